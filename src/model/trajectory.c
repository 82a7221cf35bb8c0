#include "trajectory.h"

#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

// the states, then the contact forces and the turns
static size_t mapped_bytes(const ck_Trajectory *trajectory) {
    return trajectory->bytes +
           (3 * sizeof(double) + (size_t)trajectory->rigid_count * sizeof(ck_Turn)) * (size_t)trajectory->capacity;
}

// A path of so many bytes is in a file without a name, so that the paths of a comparison may be more than fit into
// memory.
#define LARGE ((size_t)64 << 20)

// Its descriptor; −1: the path is small, or there is no room on the disk.
static int open_file(size_t bytes) {
    if (bytes < LARGE) return -1;
    const char *directory = getenv("TMPDIR");
    const int file = open(directory && *directory ? directory : "/var/tmp", O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    // else a write would find out that the disk is full, by a signal
    if (file < 0 || !posix_fallocate(file, 0, (off_t)bytes)) return file;
    close(file);
    return -1;
}

static void *map(size_t bytes) {
    const int file = open_file(bytes), kind = file < 0 ? MAP_ANONYMOUS | MAP_NORESERVE : 0;
    void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | kind, file, 0);
    if (file >= 0) close(file);
    return memory;
}

ck_Status ck_trajectory_create(ck_Trajectory *trajectory, const ck_Model *model, ck_Error *error) {
    *trajectory = (ck_Trajectory){.particle_count = model->particle_count,
                                  .rigid_count = model->rigid_count,
                                  .capacity = model->frame_count + 1,
                                  .step = model->step};
    trajectory->bytes = sizeof(double) * 6 * (size_t)model->particle_count * (size_t)trajectory->capacity;
    void *data = map(mapped_bytes(trajectory));
    if (data == MAP_FAILED)
        return ck_fail(error, CK_NO_MEMORY, "%s: no memory for %d frames of %d particles", model->name,
                       trajectory->capacity, model->particle_count);
    trajectory->data = data;
    double *contact = trajectory->data + trajectory->bytes / sizeof(double);
    if (model->collider_count) trajectory->contact = contact;
    for (int i = 0; i < 3 * trajectory->capacity && trajectory->contact; i++) contact[i] = NAN;
    if (model->rigid_count) trajectory->turn = (ck_Turn *)(contact + 3 * (size_t)trajectory->capacity);
    return CK_OK;
}

void ck_trajectory_rest(const ck_Trajectory *trajectory) {
    const size_t bytes = trajectory->data ? mapped_bytes(trajectory) : 0;
    if (bytes >= LARGE) madvise(trajectory->data, bytes, MADV_DONTNEED);
}

void ck_trajectory_free(ck_Trajectory *trajectory) {
    if (trajectory->data) munmap(trajectory->data, mapped_bytes(trajectory));
    *trajectory = (ck_Trajectory){0};
}

double *ck_trajectory_position(const ck_Trajectory *trajectory, int frame) {
    return trajectory->data + 6 * (size_t)trajectory->particle_count * (size_t)frame;
}

double *ck_trajectory_velocity(const ck_Trajectory *trajectory, int frame) {
    return ck_trajectory_position(trajectory, frame) + 3 * (size_t)trajectory->particle_count;
}

ck_Turn *ck_trajectory_turn(const ck_Trajectory *trajectory, int frame) {
    if (!trajectory->turn) return NULL;
    return trajectory->turn + (size_t)trajectory->rigid_count * (size_t)frame;
}
