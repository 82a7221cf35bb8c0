// Charts and page of a comparison: whole or not at all, the same twice, and nothing lost when a CSV is bad. What the
// page does in a browser is tested in tests/page.
#include "fixture_comparison.h"
#include "fixture_program.h"

#include "engine.h"
#include "files.h"
#include "tables.h"

#include <unistd.h>

static void shell(const char *format, ...) __attribute__((format(printf, 1, 2)));
static void shell(const char *format, ...) {
    char command[2000];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(command, sizeof command, format, arguments);
    va_end(arguments);
    if (system(command)) fail_msg("failed: %s", command);
}

static int program(const char *format, const char *directory) {
    char arguments[500];
    snprintf(arguments, sizeof arguments, format, fixture_directory, directory);
    return fixture_program(arguments);
}

// A comparison of two scenes, made once for the group.
static int make_comparison(void **state) {
    if (fixture_make_directory(state)) return -1;
    return program(
        "compare bounce rope_hanging --engine native-verlet --engine bullet-pbd --engine seed-tecido --repeats 1 "
        "--out %s/%s",
        "whole");
}

static void test_report(void **state) {
    (void)state;
    shell("cp -r %s/whole %s/one", fixture_directory, fixture_directory);
    assert_int_equal(program("report %s/%s", "one"), 0);
    fixture_assert_output("/one/index.html\n");
    char *page = fixture_read("one/index.html");
    assert_non_null(page);
    // whatever is fetched would be named by src=, href= or url( with an address
    assert_null(strstr(page, "src=\"http"));
    assert_null(strstr(page, "href=\"http"));
    assert_null(strstr(page, "url(http"));
    assert_non_null(strstr(page, "id=\"file:bounce.height.svg\""));
    free(page);
    static const char *const files[] = {"bounce.height.svg", "bounce.height.png", "rope_hanging.sag.csv",
                                        "rope_hanging.energy.svg", "summary.svg"};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char name[100];
        snprintf(name, sizeof name, "one/charts/%s", files[i]);
        char *text = fixture_read(name);
        if (!text || !*text) fail_msg("there is no %s", name);
        free(text);
    }
    // nothing half-made is left, and the same CSVs make the same report
    shell("! ls %s/one | grep -q part", fixture_directory);
    shell("cp -r %s/one %s/before", fixture_directory, fixture_directory);
    assert_int_equal(program("report %s/%s", "one"), 0);
    shell("diff -r -x '*.png' %s/before %s/one", fixture_directory, fixture_directory);
}

static void test_bad_files(void **state) {
    (void)state;
    static const struct {
        const char *change, *output; // in the report's directory
    } cases[] = {
        {"truncate -s -20 series.csv", "series.csv:"},
        {"truncate -s 0 metrics.csv", "metrics.csv:1: the file is empty"},
        {"cp machine.csv runs.csv", "runs.csv:1: column 1 is 'key' where it must be scene"},
        {"sed -i '3s/,ok,/,splendid,/' runs.csv", "runs.csv:3: column 3 (status): must be what a run can end in"},
        {"sed -i '2s/^bounce/..\\/bounce/' metrics.csv",
         "column 1 (scene): '../bounce' must be of at most 100 letters"},
        {"truncate -s -4 replays/bounce.replay", "bounce.replay: is no whole replay of bounce"},
        {"sed -i 3p runs.csv", "rows 2 and 3 are both of bullet-pbd on bounce"},
        {"echo mine >charts/notes.txt", "charts/notes.txt: is no chart; move it away"},
        {"sed -i 's/^particles 1$/particles 4294967297/' replays/bounce.replay", "is no whole replay"},
        {"sed -i 's/^columns 0$/columns -1/' replays/bounce.replay", "is no whole replay"},
        {"sed -i 's/^path truth$/path bullet-pbd/' replays/bounce.replay", "is no whole replay"},
        {"sed -i 's/^path truth$/path a b/' replays/bounce.replay", "is no whole replay"},
        {"sed -i 's/^plane .*/plane 0 0 0 0 1 nan/' replays/bounce.replay", "is no whole replay"},
        {"cp replays/rope_hanging.replay replays/bounce.replay", "bounce.replay: is no whole replay of bounce"},
    };
    shell("cp -r %s/whole %s/two", fixture_directory, fixture_directory);
    assert_int_equal(program("report %s/%s", "two"), 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        shell("cd %s && rm -rf bad wanted && cp -r two bad && cd bad && %s && cp -r . ../wanted", fixture_directory,
              cases[i].change);
        int status = program("report %s/%s", "bad");
        if (status != 2) fail_msg("'%s': exit status %d", cases[i].change, status);
        fixture_assert_output(cases[i].output);
        shell("cd %s && diff -r wanted bad", fixture_directory);
    }
    shell("mkdir %s/empty", fixture_directory);
    assert_int_equal(program("report %s/%s", "empty"), 2);
    fixture_assert_output("holds no CSV of a comparison or study");
    assert_int_equal(program("report %s/%s", "nowhere"), 2);
    assert_int_equal(fixture_program("report"), 2);
    assert_int_equal(fixture_program("report --help"), 0);
}

// Without gnuplot: what is missing is named, and what was there stays.
static void test_no_gnuplot(void **state) {
    (void)state;
    char command[600];
    snprintf(command, sizeof command, "cp -r %s/whole %s/three && PATH=/nowhere %s report %s/three 2>%s/output",
             fixture_directory, fixture_directory, PROGRAM, fixture_directory, fixture_directory);
    assert_int_not_equal(system(command), 0);
    fixture_assert_output("gnuplot-nox");
    shell("cd %s && diff -r whole three", fixture_directory);
}

// Numbers that have no place on an axis cost their dots, not the report.
static void test_undrawable(void **state) {
    (void)state;
    static const char *const changes[] = {
        "NR > 1 && $2 == \"bullet-pbd\" {$5 = \"\"} 1' series.csv",
        "NR > 1 {$5 = \"inf\"} 1' series.csv",
        "NR > 1 {$5 = 50000} 1' series.csv",
        "NR > 1 {$9 = \"inf\"} 1' metrics.csv",
        "NR > 1 {$9 = 0; $8 = \"\"} 1' metrics.csv",
        "NR > 1 {$5 = \"\"} 1' deviations.csv",
    };
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        const char *file = strrchr(changes[i], ' ') + 1;
        shell("cd %s && rm -rf odd && cp -r whole odd && cd odd && awk -F, -v OFS=, '%s >changed && mv changed %s",
              fixture_directory, changes[i], file);
        int status = program("report %s/%s", "odd");
        if (status) fail_msg("%s: exit status %d", changes[i], status);
    }
}

// Any one CSV is enough for its charts.
static void test_single_files(void **state) {
    (void)state;
    static const char *const files[] = {"runs.csv", "metrics.csv", "series.csv", "deviations.csv", "ledger.csv"};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        shell("cd %s && rm -rf single && mkdir single && cp whole/%s single/", fixture_directory, files[i]);
        int status = program("report %s/%s", "single");
        if (status) fail_msg("%s: exit status %d", files[i], status);
    }
}

// The charts that README shows are what their CSVs make. gnuplot's SVG is the same on every machine of one version.
static void test_readme(void **state) {
    (void)state;
    static const char *const charts[] = {"cloth_two_corners.precision", "summary", "rope_hanging.stability"};
    const char *readme = SCENE_DIRECTORY "/../reports/readme";
    shell("mkdir %s/readme && cp %s/*.csv %s/readme", fixture_directory, readme, fixture_directory);
    assert_int_equal(program("report %s/%s", "readme"), 0);
    for (size_t i = 0; i < sizeof charts / sizeof *charts; i++)
        shell("cmp %s/charts/%s.svg %s/readme/charts/%s.svg", readme, charts[i], fixture_directory, charts[i]);
}

// As wide as asked for, to a point of 1/72 in, which gnuplot cuts to; a chart of many letters is as wide as two columns
// and 8 mm between them.
static void test_paper(void **state) {
    (void)state;
    assert_int_equal(program("report %s/%s", "whole --format pdf --width 85mm"), 0);
    const struct {
        const char *chart;
        double width;
    } charts[] = {{"rope_hanging.cost", 8.5}, {"rope_hanging.deviations", 17.8}, {"summary", 17.8}};
    for (size_t i = 0; i < sizeof charts / sizeof *charts; i++) {
        char path[300], *bytes;
        size_t size;
        snprintf(path, sizeof path, "%s/whole/charts/%s.pdf", fixture_directory, charts[i].chart);
        assert_int_equal(ck_file_read(&bytes, &size, path, NULL), CK_OK);
        assert_memory_equal(bytes, "%PDF-", 5);
        const char *box = memmem(bytes, size, "/MediaBox [ 0 0 ", strlen("/MediaBox [ 0 0 "));
        assert_non_null(box);
        assert_float_equal(strtod(box + strlen("/MediaBox [ 0 0 "), NULL) * 2.54 / 72, charts[i].width, 2.54 / 72);
        free(bytes);
    }
    // a page that is written anew takes the place of the charts for a paper, too
    assert_int_equal(program("report %s/%s", "whole"), 0);
    shell("test ! -e %s/whole/charts/summary.pdf", fixture_directory);
    static const char *const bad[] = {"--format png", "--width 8.5cm", "--format pdf --width 8.5",
                                      "--format pdf --width 2cm", "--format pdf --width nan"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char words[100];
        snprintf(words, sizeof words, "whole %s", bad[i]);
        assert_int_equal(program("report %s/%s", words), 2);
    }
}

// A sentence of the scene is one line of the header, and cut between letters where it is long.
static void test_about(void **state) {
    (void)state;
    char path[300];
    snprintf(path, sizeof path, "%s/told.yaml", fixture_directory);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "name: told\nabout: \"one\\npath five");
    for (int i = 0; i < 400; i++) fprintf(file, "\xc3\xa9");
    fprintf(file, "\"\nrope: {particles: 2, spacing: 1, mass: 1}\nsprings: {stiffness: 50}\npins: [first]\n"
                  "gravity: [0, -9.81, 0]\ntime: {duration: 0.1, fps: 60}\n");
    fclose(file);
    char words[300];
    snprintf(words, sizeof words, "told.yaml -e native-verlet --repeats 1 --out %s/told", fixture_directory);
    assert_int_equal(program("compare %s/%s", words), 0);
    ck_Replay replay;
    ck_Error error = {0};
    snprintf(words, sizeof words, "%s/told", fixture_directory);
    if (ck_replay_read(&replay, words, "told", &error)) fail_msg("%s", error.message);
    const char *line = strstr(replay.bytes, "\nabout ") + strlen("\nabout ");
    assert_memory_equal(line, "one path five\xc3\xa9", strlen("one path five\xc3\xa9"));
    // 500 bytes would end within a letter of two, for 13 stand before them
    assert_int_equal(strcspn(line, "\n"), 499);
    ck_replay_free(&replay);
}

// A replay holds the runs' own positions: the first frame is the model's start, and as many paths as there are runs.
static void test_replay(void **state) {
    (void)state;
    char directory[200];
    snprintf(directory, sizeof directory, "%s/whole", fixture_directory);
    ck_Replay replay;
    ck_Error error = {0};
    if (ck_replay_read(&replay, directory, "rope_hanging", &error)) fail_msg("%s", error.message);
    ck_Comparison comparison;
    assert_int_equal(ck_comparison_load(&comparison, SCENE_DIRECTORY "/rope_hanging.yaml", NULL), CK_OK);
    const ck_Model *model = &comparison.model;
    assert_int_equal(replay.particle_count, model->particle_count);
    assert_int_equal(replay.spring_count, model->spring_count);
    assert_int_equal(replay.path_count, 3); // seed-tecido does not take the scene; the truth is one
    assert_true(replay.frame_count > 30 && replay.frame_count <= 61);
    const char *positions = replay.bytes + replay.header_size + sizeof(float) * (size_t)replay.frame_count +
                            sizeof(float) * 3 * (size_t)replay.spring_count;
    for (int k = 0; k < 3 * model->particle_count; k++) {
        float at;
        memcpy(&at, positions + sizeof at * (size_t)k, sizeof at);
        assert_true(at == (float)model->position[k]);
    }
    ck_comparison_free(&comparison);
    ck_replay_free(&replay);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_report),     cmocka_unit_test(test_bad_files), cmocka_unit_test(test_no_gnuplot),
        cmocka_unit_test(test_undrawable), cmocka_unit_test(test_readme),    cmocka_unit_test(test_single_files),
        cmocka_unit_test(test_replay),     cmocka_unit_test(test_paper),     cmocka_unit_test(test_about),
    };
    return cmocka_run_group_tests(tests, make_comparison, fixture_remove_directory);
}
