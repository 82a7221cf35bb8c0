// bullet-stock is what an independent program gets of Bullet: its figures, to the digits that were printed.
#include "fixture.h"

static double sag_of(const char *text, uint32_t substeps, uint32_t iterations, double share, double over) {
    Fixture fixture;
    ck_Trajectory path;
    const ck_Settings settings = {.substeps = substeps, .iterations = iterations, .softness = share};
    fixture_load(&fixture, text);
    fixture_run(&path, &fixture.model, ck_engine_find("bullet-stock"), &settings, NULL);
    const double *position = ck_trajectory_position(&path, fixture.model.frame_count);
    double lowest = INFINITY;
    for (int i = 0; i < fixture.model.particle_count; i++) lowest = fmin(lowest, position[3 * i + 1]);
    ck_trajectory_free(&path);
    fixture_free(&fixture);
    return -lowest / over;
}

// A weight of a thousand nodes on twenty, of 1.9 m, at 60 Hz with one step a frame.
static void test_heavy_end(void **state) {
    (void)state;
    static const char scene[] =
        "name: h\nrope: {particles: 20, spacing: 0.1, mass: 0.2, end_mass: 10}\nsprings: {rigid: "
        "true}\npins: [first]\ngravity: [0, -9.81, 0]\ndrag: 1\ntime: {duration: 10, fps: 60}\n";
    assert_near("1 iteration", sag_of(scene, 1, 1, 0, 1.9), 23.657, 5e-4);
    assert_near("10 iterations", sag_of(scene, 1, 10, 0, 1.9), 2.958, 5e-4);
    assert_near("100 iterations", sag_of(scene, 1, 100, 0, 1.9), 1.19293, 5e-6);
}

// Bullet's own rope demo: 18 nodes of 20 kg in all over 20 m, four iterations, for some of its stiffnesses.
static void test_rope_demo(void **state) {
    (void)state;
    static const struct {
        double share, sag;
    } ropes[] = {{0.1, 0.2053}, {0.1 + 0.9 * 4 / 14, 0.1270}, {0.1 + 0.9 * 8 / 14, 0.0997}, {1, 0.0756}};
    char scene[4000];
    size_t used = (size_t)snprintf(scene, sizeof scene,
                                   "name: d\nsprings: {rigid: true}\npins: [first, last]\ngravity: "
                                   "[0, -10, 0]\ntime: {duration: 60, fps: 60}\nnetwork:\n  bars: [");
    for (int i = 0; i < 17; i++)
        used += (size_t)snprintf(scene + used, sizeof scene - used, "%s[%d, %d]", i ? ", " : "", i, i + 1);
    used += (size_t)snprintf(scene + used, sizeof scene - used, "]\n  nodes: [");
    for (int i = 0; i < 18; i++)
        used += (size_t)snprintf(scene + used, sizeof scene - used, "%s{at: [%.17g, 0, 0], mass: 1.25}", i ? ", " : "",
                                 -10 + 20 * i / 17.0);
    snprintf(scene + used, sizeof scene - used, "]\n");
    for (size_t i = 0; i < sizeof ropes / sizeof *ropes; i++)
        assert_near("sag", sag_of(scene, 1, 4, ropes[i].share, 20), ropes[i].sag, 6e-5);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_heavy_end), cmocka_unit_test(test_rope_demo)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
