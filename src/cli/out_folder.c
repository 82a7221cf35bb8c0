#include "out_folder.h"

#include "files.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <time.h>
#include <unistd.h>

ck_Status ck_out_folder_claim(ck_OutFolder *folder, const char *path, bool shares, ck_Error *error) {
    *folder = (ck_OutFolder){.file = -1, .is_made = access(path, F_OK) != 0};
    const int failed = ck_path_make(path);
    if (failed) return ck_fail(error, CK_IO, "%s: %s", path, strerror(failed));
    folder->path = path;
    folder->file = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder->file < 0 && errno == ENOTDIR)
        return ck_fail(error, CK_BAD_INPUT, "%s: is no folder; give another --out", path);
    if (folder->file < 0) return ck_fail(error, CK_IO, "%s: %s", path, strerror(errno));
    if (ck_file_lock(folder->file, shares)) return CK_OK;
    folder->is_made = false;
    return ck_fail(error, CK_BAD_INPUT, "%s: another clothcheck is writing there; wait for it, or give another --out",
                   path);
}

void ck_out_folder_leave(ck_OutFolder *folder) {
    // all that inherited it let it go, too
    if (folder->path && folder->file >= 0) flock(folder->file, LOCK_UN);
    if (folder->path && folder->file >= 0) close(folder->file);
    if (folder->path && folder->is_made) rmdir(folder->path);
    *folder = (ck_OutFolder){.file = -1};
}
