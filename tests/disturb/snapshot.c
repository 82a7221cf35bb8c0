#include "snapshot.h"

#include "fixture.h"

#include <ftw.h>

static Snapshot *taken;
static size_t length;

static int take_file(const char *path, const struct stat *about, int kind, struct FTW *at) {
    (void)at;
    const char *ending = strrchr(path, '.');
    // a study's store, of files named by who wrote them
    if (kind != FTW_F || (ending && !strcmp(ending, ".cases"))) return 0;
    assert_true(taken->count < SNAPSHOT_FILES);
    SnapshotFile *file = &taken->files[taken->count++];
    *file = (SnapshotFile){.path = strdup(path + length + 1), .bytes = calloc(1, (size_t)about->st_size + 1)};
    FILE *stream = fopen(path, "r");
    if (stream) file->size = fread(file->bytes, 1, (size_t)about->st_size, stream);
    if (stream) fclose(stream);
    return 0;
}

static int by_path(const void *one, const void *other) {
    return strcmp(((const SnapshotFile *)one)->path, ((const SnapshotFile *)other)->path);
}

void snapshot_take(Snapshot *snapshot, const char *folder) {
    *snapshot = (Snapshot){0};
    taken = snapshot;
    length = strlen(folder);
    nftw(folder, take_file, 16, FTW_PHYS);
    qsort(snapshot->files, (size_t)snapshot->count, sizeof *snapshot->files, by_path);
}

void snapshot_free(Snapshot *snapshot) {
    for (int i = 0; i < snapshot->count; i++) {
        free(snapshot->files[i].path);
        free(snapshot->files[i].bytes);
    }
    *snapshot = (Snapshot){0};
}

static const SnapshotFile *find(const Snapshot *snapshot, const char *path) {
    for (int i = 0; i < snapshot->count; i++)
        if (!strcmp(snapshot->files[i].path, path)) return &snapshot->files[i];
    return NULL;
}

static bool is_same(const SnapshotFile *one, const SnapshotFile *other) {
    return one->size == other->size && !memcmp(one->bytes, other->bytes, one->size);
}

// Memory, load and what is drawn of times, which may be alike by chance.
static bool holds_measurements(const char *path) {
    if (!strncmp(path, "charts/", 7)) return true;
    return !strcmp(path, "runs.csv") || !strcmp(path, "machine.csv") || !strcmp(path, "study.csv");
}

void snapshot_mark(Snapshot *snapshot, const Snapshot *other) {
    for (int i = 0; i < snapshot->count; i++) {
        const SnapshotFile *twin = find(other, snapshot->files[i].path);
        snapshot->files[i].is_stable = twin && !holds_measurements(twin->path) && is_same(&snapshot->files[i], twin);
    }
}

static int count_lines(const SnapshotFile *file) {
    int lines = 0;
    for (size_t i = 0; i < file->size; i++) lines += file->bytes[i] == '\n';
    return lines;
}

static const char *end_of(const SnapshotFile *file) {
    return file->bytes + (file->size > 6 ? file->size - 6 : 0);
}

// What holds times is whole where a table has as many lines; a drawing or page, where its end is there.
static bool is_whole(const SnapshotFile *file, const SnapshotFile *undisturbed) {
    const char *ending = strrchr(file->path, '.');
    if (undisturbed->is_stable) return is_same(file, undisturbed);
    if (ending && (!strcmp(ending, ".csv") || !strcmp(ending, ".axes")))
        return count_lines(file) == count_lines(undisturbed);
    return !strcmp(end_of(file), end_of(undisturbed));
}

void snapshot_assert_whole(const Snapshot *snapshot, const Snapshot *undisturbed, const char *what) {
    for (int i = 0; i < snapshot->count; i++) {
        const SnapshotFile *file = &snapshot->files[i], *twin = find(undisturbed, file->path);
        // what a study keeps to go on with is no result, nor is what a tool said
        const char *ending = strrchr(file->path, '.');
        if (!strncmp(file->path, "study/", 6) || (ending && !strcmp(ending, ".log"))) continue;
        if (twin && !is_whole(file, twin)) fail_msg("%s: %s is not whole:\n%.300s", what, file->path, file->bytes);
    }
}

void snapshot_assert_same(const Snapshot *snapshot, const Snapshot *undisturbed, const char *what) {
    for (int i = 0; i < undisturbed->count; i++)
        if (!find(snapshot, undisturbed->files[i].path))
            fail_msg("%s: there is no %s", what, undisturbed->files[i].path);
    for (int i = 0; i < snapshot->count; i++)
        if (!find(undisturbed, snapshot->files[i].path))
            fail_msg("%s: %s is left behind", what, snapshot->files[i].path);
    snapshot_assert_whole(snapshot, undisturbed, what);
}
