// MuJoCo where it is installed: exact at rest, of its method's order on the way, and near in contact, which it models
// soft.
#include "fixture_truth.h"

static const ck_Engine *mujoco(void) {
    const ck_Engine *engine = ck_engine_find("mujoco");
    if (!engine) skip();
    return engine;
}

static double error_on(const char *scene, const char *metric, const ck_Settings *settings) {
    TruthFixture fixture;
    ck_Trajectory path;
    ck_Error error = {0};
    char file[400];
    snprintf(file, sizeof file, SCENE_DIRECTORY "/%s.yaml", scene);
    if (fixture_open_truth(&fixture, file, &error)) fail_msg("%s", error.message);
    assert_int_equal(ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, NULL), CK_OK);
    fixture_run(&path, &fixture.model, mujoco(), settings, NULL);
    const ck_Metric *measured = ck_metric_find(metric);
    double value = ck_metric_value(measured, &fixture.model, &path, &fixture.truth.reference),
           truth = ck_metric_truth(measured, &fixture.model, &fixture.truth.reference);
    ck_trajectory_free(&path);
    fixture_free_truth(&fixture);
    print_message("%s: %s %.6g, right %.6g\n", scene, metric, value, truth);
    return fabs(value - truth);
}

// A rest knows no step: what drag has left of the motion is all.
static void test_rest(void **state) {
    (void)state;
    assert_near("sag", error_on("rope_hanging", "sag", NULL), 0, 1e-9);
    assert_near("RK4", error_on("rope_hanging", "sag", &(ck_Settings){.own = {2}, .own_set = 1}), 0, 1e-9);
    assert_near("implicit", error_on("rope_hanging", "sag", &(ck_Settings){.own = {1}, .own_set = 1}), 0, 1e-9);
}

// Euler is of first order, RK4 of fourth: halved steps leave a half, and a sixteenth.
static void test_order(void **state) {
    (void)state;
    static const struct { double integrator, factor; } cases[] = {{0, 2}, {2, 16}};
    for (size_t i = 0; i < 2; i++) {
        ck_Settings coarse = {.substeps = 4, .own = {cases[i].integrator}, .own_set = 1}, fine = coarse;
        fine.substeps = 8;
        double ratio = error_on("oscillator", "position_rms", &coarse) / error_on("oscillator", "position_rms", &fine);
        assert_near("ratio", ratio, cases[i].factor, 0.1 * cases[i].factor);
    }
}

// A soft contact lasts some steps and creeps: a few hundredths of restitution, a thousandth of a slide.
static void test_contact(void **state) {
    (void)state;
    assert_near("bounce", error_on("bounce", "restitution", NULL), 0, 0.03);
    assert_near("slide", error_on("slide_0", "friction", NULL), 0, 0.02);
    assert_near("slide", error_on("slide_45", "friction", NULL), 0, 0.02);
    assert_near("sticks", error_on("incline_sticks", "position_rms", NULL), 0, 1e-4);
    assert_near("slips", error_on("incline_slips", "position_rms", NULL), 0, 0.01);
}

// What MuJoCo keeps of a step grows with the square of a cloth in contact, and implicit with its springs: it has room
// for both. The soft contact leaves a cloth on a ball where the hard one does, to a hundredth.
static void test_room(void **state) {
    (void)state;
    static const struct {
        const char *scene;
        double integrator;
        int frames;
    } cases[] = {{"cloth_release", 1, 1}, {"cloth_on_sphere", 0, 0}};
    for (size_t i = 0; i < (fixture_asks_all() ? 2 : 1); i++) {
        Fixture fixture;
        ck_Trajectory path, other;
        ck_Error error = {0};
        char file[400];
        const ck_Settings settings = {.own = {cases[i].integrator}, .own_set = 1};
        snprintf(file, sizeof file, SCENE_DIRECTORY "/%s.yaml", cases[i].scene);
        if (fixture_open(&fixture, file, &error)) fail_msg("%s", error.message);
        if (cases[i].frames) fixture.model.frame_count = cases[i].frames;
        fixture_run(&path, &fixture.model, mujoco(), &settings, NULL);
        fixture_run(&other, &fixture.model, ck_engine_find("native-verlet"), NULL, NULL);
        const ck_Metric *sag = ck_metric_find("sag");
        assert_near(cases[i].scene, ck_metric_value(sag, &fixture.model, &path, NULL),
                    ck_metric_value(sag, &fixture.model, &other, NULL), 0.01);
        ck_trajectory_free(&path);
        ck_trajectory_free(&other);
        fixture_free(&fixture);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rest), cmocka_unit_test(test_order),
                                       cmocka_unit_test(test_contact), cmocka_unit_test(test_room)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
