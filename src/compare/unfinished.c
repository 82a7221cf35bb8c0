#include "unfinished.h"

#include "csv_reader.h"
#include "files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define QUESTION "question"
#define SCENES "scenes"

static int remove_one(const char *path, const struct stat *about, int kind, struct FTW *at) {
    (void)about, (void)kind;
    // what is locked goes last, with its folder
    return at->level == 1 && !strcmp(path + at->base, QUESTION) ? 0 : at->level ? remove(path) : 0;
}

// All but the question.
static void empty(const char *directory) {
    nftw(directory, remove_one, 16, FTW_DEPTH | FTW_PHYS);
}

// How many names a folder has, but for those of ours.
static int count_names(const char *directory, const char *const *ours) {
    int count = 0;
    DIR *folder = directory ? opendir(directory) : NULL;
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        bool is_ours = *entry->d_name == '.';
        for (const char *const *name = ours; *name && !is_ours; name++) is_ours = !strcmp(entry->d_name, *name);
        count += !is_ours;
    }
    if (folder) closedir(folder);
    return count;
}

static int count_scenes(const char *directory) {
    char *scenes = ck_path_join(directory, SCENES);
    const int count = count_names(scenes, (const char *const[]){NULL});
    free(scenes);
    return count;
}

static bool is_asked(int file, const char *question) {
    const size_t length = strlen(question);
    char *text = malloc(length + 2);
    const bool is_same = text && pread(file, text, length + 1, 0) == (ssize_t)length && !memcmp(text, question, length);
    free(text);
    return is_same;
}

ck_Status ck_unfinished_open(ck_Unfinished *unfinished, const char *out, const char *question, int *dropped,
                             ck_Error *error) {
    *dropped = 0;
    *unfinished = (ck_Unfinished){.directory = ck_path_join(out, "unfinished"), .out = out, .question = -1};
    char *path = unfinished->directory ? ck_path_join(unfinished->directory, QUESTION) : NULL;
    int failed = path ? ck_path_make(unfinished->directory) : ENOMEM;
    if (!failed && (unfinished->question = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666)) < 0) failed = errno;
    ck_Status status = failed ? ck_fail(error, CK_IO, "%s/unfinished: %s", out, strerror(failed)) : CK_OK;
    // a folder of that name that is somebody else's is not ours to empty
    static const char *const ours[] = {QUESTION, SCENES, CK_REPLAY_DIRECTORY, NULL};
    struct stat about;
    if (!status && !fstat(unfinished->question, &about) && !about.st_size && count_names(unfinished->directory, ours)) {
        status = ck_fail(error, CK_BAD_INPUT,
                         "%s: is no folder of an unfinished comparison; give another --out, or move it away",
                         unfinished->directory);
        unlink(path);
    }
    if (!status && !ck_file_lock(unfinished->question, false))
        status = ck_fail(error, CK_BAD_INPUT, "%s: another comparison is running there; give another --out", out);
    if (!status && !is_asked(unfinished->question, question)) {
        *dropped = count_scenes(unfinished->directory);
        empty(unfinished->directory);
        if (ftruncate(unfinished->question, 0) || lseek(unfinished->question, 0, SEEK_SET) ||
            !ck_file_write(unfinished->question, question, strlen(question)))
            status = ck_fail(error, CK_IO, "%s: %s", path, strerror(errno));
    }
    if (!status) unfinished->kept = count_scenes(unfinished->directory);
    free(path);
    return status;
}

static char *folder_of(const ck_Unfinished *unfinished, const ck_Comparison *comparison) {
    char *scenes = ck_path_join(unfinished->directory, SCENES),
         *folder = scenes ? ck_path_join(scenes, comparison->model.name) : NULL;
    free(scenes);
    return folder;
}

bool ck_unfinished_take(const ck_Unfinished *unfinished, const ck_Comparison *comparison, ck_Tables *tables) {
    if (!unfinished->directory) return false;
    ck_CsvTable read[CK_COMPARISON_LAYOUTS] = {0};
    char *folder = folder_of(unfinished, comparison);
    bool is_whole = folder != NULL;
    for (int i = 0; i < CK_COMPARISON_LAYOUTS && is_whole; i++)
        is_whole = !ck_csv_table_read(&read[i], folder, &ck_layouts[i], NULL);
    for (int i = 0; i < CK_COMPARISON_LAYOUTS; i++) {
        for (int row = 0; row < read[i].row_count && is_whole && i != CK_MACHINE; row++)
            for (int k = 0; k < read[i].column_count; k++)
                ck_csv_text(&tables->csv[i], ck_csv_table_text(&read[i], row, k));
        ck_csv_table_free(&read[i]);
    }
    free(folder);
    return is_whole;
}

static bool is_in_place(const ck_Unfinished *unfinished) {
    char *path = ck_path_join(unfinished->directory, QUESTION);
    struct stat named, held;
    const bool is = path && !stat(path, &named) && !fstat(unfinished->question, &held) && named.st_ino == held.st_ino;
    free(path);
    return is;
}

ck_Status ck_unfinished_keep(const ck_Unfinished *unfinished, const ck_Comparison *comparison,
                             const ck_CompareOptions *options, ck_Error *error) {
    ck_Tables tables = {0};
    char *folder = folder_of(unfinished, comparison);
    ck_Status status = folder ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    // what is written without its question is nobody's
    if (!status && !is_in_place(unfinished))
        status = ck_fail(error, CK_IO, "%s: was moved or removed while the comparison ran", unfinished->directory);
    if (!status) status = ck_replay_write(comparison, unfinished->directory, false, CK_REPLAY_FRAMES, error);
    if (!status) status = ck_tables_open(&tables, folder, CK_KEEP_NONE, false, comparison, 1, options, error);
    if (!status) ck_tables_add(&tables, comparison, options);
    // machine.csv is the last of them: with it the scene is whole
    if (!status) status = ck_tables_close(&tables, error);
    ck_tables_discard(&tables);
    free(folder);
    return status;
}

static ck_Status move_replays(const ck_Unfinished *unfinished, ck_Error *error) {
    char *from = ck_path_join(unfinished->directory, CK_REPLAY_DIRECTORY),
         *to = ck_path_join(unfinished->out, CK_REPLAY_DIRECTORY);
    int failed = from && to ? ck_path_make(to) : ENOMEM;
    DIR *folder = failed ? NULL : opendir(from);
    for (struct dirent *entry; folder && !failed && (entry = readdir(folder));) {
        if (*entry->d_name == '.') continue;
        char *old = ck_path_join(from, entry->d_name), *new = ck_path_join(to, entry->d_name);
        failed = !old || !new ? ENOMEM : rename(old, new) ? errno : 0;
        free(old);
        free(new);
    }
    ck_Status status = failed ? ck_fail(error, CK_IO, "%s: %s", to ? to : unfinished->out, strerror(failed)) : CK_OK;
    if (folder) closedir(folder);
    free(from);
    free(to);
    return status;
}

ck_Status ck_unfinished_finish(ck_Unfinished *unfinished, ck_Error *error) {
    if (!unfinished->directory) return CK_OK;
    ck_Status status = move_replays(unfinished, error);
    char *path = status ? NULL : ck_path_join(unfinished->directory, QUESTION);
    if (!status) empty(unfinished->directory);
    if (path) unlink(path);
    if (path) rmdir(unfinished->directory);
    free(path);
    return status;
}

void ck_unfinished_close(ck_Unfinished *unfinished) {
    if (unfinished->directory && unfinished->question >= 0) close(unfinished->question);
    free(unfinished->directory);
    *unfinished = (ck_Unfinished){0};
}
