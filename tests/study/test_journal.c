// Journals that something damaged: a row that is not whole and sound is run again, and all others are kept.
#include "fixture.h"

#include "journal.h"

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

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_damaged_rows)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
