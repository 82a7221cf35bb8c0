#include "out_folder.h"

#include "files.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

// Takes the last folder off a path. False where there is none above it.
static bool climb(char *path) {
    char *slash = strrchr(path, '/');
    if (!slash || slash == path) return false;
    *slash = 0;
    return true;
}

// How many folders of a path are not there yet.
static int count_missing(const char *path) {
    char above[4096];
    int missing = 0;
    snprintf(above, sizeof above, "%s", path);
    do missing += access(above, F_OK) != 0;
    while (climb(above));
    return missing;
}

// One that fails takes the folder that it made away, even while another waits for it.
static ck_Status claim(ck_OutFolder *folder, const char *path, bool shares, ck_Error *error) {
    do {
        if (folder->file >= 0) close(folder->file);
        folder->file = -1;
        const int failed = ck_path_make(path);
        if (failed) return ck_fail(error, CK_IO, "%s: %s", path, strerror(failed));
        folder->file = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (folder->file < 0 && errno == ENOTDIR)
            return ck_fail(error, CK_BAD_INPUT, "%s: is no folder; give another --out", path);
        if (folder->file < 0 && errno != ENOENT) return ck_fail(error, CK_IO, "%s: %s", path, strerror(errno));
        if (folder->file >= 0 && !ck_file_lock(folder->file, shares))
            return ck_fail(error, CK_BAD_INPUT,
                           "%s: another clothcheck is writing there; wait for it, or give another --out", path);
    } while (folder->file < 0 || !ck_file_is_named(folder->file, path));
    return CK_OK;
}

ck_Status ck_out_folder_claim(ck_OutFolder *folder, const char *path, bool shares, ck_Error *error) {
    *folder = (ck_OutFolder){.file = -1, .made = count_missing(path)};
    const ck_Status status = claim(folder, path, shares, error);
    if (folder->file >= 0) folder->path = path;
    if (status) folder->made = 0;
    return status;
}

void ck_out_folder_leave(ck_OutFolder *folder) {
    char path[4096];
    // all that inherited it let it go, too
    if (folder->path && folder->file >= 0) flock(folder->file, LOCK_UN);
    if (folder->path && folder->file >= 0) close(folder->file);
    snprintf(path, sizeof path, "%s", folder->path ? folder->path : "");
    // with slashes at its end a path has a folder twice
    for (int i = 0; i < folder->made && folder->path && (!rmdir(path) || errno == ENOENT); i++)
        if (!climb(path)) break;
    *folder = (ck_OutFolder){.file = -1};
}
