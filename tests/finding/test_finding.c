// Sentences come by rules: each rule says its sentence where it holds, and nothing where a difference is within what is
// known.
#include "fixture.h"

#include "finding.h"

#include <unistd.h>

// A row of a table: what "column=value" says, and where it says nothing, what a column takes.
static void write_row(FILE *file, const ck_Layout *layout, const char *const *values) {
    for (int i = 0; i < ck_layout_column_count(layout); i++) {
        static const char *const plain[] = {"x", "", "", "ok"};
        const char *value = plain[layout->columns[i].kind];
        size_t length = strlen(layout->columns[i].name);
        for (const char *const *one = values; *one; one++)
            if (!strncmp(*one, layout->columns[i].name, length) && (*one)[length] == '=') value = *one + length + 1;
        fprintf(file, "%s\"%s\"", i ? "," : "", value);
    }
    fprintf(file, "\n");
}

static void write_table(const char *directory, ck_LayoutName name, const char *const (*rows)[10], size_t count) {
    char path[100];
    snprintf(path, sizeof path, "%s/%s", directory, ck_layouts[name].file);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (int i = 0; i < ck_layout_column_count(&ck_layouts[name]); i++)
        fprintf(file, "%s%s", i ? "," : "", ck_layouts[name].columns[i].name);
    fprintf(file, "\n");
    for (size_t i = 0; i < count; i++) write_row(file, &ck_layouts[name], rows[i]);
    fclose(file);
}

#define TABLE(directory, name, rows) write_table(directory, name, rows, sizeof(rows) / sizeof *(rows))

static void find(ck_Findings *findings, char *directory) {
    ck_Error error = {0};
    char command[100];
    if (ck_findings_read(findings, directory, &error)) fail_msg("%s", error.message);
    snprintf(command, sizeof command, "rm -r %s", directory);
    assert_int_equal(system(command), 0);
}

static void assert_said(const ck_Findings *findings, const char *kind, const char *text) {
    for (int i = 0; i < findings->count; i++)
        if (!strcmp(findings->items[i].kind, kind) && !strcmp(findings->items[i].text, text)) return;
    for (int i = 0; i < findings->count; i++)
        print_message("%s: %s\n", findings->items[i].kind, findings->items[i].text);
    fail_msg("nobody said '%s: %s'", kind, text);
}

static void test_comparison(void **state) {
    (void)state;
    static const char *const runs[][10] = {
        {"scene=a", "engine=one", "status=diverged", "reason=left the finite numbers; at once"},
        {"scene=b", "engine=one", "status=energy_gain"},
        {"scene=talk", "engine=bullet-pbd", "cpu_median_s=2", "cpu_low_s=1.9", "cpu_high_s=2.1"},
        {"scene=talk", "engine=bullet-pbd-float", "cpu_median_s=5", "cpu_low_s=4.9", "cpu_high_s=5.1",
         "time_step_s=0.005", "substeps=2", "simulated_s=1"},
        {"scene=a", "engine=bullet-pbd", "cpu_median_s=2", "cpu_low_s=1.9", "cpu_high_s=2.1"},
        {"scene=a", "engine=bullet-pbd-float", "cpu_median_s=1", "cpu_low_s=0.9", "cpu_high_s=1.1"},
        {"scene=a", "engine=bullet-stock", "cpu_median_s=2.05", "cpu_low_s=1.9", "cpu_high_s=2.2"},
        {"scene=a", "engine=lacking"},
        {"scene=a", "engine=near"},
    };
    static const char *const metrics[][10] = {
        {"scene=a", "engine=bullet-pbd", "metric=position_rms", "error=0.002", "truth_uncertainty=1e-6",
         "truth_kind=trajectory"},
        {"scene=a", "engine=bullet-pbd-float", "metric=position_rms", "error=0.0021", "truth_uncertainty=1e-6",
         "truth_kind=trajectory"},
        {"scene=talk", "engine=bullet-pbd", "metric=position_rms", "error=0.002"},
        {"scene=talk", "engine=bullet-pbd-float", "metric=position_rms", "error=0.002"},
        {"scene=far", "engine=bullet-pbd", "metric=position_rms", "error=0.002", "truth_uncertainty=1e-6"},
        {"scene=far", "engine=bullet-pbd-float", "metric=position_rms", "error=0.8", "truth_uncertainty=1e-6"},
        {"scene=a", "engine=bullet-stock", "metric=position_rms", "error=0.003", "truth_uncertainty=1e-6",
         "truth_kind=trajectory"},
        {"scene=a", "engine=lacking", "metric=position_rms", "error=0.02", "truth_uncertainty=1e-6",
         "truth_kind=trajectory"},
        {"scene=a", "engine=near", "metric=position_rms", "error=0.004", "truth_uncertainty=1e-6",
         "truth_kind=trajectory"},
    };
    static const char *const ledger[][10] = {
        {"scene=a", "engine=bullet-pbd", "quantity=spring damping", "wanted=0.5", "match=exact"},
        {"scene=a", "engine=bullet-pbd-float", "quantity=spring damping", "wanted=0.5", "match=exact"},
        {"scene=talk", "engine=bullet-pbd-float", "quantity=message", "native_value=0.03", "match=approximate"},
        {"scene=a", "engine=lacking", "quantity=spring damping", "wanted=0.5", "unit=N*s/m", "match=impossible"},
        {"scene=a", "engine=near", "quantity=spring damping", "wanted=0.5", "unit=N*s/m", "match=impossible"},
    };
    char directory[] = "/tmp/clothcheck-test-XXXXXX";
    ck_Findings findings;
    assert_non_null(mkdtemp(directory));
    TABLE(directory, CK_RUNS, runs);
    TABLE(directory, CK_METRICS, metrics);
    TABLE(directory, CK_LEDGER, ledger);
    find(&findings, directory);
    assert_said(&findings, "breakdown", "one breaks down on a, b; on a: left the finite numbers");
    assert_said(&findings, "model",
                "lacking has no spring damping (0.5 N*s/m), which may be why it is 2 % of the size off on a, where the "
                "middle of those "
                "that have it is 0.21 % off");
    assert_said(&findings, "cost",
                "bullet-pbd-float takes 0.5 of the time of bullet-pbd, in double precision (0.5 to 0.5, on 1 scene), "
                "and is 0.21 % off where that is 0.2 % (medians)");
    assert_said(
        &findings, "rounding",
        "bullet-pbd-float on far: single precision is 80 % of the size off, where bullet-pbd, in double, is 0.2 % "
        "off");
    // of talk the cost is mostly of messages; stock's costs are not told apart, and near is no farther than thrice the
    // others
    assert_int_equal(findings.count, 4);
    ck_findings_free(&findings);
}

// What ends a motion does not change a rest, and nothing is said of errors that the truth cannot tell.
static void test_silence(void **state) {
    (void)state;
    static const char *const runs[][10] = {{"scene=a", "engine=lacking"}, {"scene=b", "engine=lacking"}};
    static const char *const metrics[][10] = {
        {"scene=a", "engine=one", "metric=position_rms", "error=0.001"},
        {"scene=a", "engine=two", "metric=position_rms", "error=0.001"},
        {"scene=a", "engine=lacking", "metric=position_rms", "error=0.02", "truth_uncertainty=1e-6",
         "truth_kind=energy minimum"},
        {"scene=b", "engine=one", "metric=position_rms", "error=0.001"},
        {"scene=b", "engine=two", "metric=position_rms", "error=0.001"},
        {"scene=b", "engine=lacking", "metric=position_rms", "error=0.02", "truth_uncertainty=0.01",
         "truth_kind=trajectory"},
    };
    static const char *const ledger[][10] = {
        {"scene=a", "engine=one", "quantity=spring damping", "wanted=1", "match=exact"},
        {"scene=a", "engine=two", "quantity=spring damping", "wanted=1", "match=exact"},
        {"scene=a", "engine=lacking", "quantity=spring damping", "wanted=1", "match=impossible"},
        {"scene=b", "engine=one", "quantity=friction", "wanted=1", "match=exact"},
        {"scene=b", "engine=two", "quantity=friction", "wanted=1", "match=exact"},
        {"scene=b", "engine=lacking", "quantity=friction", "wanted=1", "match=impossible"},
    };
    char directory[] = "/tmp/clothcheck-test-XXXXXX";
    ck_Findings findings;
    assert_non_null(mkdtemp(directory));
    TABLE(directory, CK_RUNS, runs);
    TABLE(directory, CK_METRICS, metrics);
    TABLE(directory, CK_LEDGER, ledger);
    find(&findings, directory);
    assert_int_equal(findings.count, 0);
    ck_findings_free(&findings);
}

static void test_precision(void **state) {
    (void)state;
    static const char *const rows[][10] = {
        {"scene=a", "engine=one", "substeps=4", "iterations=1", "error=0.021", "cpu_s=1"},
        {"scene=a", "engine=one", "substeps=4", "iterations=16", "error=0.02", "cpu_s=3"},
        {"scene=a", "engine=helped", "substeps=4", "iterations=1", "error=0.02", "cpu_s=1"},
        {"scene=a", "engine=helped", "substeps=4", "iterations=16", "error=0.002", "cpu_s=3"},
        {"scene=a", "engine=good", "substeps=4", "iterations=1", "error=0.0002", "cpu_s=1"},
        {"scene=a", "engine=good", "substeps=4", "iterations=16", "error=0.0002", "cpu_s=3"},
    };
    static const char *const summary[][10] = {
        {"scene=a", "engine=jolt", "quantity=finest_before_rounding", "value=4",
         "reason=finer steps are worse: rounding"},
        {"scene=a", "engine=bars", "quantity=finest_useful_substeps", "value=9",
         "reason=finer steps are worse: by its method, not by rounding"},
        {"scene=a", "engine=bars", "quantity=floor", "value=9"},
    };
    char directory[] = "/tmp/clothcheck-test-XXXXXX";
    ck_Findings findings;
    assert_non_null(mkdtemp(directory));
    TABLE(directory, CK_PRECISION, rows);
    TABLE(directory, CK_PRECISION_SUMMARY, summary);
    find(&findings, directory);
    assert_said(&findings, "setting",
                "one on a: 16 iterations in place of 1, at 4 substeps a frame, cost 3 times as much, and the error is "
                "2 % where it was 2.1 %");
    assert_said(&findings, "rounding",
                "jolt on a: more than 4 substeps a frame are no use: finer steps are worse: rounding");
    assert_said(&findings, "setting",
                "bars on a: more than 9 substeps a frame are no use: finer steps are worse: by its method, not by "
                "rounding");
    assert_int_equal(findings.count, 3);
    ck_findings_free(&findings);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_comparison), cmocka_unit_test(test_silence),
                                       cmocka_unit_test(test_precision)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
