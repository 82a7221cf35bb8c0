#include "mesh.h"

#include "files.h"
#include "mesh_import.h"
#include "process.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

// A file's size in MiB gives what reading it may take: a whole one takes some 0.1 s and ten times its size; one that
// claims to be larger than it is would take all there is. A child starts with what its parent has.
static ck_Limits limits_for(off_t size) {
    const double mebibytes = (double)size / (1 << 20);
    return (ck_Limits){.seconds = 2 + 0.5 * mebibytes,
                       .memory_bytes = ck_process_memory() + ((size_t)512 << 20) + 24 * (size_t)size};
}

// A child's work: its mesh goes to file, and its error to memory that both see.
typedef struct Import {
    const char *path;
    const ck_MeshOptions *options;
    int file;
    struct Outcome {
        ck_Status status;
        ck_Error error;
    } * outcome;
} Import;

static void import(void *context) {
    const Import *job = context;
    FILE *out = fdopen(dup(job->file), "w");
    job->outcome->status = out ? ck_mesh_import(out, job->path, job->options, &job->outcome->error)
                               : ck_fail(&job->outcome->error, CK_IO, "%s", strerror(errno));
    if (out) fclose(out);
}

static bool take(FILE *in, void *items, size_t size, size_t count) {
    return fread(items, size, count, in) == count;
}

static bool take_groups(FILE *in, ck_Mesh *mesh) {
    int count;
    if (!take(in, &count, sizeof count, 1) || count < 0) return false;
    mesh->groups = calloc((size_t)count + 1, sizeof *mesh->groups);
    for (int i = 0; i < count && mesh->groups; i++) {
        ck_MeshGroup *group = &mesh->groups[mesh->group_count++];
        if (!take(in, group->name, sizeof group->name, 1) || !take(in, &group->vertex_count, sizeof(int), 1))
            return false;
        group->vertices = malloc(((size_t)group->vertex_count + 1) * sizeof(int));
        if (!group->vertices || !take(in, group->vertices, sizeof(int), (size_t)group->vertex_count)) return false;
    }
    return mesh->groups != NULL;
}

// Takes back what ck_mesh_import wrote. False without memory.
static bool take_mesh(ck_Mesh *mesh, int file) {
    FILE *in = fdopen(dup(file), "r");
    if (!in) return false;
    rewind(in);
    bool is_whole = take(in, &mesh->vertex_count, sizeof(int), 1) && take(in, &mesh->triangle_count, sizeof(int), 1);
    if (is_whole) {
        mesh->position = malloc(((size_t)mesh->vertex_count + 1) * sizeof(double[3]));
        mesh->triangles = malloc(((size_t)mesh->triangle_count + 1) * sizeof(int[3]));
        is_whole = mesh->position && mesh->triangles &&
                   take(in, mesh->position, sizeof(double[3]), (size_t)mesh->vertex_count) &&
                   take(in, mesh->triangles, sizeof(int[3]), (size_t)mesh->triangle_count) && take_groups(in, mesh);
    }
    fclose(in);
    return is_whole;
}

static ck_Status check_file(ck_Limits *limits, const char *path, ck_Error *error) {
    static const char *const endings[] = {".obj", ".ply", ".stl", ".gltf", ".glb"};
    struct stat info;
    const char *ending = strrchr(path, '.');
    bool is_known = false;
    for (size_t i = 0; i < sizeof endings / sizeof *endings && ending; i++) is_known |= !strcasecmp(ending, endings[i]);
    if (stat(path, &info))
        return ck_fail(error, ck_file_status(errno), "%s: %s; give the path of a mesh", path, strerror(errno));
    if (!S_ISREG(info.st_mode)) return ck_fail(error, CK_BAD_INPUT, "%s: is not a file; give the path of a mesh", path);
    if (!is_known)
        return ck_fail(error, CK_BAD_INPUT, "%s: is of no known kind; a mesh is a .obj, .ply, .stl, .gltf or .glb",
                       path);
    if (info.st_size > (off_t)CK_MESH_MAX_BYTES)
        return ck_fail(error, CK_BAD_INPUT, "%s: is %lld MiB long; a mesh has at most %u", path,
                       (long long)info.st_size >> 20, CK_MESH_MAX_BYTES >> 20);
    *limits = limits_for(info.st_size);
    return CK_OK;
}

ck_Status ck_mesh_load(ck_Mesh *mesh, const char *path, const ck_MeshOptions *options, ck_Error *error) {
    *mesh = (ck_Mesh){0};
    ck_Limits limits;
    ck_Status status = check_file(&limits, path, error);
    if (status) return status;
    ck_ChildResult result;
    Import job = {.path = path, .options = options, .file = memfd_create("mesh", MFD_CLOEXEC)};
    job.outcome = ck_shared_allocate(sizeof *job.outcome);
    if (job.file < 0 || !job.outcome) status = ck_fail(error, CK_NO_MEMORY, "%s: out of memory", path);
    if (!status) status = ck_child_run(&result, import, &job, &limits, error);
    if (!status && result.end != CK_CHILD_DONE)
        status = ck_fail(error, CK_BAD_INPUT, "%s: cannot be read as a mesh: %s", path, result.reason);
    else if (!status && job.outcome->status)
        status = ck_fail(error, job.outcome->status, "%s: %s", path, job.outcome->error.message);
    if (!status && !take_mesh(mesh, job.file)) status = ck_fail(error, CK_NO_MEMORY, "%s: out of memory", path);
    if (job.file >= 0) close(job.file);
    ck_shared_free(job.outcome, sizeof *job.outcome);
    return status;
}

void ck_mesh_free(ck_Mesh *mesh) {
    for (int i = 0; i < mesh->group_count; i++) free(mesh->groups[i].vertices);
    free(mesh->groups);
    free(mesh->triangles);
    free(mesh->position);
    *mesh = (ck_Mesh){0};
}

static int compare_edges(const void *a, const void *b) {
    const int *x = a, *y = b;
    return x[0] != y[0] ? (x[0] > y[0]) - (x[0] < y[0]) : (x[1] > y[1]) - (x[1] < y[1]);
}

ck_Status ck_mesh_edges(int (**edges)[2], int *edge_count, const int (*triangles)[3], int triangle_count) {
    *edges = malloc(((size_t)triangle_count * 3 + 1) * sizeof **edges);
    if (!*edges) return CK_NO_MEMORY;
    for (int i = 0; i < 3 * triangle_count; i++) {
        const int a = triangles[i / 3][i % 3], b = triangles[i / 3][(i + 1) % 3];
        (*edges)[i][0] = a < b ? a : b;
        (*edges)[i][1] = a < b ? b : a;
    }
    qsort(*edges, (size_t)triangle_count * 3, sizeof **edges, compare_edges);
    int kept = 0;
    for (int i = 0; i < 3 * triangle_count; i++)
        if (!kept || compare_edges((*edges)[i], (*edges)[kept - 1]))
            memcpy((*edges)[kept++], (*edges)[i], sizeof **edges);
    *edge_count = kept;
    return CK_OK;
}
