// The regression check: a fault of 1 % in an engine's stiffness is found and the engine named; a whole one passes.
#include "fixture_comparison.h"

#include "check.h"

#include <unistd.h>

// A baseline of one engine's rows, with bands, as --update writes it.
static void make_baseline(ck_Baseline *baseline, const ck_CheckCase *one, const ck_JournalRow *row) {
    char directory[] = "/tmp/clothcheck-check-XXXXXX", path[100];
    ck_Csv csv;
    assert_non_null(mkdtemp(directory));
    assert_int_equal(ck_csv_open(&csv, directory, &ck_layouts[CK_BASELINE], NULL), CK_OK);
    assert_true(ck_check_add(one, row, 1e9, &csv));
    assert_int_equal(ck_csv_close(&csv, NULL), CK_OK);
    snprintf(path, sizeof path, "%s/metrics.csv", directory);
    assert_int_equal(ck_baseline_read(baseline, path, NULL), CK_OK);
    unlink(path);
    rmdir(directory);
}

static void measure(ck_JournalRow *row, const ck_CheckCase *one, bool is_update) {
    const ck_CompareOptions options = ck_compare_options_default();
    ck_Check check = {.cases = (ck_CheckCase *)one, .case_count = 1, .options = &options, .is_update = is_update};
    ck_Study study = ck_check_study(&check);
    *row = (ck_JournalRow){.is_done = true};
    for (int i = 0; i < CK_JOURNAL_VALUES; i++) row->values[i] = NAN;
    assert_int_equal(study.run(study.context, 0, row, NULL), CK_OK);
}

static void check_engine(ck_Comparison *comparison, const ck_Engine *engine) {
    ck_CheckCase one = {comparison, engine};
    const ck_Tolerance loose[] = {{NULL, 0.02, true}, {"stretch_max", 1, false}};
    const ck_Check strict = {.cases = &one, .case_count = 1},
                   generous = {.cases = &one, .case_count = 1, .tolerances = loose, .tolerance_count = 2};
    ck_JournalRow row;
    ck_Baseline baseline;
    ck_Deviation deviations[100];
    measure(&row, &one, true);
    make_baseline(&baseline, &one, &row);
    assert_true(baseline.count > 5 && baseline.count < 100);
    measure(&row, &one, false);
    if (ck_check_compare(&strict, 0, &row, &baseline, deviations))
        fail_msg("%s: %s deviates from itself", engine->name, deviations[0].row->metric);
    for (int i = 0; i < comparison->model.spring_count; i++) comparison->model.springs[i].stiffness *= 1.01;
    measure(&row, &one, false);
    for (int i = 0; i < comparison->model.spring_count; i++) comparison->model.springs[i].stiffness /= 1.01;
    int found = ck_check_compare(&strict, 0, &row, &baseline, deviations);
    if (!found) fail_msg("%s: 1 %% of stiffness is not found", engine->name);
    assert_string_equal(deviations[0].row->engine, engine->name);
    assert_true(deviations[0].excess > 100);
    // what rounding makes of a rest is let through by no share of it, nor should it be
    found = ck_check_compare(&generous, 0, &row, &baseline, deviations);
    for (int i = 0; i < found; i++)
        if (!strcmp(deviations[i].row->metric, "sag") || !strcmp(deviations[i].row->metric, "stretch_max"))
            fail_msg("%s: %s deviates by more than its tolerance", engine->name, deviations[i].row->metric);
    ck_baseline_free(&baseline);
}

static void test_fault(void **state) {
    (void)state;
    ck_Comparison comparison;
    assert_int_equal(ck_comparison_load(&comparison, SCENE_DIRECTORY "/rope_hanging.yaml", NULL), CK_OK);
    assert_int_equal(ck_truth_create(&comparison.truth, &comparison.model, NULL, NULL, NULL), CK_OK);
    for (int i = 0; i < ck_engine_count(); i++)
        if (fixture_is_solver(ck_engine_at(i)) && ck_engine_at(i)->order > 0 &&
            fixture_takes(ck_engine_at(i), &comparison.model))
            check_engine(&comparison, ck_engine_at(i));
    ck_comparison_free(&comparison);
}

// A baseline without rows would let everything pass.
static void test_empty_baseline(void **state) {
    (void)state;
    char directory[] = "/tmp/clothcheck-check-XXXXXX", path[100];
    ck_Csv csv;
    ck_Baseline baseline;
    ck_Error error = {0};
    assert_non_null(mkdtemp(directory));
    assert_int_equal(ck_csv_open(&csv, directory, &ck_layouts[CK_BASELINE], NULL), CK_OK);
    assert_int_equal(ck_csv_close(&csv, NULL), CK_OK);
    snprintf(path, sizeof path, "%s/metrics.csv", directory);
    assert_int_equal(ck_baseline_read(&baseline, path, &error), CK_BAD_INPUT);
    assert_non_null(strstr(error.message, "holds no rows"));
    ck_baseline_free(&baseline);
    unlink(path);
    rmdir(directory);
}

// So would a band that is none.
static void test_bands(void **state) {
    (void)state;
    static const double bands[] = {NAN, -1e-9, INFINITY};
    for (int i = 0; i < 3; i++) {
        char directory[] = "/tmp/clothcheck-check-XXXXXX", path[100];
        ck_Csv csv;
        ck_Baseline baseline;
        ck_Error error = {0};
        const ck_BaselineRow row = {"rope_hanging", "native-verlet", "ok", "sag", 12345, bands[i]};
        assert_non_null(mkdtemp(directory));
        assert_int_equal(ck_csv_open(&csv, directory, &ck_layouts[CK_BASELINE], NULL), CK_OK);
        ck_baseline_add(&row, &csv);
        assert_int_equal(ck_csv_close(&csv, NULL), CK_OK);
        snprintf(path, sizeof path, "%s/metrics.csv", directory);
        assert_int_equal(ck_baseline_read(&baseline, path, &error), CK_BAD_INPUT);
        assert_non_null(strstr(error.message, "row 2, sag of native-verlet on rope_hanging: the band is"));
        ck_baseline_free(&baseline);
        unlink(path);
        rmdir(directory);
    }
}

// Whatever a solver says and a baseline is called, the XML is XML; a link in its place is replaced, not followed.
static void test_junit(void **state) {
    (void)state;
    char directory[] = "/tmp/clothcheck-check-XXXXXX", path[100], aim[100], text[2000];
    ck_Comparison comparison;
    assert_int_equal(ck_comparison_load(&comparison, SCENE_DIRECTORY "/rope_hanging.yaml", NULL), CK_OK);
    ck_CheckCase one = {&comparison, ck_engine_find("native-verlet")};
    ck_BaselineRow was = {"rope_hanging", "native-verlet", "<ok>", "a&b", 1, 0.1};
    const ck_Check check = {.cases = &one, .case_count = 1};
    const ck_Baseline baseline = {.rows = &was, .count = 1};
    ck_JournalRow row = {.reason = "caf\xe9 <script> \"said\" \x1b[31m"};
    for (int i = 0; i < CK_JOURNAL_VALUES; i++) row.values[i] = NAN;
    assert_non_null(mkdtemp(directory));
    snprintf(path, sizeof path, "%s/check.xml", directory);
    snprintf(aim, sizeof aim, "%s/aim", directory);
    FILE *file = fopen(aim, "w");
    assert_non_null(file);
    fputs("mine", file);
    fclose(file);
    assert_int_equal(symlink(aim, path), 0);
    assert_int_equal(ck_check_write_junit(directory, &check, &row, &baseline, NULL), CK_OK);
    file = fopen(path, "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = 0;
    fclose(file);
    if (!strstr(text, "a&amp;b: nan, was 1 within 0.1, status ok, was &lt;ok&gt;\n"
                      "caf? &lt;script&gt; &quot;said&quot;  [31m</failure>"))
        fail_msg("%s", text);
    file = fopen(aim, "r");
    assert_non_null(fgets(text, sizeof text, file));
    fclose(file);
    assert_string_equal(text, "mine");
    unlink(path);
    unlink(aim);
    rmdir(directory);
    ck_comparison_free(&comparison);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_fault), cmocka_unit_test(test_empty_baseline),
                                       cmocka_unit_test(test_bands), cmocka_unit_test(test_junit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
