// What a study's file may say, and what is wrong with others.
#include "fixture.h"

#include "study_file.h"

#include <unistd.h>

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

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bad_studies), cmocka_unit_test(test_values)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
