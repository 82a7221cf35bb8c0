// Each case of a study is run once, whatever is killed, shared or damaged, and its CSVs are the same.
#include "fixture.h"
#include "fixture_program.h"
#include "fixture_study.h"

#include "csv_reader.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

// Of all that there is five hundred cases; else, and under the sanitizers, which make processes slow to start, fewer
// do.
typedef struct Size {
    const char *study, *engines;
    int least; // cases
} Size;

static Size size_of(void) {
#ifndef __SANITIZE_ADDRESS__
    if (fixture_asks_all()) return (Size){"tests/sweep/studies/five_hundred.yaml", "", 500};
#endif
    return (Size){"tests/sweep/studies/few.yaml", "-e native-verlet -e still -e ode-quick", 4 + 8 * 3};
}

// What two runs of the same do not have in common.
static bool is_timing(const char *column) {
    static const char *const timings[] = {"cost_s",     "cpu_median_s",     "cpu_iqr_s",       "cpu_low_s",
                                          "cpu_high_s", "cpu_worst_step_s", "realtime_factor", "peak_rss_bytes"};
    for (size_t i = 0; i < sizeof timings / sizeof *timings; i++)
        if (!strcmp(column, timings[i])) return true;
    return false;
}

static void assert_same_table(const char *one, const char *other, ck_LayoutName layout) {
    ck_CsvTable tables[2];
    const char *const names[] = {one, other};
    for (int i = 0; i < 2; i++) {
        ck_Error error = {0};
        char *directory = fixture_path(names[i]);
        if (ck_csv_table_read(&tables[i], directory, &ck_layouts[layout], &error)) fail_msg("%s", error.message);
        free(directory);
    }
    assert_int_equal(tables[0].row_count, tables[1].row_count);
    assert_int_equal(tables[0].width, tables[1].width);
    assert_true(tables[0].row_count > 0);
    for (int row = 0; row < tables[0].row_count; row++)
        for (int column = 0; column < tables[0].width; column++) {
            const char *a = ck_csv_table_text(&tables[0], row, column), *b = ck_csv_table_text(&tables[1], row, column);
            if (!is_timing(tables[0].fields[column]) && strcmp(a, b))
                fail_msg("%s of %s and %s: row %d, %s: %s and %s", ck_layouts[layout].file, one, other, row + 1,
                         tables[0].fields[column], a, b);
        }
    ck_csv_table_free(&tables[0]);
    ck_csv_table_free(&tables[1]);
}

static void assert_same_results(const char *one, const char *other) {
    static const ck_LayoutName layouts[] = {CK_STUDY, CK_RUNS, CK_METRICS, CK_LEDGER, CK_STUDY_CHARTS};
    for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++) assert_same_table(one, other, layouts[i]);
}

// The words of a command that runs it into a folder.
static void write_words(char line[600], const char *out, const char *options) {
    const Size size = size_of();
    snprintf(line, 600, "study %s --out %s/%s %s %s", size.study, fixture_directory, out, size.engines, options);
}

static void run_study(const char *out, const char *options) {
    char line[600];
    write_words(line, out, options);
    if (fixture_program(line)) fail_msg("%s fails: %s", line, fixture_read("output"));
}

static void test_whole(void **state) {
    (void)state;
    size_t distinct;
    run_study("whole", "");
    const int records = fixture_count_cases("whole", &distinct);
    assert_int_equal((size_t)records, distinct);
    assert_true(records >= size_of().least);
}

// Cases that are done by now, as the board's bytes say.
static int count_done(const char *out) {
    char line[400], number[40] = "0";
    snprintf(line, sizeof line, "cat %s/%s/study/board-* 2>/dev/null | tr -d '\\000' | wc -c", fixture_directory, out);
    FILE *pipe = popen(line, "r");
    if (!fgets(number, sizeof number, pipe)) strcpy(number, "0");
    pclose(pipe);
    return atoi(number);
}

// Killed ten times, each time after a random number of cases more.
static void test_killed(void **state) {
    (void)state;
    char line[600];
    size_t distinct;
    srand(24);
    write_words(line, "killed", "");
    for (int i = 0; i < 10; i++) {
        const int until = count_done("killed") + 1 + rand() % (size_of().least / 12);
        const pid_t program = fixture_start(line);
        int how;
        while (count_done("killed") < until && !waitpid(program, &how, WNOHANG)) usleep(200);
        kill(program, SIGKILL);
        waitpid(program, &how, 0);
    }
    run_study("killed", "");
    assert_same_results("whole", "killed");
    // a case that was killed between its record and its mark may be there twice, but each is
    fixture_count_cases("killed", &distinct);
    size_t whole;
    fixture_count_cases("whole", &whole);
    assert_int_equal(distinct, whole);
}

// Four processes that begin at once, in one folder.
static void test_shared(void **state) {
    (void)state;
    char line[600];
    pid_t programs[4];
    size_t distinct;
    write_words(line, "shared", "");
    for (int i = 0; i < 4; i++) programs[i] = fixture_start(line);
    for (int i = 0; i < 4; i++) {
        int how;
        waitpid(programs[i], &how, 0);
        assert_true(WIFEXITED(how) && WEXITSTATUS(how) == 0);
    }
    const int records = fixture_count_cases("shared", &distinct);
    assert_int_equal((size_t)records, distinct);
    assert_same_results("whole", "shared");
}

// Parts with folders of their own, joined.
static void test_parts(void **state) {
    (void)state;
    char line[900];
    run_study("part1", "--shard 1/2");
    run_study("part2", "--shard 2/2");
    const char *d = fixture_directory;
    snprintf(line, sizeof line, "merge %s/joined %s/part1 %s/part2", d, d, d);
    assert_int_equal(fixture_program(line), 0);
    run_study("joined", "--kept");
    assert_same_results("whole", "joined");
}

// A record that is damaged or cut off is run again, and what follows it in its file with it.
static void test_damage(void **state) {
    (void)state;
    char line[900];
    size_t before, after;
    const char *d = fixture_directory;
    fixture_count_cases("whole", &before);
    snprintf(line, sizeof line,
             "cp -r %s/whole %s/damaged && cd %s/damaged/study && for file in *.cases; do size=$(stat -c %%s $file); "
             "printf xx | dd of=$file bs=1 seek=$((size / 2)) conv=notrunc status=none; truncate -s -7 $file; done",
             d, d, d);
    assert_int_equal(system(line), 0);
    fixture_count_cases("damaged", &after);
    assert_true(after < before);
    run_study("damaged", "");
    assert_same_results("whole", "damaged");
}

// A study of many points is shown by its charts alone.
static void test_report_of_many(void **state) {
    (void)state;
    char line[400];
    snprintf(line, sizeof line, "report %s/whole", fixture_directory);
    assert_int_equal(fixture_program(line), 0);
    char *chart = fixture_read("whole/charts/sweep.csv"), *page = fixture_read("whole/index.html");
    assert_non_null(chart);
    if (size_of().least >= 500) assert_non_null(strstr(page, "\"scenes\":[]"));
    free(chart);
    free(page);
}

// Through a Slurm of this machine's own; where it cannot run, why is said.
static void test_slurm(void **state) {
    (void)state;
    fixture_skip_unasked();
    char line[800];
#ifdef __SANITIZE_ADDRESS__
    skip();
#endif
    snprintf(line, sizeof line, SOURCES "/tests/sweep/slurm " PROGRAM " %s/slurm > %s/slurm.log 2>&1",
             fixture_directory, fixture_directory);
    const int how = system(line);
    char *said = fixture_read("slurm.log");
    if (how && WIFEXITED(how) && WEXITSTATUS(how) == 77) {
        print_message("%s", said);
        free(said);
        skip();
    }
    if (how) fail_msg("%s", said);
    free(said);
    assert_same_results("slurm/alone", "slurm/array");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_whole), cmocka_unit_test(test_killed), cmocka_unit_test(test_shared),
        cmocka_unit_test(test_parts), cmocka_unit_test(test_damage), cmocka_unit_test(test_report_of_many),
        cmocka_unit_test(test_slurm),
    };
    return cmocka_run_group_tests(tests, fixture_make_directory, fixture_remove_directory);
}
