// Journals that something damaged: a row that is not whole and sound is run again, and all others are kept.
#include "fixture.h"

#include "journal.h"

#include <dirent.h>
#include <sys/wait.h>
#include <unistd.h>

static bool value_name(int index, char *name, size_t size) {
    static const char *const names[] = {"error", "cpu_s"};
    if (index > 1) return false;
    snprintf(name, size, "%s", names[index]);
    return true;
}

static void keep(void *context, const char *key, const ck_JournalRow *row) {
    char *kept = context;
    assert_true(row->status >= 0 && row->status < CK_RUN_STATUS_COUNT);
    snprintf(kept + strlen(kept), 100, "%s %d %g; ", key, row->status, row->values[0]);
}

static void test_damaged_rows(void **state) {
    (void)state;
    static const struct {
        const char *row, *kept;
    } cases[] = {
        {"a,0,fine,0.5,1\n", "a 0 0.5; "},
        {"a,10,refused,,\n", "a 10 nan; "},
        {"a,99,beyond the last,0.5,1\n", ""},
        {"a,-1,before the first,0.5,1\n", ""},
        {"a,ok,letters,0.5,1\n", ""},
        {"a,,none,0.5,1\n", ""},
        {"a,4294967296,wraps around,0.5,1\n", ""},
        {"a,0,no number,half,1\n", ""},
        {"a,0,half a number,0.5x,1\n", ""},
        {"a,0,one too few,0.5\n", ""},
        {"a,0,one too many,0.5,1,2\n", ""},
        {"a,0,cut off,0.5,1", ""},
        {"a,99,bad,1,1\nb,0,good,2,1\n", "b 0 2; "},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char directory[] = "/tmp/clothcheck-journal-XXXXXX", path[100], kept[1000] = "";
        ck_Journal journal;
        assert_non_null(mkdtemp(directory));
        snprintf(path, sizeof path, "%s/study.journal", directory);
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        fprintf(file, "question\nkey,status,reason,error,cpu_s\n%s", cases[i].row);
        fclose(file);
        ck_Error error = {0};
        if (ck_journal_open(&journal, directory, "study.journal", "question", value_name, keep, kept, &error))
            fail_msg("%s", error.message);
        if (strcmp(kept, cases[i].kept)) fail_msg("'%s' kept '%s'", cases[i].row, kept);
        ck_journal_close(&journal, true);
        rmdir(directory);
    }
}

// True as soon as a process has a file of this path open.
static bool has_open(pid_t process, const char *path) {
    char folder[60], link[400], target[400];
    snprintf(folder, sizeof folder, "/proc/%d/fd", (int)process);
    DIR *files = opendir(folder);
    bool found = false;
    for (struct dirent *entry; files && !found && (entry = readdir(files));) {
        snprintf(link, sizeof link, "%s/%s", folder, entry->d_name);
        const ssize_t length = readlink(link, target, sizeof target - 1);
        found = length == (ssize_t)strlen(path) && !memcmp(target, path, (size_t)length);
    }
    if (files) closedir(files);
    return found;
}

// Opens the journal once it is told to, and adds a row. 0 where all went well.
static int take_over(int told, const char *directory) {
    ck_Journal journal;
    char byte, kept[1000] = "";
    if (read(told, &byte, 1) != 1) return 1;
    if (ck_journal_open(&journal, directory, "study.journal", "other", value_name, keep, kept, NULL)) return 2;
    if (ck_journal_add(&journal, "a", &(ck_JournalRow){.values = {0.5, 1}}, NULL)) return 3;
    ck_journal_close(&journal, false);
    return 0;
}

// A study that waits for a journal which its study takes away at its end has one of its own, which can be found again.
static void test_taken_away(void **state) {
    (void)state;
    char directory[] = "/tmp/clothcheck-journal-XXXXXX", path[100], kept[1000] = "";
    ck_Journal journal;
    int told[2], status = 0;
    assert_non_null(mkdtemp(directory));
    snprintf(path, sizeof path, "%s/study.journal", directory);
    assert_int_equal(pipe(told), 0);
    const pid_t other = fork();
    if (!other) _exit(take_over(told[0], directory));
    assert_int_equal(ck_journal_open(&journal, directory, "study.journal", "one", value_name, keep, kept, NULL), CK_OK);
    assert_int_equal(write(told[1], "x", 1), 1);
    while (!has_open(other, path) && !waitpid(other, &status, WNOHANG)) usleep(500);
    ck_journal_close(&journal, true);
    assert_int_equal(waitpid(other, &status, 0), other);
    assert_int_equal(status, 0);
    assert_int_equal(ck_journal_open(&journal, directory, "study.journal", "other", value_name, keep, kept, NULL),
                     CK_OK);
    assert_string_equal(kept, "a 0 0.5; ");
    ck_journal_close(&journal, true);
    rmdir(directory);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_damaged_rows), cmocka_unit_test(test_taken_away)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
