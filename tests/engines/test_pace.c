// Steps that adapt to a tolerance.
#include "fixture.h"

#include "engines.h"
#include "vector.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char swing[] = "name: swing\nrope: {particles: 2, spacing: 1, mass: 2, along: [1, 0, 0]}\n"
                            "springs: {stiffness: 100%s}\npins: [first]\nvelocity: [1, 0, 0]\n%s"
                            "time: {duration: 2, step: 0.5}\n";

static void run(ck_Trajectory *trajectory, const char *text, double tolerance, const ck_Settings *more) {
    Fixture fixture;
    ck_Settings settings = *more;
    if (tolerance > 0) ck_settings_set(&settings, CK_OWN + 1, tolerance);
    fixture_load(&fixture, text);
    fixture_run(trajectory, &fixture.model, ck_engine_find("native-verlet"), &settings, NULL);
    fixture_free(&fixture);
}

// How far apart, rms, m, two runs are over their frames.
static double apart(const ck_Trajectory *a, const ck_Trajectory *b) {
    const int count = 3 * a->particle_count;
    double sum = 0;
    assert_int_equal(a->frame_count, b->frame_count);
    for (int frame = 0; frame < a->frame_count; frame++)
        for (int i = 0; i < count; i++) {
            const double off = ck_trajectory_position(a, frame)[i] - ck_trajectory_position(b, frame)[i];
            sum += off * off;
        }
    return sqrt(sum * 3 / count / a->frame_count);
}

// The error goes with the tolerance, and is within what it allows in two seconds: it is what a second's substeps make.
// As steps are not quite as the square root of it, an order is not quite one. In the kernel, and where a pin is moved,
// which native steps itself.
static void test_order(void **state) {
    (void)state;
    static const char *const kinds[][2] = {
        {"", ""},
        {", damping: 0.5", "drag: 0.5\n"},
        {"", "moves: [{pins: [first], path: {amplitude: [0.1, 0, 0], frequency: 0.5}}]\n"}};
    for (size_t kind = 0; kind < sizeof kinds / sizeof *kinds; kind++) {
        char text[400];
        double errors[3];
        ck_Trajectory fine, path;
        snprintf(text, sizeof text, swing, kinds[kind][0], kinds[kind][1]);
        run(&fine, text, 0, &(ck_Settings){.substeps = 100000});
        for (int i = 0; i < 3; i++) {
            run(&path, text, pow(10, -2 - i), &(ck_Settings){0});
            errors[i] = apart(&fine, &path);
            ck_trajectory_free(&path);
        }
        for (int i = 1; i < 3; i++) assert_near(text, log10(errors[i - 1] / errors[i]), 1, 0.3);
        for (int i = 0; i < 3; i++)
            if (errors[i] > 2 * pow(10, -2 - i))
                fail_msg("%s: a tolerance of 1e%d makes %g m", text, -2 - i, errors[i]);
        ck_trajectory_free(&fine);
    }
}

// Cloths in rows and as a list, with and without contact and air, with a tolerance that never holds them up: they take
// steps as long as are stable, and end where small ones do.
static void test_rest(void **state) {
    (void)state;
    fixture_skip_long();
    static const char *const kinds[] = {
        "", "force: [0, 0.01, 0]\ncolliders: [{plane: {point: [0, -3, 0], normal: [0, 1, 0]}}]\n",
        "wind: {velocity: [0.5, 0, 0.2], drag: 1.2}\n"};
    for (size_t kind = 0; kind < sizeof kinds / sizeof *kinds; kind++)
        for (int cuts = 0; cuts < 2; cuts++) {
            char text[600];
            ck_Trajectory fine, path;
            snprintf(text, sizeof text,
                     "name: hung\ncloth: {rows: 6, columns: 6, spacing: 0.1, mass: 0.1, down: [0, -1, 0]}\n"
                     "springs: {stiffness: 300, damping: 0.05, shear: 150%s}\npins: [0:0, 0:5]\n%s"
                     "gravity: [0, -9.81, 0]\ndrag: 5\ntime: {duration: 6, step: 0.05}\n",
                     cuts ? ", bend: 1" : "", kinds[kind]);
            run(&fine, text, 0, &(ck_Settings){.substeps = 1000});
            run(&path, text, 1, &(ck_Settings){0});
            const size_t bytes = 3 * sizeof(double) * (size_t)path.particle_count;
            const double *a = ck_trajectory_position(&fine, fine.frame_count - 1),
                         *b = ck_trajectory_position(&path, path.frame_count - 1);
            double most = 0;
            for (size_t i = 0; i < bytes / sizeof *a; i++) most = fmax(most, fabs(a[i] - b[i]));
            // exp(−5·6/2) of a swing of some 0.1 m is left: 3e-8
            assert_near(text, most, 0, 1e-7);
            ck_trajectory_free(&fine);
            ck_trajectory_free(&path);
        }
}

// The same bits with any number of threads and any vectors that fuse: what decides is summed in one order.
static void test_bits(void **state) {
    (void)state;
    static const char text[] = "name: bits\ncloth: {rows: 40, columns: 24, spacing: 0.05, mass: 0.3, down: [0, 0, 1]}\n"
                               "springs: {stiffness: 500, damping: 0.02, shear: 250}\npins: [0:0, 0:23]\n"
                               "gravity: [0, -9.81, 0]\ndrag: 1\ntime: {duration: 0.5, step: 0.05}\n";
    ck_Trajectory one, other;
    run(&one, text, 1e-3, &(ck_Settings){0});
    run(&other, text, 1e-3, &(ck_Settings){.threads = 3});
    assert_memory_equal(ck_trajectory_position(&one, 10), ck_trajectory_position(&other, 10),
                        3 * sizeof(double) * (size_t)one.particle_count);
    ck_trajectory_free(&one);
    ck_trajectory_free(&other);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_order), cmocka_unit_test(test_rest),
                                       cmocka_unit_test(test_bits)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
