// Values that are known, put into a measurement and found again.
#include "fixture_comparison.h"
#include "fixture_program.h"

#include "fit.h"
#include "statistics.h"

#include <unistd.h>

// A rope of eight let go level, which swings and stretches; of a rest where the truth is one.
static void write_scene(char *text, size_t size, double stiffness, double damping, double drag, const char *truth,
                        const char *more) {
    snprintf(text, size,
             "name: rope\nrope: {particles: 8, spacing: 0.1, mass: 0.4, along: [1, 0, 0]}\nsprings: {stiffness: %.17g, "
             "damping: %.17g}\npins: [first]\ngravity: [0, -9.81, 0]\ndrag: %.17g\ntime: {duration: 0.6, step: 0.02}\n"
             "truth: %s\n%s",
             stiffness, damping, drag, truth, more);
}

static void load_with_truth(ck_Comparison *comparison, const char *text) {
    ck_Error error = {0};
    fixture_load_comparison(comparison, text);
    if (ck_truth_create(&comparison->truth, &comparison->model, NULL, NULL, &error)) fail_msg("%s", error.message);
}

// Every second particle at every third frame, to a millimetre: 1/√12 mm of uncertainty.
static void look_at(ck_FitData *data, const ck_Comparison *comparison) {
    const ck_Trajectory *path = &comparison->truth.paths[0];
    *data =
        (ck_FitData){.points = {.points = calloc(400, sizeof *data->points.points)}, .uncertainty = 1e-3 / sqrt(12)};
    for (int frame = 3; frame < path->frame_count; frame += 3)
        for (int particle = 1; particle < comparison->model.particle_count; particle += 2) {
            ck_RecordedPoint *point = &data->points.points[data->points.point_count++];
            *point = (ck_RecordedPoint){.time = frame * path->step, .particle = particle};
            for (int axis = 0; axis < 3; axis++)
                point->at[axis] = 1e-3 * round(1e3 * ck_trajectory_position(path, frame)[3 * particle + axis]);
        }
}

// Ten scenes of known stiffness, damping and drag: intervals of 95 % hold at least nine of ten values of each.
static void test_known_values(void **state) {
    (void)state;
    fixture_skip_sanitized();
    ck_Random random = ck_random_seed(7);
    int held[CK_FIT_PARAMETERS] = {0};
    for (int scene = 0; scene < 10; scene++) {
        char text[600];
        double known[CK_FIT_PARAMETERS];
        known[CK_FIT_STIFFNESS] = 100 * exp(1.5 * ck_random_unit(&random));
        known[CK_FIT_DAMPING] = 0.5 * exp(1.5 * ck_random_unit(&random));
        known[CK_FIT_DRAG] = 0.5 * exp(1.5 * ck_random_unit(&random));
        write_scene(text, sizeof text, known[0], known[1], known[2], "trajectory", "");
        ck_Comparison real, start;
        load_with_truth(&real, text);
        ck_FitData data;
        look_at(&data, &real);
        write_scene(text, sizeof text, known[0] * 1.6, known[1] * 0.5, known[2] * 1.8, "trajectory", "");
        load_with_truth(&start, text);
        ck_FitOptions options = {.varies = {true, true, true}, .limits = ck_limits_default()};
        ck_Fit fit;
        ck_Error error = {0};
        if (ck_fit_run(&fit, &start, &data, &options, &error)) fail_msg("scene %d: %s", scene, error.message);
        for (int i = 0; i < CK_FIT_PARAMETERS; i++) held[i] += fit.low[i] <= known[i] && known[i] <= fit.high[i];
        assert_near("misfit", fit.misfit, 1, 0.3);
        // a millimetre of some 40 cm on tens of points: a few per cent at most of what moves the rope
        assert_near("stiffness", fit.value[0] / known[0], 1, 0.1);
        ck_recording_free(&data.points);
        ck_comparison_free(&real);
        ck_comparison_free(&start);
    }
    for (int i = 0; i < CK_FIT_PARAMETERS; i++)
        if (held[i] < 9) fail_msg("%s: %d of 10 intervals hold", ck_fit_names[i], held[i]);
}

// One number cannot tell two values apart, and a rest says nothing of drag.
static void test_untold(void **state) {
    (void)state;
    char text[700];
    ck_Comparison comparison;
    write_scene(text, sizeof text, 300, 1, 2, "equilibrium", "measured: {sag: {value: 0.72, uncertainty: 0.001}}\n");
    load_with_truth(&comparison, text);
    ck_FitData none = {.uncertainty = 1};
    ck_FitOptions options = {.varies = {true, false, true}, .limits = ck_limits_default()};
    ck_Fit fit;
    ck_Error error = {0};
    assert_int_equal(ck_fit_run(&fit, &comparison, &none, &options, &error), CK_REFUSED);
    assert_non_null(strstr(error.message, "cannot tell"));
    // the sag alone gives the stiffness: a chain's stretch is sum of weights / k
    options.varies[CK_FIT_DRAG] = false;
    if (ck_fit_run(&fit, &comparison, &none, &options, &error)) fail_msg("%s", error.message);
    double weights = 0, k;
    for (int i = 1; i < 8; i++) weights += i * comparison.model.mass[1] * 9.81;
    k = weights / (0.72 - 0.7);
    assert_near("stiffness by the sag", fit.value[0] / k, 1, 1e-3);
    // σ of the stretch is a twentieth of it, and so is that of k
    assert_near("its interval", log(fit.high[0] / fit.low[0]) / (2 * 1.96 * 0.05), 1, 0.02);
    ck_comparison_free(&comparison);
}

// Files of points with a wrong line are refused with its place; the program finds what was put in.
static void test_program(void **state) {
    (void)state;
    static const struct {
        const char *text, *wanted;
    } bad[] = {{"t,particle,x,y,z\n", ":1: the header has no column time_s"},
               {"time_s,particle,x,y,z\n0.1,1,2,3\n", ":2: 4 columns where the header has 5"},
               {"time_s,particle,x,y,z\n0.1,9,0,0,0\n", ":2: particle is 9; the scene has 0 to 7"},
               {"time_s,particle,x,y,z\n0.7,1,0,0,0\n", ":2: time_s is 0.7; the scene goes from 0 to 0.6 s"}};
    char text[600], arguments[400];
    write_scene(text, sizeof text, 200, 1, 2, "trajectory", "");
    char *scene = fixture_file(text);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char *points = fixture_file(bad[i].text);
        snprintf(arguments, sizeof arguments, "fit %s --vary drag --points %s --out %s/fit", scene, points,
                 fixture_directory);
        assert_int_equal(fixture_program(arguments), 2);
        fixture_assert_output(bad[i].wanted);
        unlink(points);
        free(points);
    }
    snprintf(arguments, sizeof arguments, "fit %s --vary drag --out %s/fit", scene, fixture_directory);
    assert_int_equal(fixture_program(arguments), 2);
    fixture_assert_output("nothing is measured; give --points FILE");
    snprintf(arguments, sizeof arguments, "fit %s --vary mass --out %s/fit", scene, fixture_directory);
    assert_int_equal(fixture_program(arguments), 2);
    unlink(scene);
    free(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_known_values),
        cmocka_unit_test(test_untold),
        cmocka_unit_test(test_program),
    };
    return cmocka_run_group_tests(tests, fixture_make_directory, fixture_remove_directory);
}
