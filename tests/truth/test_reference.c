// The reference integrator: its order, how far its paths can be trusted, and that what it may take is kept.
#include "fixture_truth.h"

#include "process.h"
#include "runge_kutta.h"

// Halving the step divides the difference by 2 to the order: the eighth where forces are smooth, the fourth where they
// might not be, here for a floor that is never touched.
static void test_reference_order(void **state) {
    (void)state;
    static const struct {
        const char *floor;
        int substeps, order;
        double tolerance;
    } cases[] = {{"", 3, 8, 0.4}, {"colliders: [{plane: {point: [0, -100, 0], normal: [0, 1, 0]}}]\n", 20, 4, 0.15}};
    const ck_Metric *distance = ck_metric_find("position_rms");
    for (int i = 0; i < 2; i++) {
        char scene[500];
        TruthFixture fixture;
        snprintf(scene, sizeof scene,
                 "name: swing\nrope: {particles: 4, spacing: 0.5, mass: 1, along: [1, 0, 0]}\nsprings: "
                 "{stiffness: 200, damping: 0.5}\npins: [first]\ngravity: [0, -9.81, 0]\ndrag: 0.2\n%s"
                 "time: {duration: 0.5, step: 0.05}\n",
                 cases[i].floor);
        fixture_load_truth(&fixture, scene);
        ck_Trajectory path[3];
        for (int level = 0; level < 3; level++)
            assert_int_equal(
                ck_reference_integrate(&path[level], &fixture.model, cases[i].substeps << level, 0, 0, NULL), CK_OK);
        double coarse = distance->between(&fixture.model, &path[0], &path[1]),
               fine = distance->between(&fixture.model, &path[1], &path[2]);
        assert_near("order", log2(coarse / fine), cases[i].order, cases[i].tolerance);
        for (int level = 0; level < 3; level++) ck_trajectory_free(&path[level]);
        fixture_free_truth(&fixture);
    }
}

// Whatever keeps its steps short, swings, dampers or frames, a first path costs at most half as much again as that of
// the fourth order, which a floor far below asks for: no scene that had a reference is too long for one.
static void test_first_path(void **state) {
    (void)state;
    static const char *const springs[] = {"stiffness: 1.0e+5", "stiffness: 1.0e+5, damping: 1000", "stiffness: 1"};
    for (size_t i = 0; i < sizeof springs / sizeof *springs; i++) {
        double work[2];
        for (int has_floor = 0; has_floor < 2; has_floor++) {
            char text[500];
            Fixture fixture;
            snprintf(text, sizeof text,
                     "name: first\nrope: {particles: 4, spacing: 0.1, mass: 0.04}\nsprings: {%s}\npins: [first]\n"
                     "gravity: [0, -9.81, 0]\n%stime: {duration: 1, fps: 60}\n",
                     springs[i], has_floor ? "colliders: [{plane: {point: [0, -100, 0], normal: [0, 1, 0]}}]\n" : "");
            fixture_load(&fixture, text);
            work[has_floor] = ck_reference_work(&fixture.model);
            fixture_free(&fixture);
        }
        assert_true(work[0] > 0);
        if (!(work[0] <= 1.5 * work[1]))
            fail_msg("%s: %.3g, and %.3g by the fourth order", springs[i], work[0], work[1]);
    }
}

// A rope thrown about is chaotic: its horizon ends before the scene does. A damped one is not.
static void test_horizon(void **state) {
    (void)state;
    fixture_skip_long();
    static const char text[] = "name: wild\nrope: {particles: 20, spacing: 0.1, mass: 1, along: [1, 0.3, 0]}\nsprings: "
                               "{stiffness: 1000}\npins: [first]\nnoise: {amplitude: 0.01, seed: 2}\n"
                               "gravity: [0, -9.81, 0]\ndrag: %g\ntime: {duration: 3, step: 0.02}\ntruth: trajectory\n";
    for (int damped = 0; damped < 2; damped++) {
        char scene[500];
        snprintf(scene, sizeof scene, text, damped ? 8.0 : 0.0);
        TruthFixture fixture;
        fixture_load_truth(&fixture, scene);
        assert_int_equal(ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, NULL), CK_OK);
        int horizon = fixture.truth.reference.horizon;
        if (damped) assert_int_equal(horizon, fixture.model.frame_count);
        if (!damped && (horizon < 20 || horizon >= fixture.model.frame_count)) fail_msg("horizon at frame %d", horizon);
        assert_true(damped == !strstr(fixture.truth.kind, "points to"));
        fixture_free_truth(&fixture);
    }
}

// Beyond the horizon of a path nobody knows where the body is. What is still said of it there holds other paths, of
// nudges that the truth has not seen: nine in ten of them, as an ensemble of eight can promise.
// The sanitizers, which make it ten times as slow, see one start.
#ifdef __SANITIZE_ADDRESS__
#define STARTS 1
#else
#define STARTS 4
#endif

static void test_ensemble(void **state) {
    (void)state;
    fixture_skip_long();
    static const char *const names[] = {"sag", "stretch_max", "stretch_rms"};
    int tries = 0, outside = 0;
    for (int noise = 1; noise <= STARTS; noise++) {
        char scene[500];
        snprintf(scene, sizeof scene,
                 "name: wild\nrope: {particles: 12, spacing: 0.1, mass: 1, along: [1, 0.3, 0]}\nsprings: "
                 "{stiffness: 1000}\npins: [first]\nnoise: {amplitude: 0.01, seed: %d}\n"
                 "gravity: [0, -9.81, 0]\ntime: {duration: 4, step: 0.02}\ntruth: trajectory\n",
                 noise);
        TruthFixture fixture;
        fixture_load_truth(&fixture, scene);
        const ck_Model *model = &fixture.model;
        assert_int_equal(ck_truth_create(&fixture.truth, model, NULL, NULL, NULL), CK_OK);
        assert_true(fixture.truth.reference.horizon < model->frame_count);
        for (uint64_t seed = 100; seed < 106; seed++) {
            ck_Trajectory path;
            assert_int_equal(ck_reference_integrate(&path, model, 200, 1e-9 * model->size, seed, NULL), CK_OK);
            for (int i = 0; i < 3; i++, tries++) {
                const ck_Metric *metric = ck_metric_find(names[i]);
                double off = ck_metric_value(metric, model, &path, &fixture.truth.reference) -
                             ck_metric_truth(metric, model, &fixture.truth.reference);
                outside += !(fabs(off) <= ck_truth_uncertainty(&fixture.truth, model, metric));
            }
            ck_trajectory_free(&path);
        }
        fixture_free_truth(&fixture);
    }
    print_message("%d of %d are outside\n", outside, tries);
    assert_true(tries == 18 * STARTS && outside <= tries / 10);
}

// In a child it is the same to the last bit.
static void test_child(void **state) {
    (void)state;
    const ck_Limits limits = {.seconds = 60};
    TruthFixture fixture;
    ck_Truth here, there;
    fixture_load_truth(&fixture, "name: a\nrope: {particles: 4, spacing: 0.1, mass: 0.4}\nsprings: {stiffness: 50}\n"
                                 "pins: [first]\ngravity: [1, -9.81, 0]\ntime: {duration: 0.3, fps: 60}\n"
                                 "truth: trajectory\n");
    assert_int_equal(ck_truth_create(&here, &fixture.model, NULL, NULL, NULL), CK_OK);
    assert_int_equal(ck_truth_create(&there, &fixture.model, NULL, &limits, NULL), CK_OK);
    assert_int_equal(here.path_count, there.path_count);
    assert_int_equal(here.reference.horizon, there.reference.horizon);
    for (int i = 0; i < here.path_count; i++) {
        assert_int_equal(here.paths[i].frame_count, there.paths[i].frame_count);
        assert_memory_equal(here.paths[i].data, there.paths[i].data, here.paths[i].bytes);
    }
    ck_truth_free(&here);
    ck_truth_free(&there);
    fixture_free_truth(&fixture);
}

// One that takes too long is given up, with a word, and leaves nothing; where that is known before, it is not begun.
static void test_limits(void **state) {
    (void)state;
    static const char *const kinds[] = {"equilibrium", "trajectory"},
                             *const words[] = {"given up: still running after the limit of 0.2 s",
                                               "s; --time-limit is 0.2 s"};
    const ck_Limits less = {.seconds = 0.2};
    for (int i = 0; i < 2; i++) {
        // a gram of cloth and springs of 1e6 N/m, for a second
        char text[400];
        snprintf(text, sizeof text,
                 "name: e\ncloth: {rows: 30, columns: 30, spacing: 0.05, mass: 0.001, down: [0, 0, 1]}\n"
                 "springs: {stiffness: 1.0e+6}\npins: [top_left, top_right]\ngravity: [0, -9.81, 0]\n"
                 "time: {duration: 1, step: 1}\ntruth: %s\n",
                 kinds[i]);
        TruthFixture endless;
        fixture_load_truth(&endless, text);
        const double start = ck_wall();
        assert_int_equal(ck_truth_create(&endless.truth, &endless.model, NULL, &less, NULL), CK_OK);
        // by itself it takes minutes
        assert_true(ck_wall() - start < 30);
        assert_int_equal(endless.truth.path_count, 0);
        if (!strstr(endless.truth.kind, words[i])) fail_msg("%s", endless.truth.kind);
        fixture_free_truth(&endless);
    }
}

// Dampers of a thousand times what is critical do not move a rest; nobody waits for how they get there.
static void assert_same_rest(int side) {
    static const char scene[] = "name: d\ncloth: {rows: %d, columns: %d, spacing: 0.1, mass: %g, down: [0, 0, 1]}\n"
                                "springs: {stiffness: 1000, shear: 500, damping: %g}\npins: [top_left, top_right]\n"
                                "gravity: [0, -9.81, 0]\ndrag: 5\ntime: {duration: 6, fps: 60}\n"
                                "truth: equilibrium\n";
    TruthFixture fixture[2];
    for (int i = 0; i < 2; i++) {
        char text[400];
        ck_Error error = {0};
        snprintf(text, sizeof text, scene, side, side, 0.003 * side * side, i ? 3000.0 : 0.02);
        fixture_load_truth(&fixture[i], text);
        if (ck_truth_create(&fixture[i].truth, &fixture[i].model, NULL, NULL, &error)) fail_msg("%s", error.message);
        assert_true(!i == !strstr(fixture[i].truth.kind, "may not reach in time"));
    }
    const ck_Metric *distance = ck_metric_find("position_rms");
    const double apart = distance->between(&fixture[0].model, &fixture[0].truth.paths[0], &fixture[1].truth.paths[0]);
    assert_near("rests apart", apart, 0, 1e-9);
    for (int i = 0; i < 2; i++) fixture_free_truth(&fixture[i]);
}

// By what following it would take, and of a small body by how short its steps would have to be.
static void test_strong_dampers(void **state) {
    (void)state;
    assert_same_rest(6);
    assert_same_rest(3);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_reference_order), cmocka_unit_test(test_first_path),
                                       cmocka_unit_test(test_horizon),         cmocka_unit_test(test_ensemble),
                                       cmocka_unit_test(test_child),           cmocka_unit_test(test_limits),
                                       cmocka_unit_test(test_strong_dampers)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
