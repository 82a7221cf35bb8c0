// What studies come to: their values, names, files, folders, charts and scripts.
#include "fixture.h"
#include "fixture_program.h"
#include "fixture_study.h"

#include "csv_reader.h"
#include "files.h"

#include <unistd.h>

#define FEW "tests/sweep/studies/few.yaml"

#define SMALL                                                                                                          \
    "study: small\nscenes: [" STUDIES "/chain.yaml]\nengines: [native-verlet, still]\nseries: %s\n"                    \
    "repeats: 0\nsweep:\n  - springs.stiffness: [%s]\n"

static void run_small(const char *series, const char *values, const char *out) {
    char text[3000];
    snprintf(text, sizeof text, SMALL, series, values);
    if (fixture_study(text, out, "")) fail_msg("%s: %s", out, fixture_read("output"));
}

// With more values only those are run; with other values those of before stay for the next time.
static void test_more_values(void **state) {
    (void)state;
    size_t distinct;
    run_small("none", "100, 200", "more");
    assert_int_equal(fixture_count_cases("more", &distinct), 4);
    run_small("none", "100, 150, 200", "more");
    assert_int_equal(fixture_count_cases("more", &distinct), 6);
    run_small("none", "150", "more");
    assert_int_equal(fixture_count_cases("more", &distinct), 6);
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

// Its report has a chart of the swept key.
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
        assert_int_equal(fixture_study(colliding[i], "colliding", ""), 2);
        fixture_assert_output("are both named sheet");
    }
    for (size_t i = 0; i < sizeof apart / sizeof *apart; i++) {
        char out[20];
        snprintf(out, sizeof out, "apart%zu", i);
        if (fixture_study(apart[i], out, "")) fail_msg("%s", fixture_read("output"));
    }
}

static double first_sag(const char *out) {
    ck_CsvTable table;
    char *directory = fixture_path(out);
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
        if (fixture_study(text, "files", "")) fail_msg("%s", fixture_read("output"));
        sags[i] = first_sag("files");
    }
    assert_true(fabs(sags[1] - sags[0]) > 1e-3);
}

// A folder holds the results of one study, and no two studies take it from each other by force.
static void test_one_folder(void **state) {
    (void)state;
    assert_int_equal(fixture_study(OF_SHEET "sweep: [{drag: [1, 2]}]\n", "folder", ""), 0);
    char *there = fixture_read("folder/metrics.csv");
    assert_non_null(there);
    free(there);
    assert_int_equal(fixture_study("study: t\nrun: tune\nscenes: [" STUDIES "/sheet.yaml]\nengines: [native-verlet]\n"
                                   "options: [--error, 0.5]\n",
                                   "folder", ""),
                     0);
    assert_null(fixture_read("folder/metrics.csv"));
    there = fixture_read("folder/tune.csv");
    assert_non_null(there);
    free(there);
    assert_int_equal(fixture_study(OF_SHEET, "folder", "--kept --force"), 2);
    fixture_assert_output("--kept writes what is there, and --force removes it");
    // a case that its limit ended is run again with another: one of many runs, which takes far longer than a look at it
    static const char many[] = "study: p\nrun: precision\nscenes: [" STUDIES "/sheet.yaml]\nengines: [native-verlet, "
                               "ode-quick]\noptions: [--repeats, 0]\n";
    assert_int_equal(fixture_study(many, "limited", "--case-limit 1e-3"), 0);
    fixture_assert_output("1 refused");
    assert_int_equal(fixture_study(many, "limited", "--case-limit 600"), 0);
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
    assert_int_equal(fixture_study("study: hosts\nscenes: [" STUDIES "/sheet.yaml]\n"
                                   "engines: [native-verlet, native-narrow]\n",
                                   "hosts", ""),
                     0);
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
             "study " FEW " --out '%s/a b' --slurm --dry-run --array 5 --array-limit 2 --partition short --cores 3 "
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
    // a part that lacks an engine of the other, and one of another engine
    snprintf(line, sizeof line, "compare " THREE " %s/other --shard 2/2 -e native-bars", d);
    assert_int_equal(fixture_program(line), 0);
    static const struct {
        const char *parts, *said;
    } wrong[] = {{"%s/again %s/three1 %s/other", "are of other engines"},
                 {"%s/again %s/three1 %s/three1", "both have pendulum"},
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
    snprintf(line, sizeof line, "study " FEW " --out %s/compared", d);
    assert_int_equal(fixture_program(line), 2);
    fixture_assert_output("holds results that are of no study");
    snprintf(line, sizeof line, "compare pendulum -e native-verlet -r 0 --append --out %s/more", d);
    assert_int_equal(fixture_program(line), 2);
    fixture_assert_output("holds results of a study, which would be lost");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_more_values),     cmocka_unit_test(test_series),
        cmocka_unit_test(test_shipped_study),   cmocka_unit_test(test_report),
        cmocka_unit_test(test_folders),         cmocka_unit_test(test_names),
        cmocka_unit_test(test_files),           cmocka_unit_test(test_one_folder),
        cmocka_unit_test(test_unlike_machines), cmocka_unit_test(test_scripts),
        cmocka_unit_test(test_several_scenes),
    };
    return cmocka_run_group_tests(tests, fixture_make_directory, fixture_remove_directory);
}
