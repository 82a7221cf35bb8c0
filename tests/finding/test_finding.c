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

typedef struct Table {
    ck_LayoutName name;
    const char *const (*rows)[10];
    size_t count;
} Table;

#define TABLE(name, rows)                                                                                              \
    { name, rows, sizeof(rows) / sizeof *(rows) }

// Of a directory that holds these tables alone.
static void find_in(ck_Findings *findings, const Table *tables, size_t count) {
    char directory[] = "/tmp/clothcheck-test-XXXXXX", command[100];
    ck_Error error = {0};
    assert_non_null(mkdtemp(directory));
    for (size_t i = 0; i < count; i++) write_table(directory, tables[i].name, tables[i].rows, tables[i].count);
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
    const Table tables[] = {TABLE(CK_RUNS, runs), TABLE(CK_METRICS, metrics), TABLE(CK_LEDGER, ledger)};
    ck_Findings findings;
    find_in(&findings, tables, sizeof tables / sizeof *tables);
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
    const Table tables[] = {TABLE(CK_RUNS, runs), TABLE(CK_METRICS, metrics), TABLE(CK_LEDGER, ledger)};
    ck_Findings findings;
    find_in(&findings, tables, sizeof tables / sizeof *tables);
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
        {"scene=a", "engine=lost", "substeps=8", "iterations=1", "error=0.8", "cpu_s=1", "rounding=2"},
        {"scene=a", "engine=lost", "substeps=4", "iterations=1", "error=0.5", "cpu_s=1", "rounding=0.5"},
        {"scene=a", "engine=lost", "substeps=4", "iterations=16", "error=0.5", "cpu_s=3", "rounding=0.5"},
        {"scene=a", "engine=lost", "substeps=2", "iterations=1", "error=0.02", "cpu_s=1", "rounding=0.1"},
    };
    static const char *const summary[][10] = {
        {"scene=a", "engine=jolt", "quantity=finest_before_rounding", "value=4",
         "reason=finer steps are worse: rounding"},
        {"scene=a", "engine=bars", "quantity=finest_useful_substeps", "value=9",
         "reason=finer steps are worse: by its method, not by rounding"},
        {"scene=a", "engine=bars", "quantity=floor", "value=9"},
    };
    const Table tables[] = {TABLE(CK_PRECISION, rows), TABLE(CK_PRECISION_SUMMARY, summary)};
    ck_Findings findings;
    find_in(&findings, tables, sizeof tables / sizeof *tables);
    assert_said(&findings, "setting",
                "one on a: 16 iterations in place of 1, at 4 substeps a frame, cost 3 times as much, and the error is "
                "2 % where it was 2.1 %");
    assert_said(&findings, "rounding",
                "jolt on a: more than 4 substeps a frame are no use: finer steps are worse: rounding");
    assert_said(&findings, "setting",
                "bars on a: more than 9 substeps a frame are no use: finer steps are worse: by its method, not by "
                "rounding");
    assert_said(&findings, "rounding",
                "lost on a: at 4 substeps a frame a step falls by 2 of the spacing of its numbers, and it is 50 % off");
    assert_int_equal(findings.count, 4);
    ck_findings_free(&findings);
}

// Of stability, needs and speed.
static void test_studies(void **state) {
    (void)state;
    static const char *const stability[][10] = {
        {"scene=a", "engine=slow", "case=critical", "damping=scene", "stiffness_factor=1", "critical_step_s=0.005",
         "ratio=1.01"},
        {"scene=a", "engine=fast", "case=critical", "damping=scene", "stiffness_factor=1", "critical_step_s=0.001",
         "ratio=0.7"},
        {"scene=a", "engine=slow", "case=critical", "damping=none", "stiffness_factor=1", "critical_step_s=0.009",
         "ratio=0.1"},
        {"scene=a", "engine=slow", "case=map", "damping=scene", "stiffness_factor=1", "time_step_s=0.01"},
        {"scene=a", "engine=never", "case=critical", "damping=scene", "stiffness_factor=1"},
    };
    static const char *const needs[][10] = {
        {"scene=a", "engine=one", "left_out=drag", "metric=sag", "matters=no", "tolerance=0.01", "cpu_with_s=3",
         "cpu_without_s=1.5"},
        {"scene=a", "engine=one", "left_out=drag", "metric=stretch_max", "matters=no", "tolerance=0.01", "cpu_with_s=3",
         "cpu_without_s=1.5"},
        {"scene=a", "engine=one", "left_out=shear", "metric=sag", "matters=yes", "tolerance=0.01"},
        {"scene=a", "engine=one", "left_out=shear", "metric=stretch_max", "matters=no", "tolerance=0.01"},
        {"scene=a", "engine=one", "left_out=bend", "metric=sag", "matters=no", "status=diverged"},
    };
    static const char *const bench[][10] = {
        {"body=cloth", "particles=400", "engine=peer", "setup=4 sweeps", "metric=update_over_native", "value=5",
         "low=4", "high=6"},
        {"body=cloth", "particles=4096", "engine=peer", "setup=4 sweeps", "metric=update_over_native", "value=9",
         "low=8", "high=10"},
        {"body=cloth", "particles=4096", "engine=like", "setup=", "metric=update_over_native", "value=1.3", "low=1.1",
         "high=1.5"},
        {"body=rope", "particles=4096", "engine=peer", "setup=", "metric=update_over_native", "value=9", "low=8",
         "high=10"},
    };
    const Table tables[] = {TABLE(CK_STABILITY, stability), TABLE(CK_NEEDS, needs), TABLE(CK_BENCH, bench)};
    ck_Findings findings;
    find_in(&findings, tables, sizeof tables / sizeof *tables);
    assert_said(&findings, "breakdown", "on a longer steps than these blow up: fast 1 ms, slow 5 ms");
    assert_said(&findings, "breakdown", "fast on a: its longest stable step is 1 ms, 0.7 of that of its theory");
    assert_said(&findings, "model",
                "a can do without 'drag': no metric moves by more than 0.01, and one takes 0.5 of the time without");
    assert_said(&findings, "cost",
                "peer, 4 sweeps takes 9 times as long for a spring and sweep as the native solver of its kind (8 to "
                "10), on a cloth of 4096 particles");
    assert_int_equal(findings.count, 4);
    ck_findings_free(&findings);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_comparison), cmocka_unit_test(test_silence),
                                       cmocka_unit_test(test_precision), cmocka_unit_test(test_studies)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
