#include "store.h"

#include "files.h"
#include "process.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define ENDING ".cases"

static ck_Status fail_memory(ck_Error *error) {
    return ck_fail(error, CK_NO_MEMORY, "out of memory");
}

static bool is_records(const char *name) {
    const size_t length = strlen(name), ending = strlen(ENDING);
    return length > ending && !strcmp(name + length - ending, ENDING);
}

static int compare_names(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

// In the order of their names, so that of two records of a case the same one counts each time.
static ck_Status list_files(ck_Store *store, ck_Error *error) {
    DIR *directory = opendir(store->directory);
    ck_Status status = CK_OK;
    if (!directory && errno != ENOENT) return ck_fail(error, CK_IO, "%s: %s", store->directory, strerror(errno));
    for (struct dirent *entry; directory && !status && (entry = readdir(directory));) {
        if (!is_records(entry->d_name)) continue;
        char **grown = realloc(store->files, ((size_t)store->file_count + 1) * sizeof *grown);
        if (grown) store->files = grown;
        if (grown) grown[store->file_count] = strdup(entry->d_name);
        if (!grown || !grown[store->file_count])
            status = fail_memory(error);
        else
            store->file_count++;
    }
    if (directory) closedir(directory);
    if (store->file_count) qsort(store->files, (size_t)store->file_count, sizeof *store->files, compare_names);
    return status;
}

static ck_StoreEntry *slot_of(const ck_Store *store, uint64_t key) {
    size_t at = (size_t)(key * 0x9e3779b97f4a7c15u >> 20) & (store->capacity - 1);
    while (store->entries[at].bytes && store->entries[at].key != key) at = (at + 1) & (store->capacity - 1);
    return &store->entries[at];
}

static bool grow(ck_Store *store) {
    ck_Store grown = *store;
    grown.capacity = store->capacity ? 2 * store->capacity : 1024;
    grown.entries = calloc(grown.capacity, sizeof *grown.entries);
    if (!grown.entries) return false;
    for (size_t i = 0; i < store->capacity; i++)
        if (store->entries[i].bytes) *slot_of(&grown, store->entries[i].key) = store->entries[i];
    free(store->entries);
    *store = grown;
    return true;
}

static bool keep(ck_Store *store, const ck_StoreEntry *entry) {
    if (2 * (store->count + 1) > store->capacity && !grow(store)) return false;
    ck_StoreEntry *slot = slot_of(store, entry->key);
    if (slot->bytes) return true; // the first one counts
    *slot = *entry;
    store->count++;
    return true;
}

// One record after the other; the first that is not whole ends the file, as its process ended there.
static ck_Status read_file(ck_Store *store, int number, ck_Error *error) {
    char *path = ck_path_join(store->directory, store->files[number]), *text = NULL;
    size_t room = 0;
    struct stat about = {0};
    FILE *file = path ? fopen(path, "re") : NULL;
    ck_Status status = path ? CK_OK : fail_memory(error);
    // one that is gone by now has no cases
    if (path && !file && errno != ENOENT)
        status = ck_fail(error, ck_file_status(errno), "%s: %s", path, strerror(errno));
    free(path);
    if (file && (fstat(fileno(file), &about) || !S_ISREG(about.st_mode))) about.st_size = 0;
    for (bool is_whole = file != NULL; is_whole && !status;) {
        ck_StoreEntry entry = {.file = (uint32_t)number};
        size_t bytes;
        uint64_t check;
        char line[160];
        is_whole =
            fgets(line, sizeof line, file) && strchr(line, '\n') &&
            sscanf(line, "case %16" SCNx64 " %zu %lf %16" SCNx64, &entry.key, &bytes, &entry.cost, &check) == 4 &&
            bytes && bytes < UINT32_MAX;
        if (!is_whole) break;
        entry.place = ftello(file);
        // what a damaged line asks for may be any size
        if (bytes >= (uint64_t)(about.st_size - entry.place)) break;
        entry.bytes = (uint32_t)bytes;
        if (bytes + 1 > room) {
            free(text);
            room = 2 * bytes + 1;
            text = malloc(room);
        }
        if (!text)
            status = fail_memory(error);
        else
            is_whole = fread(text, 1, bytes + 1, file) == bytes + 1 && text[bytes] == '\n' &&
                       ck_hash(CK_HASH_START, text, bytes) == check;
        if (is_whole && !status && !keep(store, &entry)) status = fail_memory(error);
    }
    if (file && ferror(file) && !status)
        status = ck_fail(error, ck_file_status(errno), "%s: %s", store->files[number], strerror(errno));
    if (file) fclose(file);
    free(text);
    return status;
}

ck_Status ck_store_open(ck_Store *store, const char *directory, ck_Error *error) {
    *store = (ck_Store){.directory = strdup(directory)};
    if (!store->directory || !grow(store)) return fail_memory(error);
    ck_Status status = list_files(store, error);
    for (int i = 0; i < store->file_count && !status; i++) status = read_file(store, i, error);
    return status;
}

void ck_store_free(ck_Store *store) {
    for (int i = 0; i < store->file_count; i++) free(store->files[i]);
    free(store->files);
    free(store->entries);
    free(store->directory);
    *store = (ck_Store){0};
}

const ck_StoreEntry *ck_store_find(const ck_Store *store, uint64_t key) {
    const ck_StoreEntry *entry = slot_of(store, key);
    return entry->bytes ? entry : NULL;
}

char *ck_store_text(const ck_Store *store, const ck_StoreEntry *entry, ck_StoreFile *file, ck_Error *error) {
    if (file->number != (int)entry->file) {
        if (file->file >= 0) close(file->file);
        char *path = ck_path_join(store->directory, store->files[entry->file]);
        file->file = path ? open(path, O_RDONLY | O_CLOEXEC) : -1;
        file->number = file->file < 0 ? -1 : (int)entry->file;
        free(path);
    }
    char *text = malloc((size_t)entry->bytes + 1);
    if (!text) {
        fail_memory(error);
        return NULL;
    }
    if (file->file >= 0 && pread(file->file, text, entry->bytes, entry->place) == (ssize_t)entry->bytes) {
        text[entry->bytes] = 0;
        return text;
    }
    ck_fail(error, CK_IO, "%s/%s: a case that was there cannot be read: %s", store->directory,
            store->files[entry->file], strerror(errno));
    free(text);
    return NULL;
}

ck_Status ck_store_writer_open(ck_StoreWriter *writer, const char *directory, ck_Error *error) {
    char host[65] = "host";
    *writer = (ck_StoreWriter){.file = -1};
    gethostname(host, sizeof host - 1);
    for (char *letter = host; *letter; letter++)
        if (!isalnum((unsigned char)*letter)) *letter = '_';
    // a number may come again once its process is gone: what it has left stays
    for (int tries = 0; writer->file < 0 && tries < 10000; tries++) {
        free(writer->path);
        if (asprintf(&writer->path, "%s/%s.%d-%d" ENDING, directory, host, (int)getpid(), tries) < 0) {
            writer->path = NULL;
            return fail_memory(error);
        }
        writer->file = open(writer->path, O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
        if (writer->file < 0 && errno != EEXIST) break;
    }
    return writer->file >= 0 ? CK_OK : ck_fail(error, CK_IO, "%s: %s", writer->path, strerror(errno));
}

ck_Status ck_store_add(const ck_StoreWriter *writer, uint64_t key, double cost, const char *text, size_t bytes,
                       ck_Error *error) {
    char *record;
    const off_t before = lseek(writer->file, 0, SEEK_END);
    const int head = asprintf(&record, "case %016" PRIx64 " %zu %.6g %016" PRIx64 "\n%s\n", key, bytes, cost,
                              ck_hash(CK_HASH_START, text, bytes), text);
    if (head < 0) return fail_memory(error);
    const bool is_written = ck_file_write(writer->file, record, (size_t)head);
    const int why = errno;
    free(record);
    if (is_written) return CK_OK;
    // half a record would hide those after it
    if (before >= 0 && ftruncate(writer->file, before))
        return ck_fail(error, CK_IO, "%s: %s", writer->path, strerror(errno));
    return ck_fail(error, CK_IO, "%s: %s", writer->path, strerror(why));
}

void ck_store_writer_close(ck_StoreWriter *writer) {
    if (!writer->path) return;
    // one that wrote nothing leaves nothing
    if (writer->file >= 0 && lseek(writer->file, 0, SEEK_END) == 0) unlink(writer->path);
    if (writer->file >= 0) close(writer->file);
    free(writer->path);
    *writer = (ck_StoreWriter){.file = -1};
}

ck_Status ck_board_open(ck_Board *board, const char *directory, uint64_t study, ck_Error *error) {
    *board = (ck_Board){.file = -1};
    if (asprintf(&board->path, "%s/board-%016" PRIx64, directory, study) < 0) {
        board->path = NULL;
        return fail_memory(error);
    }
    board->file = open(board->path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    return board->file >= 0 ? CK_OK : ck_fail(error, CK_IO, "%s: %s", board->path, strerror(errno));
}

void ck_board_close(ck_Board *board) {
    if (!board->path) return;
    if (board->file >= 0) close(board->file);
    free(board->path);
    *board = (ck_Board){.file = -1};
}

static int lock(const ck_Board *board, int index, short type) {
    struct flock range = {.l_type = type, .l_whence = SEEK_SET, .l_start = index, .l_len = 1};
    return fcntl(board->file, F_OFD_SETLK, &range);
}

ck_Claim ck_board_claim(const ck_Board *board, int index) {
    unsigned char mark = 0;
    if (pread(board->file, &mark, 1, index) == 1 && mark) return CK_CLAIM_DONE;
    if (lock(board, index, F_WRLCK)) return errno == EAGAIN || errno == EACCES ? CK_CLAIM_TAKEN : CK_CLAIM_NO_LOCKS;
    // who had it may have ended it meanwhile
    if (pread(board->file, &mark, 1, index) != 1 || !mark) return CK_CLAIM_MINE;
    lock(board, index, F_UNLCK);
    return CK_CLAIM_DONE;
}

void ck_board_mark(const ck_Board *board, int index, bool is_done) {
    const unsigned char mark = is_done;
    // a mark that cannot be written costs a run, not a result
    if (pwrite(board->file, &mark, 1, index) != 1) return;
}

void ck_board_end(const ck_Board *board, int index, bool is_done) {
    if (is_done) ck_board_mark(board, index, true);
    lock(board, index, F_UNLCK);
}

bool ck_board_read(const ck_Board *board, unsigned char *marks, int count) {
    memset(marks, 0, (size_t)count);
    return pread(board->file, marks, (size_t)count, 0) >= 0;
}

bool ck_board_is_free(const ck_Board *board) {
    struct flock range = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    return !fcntl(board->file, F_OFD_GETLK, &range) && range.l_type == F_UNLCK;
}

bool ck_board_lock_results(const ck_Board *board, int count) {
    while (lock(board, count, F_WRLCK)) {
        if ((errno != EAGAIN && errno != EACCES) || ck_child_interrupted) return false;
        nanosleep(&(struct timespec){.tv_nsec = 50000000}, NULL);
    }
    return true;
}
