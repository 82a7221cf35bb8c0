// Native engines in single precision, from an origin that moves with the cloth.
#include "fixture.h"

#include "engines.h"
#include "trajectory.h"
#include "vector.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const engines[] = {"native-verlet", "native-bars", "native-xpbd", "native-lines"};
// Of a frame: stable, and of bars so long that what their lengths of 0.1 m are rounded by, 6e-9 m, is less than a
// hundredth of gravity's push in one, 2.5e-6 m: it pushes them, too. Springs give way to it.
static const uint32_t steps[] = {50, 40, 160, 160};
// m: rounding of places and ways, at random, over as many substeps and their sweeps.
static const double within[] = {1e-5, 1e-4, 1e-5, 1e-5};

// Settings of so many substeps in single precision, or in double, with vectors of so many doubles at most.
static ck_Settings settings_of(uint32_t substeps, bool is_single, int vectors) {
    ck_Settings settings = {.substeps = substeps, .iterations = 4};
    if (vectors) ck_settings_set(&settings, CK_OWN, vectors);
    if (is_single) ck_settings_set(&settings, CK_OWN + 2, 1);
    return settings;
}

static void run(ck_Trajectory *trajectory, const char *text, const char *engine, const ck_Settings *settings) {
    Fixture fixture;
    fixture_load(&fixture, text);
    fixture_run(trajectory, &fixture.model, ck_engine_find(engine), settings, NULL);
    fixture_free(&fixture);
}

// The largest distance of a coordinate of two paths, the second less an offset.
static double apart(const ck_Trajectory *a, const ck_Trajectory *b, const double offset[3]) {
    double most = 0;
    assert_int_equal(a->frame_count, b->frame_count);
    for (int frame = 0; frame < a->frame_count; frame++)
        for (int i = 0; i < 3 * a->particle_count; i++)
            most = fmax(
                most, fabs(ck_trajectory_position(a, frame)[i] + offset[i % 3] - ck_trajectory_position(b, frame)[i]));
    return most;
}

static const double nowhere[3];

static void write_scene(char text[600], const char *place, const char *more, int columns) {
    snprintf(text, 600,
             "name: single\ncloth: {rows: 12, columns: %d, spacing: 0.1, mass: 0.3%s, down: [0, 0, 1]}\n"
             "springs: {stiffness: 300, shear: 150}\n%sgravity: [0, -9.81, 0]\ndrag: 1\n"
             "time: {duration: 0.2, step: 0.02}\n",
             columns, place, more);
}

// A cloth of 1 m hung by two corners ends within 1e-5 of where it does in double precision, of bars within 1e-4: 400 to
// 1600 substeps and their sweeps round places of 1 m by 6e-8 each, at random; a sheet of bars grows them, as it does
// any nudge. A kilometre away the same, to what doubles say of places there.
static void test_precision(void **state) {
    (void)state;
    fixture_skip_sanitized();
    static const double far[3] = {1000, 0, -1000};
    static const char hung[] = "pins: [top_left, top_right]\nnoise: {amplitude: 1e-3, seed: 3}\n";
    for (int columns = 8; columns < 40; columns += 8)
        for (size_t i = 0; i < sizeof engines / sizeof *engines; i++) {
            // wider rows are dealt out otherwise, and so is the order of a sweep
            if (i > 0 && columns > 16) continue;
            char text[600], away[600];
            ck_Trajectory fine, path, moved;
            const ck_Settings wide = settings_of(steps[i], false, 0), narrow = settings_of(steps[i], true, 0);
            write_scene(text, "", hung, columns);
            write_scene(away, ", origin: [1000, 0, -1000]", hung, columns);
            run(&fine, text, engines[i], &wide);
            run(&path, text, engines[i], &narrow);
            run(&moved, away, engines[i], &narrow);
            assert_near(engines[i], apart(&fine, &path, nowhere), 0, within[i]);
            if (!(apart(&fine, &path, nowhere) > 0)) fail_msg("%s: not in single precision", engines[i]);
            assert_near(engines[i], apart(&path, &moved, far), 0, within[i]);
            ck_trajectory_free(&fine);
            ck_trajectory_free(&path);
            ck_trajectory_free(&moved);
        }
}

// Thrown at 200 m/s, it goes 40 m, and its shape is as well known as at rest.
static void test_flight(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof engines / sizeof *engines; i++) {
        char text[600];
        ck_Trajectory fine, path;
        const ck_Settings wide = settings_of(steps[i], false, 0), narrow = settings_of(steps[i], true, 0);
        write_scene(text, "", "velocity: [200, 0, 30]\nnoise: {amplitude: 1e-3, seed: 3}\n", 12);
        run(&fine, text, engines[i], &wide);
        run(&path, text, engines[i], &narrow);
        const int last = fine.frame_count - 1;
        const double *a = ck_trajectory_position(&fine, last), *b = ck_trajectory_position(&path, last);
        assert_true(a[0] > 30);
        // drag's factor of a substep is rounded by up to 3e-8, and there are up to 500: of 40 m half of 1.5e-5
        assert_near(engines[i], b[0] - a[0], 0, 1e-3);
        for (int k = 3; k < 3 * fine.particle_count; k++)
            assert_near(engines[i], (b[k] - b[k % 3]) - (a[k] - a[k % 3]), 0, 1e-4);
        ck_trajectory_free(&fine);
        ck_trajectory_free(&path);
    }
}

// The same bits by all vectors that fuse, and by any number of threads.
static void test_bits(void **state) {
    (void)state;
    fixture_skip_sanitized();
    for (size_t i = 0; i < sizeof engines / sizeof *engines; i++) {
        char text[600];
        ck_Trajectory wide, narrow, shared;
        write_scene(text, "", "pins: [top_left, top_right]\n", 80);
        ck_Settings settings = settings_of(steps[i], true, 0);
        run(&wide, text, engines[i], &settings);
        settings.threads = 3;
        run(&shared, text, engines[i], &settings);
        settings = settings_of(steps[i], true, 4);
        run(&narrow, text, engines[i], &settings);
        assert_near(engines[i], apart(&wide, &shared, nowhere), 0, 0);
        assert_near(engines[i], apart(&wide, &narrow, nowhere), 0, 0);
        ck_trajectory_free(&wide);
        ck_trajectory_free(&narrow);
        ck_trajectory_free(&shared);
    }
}

// A corner that is let go after half of the time: lines go on from what they pulled, damped, a sweep a substep.
static void test_let_go(void **state) {
    (void)state;
    char text[600];
    ck_Trajectory fine, path;
    ck_Settings wide = settings_of(steps[3], false, 0), narrow = settings_of(steps[3], true, 0);
    wide.iterations = narrow.iterations = 1;
    write_scene(text, ", origin: [30, 0, 0]",
                "pins: [top_left, top_right]\nrelease: [{at: 0.1, pins: [top_right]}]\n"
                "noise: {amplitude: 1e-3, seed: 3}\n",
                12);
    char *springs = strstr(text, "shear: 150}");
    memcpy(springs, "damping: 2}", 11);
    run(&fine, text, "native-lines", &wide);
    run(&path, text, "native-lines", &narrow);
    assert_near("native-lines", apart(&fine, &path, nowhere), 0, 1e-4);
    assert_true(apart(&fine, &path, nowhere) > 0);
    ck_trajectory_free(&fine);
    ck_trajectory_free(&path);
}

// Refused, with a word of what would do, where a body is no regular cloth or touches something.
static void test_refusals(void **state) {
    (void)state;
    static const char *const scenes[] = {
        "name: rope\nrope: {particles: 5, spacing: 0.1, mass: 1}\nsprings: {stiffness: 100}\npins: [first]\n"
        "time: {duration: 1, step: 0.1}\n",
        "name: floor\ncloth: {rows: 5, columns: 5, spacing: 0.1, mass: 1}\nsprings: {stiffness: 100}\n"
        "colliders: [{plane: {point: [0, -1, 0], normal: [0, 1, 0]}}]\ntime: {duration: 1, step: 0.1}\n"};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++)
        for (size_t k = 0; k < sizeof engines / sizeof *engines; k++) {
            Fixture fixture;
            ck_Error error;
            ck_Settings used;
            void *created;
            const ck_Settings settings = settings_of(steps[k], true, 0);
            fixture_load(&fixture, scenes[i]);
            assert_int_equal(
                ck_engine_create(ck_engine_find(engines[k]), &created, &fixture.model, &settings, &used, NULL, &error),
                CK_REFUSED);
            assert_non_null(strstr(error.message, "regular cloths that touch nothing"));
            fixture_free(&fixture);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_precision), cmocka_unit_test(test_flight),
                                       cmocka_unit_test(test_bits), cmocka_unit_test(test_let_go),
                                       cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
