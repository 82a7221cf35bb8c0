// Refinement: what converges, with which order, and to what.
#include "fixture_comparison.h"

#include "refine.h"

// Values of a known order come to their limit; others get the verdict that they deserve.
static void test_judge(void **state) {
    (void)state;
    for (double order = 0.5; order <= 4; order += 0.5) {
        const double half = pow(0.5, order), values[3] = {2 + 0.3, 2 + 0.3 * half, 2 + 0.3 * half * half};
        const ck_Refinement judged = ck_refine_judge(values);
        assert_string_equal(judged.verdict, "converges");
        assert_near("order", judged.order, order, 1e-9);
        assert_near("limit", judged.limit, 2, 1e-9);
    }
    static const struct {
        double values[3];
        const char *verdict;
    } cases[] = {{{1, 2, 4}, "does not converge"}, {{1, 2, 3}, "does not converge"},   {{1, 2, 1}, "does not converge"},
                 {{1, 2, 1.9}, "converges"},       {{1, 1.001, 1.003}, "settled"},     {{1, NAN, 1}, "unknown"},
                 {{0, 0, 0}, "settled"},           {{-1, -2, -4}, "does not converge"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_string_equal(ck_refine_judge(cases[i].values).verdict, cases[i].verdict);
}

static ck_Refinement refine(const char *text, const char *metric, double *values) {
    ck_Comparison comparison;
    const ck_Engine *engines[] = {ck_engine_find("native-verlet")};
    const ck_CompareOptions options = {.limits = ck_limits_default(), .engines = engines, .engine_count = 1};
    ck_Error error = {0};
    ck_Refine refine;
    ck_JournalRow row;
    fixture_load_comparison(&comparison, text);
    if (ck_refine_create(&refine, &comparison, &options, NULL, &error)) fail_msg("%s", error.message);
    const ck_Study study = ck_refine_study(&refine);
    assert_int_equal(study.case_count, CK_REFINE_LEVELS);
    for (int i = 0; i < CK_REFINE_LEVELS; i++) {
        row = (ck_JournalRow){0};
        if (study.run(study.context, i, &row, &error)) fail_msg("%s", error.message);
        assert_int_equal(row.status, CK_RUN_OK);
        for (int k = 0; k < ck_metric_count(); k++)
            if (!strcmp(ck_metric_at(k)->name, metric)) values[i] = row.values[k];
    }
    ck_refine_free(&refine);
    ck_comparison_free(&comparison);
    const ck_Refinement judged = ck_refine_judge(values);
    print_message("%s: %.6g, %.6g, %.6g: order %.2f to %.6g\n", metric, values[0], values[1], values[2], judged.order,
                  judged.limit);
    return judged;
}

#define HUNG(springs)                                                                                                  \
    "name: h\ncloth: {rows: 5, columns: 5, spacing: 0.1" springs                                                       \
    "\npins: [top_edge]\ngravity: [0, -9.81, 0]\ndrag: 6\ntime: {duration: 3, step: 0.1}\n"

// A strip of Poisson's ratio 0 that hangs by its edge is a hanging bar: it stretches by ρgL²/2Eh, and its largest
// strain is ρgL/Eh, where it is held. Of the first the error is of second order, the second is met half a cell too low.
static void test_material(void **state) {
    (void)state;
    static const char text[] = HUNG("}\nmaterial: {membrane: 80, poisson: 0, density: 0.4, retardation: 0.004}");
    const double strain = 0.4 * 9.81 * 0.4 / 80;
    double values[3];
    ck_Refinement judged = refine(text, "stretch_max", values);
    assert_string_equal(judged.verdict, "converges");
    assert_near("order", judged.order, 1, 0.1);
    assert_near("limit", judged.limit / strain, 1, 1e-3);
    // by area every particle carries what hangs below its middle: of the sum nothing is left to converge
    judged = refine(text, "sag", values);
    for (int i = 0; i < 3; i++) assert_near("sag", values[i], 1 + strain / 2, 1e-6);
    assert_string_equal(judged.verdict, "settled");
}

#define STRIP(bend)                                                                                                    \
    "name: s\nrope: {particles: 6, spacing: 0.06, mass: 0.03, along: [1, 0, 0]}\n"                                     \
    "springs: {stiffness: 300, damping: 0.05" bend "}\npins: ['x < 0.061']\ngravity: [0, -9.81, 0]\ndrag: 8\n"         \
    "time: {duration: 2, step: 0.1}\n"

// Second neighbours bend by the square of their distance: a finer rope of them comes to one that does not bend at all,
// where one of a bending stiffness keeps its own.
static void test_second_neighbours(void **state) {
    (void)state;
    double values[3], bare[3], bent[3];
    const ck_Refinement judged = refine(STRIP(", bend: 30"), "sag", values);
    refine(STRIP(""), "sag", bare);
    refine(STRIP("}\nbending: {stiffness: 0.01"), "sag", bent);
    for (int i = 0; i < 2; i++) assert_true(fabs(values[i + 1] - bare[i + 1]) < 0.6 * fabs(values[i] - bare[i]));
    assert_near("limit", judged.limit, bare[2], 0.01);
    assert_true(fabs(bent[2] - bent[1]) < 0.5 * fabs(bent[1] - bent[0]) && fabs(bent[2] - bare[2]) > 0.1);
}

static void test_refused(void **state) {
    (void)state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {HUNG(", mass: 1}\nsprings: {stiffness: 9}\nrelease: [{at: 1, pins: [top_edge]}]"), "it lets pins go"},
        {"name: r\nrope: {particles: 3, spacing: 0.1, mass: 1}\npins: [0]\ntime: {duration: 1, step: 0.1}\n",
         "its pins are numbered"},
        {"name: n\nnetwork: {nodes: [{at: [0, 0, 0], mass: 1}]}\ntime: {duration: 1, step: 0.1}\n",
         "neither a cloth nor a rope"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ck_Comparison comparison;
        const ck_CompareOptions options = {.limits = ck_limits_default()};
        ck_Error error = {0};
        ck_Refine refine;
        fixture_load_comparison(&comparison, cases[i].text);
        assert_int_equal(ck_refine_create(&refine, &comparison, &options, NULL, &error), CK_BAD_INPUT);
        if (!strstr(error.message, cases[i].message)) fail_msg("'%s' without '%s'", error.message, cases[i].message);
        ck_refine_free(&refine);
        ck_comparison_free(&comparison);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_judge), cmocka_unit_test(test_material),
                                       cmocka_unit_test(test_second_neighbours), cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
