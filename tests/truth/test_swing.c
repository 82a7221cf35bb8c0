// Closed forms of swinging against the reference integrator, which knows nothing of them.
#include "fixture_truth.h"

#include "runge_kutta.h"
#include "vector.h"

// The largest distance of the truth from the reference over all frames, m.
static double off_of(const char *text) {
    TruthFixture fixture;
    ck_Error error = {0};
    ck_ReferencePath path;
    double largest = 0;
    fixture_load_truth(&fixture, text);
    if (ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, &error)) fail_msg("%s", error.message);
    if (ck_reference_path_create(&path, &fixture.model, &error)) fail_msg("%s", error.message);
    for (int frame = 0; frame <= fixture.model.frame_count; frame++)
        largest = fmax(largest, ck_distance(ck_trajectory_position(&fixture.truth.paths[0], frame) + 3,
                                            ck_trajectory_position(&path.fine, frame) + 3));
    ck_reference_path_free(&path);
    fixture_free_truth(&fixture);
    return largest;
}

// A circle of 0.3 m, 0.4 m below its pin: 0.5 m of spring, of which m·g·l/(h·k) is stretch.
static void test_conical(void **state) {
    (void)state;
    char text[500];
    const double stretch = 0.2 * 9.81 * 0.5 / 0.4 / 300;
    snprintf(text, sizeof text,
             "name: c\nnetwork:\n  nodes: [{at: [0, 0, 0], mass: 1}, {at: [0.3, -0.4, 0], mass: 0.2, velocity: [0, 0, "
             "%.17g]}]\n  springs: [{ends: [0, 1], stiffness: 300, rest: %.17g}]\npins: [0]\ngravity: [0, -9.81, 0]\n"
             "time: {duration: 3, fps: 60}\ntruth: conical_pendulum\n",
             0.3 * sqrt(9.81 / 0.4), 0.5 - stretch);
    // the reference agrees with itself to 1e-9 of its size
    assert_near("circle", off_of(text), 0, 2e-9);
}

static double plucked_off(double amplitude) {
    char text[500];
    // four periods of 7.4163·L·√(m/k)/A
    snprintf(
        text, sizeof text,
        "name: p\nnetwork:\n  nodes: [{at: [0, 0, 0], mass: 1}, {at: [1, %.17g, 0], mass: 0.25}, {at: [2, 0, 0], "
        "mass: 1}]\n  springs: [{ends: [0, 1], stiffness: 100, rest: 1}, {ends: [1, 2], stiffness: 100, rest: 1}]\n"
        "pins: [0, 2]\ntime: {duration: %.17g, fps: %.17g}\ntruth: plucked_mass\n",
        amplitude, 4 * 7.4162987 * 0.05 / amplitude, 100 / (4 * 7.4162987 * 0.05 / amplitude));
    return off_of(text) / amplitude;
}

// What the form leaves out is of the square of A/L, in the period too, and so fourth of it at half the amplitude.
static void test_plucked(void **state) {
    (void)state;
    const double wide = plucked_off(0.04), narrow = plucked_off(0.02);
    print_message("off by %.2e and %.2e of the amplitude\n", wide, narrow);
    assert_near("order", log2(wide / narrow), 2, 0.1);
    assert_true(narrow < 1e-2);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_conical), cmocka_unit_test(test_plucked)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
