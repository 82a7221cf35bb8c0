// Scenes on which something was once wrong, tests/cases, each with its right value.
#include "fixture_comparison.h"

#include "runner.h"
#include "stability_study.h"

static void load(ck_Comparison *comparison, const char *name) {
    static char path[300];
    snprintf(path, sizeof path, SCENE_DIRECTORY "/../tests/cases/%s.yaml", name);
    ck_Error error = {0};
    if (ck_comparison_load(comparison, path, &error)) fail_msg("%s", error.message);
    assert_int_equal(ck_truth_create(&comparison->truth, &comparison->model, NULL, NULL, NULL), CK_OK);
}

static double truth_of(const ck_Comparison *comparison, const char *metric) {
    return ck_metric_truth(ck_metric_find(metric), &comparison->model, &comparison->truth.reference);
}

static double value_of(const ck_Run *run, const ck_Comparison *comparison, const char *metric) {
    return ck_metric_value(ck_metric_find(metric), &comparison->model, &run->trajectory, &comparison->truth.reference);
}

// Runs and judges; fails where the run has no such status.
static void run_as(ck_Run *run, const ck_Comparison *comparison, const char *engine, ck_Settings wanted,
                   ck_RunStatus status) {
    ck_Limits limits = ck_limits_default();
    assert_int_equal(ck_verdict_run(run, &comparison->model, &comparison->truth.reference, ck_engine_find(engine),
                                    &wanted, &limits, NULL),
                     CK_OK);
    if (run->status != status)
        fail_msg("%s on %s is %s: %s", engine, comparison->model.name, ck_run_status_names[run->status], run->reason);
}

// What is asked of one engine's run, or with no engine, of the truth.
typedef struct Case {
    const char *scene, *engine;
    ck_Settings wanted;
    ck_RunStatus status;
    const char *metric; // NULL: the status alone
    double value, tolerance;
} Case;

static const Case cases[] = {
    // 2π√(m/k); velocity Verlet is off by (ω·dt)²/24, others by more, and none takes the swing's start for its rest
    {"bounces_on_a_rope", NULL, {0}, CK_RUN_OK, "period", 2.0556067, 1e-6},
    {"bounces_on_a_rope", "native-verlet", {0}, CK_RUN_OK, "period", 2.0556067, 2e-4},
    {"bounces_on_a_rope", "bullet-implicit", {0}, CK_RUN_OK, "period", 2.0556067, 1e-3},
    // the linear string is off by some strain, and says so
    {"slow_string", "native-verlet", {0}, CK_RUN_OK, "period", 6.94359, 2e-3},
    // the first hop is shorter than two frames
    {"low_bounce", NULL, {0}, CK_RUN_OK, "restitution", 0.15, 1e-9},
    {"low_bounce", "native-verlet", {0}, CK_RUN_OK, "restitution", 0.15, 1e-9},
    {"low_bounce", "native-bars", {0}, CK_RUN_OK, "restitution", 0.15, 1e-9},
    // a polygon of 24 to the quarter is rougher than the ball by 1/1000
    {"heavy_over_ball", NULL, {0}, CK_RUN_OK, "wrap_friction", 0.3, 5e-4},
    {"heavy_over_ball", "native-verlet", {0}, CK_RUN_OK, "wrap_friction", 0.3, 1e-3},
    // settled, and too soft: a result with an error, from Bullet's own stiffness at one step of 60 Hz
    {"soft_is_no_blowup", "bullet-pbd", {.substeps = 1, .iterations = 1}, CK_RUN_OK, "position_rms", 0.0765, 5e-4},
    // at rest to rounding, whatever sweeps
    {"bar_at_rest", "native-bars", {0}, CK_RUN_OK, "position_rms", 0, 1e-7},
    {"bar_at_rest", "bullet-pbd", {0}, CK_RUN_OK, "position_rms", 0, 1e-7},
    {"bar_at_rest", "ode-quick", {0}, CK_RUN_OK, "position_rms", 0, 1e-7},
    {"bar_at_rest", "native-rope", {0}, CK_RUN_OK, "position_rms", 0, 1e-7},
    // steps of lines know what pins stretch them by, not the weight alone
    {"taut_sheet", "native-lines", {0}, CK_RUN_OK, "position_rms", 0, 1e-6},
    // a soft rope that still swings, undamped, may be as long as it likes
    {"soft_rope", "native-verlet", {0}, CK_RUN_UNSETTLED, NULL, 0, 0},
    {"soft_rope", "ode-direct", {0}, CK_RUN_UNSETTLED, NULL, 0, 0},
    // stock Bullet's links, as Bullet itself leaves them
    {"heavy_end_bars", "bullet-pbd", {.substeps = 1, .iterations = 10}, CK_RUN_OVERSTRETCHED, "sag", 2.958, 1e-3},
    {"heavy_end_bars", "bullet-pbd", {.substeps = 1, .iterations = 100}, CK_RUN_OK, "sag", 1.19293, 1e-4},
    // a step that damping across a sheet would blow up
    {"damped_sheet", "bullet-pbd", {0}, CK_RUN_OK, NULL, 0, 0},
    // 30 s after the fall, as after one
    {"floor_for_long", "bullet-pbd", {.substeps = 8, .iterations = 1}, CK_RUN_OK, "sag", 1, 1e-5},
    {"floor_for_long", "bullet-implicit", {.substeps = 8, .iterations = 1}, CK_RUN_OK, "sag", 1, 1e-5},
    {"floor_for_long", "bullet-explicit", {.substeps = 16}, CK_RUN_OK, "sag", 1, 1e-5},
    {"floor_for_long", "ode-quick", {.substeps = 8, .iterations = 20}, CK_RUN_OK, "sag", 1, 1e-5},
    // farther from a collider than Bullet's distances can count, at the start and later
    {"far_from_a_grain", "bullet-pbd", {0}, CK_RUN_REFUSED, NULL, 0, 0},
    {"far_from_a_grain", "bullet-implicit", {0}, CK_RUN_REFUSED, NULL, 0, 0},
    {"thrown_far", "bullet-pbd", {0}, CK_RUN_DIVERGED, NULL, 0, 0},
    // a collider that moves gives some energy, but not a million times its own speed
    {"flung_in_contact", "bullet-implicit", {0}, CK_RUN_ENERGY_GAIN, NULL, 0, 0},
    // a minute on the floor
    {"lies_there", "bullet-pbd", {.substeps = 4, .iterations = 1}, CK_RUN_OK, "rest_height", 0, 1e-3},
};

static void test_cases(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const Case *one = &cases[i];
        ck_Comparison comparison;
        ck_Run run = {0};
        char what[200];
        load(&comparison, one->scene);
        if (one->engine) run_as(&run, &comparison, one->engine, one->wanted, one->status);
        snprintf(what, sizeof what, "%s of %s on %s", one->metric, one->engine ? one->engine : "the truth", one->scene);
        if (one->metric)
            assert_near(what,
                        one->engine ? value_of(&run, &comparison, one->metric) : truth_of(&comparison, one->metric),
                        one->value, one->tolerance);
        ck_run_free(&run);
        ck_comparison_free(&comparison);
    }
}

// The truth's uncertainty holds what the linear theory leaves out.
static void test_uncertain(void **state) {
    (void)state;
    ck_Comparison comparison;
    load(&comparison, "slow_string");
    double uncertainty = ck_truth_uncertainty(&comparison.truth, &comparison.model, ck_metric_find("period"));
    assert_near("the period of a slack string", truth_of(&comparison, "period"), 6.94359, uncertainty);
    assert_true(uncertainty < 0.05);
    ck_comparison_free(&comparison);
}

// Engines that come to rest in another fold are told from those that miss theirs, and are found to rest there.
static void test_folds(void **state) {
    (void)state;
    static const struct {
        const char *engine;
        bool is_another;
    } engines[] = {
        {"native-verlet", false}, {"bullet-explicit", false}, {"ode-direct", true}, {"bullet-implicit", true}};
    ck_Comparison comparison;
    load(&comparison, "two_folds");
    for (size_t i = 0; i < sizeof engines / sizeof *engines; i++) {
        ck_Run run;
        ck_Fold fold;
        run_as(&run, &comparison, engines[i].engine, (ck_Settings){0}, CK_RUN_OK);
        assert_int_equal(ck_fold_find(&fold, &run, &comparison.truth, &(ck_Limits){.seconds = 60}, NULL), CK_OK);
        print_message("%s: %.2g from its own rest, which is %.2g from the truth's\n", engines[i].engine, fold.own,
                      fold.apart);
        assert_int_equal(ck_fold_is_another(&fold, &comparison.truth, &comparison.model), engines[i].is_another);
        assert_near("distance to its own rest", fold.own, 0, 1e-6);
        assert_near("distance of the rests", fold.apart, engines[i].is_another ? 0.0589 : 0, 1e-4);
        assert_near("energy of one over the other, J", fold.energy, 0, 1e-9);
        ck_run_free(&run);
    }
    ck_comparison_free(&comparison);
}

// What swings across springs is not damped by them, and sets the critical step.
static void test_foretold(void **state) {
    (void)state;
    ck_Comparison comparison;
    load(&comparison, "strongly_damped");
    const ck_Engine *engine = ck_engine_find("bullet-explicit");
    ck_CompareOptions options = ck_compare_options_default();
    options.engines = &engine;
    options.engine_count = 1;
    ck_StabilityMap map;
    assert_int_equal(ck_stability_map_create(&map, &comparison, &options, NULL), CK_OK);
    bool is_found = false;
    for (int i = 0; i < CK_STABILITY_RESTS; i++) {
        const ck_StabilityRest *rest = &map.rests[i];
        if (rest->stiffness != 1) continue;
        is_found = true;
        assert_near("the step foretold, s", ck_stability_limit(engine->method, rest->fastest, rest->across), 0.09666,
                    1e-5);
        // by springs along which damping is, it would be far longer
        assert_true(ck_stability_limit(engine->method, rest->fastest, (ck_Vibration){0}) > 1);
    }
    assert_true(is_found);
    ck_stability_map_free(&map);
    ck_comparison_free(&comparison);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_cases), cmocka_unit_test(test_uncertain),
                                       cmocka_unit_test(test_folds), cmocka_unit_test(test_foretold)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
