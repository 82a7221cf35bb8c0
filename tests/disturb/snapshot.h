// All files below a folder, to be held against those of an undisturbed run.
#ifndef SNAPSHOT_H
#define SNAPSHOT_H

#include <stdbool.h>
#include <stddef.h>

#define SNAPSHOT_FILES 200

typedef struct SnapshotFile {
    char *path; // below the folder
    char *bytes;
    size_t size;
    bool is_stable; // alike in each run; else it holds times
} SnapshotFile;

typedef struct Snapshot {
    SnapshotFile files[SNAPSHOT_FILES];
    int count;
} Snapshot;

// Of nothing where there is no such folder.
void snapshot_take(Snapshot *snapshot, const char *folder);
void snapshot_free(Snapshot *snapshot);

// Marks what is alike in two undisturbed runs.
void snapshot_mark(Snapshot *snapshot, const Snapshot *other);

// Fails the test where a file that an undisturbed run leaves is there and is not whole.
void snapshot_assert_whole(const Snapshot *snapshot, const Snapshot *undisturbed, const char *what);

// Fails the test unless there are the same files, and those that are stable are the same.
void snapshot_assert_same(const Snapshot *snapshot, const Snapshot *undisturbed, const char *what);

#endif
