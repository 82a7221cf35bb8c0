// Springs that only pull, and ropes that are longer than their span.
#include "fixture_truth.h"

#include "springs.h"
#include "vector.h"

// A mass on a tether of length l that falls from l above its pin: stretch at most m·g/k·(1 + √(1 + 4·k·l/(m·g))), and
// free fall before.
static void test_climber(void **state) {
    (void)state;
    static const char *const engines[] = {"native-verlet", "native-xpbd"};
    TruthFixture fixture;
    fixture_load_truth(&fixture, "name: c\nnetwork:\n  nodes: [{at: [0, 0, 0], mass: 1}, {at: [0, 2, 0], mass: 0.7}]\n"
                                 "  springs: [{ends: [0, 1], stiffness: 80, pull_only: true}]\npins: [0]\n"
                                 "gravity: [0, -9.81, 0]\ntime: {duration: 1.5, step: 0.002}\n");
    const double weight = 0.7 * 9.81, most = weight / 80 * (1 + sqrt(1 + 4 * 80 * 2 / weight));
    for (int i = 0; i < 2; i++) {
        const ck_Settings settings = {.substeps = 20};
        ck_Trajectory path;
        double lowest = 0;
        fixture_run(&path, &fixture.model, ck_engine_find(engines[i]), &settings, NULL);
        for (int frame = 0; frame <= fixture.model.frame_count; frame++)
            lowest = fmin(lowest, ck_trajectory_position(&path, frame)[4]);
        // steps of 0.1 ms; XPBD is of the first order: half a step of 9 m/s
        assert_near("stretch", -lowest - 2, most, i ? 1e-3 : 2e-4);
        const double fallen = 2 - ck_trajectory_position(&path, 300)[4];
        assert_near("fall", fallen, 0.5 * 9.81 * 0.36, i ? 1e-3 : 1e-10);
        ck_trajectory_free(&path);
    }
    fixture_free_truth(&fixture);
}

// The reference takes the same way.
static void test_reference(void **state) {
    (void)state;
    TruthFixture fixture;
    ck_Error error = {0};
    ck_Trajectory path;
    fixture_load_truth(&fixture,
                       "name: s\ncloth: {rows: 3, columns: 3, spacing: 0.1, mass: 0.02, down: [0, 0, 1]}\n"
                       "springs: {stiffness: 60, shear: 30, damping: 0.01, pull_only: true}\npins: [top_edge]\n"
                       "gravity: [0, -9.81, 0]\ntime: {duration: 0.1, fps: 100}\ntruth: trajectory\n");
    if (ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, &error)) fail_msg("%s", error.message);
    const ck_Settings settings = {.substeps = 100};
    fixture_run(&path, &fixture.model, ck_engine_find("native-verlet"), &settings, NULL);
    const double off = ck_metric_value(ck_metric_find("position_rms"), &fixture.model, &path, &fixture.truth.reference);
    print_message("off by %.2e, truth known to %.2e\n", off,
                  ck_truth_uncertainty(&fixture.truth, &fixture.model, ck_metric_find("position_rms")));
    assert_true(fixture.truth.path_count > 0 && off < 1e-4);
    ck_trajectory_free(&path);
    fixture_free_truth(&fixture);
}

// A rope of 1.2 times its span hangs as a catenary, whether its springs push or not.
static void test_length(void **state) {
    (void)state;
    for (int pulls = 0; pulls < 2; pulls++) {
        TruthFixture fixture;
        ck_Error error = {0};
        ck_Trajectory path;
        char text[400];
        snprintf(text, sizeof text,
                 "name: l\nrope: {particles: 11, spacing: 0.1, mass: 0.1, length: 1.2, along: [1, 0, 0]}\n"
                 "springs: {stiffness: 500, damping: 0.05%s}\npins: [first, last]\nnoise: {amplitude: 0.001, seed: 1}\n"
                 "gravity: [0, -9.81, 0]\ndrag: 6\ntime: {duration: 4, fps: 60}\ntruth: catenary\n",
                 pulls ? ", pull_only: true" : "");
        fixture_load_truth(&fixture, text);
        assert_near("size", fixture.model.size, 1.2, 1e-15);
        if (ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, &error)) fail_msg("%s", error.message);
        fixture_run(&path, &fixture.model, ck_engine_find("native-verlet"), NULL, NULL);
        const double off =
            ck_metric_value(ck_metric_find("position_rms"), &fixture.model, &path, &fixture.truth.reference);
        assert_true(off < 1e-6); // what is left of the motion after 4 s of a drag of 6
        ck_trajectory_free(&path);
        fixture_free_truth(&fixture);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_climber), cmocka_unit_test(test_reference),
                                       cmocka_unit_test(test_length)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
