// Studies: what a file may say, and that its cases are run once, whatever is killed, and come to the same CSVs.
#include "fixture.h"
#include "fixture_program.h"

#include "csv_reader.h"
#include "files.h"
#include "store.h"
#include "study_file.h"
#include "values.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#define SOURCES SCENE_DIRECTORY "/.."
#define STUDIES SOURCES "/tests/sweep/studies"

// The sanitizers make processes slow to start: there fewer cases do.
#ifdef __SANITIZE_ADDRESS__
#define STUDY "tests/sweep/studies/few.yaml"
#define ENGINES " -e native-verlet -e still -e ode-quick"
#define LEAST_CASES (4 + 8 * 3)
#else
#define STUDY "tests/sweep/studies/five_hundred.yaml"
#define ENGINES ""
#define LEAST_CASES 500
#endif

static const struct {
    const char *about, *text, *message;
} bad_studies[] = {
    {"no name", "scenes: [a]\n", "lacks the key study"},
    {"no scenes", "study: s\n", "lacks the key scenes"},
    {"unknown key", "study: s\nscenes: [a]\nsweeps: []\n", ":3:1: unknown key sweeps; did you mean sweep?"},
    {"a key twice", "study: s\nstudy: t\nscenes: [a]\n", ":2:1: study is given twice"},
    {"a name with a blank", "study: a b\nscenes: [a]\n", ":1:8: study must be a name"},
    {"nothing to run", "study: s\nscenes: [a]\nrun: walk\n", "run is walk; it must be one of compare, precision"},
    {"no values", "study: s\nscenes: [a]\nsweep: [{drag: []}]\n", ":3:16: drag must have a list of values"},
    {"half a rule", "study: s\nscenes: [a]\nsweep: [{drag: {log: [1, 2]}}]\n", "drag must have a list of values"},
    {"a logarithm of 0", "study: s\nscenes: [a]\nsweep: [{drag: {log: [0, 2], count: 3}}]\n", "drag must have"},
    {"unlike numbers", "study: s\nscenes: [a]\nsweep: [{drag: [1, 2], noise.seed: [1]}]\n",
     "noise.seed has 1 values and drag has 2; keys of one entry go together"},
    {"a chart of what is not swept", "study: s\nscenes: [a]\ncharts: [{x: drag, metric: sag}]\n",
     "a chart's x is drag, which is not swept"},
    {"half a chart", "study: s\nscenes: [a]\ncharts: [{x: drag}]\n", "a chart needs x, a key, and metric"},
    {"too many repeats", "study: s\nscenes: [a]\nrepeats: 100\n", "repeats is 100; it must be a whole number from 0"},
    {"scenes of conform", "study: s\nrun: conform\nscenes: [a]\n", "conform has scenes of its own"},
    {"a key swept twice", "study: s\nscenes: [a]\nsweep: [{drag: [1]}, {drag: [2]}]\n",
     "drag is swept twice; keep one"},
    {"too many points", "study: s\nscenes: [a]\nsweep: [{drag: {seeds: 1000000}}, {noise.seed: {seeds: 1000000}}]\n",
     "it has 1000000000000 points by now; a study has at most 10000000"},
    {"repeats of another command", "study: s\nscenes: [a]\nrun: tune\nrepeats: 2\n",
     "repeats and series are of compare"},
    {"empty", "", ":1:1: is empty; a study needs study, its name, and scenes"},
};

static void test_bad_studies(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof bad_studies / sizeof *bad_studies; i++) {
        ck_StudyFile study;
        ck_Error error = {0};
        char *path = fixture_file(bad_studies[i].text);
        ck_Status status = ck_study_file_load(&study, path, &error);
        ck_study_file_free(&study);
        unlink(path);
        free(path);
        if (status != CK_BAD_INPUT || !strstr(error.message, bad_studies[i].message))
            fail_msg("%s: status %d, wanted %s, got %s", bad_studies[i].about, status, bad_studies[i].message,
                     error.message);
    }
}

static void test_values(void **state) {
    (void)state;
    static const struct {
        const char *rule, *values;
    } cases[] = {{"[1, 2.50, x]", "1 2.50 x "},
                 {"[[0, -9.81, 0], {a: 1}]", "[0, -9.81, 0] {a: 1} "},
                 {"{log: [1, 1000], count: 4}", "1 10 100 1000 "},
                 {"{linear: [0, 1], count: 3}", "0 0.5 1 "},
                 {"{linear: [3, 7], count: 1}", "3 "},
                 {"{seeds: 3}", "1 2 3 "},
                 // neighbours differ in more digits than six
                 {"{linear: [1, 1.000002], count: 3}", "1 1.000001 1.000002 "}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[200], got[200] = "";
        ck_StudyFile study;
        ck_Error error = {0};
        snprintf(text, sizeof text, "study: s\nscenes: [a]\nsweep: [{key: %s}]\n", cases[i].rule);
        char *path = fixture_file(text);
        if (ck_study_file_load(&study, path, &error)) fail_msg("%s", error.message);
        for (int k = 0; k < study.axes[0].value_count; k++)
            snprintf(got + strlen(got), sizeof got - strlen(got), "%s ", study.axes[0].values[k]);
        assert_string_equal(got, cases[i].values);
        ck_study_file_free(&study);
        unlink(path);
        free(path);
    }
}

static char *directory_of(const char *name) {
    return ck_path_join(fixture_directory, name);
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
        char *directory = directory_of(names[i]);
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

static void run_study(const char *study, const char *out, const char *options) {
    char line[600];
    snprintf(line, sizeof line, "study %s --out %s/%s" ENGINES " %s", study, fixture_directory, out, options);
    if (fixture_program(line)) fail_msg("%s fails: %s", line, fixture_read("output"));
}

// Records in a folder, of which each case has one where it was run once.
static int count_records(const char *out, size_t *distinct) {
    char line[400], number[40] = "";
    ck_Store store;
    char *directory = directory_of(out), *folder = ck_path_join(directory, "study");
    snprintf(line, sizeof line, "cat %s/*.cases | grep -ac '^case [0-9a-f]\\{16\\} '", folder);
    FILE *pipe = popen(line, "r");
    if (!fgets(number, sizeof number, pipe)) strcpy(number, "0");
    pclose(pipe);
    assert_int_equal(ck_store_open(&store, folder, NULL), CK_OK);
    *distinct = store.count;
    ck_store_free(&store);
    free(folder);
    free(directory);
    return atoi(number);
}

static void test_whole(void **state) {
    (void)state;
    size_t distinct;
    run_study(STUDY, "whole", "");
    const int records = count_records("whole", &distinct);
    assert_int_equal((size_t)records, distinct);
    assert_true(records >= LEAST_CASES);
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
    snprintf(line, sizeof line, "study " STUDY " --out %s/killed" ENGINES, fixture_directory);
    for (int i = 0; i < 10; i++) {
        const int until = count_done("killed") + 1 + rand() % (LEAST_CASES / 12);
        const pid_t program = fixture_start(line);
        int how;
        while (count_done("killed") < until && !waitpid(program, &how, WNOHANG)) usleep(200);
        kill(program, SIGKILL);
        waitpid(program, &how, 0);
    }
    run_study(STUDY, "killed", "");
    assert_same_results("whole", "killed");
    // a case that was killed between its record and its mark may be there twice, but each is
    count_records("killed", &distinct);
    size_t whole;
    count_records("whole", &whole);
    assert_int_equal(distinct, whole);
}

// Four processes that begin at once, in one folder.
static void test_shared(void **state) {
    (void)state;
    char line[600];
    pid_t programs[4];
    size_t distinct;
    snprintf(line, sizeof line, "study " STUDY " --out %s/shared" ENGINES, fixture_directory);
    for (int i = 0; i < 4; i++) programs[i] = fixture_start(line);
    for (int i = 0; i < 4; i++) {
        int how;
        waitpid(programs[i], &how, 0);
        assert_true(WIFEXITED(how) && WEXITSTATUS(how) == 0);
    }
    const int records = count_records("shared", &distinct);
    assert_int_equal((size_t)records, distinct);
    assert_same_results("whole", "shared");
}

// Parts with folders of their own, joined.
static void test_parts(void **state) {
    (void)state;
    char line[900];
    run_study(STUDY, "part1", "--shard 1/2");
    run_study(STUDY, "part2", "--shard 2/2");
    const char *d = fixture_directory;
    snprintf(line, sizeof line, "merge %s/joined %s/part1 %s/part2", d, d, d);
    assert_int_equal(fixture_program(line), 0);
    run_study(STUDY, "joined", "--kept");
    assert_same_results("whole", "joined");
}

// A record that is damaged or cut off is run again, and what follows it in its file with it.
static void test_damage(void **state) {
    (void)state;
    char line[900];
    size_t before, after;
    const char *d = fixture_directory;
    count_records("whole", &before);
    snprintf(line, sizeof line,
             "cp -r %s/whole %s/damaged && cd %s/damaged/study && for file in *.cases; do size=$(stat -c %%s $file); "
             "printf xx | dd of=$file bs=1 seek=$((size / 2)) conv=notrunc status=none; truncate -s -7 $file; done",
             d, d, d);
    assert_int_equal(system(line), 0);
    count_records("damaged", &after);
    assert_true(after < before);
    run_study(STUDY, "damaged", "");
    assert_same_results("whole", "damaged");
}

#define SMALL                                                                                                          \
    "study: small\nscenes: [" STUDIES "/chain.yaml]\nengines: [native-verlet, still]\nseries: %s\n"                    \
    "repeats: 0\nsweep:\n  - springs.stiffness: [%s]\n"

static void run_small(const char *series, const char *values, const char *out) {
    char text[3000], line[3000];
    snprintf(text, sizeof text, SMALL, series, values);
    char *path = fixture_file(text);
    snprintf(line, sizeof line, "study %s --out %s/%s", path, fixture_directory, out);
    if (fixture_program(line)) fail_msg("%s fails: %s", line, fixture_read("output"));
    unlink(path);
    free(path);
}

// With more values only those are run; with other values those of before stay for the next time.
static void test_more_values(void **state) {
    (void)state;
    size_t distinct;
    run_small("none", "100, 200", "more");
    assert_int_equal(count_records("more", &distinct), 4);
    run_small("none", "100, 150, 200", "more");
    assert_int_equal(count_records("more", &distinct), 6);
    run_small("none", "150", "more");
    assert_int_equal(count_records("more", &distinct), 6);
    char *runs = fixture_read("more/runs.csv");
    assert_non_null(strstr(runs, "chain-stiffness_150"));
    assert_null(strstr(runs, "chain-stiffness_100"));
    free(runs);
}

// The metrics at every frame: in one file, or in one a case.
static void test_series(void **state) {
    (void)state;
    char line[900];
    run_small("csv", "100, 200", "csv");
    run_small("gzip", "100, 200", "gzip");
    const char *d = fixture_directory;
    snprintf(
        line, sizeof line,
        "cd %s && for part in gzip/series/*.gz; do gzip -dc $part | tail -n +2; done | sort > packed && "
        "tail -n +2 csv/series.csv | sed 's/,[^,]*,[^,]*,[^,]*$//' | sort > plain && test -s plain && cmp packed plain",
        d);
    assert_int_equal(system(line), 0);
}

// A study of 25 lines at most is a chart of an error against the resolution, for six engines.
static void test_shipped_study(void **state) {
    (void)state;
    char *text = NULL;
    size_t size;
    int lines = 0;
    assert_int_equal(ck_file_read(&text, &size, SOURCES "/reports/studies/sag_by_resolution.yaml", NULL), CK_OK);
    for (const char *letter = text; *letter; letter++) lines += *letter == '\n';
    assert_true(lines <= 25);
    free(text);
    assert_int_equal(fixture_program("study reports/studies/sag_by_resolution.yaml --dry-run"), 0);
    fixture_assert_output("4 points, 6 engines, 28 cases, 4 of them truths");
}

// Its report has a chart of the swept key; a study of many points has nothing else.
static void test_report(void **state) {
    (void)state;
    char line[400];
    snprintf(line, sizeof line, "report %s/more", fixture_directory);
    run_small("none", "100, 150, 200", "more");
    assert_int_equal(fixture_program(line), 0);
    char *chart = fixture_read("more/charts/sweep.csv");
    assert_non_null(chart);
    assert_non_null(strstr(chart, "native-verlet,150,"));
    free(chart);
    snprintf(line, sizeof line, "report %s/whole", fixture_directory);
    assert_int_equal(fixture_program(line), 0);
    chart = fixture_read("whole/charts/sweep.csv");
    assert_non_null(chart);
    free(chart);
    char *page = fixture_read("whole/index.html");
    if (LEAST_CASES >= 500) assert_non_null(strstr(page, "\"scenes\":[]"));
    free(page);
}

// Writes a study of the sheet and runs it; what it says is in the output.
static int run_text(const char *text, const char *out, const char *options) {
    char line[3000];
    char *path = fixture_file(text);
    snprintf(line, sizeof line, "study %s --out %s/%s %s", path, fixture_directory, out, options);
    const int result = fixture_program(line);
    unlink(path);
    free(path);
    return result;
}

static void write_there(const char *name, const char *text) {
    char path[300];
    snprintf(path, sizeof path, "%s/%s", fixture_directory, name);
    FILE *file = fopen(path, "w");
    fputs(text, file);
    fclose(file);
}

// Values of which two would have one name in the CSVs.
static void test_names(void **state) {
    (void)state;
#define OF_SHEET "study: s\nscenes: [" STUDIES "/sheet.yaml]\nengines: [still]\n"
    static const char *const colliding[] = {OF_SHEET "sweep: [{drag: [1, 1]}]\n",
                                            "study: s\nscenes: [" STUDIES "/sheet.yaml, " STUDIES
                                            "/sheet.yaml]\nengines: [still]\n",
                                            OF_SHEET "sweep: [{about: [a?, a!]}]\n"};
    static const char *const apart[] = {OF_SHEET "sweep: [{gravity: [[0, -1, 10], [0, -11, 0]]}]\n",
                                        OF_SHEET "sweep: [{pins: [['x > 0.3'], ['x < 0.3']]}]\n"};
    for (size_t i = 0; i < sizeof colliding / sizeof *colliding; i++) {
        assert_int_equal(run_text(colliding[i], "colliding", ""), 2);
        fixture_assert_output("are both named sheet");
    }
    for (size_t i = 0; i < sizeof apart / sizeof *apart; i++) {
        char out[20];
        snprintf(out, sizeof out, "apart%zu", i);
        if (run_text(apart[i], out, "")) fail_msg("%s", fixture_read("output"));
    }
}

static double first_sag(const char *out) {
    ck_CsvTable table;
    char *directory = directory_of(out);
    double sag = NAN;
    assert_int_equal(ck_csv_table_read(&table, directory, &ck_layouts[CK_METRICS], NULL), CK_OK);
    for (int i = 0; i < table.row_count && isnan(sag); i++)
        if (!strcmp(ck_csv_text_of(&table, i, "metric"), "sag")) sag = ck_csv_number_of(&table, i, "value");
    ck_csv_table_free(&table);
    free(directory);
    return sag;
}

// What a case depends on beside its words: files that they name. With another one it is run again.
static void test_files(void **state) {
    (void)state;
    static const char head[] = "o a\nv 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 ", rest[] = "\nf 1 2 3 4\n";
    char mesh[200], text[600];
    write_there("cloth.yaml", "name: m\nmesh: {file: other.obj, mass: 0.1}\nsprings: {stiffness: 50}\npins: [0, 1]\n"
                              "gravity: [0, -9.81, 0]\ndrag: 2\ntime: {duration: 0.2, fps: 60}\n");
    snprintf(text, sizeof text,
             "study: files\nscenes: [%s/cloth.yaml]\nengines: [native-verlet]\nrepeats: 0\n"
             "sweep: [{mesh: [{file: quad.obj, mass: 0.1}]}]\n",
             fixture_directory);
    double sags[2];
    snprintf(mesh, sizeof mesh, "%s1%s", head, rest);
    write_there("other.obj", mesh);
    for (int i = 0; i < 2; i++) {
        snprintf(mesh, sizeof mesh, "%s%d%s", head, 1 + i, rest);
        write_there("quad.obj", mesh);
        if (run_text(text, "files", "")) fail_msg("%s", fixture_read("output"));
        sags[i] = first_sag("files");
    }
    assert_true(fabs(sags[1] - sags[0]) > 1e-3);
}

// A folder holds the results of one study, and no two studies take it from each other by force.
static void test_one_folder(void **state) {
    (void)state;
    assert_int_equal(run_text(OF_SHEET "sweep: [{drag: [1, 2]}]\n", "folder", ""), 0);
    char *there = fixture_read("folder/metrics.csv");
    assert_non_null(there);
    free(there);
    assert_int_equal(run_text("study: t\nrun: tune\nscenes: [" STUDIES "/sheet.yaml]\nengines: [native-verlet]\n"
                              "options: [--error, 0.5]\n",
                              "folder", ""),
                     0);
    assert_null(fixture_read("folder/metrics.csv"));
    there = fixture_read("folder/tune.csv");
    assert_non_null(there);
    free(there);
    assert_int_equal(run_text(OF_SHEET, "folder", "--kept --force"), 2);
    fixture_assert_output("--kept writes what is there, and --force removes it");
    // a case that its limit ended is run again with another: one of many runs, which takes far longer than a look at it
    static const char many[] = "study: p\nrun: precision\nscenes: [" STUDIES "/sheet.yaml]\nengines: [native-verlet, "
                               "ode-quick]\noptions: [--repeats, 0]\n";
    assert_int_equal(run_text(many, "limited", "--case-limit 1e-3"), 0);
    fixture_assert_output("1 refused");
    assert_int_equal(run_text(many, "limited", "--case-limit 600"), 0);
    fixture_assert_output("1 ok");
}

static int count_cheapest(void) {
    char line[400], number[20] = "";
    snprintf(line, sizeof line, "report %s/hosts", fixture_directory);
    assert_int_equal(fixture_program(line), 0);
    // is_cheapest is the eleventh column
    snprintf(line, sizeof line, "tail -n +2 %s/hosts/charts/summary.csv | cut -d, -f11 | grep -c 1", fixture_directory);
    FILE *pipe = popen(line, "r");
    assert_non_null(fgets(number, sizeof number, pipe));
    pclose(pipe);
    return atoi(number);
}

// Of two engines on one machine one is the cheapest; on unlike ones there is no telling.
static void test_unlike_machines(void **state) {
    (void)state;
    char line[3000];
    char *path =
        fixture_file("study: hosts\nscenes: [" STUDIES "/sheet.yaml]\nengines: [native-verlet, native-narrow]\n");
    snprintf(line, sizeof line, "study %s --out %s/hosts", path, fixture_directory);
    assert_int_equal(fixture_program(line), 0);
    unlink(path);
    free(path);
    assert_int_equal(count_cheapest(), 1);
    snprintf(line, sizeof line,
             "cd %s/hosts && sed -i '/native-narrow/s/,[^,]*,\\([^,]*\\)$/,other,\\1/' runs.csv && "
             "sed -i '2,$!b;/native-narrow/s/,[A-Za-z0-9_]*,[^,]*,\\(\"clothcheck\\)/,other,Z80,\\1/' study.csv && "
             "grep -q ',other,' runs.csv && grep -q ',other,Z80,' study.csv",
             fixture_directory);
    assert_int_equal(system(line), 0);
    assert_int_equal(count_cheapest(), 2);
}

// The scripts of an array, as they would be submitted.
static void test_scripts(void **state) {
    (void)state;
    char line[400];
    snprintf(line, sizeof line,
             "study " STUDY " --out '%s/a b' --slurm --dry-run --array 5 --array-limit 2 --partition short --cores 3 "
             "--slurm-time 1:00",
             fixture_directory);
    assert_int_equal(fixture_program(line), 0);
    fixture_assert_output("#SBATCH --array=1-5%2\n");
    fixture_assert_output("#SBATCH --partition=short\n");
    fixture_assert_output("#SBATCH --cpus-per-task=3\n");
    fixture_assert_output("#SBATCH --time=1:00\n");
    fixture_assert_output("--part --jobs 3\n");
    fixture_assert_output("--finish --array 5 --cores 3 --array-limit 2 --partition short --slurm-time 1:00\n");
    snprintf(line, sizeof line, "--out '%s/a b' --time-limit", fixture_directory);
    fixture_assert_output(line);
    snprintf(line, sizeof line, "#SBATCH --output='%s/a b/study'/slurm-", fixture_directory);
    fixture_assert_output(line);
}

// Several scenes of a command that takes one, and a comparison in parts.
static void test_several_scenes(void **state) {
    (void)state;
    char line[900];
    const char *d = fixture_directory;
    snprintf(line, sizeof line, "tune rope_hanging bounce -e native-verlet --error 0.5 --out %s/tuned", d);
    if (fixture_program(line)) fail_msg("%s", fixture_read("output"));
    char *tuned = fixture_read("tuned/tune.csv");
    assert_true(strstr(tuned, "\nrope_hanging,native-verlet") && strstr(tuned, "\nbounce,native-verlet"));
    free(tuned);
#define THREE "scenes/pendulum.yaml scenes/bounce.yaml scenes/free_fall.yaml -e native-verlet -r 0 --out"
    snprintf(line, sizeof line, "compare " THREE " %s/three", d);
    assert_int_equal(fixture_program(line), 0);
    for (int i = 1; i <= 2; i++) {
        snprintf(line, sizeof line, "compare " THREE " %s/three%d --shard %d/2", d, i, i);
        assert_int_equal(fixture_program(line), 0);
    }
    snprintf(line, sizeof line, "merge %s/threes %s/three1 %s/three2", d, d, d);
    assert_int_equal(fixture_program(line), 0);
    snprintf(
        line, sizeof line,
        "cd %s && for file in metrics deviations ledger series; do cmp three/$file.csv threes/$file.csv || exit 1; "
        "done; diff -q three/replays/bounce.replay threes/replays/bounce.replay",
        d);
    assert_int_equal(system(line), 0);
    static const struct {
        const char *parts, *said;
    } wrong[] = {{"%s/again %s/three1 %s/three1", "both have pendulum"},
                 {"%s/again %s/three2 %s/three1", "is part 2 of 2, and stands where part 1 of 2 should"},
                 {"%s/again %s/three1 %s/tuned", "are not parts of one command"},
                 {"%s/three %s/three1 %s/three2", "holds results, which would be lost"}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char parts[600];
        snprintf(parts, sizeof parts, wrong[i].parts, d, d, d);
        snprintf(line, sizeof line, "merge %s", parts);
        assert_int_equal(fixture_program(line), 2);
        fixture_assert_output(wrong[i].said);
    }
    snprintf(line, sizeof line, "merge %s/again %s/three1", d, d);
    assert_int_equal(fixture_program(line), 2);
    fixture_assert_output("is part 1 of 2, and stands where part 1 of 1 should");
    // a way that a single scene may be told in, and what several cannot be
    snprintf(line, sizeof line, "tune rope_hanging bounce -e native-verlet --set substeps=40 --error 0.5 --out %s/set",
             d);
    assert_int_equal(fixture_program(line), 0);
    fixture_assert_output("2 ok");
    snprintf(line, sizeof line, "tune rope_hanging bounce --out %s/none", d);
    assert_int_equal(fixture_program(line), 2);
    fixture_assert_output("tune needs one --engine NAME");
    snprintf(line, sizeof line, "tune rope_hanging bounce -e native-verlet --append --out %s/set", d);
    assert_int_equal(fixture_program(line), 2);
    // a part of one scene with changes
    for (int i = 1; i <= 2; i++) {
        snprintf(line, sizeof line,
                 "precision pendulum@drag=2@truth=trajectory -e native-bars -e ode-direct -r 0 --shard %d/2 --out "
                 "%s/change%d",
                 i, d, i);
        if (fixture_program(line)) fail_msg("%s", fixture_read("output"));
    }
    snprintf(line, sizeof line, "merge %s/changed %s/change1 %s/change2", d, d, d);
    if (fixture_program(line)) fail_msg("%s", fixture_read("output"));
}

// Results of other commands are not lost, nor those of a study to other commands.
static void test_folders(void **state) {
    (void)state;
    char line[600];
    const char *d = fixture_directory;
    snprintf(line, sizeof line, "compare pendulum -e native-verlet -r 0 --out %s/compared", d);
    assert_int_equal(fixture_program(line), 0);
    snprintf(line, sizeof line, "study " STUDY " --out %s/compared", d);
    assert_int_equal(fixture_program(line), 2);
    fixture_assert_output("holds results that are of no study");
    snprintf(line, sizeof line, "compare pendulum -e native-verlet -r 0 --append --out %s/whole", d);
    assert_int_equal(fixture_program(line), 2);
    fixture_assert_output("holds results of a study, which would be lost");
}

// Through a Slurm of this machine's own; where it cannot run, why is said.
static void test_slurm(void **state) {
    (void)state;
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
        cmocka_unit_test(test_bad_studies), cmocka_unit_test(test_values),
        cmocka_unit_test(test_whole),       cmocka_unit_test(test_killed),
        cmocka_unit_test(test_shared),      cmocka_unit_test(test_parts),
        cmocka_unit_test(test_damage),      cmocka_unit_test(test_more_values),
        cmocka_unit_test(test_series),      cmocka_unit_test(test_shipped_study),
        cmocka_unit_test(test_report),      cmocka_unit_test(test_folders),
        cmocka_unit_test(test_names),       cmocka_unit_test(test_files),
        cmocka_unit_test(test_one_folder),  cmocka_unit_test(test_unlike_machines),
        cmocka_unit_test(test_scripts),     cmocka_unit_test(test_several_scenes),
        cmocka_unit_test(test_slurm),
    };
    return cmocka_run_group_tests(tests, fixture_make_directory, fixture_remove_directory);
}
