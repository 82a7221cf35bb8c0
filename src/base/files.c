#include "files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

ck_Status ck_file_read(char **bytes, size_t *size, const char *path, ck_Error *error) {
    *bytes = NULL;
    *size = 0;
    FILE *file = fopen(path, "rb");
    if (!file) return ck_fail(error, CK_IO, "%s: %s", path, strerror(errno));
    size_t capacity = 0;
    ck_Status status = CK_OK;
    do {
        if (capacity - *size < 2) {
            capacity = capacity ? 2 * capacity : 1 << 16;
            char *more = realloc(*bytes, capacity);
            if (!more) status = ck_fail(error, CK_NO_MEMORY, "%s: out of memory", path);
            if (more) *bytes = more;
        }
        if (!status) *size += fread(*bytes + *size, 1, capacity - *size - 1, file);
    } while (!status && !feof(file) && !ferror(file));
    if (!status && ferror(file)) status = ck_fail(error, CK_IO, "%s: %s", path, strerror(errno));
    if (!status) (*bytes)[*size] = 0;
    fclose(file);
    return status;
}

ck_Status ck_file_status(int why) {
    static const int inputs[] = {ENOENT, ENOTDIR, EISDIR, EACCES, EPERM, ELOOP, ENAMETOOLONG, EINVAL};
    for (size_t i = 0; i < sizeof inputs / sizeof *inputs; i++)
        if (why == inputs[i]) return CK_BAD_INPUT;
    return why == ENOMEM ? CK_NO_MEMORY : CK_IO;
}

size_t ck_text_mark(const char *bytes, size_t size) {
    return size >= 3 && !memcmp(bytes, "\xef\xbb\xbf", 3) ? 3 : 0;
}

char *ck_path_join(const char *directory, const char *name) {
    char *path;
    return asprintf(&path, "%s/%s", directory, name) < 0 ? NULL : path;
}

char *ck_path_part(const char *directory, const char *name) {
    char *path;
    return asprintf(&path, "%s/%s.%d.part", directory, name, (int)getpid()) < 0 ? NULL : path;
}

bool ck_path_data(char *out, size_t size) {
    char program[4096];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = 0;
    for (int i = 0; i < 2 && strrchr(program, '/'); i++) *strrchr(program, '/') = 0;
    snprintf(out, size, "%s/share/clothcheck", program);
    if (!access(out, R_OK | X_OK)) return true;
    snprintf(out, size, "%s", CK_SOURCE_DIRECTORY);
    return !access(out, R_OK | X_OK);
}

bool ck_path_adapters(char *out, size_t size) {
    static const char *const places[] = {"adapters", "../libexec/clothcheck/adapters"};
    char program[4096];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = 0;
    if (strrchr(program, '/')) *strrchr(program, '/') = 0;
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        snprintf(out, size, "%s/%s", program, places[i]);
        if (!access(out, R_OK | X_OK)) return true;
    }
    return false;
}

int ck_path_make(const char *directory) {
    char path[4096];
    if (!*directory) return ENOENT;
    if (snprintf(path, sizeof path, "%s", directory) >= (int)sizeof path) return ENAMETOOLONG;
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = 0;
        if (mkdir(path, 0777) && errno != EEXIST) return errno;
        *slash = '/';
    }
    return mkdir(path, 0777) && errno != EEXIST ? errno : 0;
}

static int remove_entry(const char *path, const struct stat *about, int kind, struct FTW *place) {
    (void)about, (void)kind, (void)place;
    return remove(path);
}

void ck_path_remove(const char *path) {
    nftw(path, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

// True for NAME.NUMBER.part, what a file is called until it is whole.
static bool is_part(const char *part, const char *name) {
    const size_t length = strlen(name);
    if (strncmp(part, name, length) || part[length] != '.') return false;
    const size_t digits = strspn(part + length + 1, "0123456789");
    return digits && !strcmp(part + length + 1 + digits, ".part");
}

// Nobody holds the lock of what a killed process has left.
void ck_path_sweep(const char *directory, const char *name) {
    DIR *folder = opendir(directory);
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        if (!is_part(entry->d_name, name)) continue;
        char *path = ck_path_join(directory, entry->d_name);
        const int left = path ? open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC) : -1;
        if (left >= 0 && !flock(left, LOCK_EX | LOCK_NB)) ck_path_remove(path);
        if (left >= 0) close(left);
        free(path);
    }
    if (folder) closedir(folder);
}

bool ck_file_is_named(int file, const char *path) {
    struct stat held, named;
    return !fstat(file, &held) && !stat(path, &named) && held.st_dev == named.st_dev && held.st_ino == named.st_ino;
}

ck_Status ck_part_folder_open(ck_PartFolder *folder, const char *directory, const char *name, ck_Error *error) {
    *folder = (ck_PartFolder){.path = ck_path_part(directory, name), .lock = -1};
    if (!folder->path) return ck_fail(error, CK_NO_MEMORY, "%s/%s: out of memory", directory, name);
    ck_path_sweep(directory, name);
    for (int tries = 0; tries < 100; tries++) {
        const int failed = ck_path_make(folder->path);
        if (failed) return ck_fail(error, CK_IO, "%s: %s", folder->path, strerror(failed));
        folder->lock = open(folder->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        // one that was swept before it was locked is nobody's
        const bool is_held = folder->lock >= 0 && !flock(folder->lock, LOCK_EX | LOCK_NB);
        // where a file system has no locks nobody sweeps
        const bool is_ours = is_held || errno != EWOULDBLOCK;
        if (is_ours && ck_file_is_named(folder->lock, folder->path)) return CK_OK;
        if (folder->lock >= 0) close(folder->lock);
        folder->lock = -1;
    }
    return ck_fail(error, CK_IO, "%s: %s", folder->path, strerror(EBUSY));
}

void ck_part_folder_close(ck_PartFolder *folder) {
    if (folder->path) ck_path_remove(folder->path);
    if (folder->path && folder->lock >= 0) close(folder->lock);
    free(folder->path);
    *folder = (ck_PartFolder){.lock = -1};
}

// A new file with its lock. Below 0: errno says why.
static int open_locked(const char *path) {
    for (int tries = 0; tries < 100; tries++) {
        const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (file < 0) return -1;
        // one that was swept before it was locked is nobody's
        if (!flock(file, LOCK_EX | LOCK_NB) && ck_file_is_named(file, path)) return file;
        close(file);
    }
    errno = EBUSY;
    return -1;
}

bool ck_file_write(int file, const void *bytes, size_t size) {
    size_t done = 0;
    for (ssize_t got; done < size; done += (size_t)got) {
        got = write(file, (const char *)bytes + done, size - done);
        if (!got) errno = ENOSPC;
        if (got <= 0) return false;
    }
    return true;
}

bool ck_file_lock(int file, bool shares) {
    const struct timespec pause = {.tv_nsec = 20000000};
    for (int tries = 0; tries < 100; tries++) {
        if (!flock(file, (shares ? LOCK_SH : LOCK_EX) | LOCK_NB)) return true;
        if (errno != EWOULDBLOCK && errno != EINTR) return true;
        nanosleep(&pause, NULL);
    }
    return false;
}

ck_Status ck_whole_file_open(ck_WholeFile *whole, const char *directory, const char *name, ck_Error *error) {
    *whole = (ck_WholeFile){.path = ck_path_join(directory, name), .part = ck_path_part(directory, name)};
    if (!whole->path || !whole->part) return ck_fail(error, CK_NO_MEMORY, "%s/%s: out of memory", directory, name);
    int failed = ck_path_make(directory);
    if (failed) return ck_fail(error, CK_IO, "%s: %s", directory, strerror(failed));
    ck_path_sweep(directory, name);
    const int file = open_locked(whole->part);
    whole->file = file >= 0 ? fdopen(file, "wb") : NULL;
    if (!whole->file) ck_fail(error, CK_IO, "%s: %s", whole->part, strerror(errno));
    if (!whole->file && file >= 0) close(file);
    return whole->file ? CK_OK : CK_IO;
}

ck_Status ck_whole_file_close(ck_WholeFile *whole, ck_Error *error) {
    int failed = fflush(whole->file) || ferror(whole->file) || fsync(fileno(whole->file));
    // as long as its lock is held, nobody takes it for left behind
    if (!failed) failed = rename(whole->part, whole->path);
    ck_Status status = failed ? ck_fail(error, CK_IO, "%s: %s", whole->path, strerror(errno)) : CK_OK;
    if (failed) unlink(whole->part);
    fclose(whole->file);
    whole->file = NULL;
    ck_whole_file_discard(whole);
    return status;
}

void ck_whole_file_discard(ck_WholeFile *whole) {
    if (whole->file) unlink(whole->part);
    if (whole->file) fclose(whole->file);
    free(whole->path);
    free(whole->part);
    *whole = (ck_WholeFile){0};
}
