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

static void write_scene(char text[700], const char *place, const char *more, int columns) {
    snprintf(text, 700,
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
            char text[700], away[700];
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
        char text[700];
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

// The same bits by all vectors that fuse, and by any number of threads: hung, and with a ball in its way.
static void test_bits(void **state) {
    (void)state;
    fixture_skip_sanitized();
    static const char *const more[] = {
        "pins: [top_left, top_right]\n",
        "pins: [top_left, top_right]\ncolliders: [{sphere: {center: [3, -0.6, 0.6], radius: 0.5, friction: 0.3}}]\n"};
    for (size_t i = 0; i < sizeof engines / sizeof *engines; i++)
        for (size_t k = 0; k < sizeof more / sizeof *more; k++) {
            char text[700];
            ck_Trajectory wide, narrow, shared;
            write_scene(text, "", more[k], 80);
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
    char text[700];
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

// What a cloth falls on: with friction, so that it holds or slides, and restitution; what has edges; several at once.
// As a scene has it, with the places of two points to the right, m.
typedef struct Touched {
    const char *colliders;
    double right[2];
} Touched;

static const Touched touched[] = {
    {"{plane: {point: [%.17g, -0.02, -70], normal: [0, 1, 0], friction: 0.4}}", {50}},
    {"{plane: {point: [%.17g, -0.03, 0], normal: [0.6, 0.8, 0], friction: 0.5, restitution: 0.3}}", {0}},
    {"{sphere: {center: [%.17g, -0.52, 0.6], radius: 0.5, friction: 0.6}}", {0.4}},
    {"{box: {center: [%.17g, -0.15, 0.6], size: [0.6, 0.26, 0.4], rounding: 0.03, friction: 0.3}}", {0.4}},
    {"{box: {center: [%.17g, -0.13, 0.6], size: [0.6, 0.2, 0.4], along: [1, 0.1, 0.3], friction: 0.3}}", {0.4}},
    {"{cylinder: {point: [%.17g, -0.12, 900], axis: [0, 0, 1], radius: 0.1, friction: 0.5}}", {0.4}},
    {"{capsule: {from: [%.17g, -0.12, 0.5], to: [%.17g, -0.12, 0.7], radius: 0.1, friction: 0.5}}", {0.1, 0.8}},
    {"{plane: {point: [%.17g, -0.34, 0], normal: [0.6, 0.8, 0]}}, "
     "{plane: {point: [%.17g, -0.34, 0], normal: [-0.6, 0.8, 0]}}",
     {0.4, 0.4}},
};

static void write_touching(char text[700], const Touched *what, double right, double noise) {
    char colliders[300], more[400], place[40];
    snprintf(colliders, sizeof colliders, what->colliders, what->right[0] + right, what->right[1] + right);
    snprintf(more, sizeof more, "noise: {amplitude: %.9g, seed: 3}\ncolliders: [%s]\n", noise, colliders);
    snprintf(place, sizeof place, ", origin: [%g, 0, 0]", right);
    write_scene(text, place, more, 9);
}

// In contact a cloth is within what it is without, and what a nudge of 1 µm, some ten roundings of 6e-8 m, makes of it
// in double precision: what is near is worked out in that. All begin to touch by 0.1 s and touch for the rest of 0.2 s.
static void test_contact(void **state) {
    (void)state;
    fixture_skip_sanitized();
    for (size_t k = 0; k < sizeof touched / sizeof *touched; k++)
        for (size_t i = 0; i < sizeof engines / sizeof *engines; i++) {
            char text[700], away[700], beside[700];
            ck_Trajectory fine, path, moved, nudged;
            const ck_Settings wide = settings_of(steps[i], false, 0), narrow = settings_of(steps[i], true, 0);
            write_touching(text, &touched[k], 0, 1e-4);
            write_touching(away, &touched[k], 1000, 1e-4);
            write_touching(beside, &touched[k], 0, 1e-4 + 1e-6);
            run(&fine, text, engines[i], &wide);
            run(&nudged, beside, engines[i], &wide);
            run(&path, text, engines[i], &narrow);
            run(&moved, away, engines[i], &narrow);
            const double most = within[i] + apart(&fine, &nudged, nowhere);
            assert_near(engines[i], apart(&fine, &path, nowhere), 0, most);
            assert_near(engines[i], apart(&path, &moved, (const double[]){1000, 0, 0}), 0, most);
            assert_true(apart(&fine, &path, nowhere) > 0);
            ck_trajectory_free(&fine);
            ck_trajectory_free(&path);
            ck_trajectory_free(&moved);
            ck_trajectory_free(&nudged);
        }
}

// A corner that is let go above a ball, of which the cloth touches some.
static void test_let_go_in_contact(void **state) {
    (void)state;
    fixture_skip_sanitized();
    for (size_t i = 0; i < sizeof engines / sizeof *engines; i++) {
        char text[700];
        ck_Trajectory fine, path;
        const ck_Settings wide = settings_of(steps[i], false, 0), narrow = settings_of(steps[i], true, 0);
        write_scene(text, ", origin: [30, 0, 0]",
                    "pins: [top_left, top_right]\nrelease: [{at: 0.1, pins: [top_right]}]\n"
                    "noise: {amplitude: 1e-4, seed: 3}\n"
                    "colliders: [{sphere: {center: [30.4, -0.52, 0.6], radius: 0.5, friction: 0.3}}]\n",
                    9);
        run(&fine, text, engines[i], &wide);
        run(&path, text, engines[i], &narrow);
        // as test_contact, of a nudge that a ball makes a hundred times as large
        assert_near(engines[i], apart(&fine, &path, nowhere), 0, 10 * within[i]);
        ck_trajectory_free(&fine);
        ck_trajectory_free(&path);
    }
}

// Slides 20 m over a floor without friction, its origin after it: it neither sinks in nor leaves it.
static void test_slide(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof engines / sizeof *engines; i++) {
        char text[700];
        ck_Trajectory path;
        const ck_Settings narrow = settings_of(steps[i], true, 0);
        write_scene(text, "", "velocity: [100, 0, 30]\ncolliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0]}}]\n",
                    9);
        run(&path, text, engines[i], &narrow);
        const double *x = ck_trajectory_position(&path, path.frame_count - 1);
        assert_true(x[0] > 15);
        // places of 2 m, which it may be from its origin, are told to 1.2e-7 m
        for (int k = 1; k < 3 * path.particle_count; k += 3) assert_near(engines[i], x[k], 0, 2e-7);
        ck_trajectory_free(&path);
    }
}

// How far a cloth that slides 200 m over a floor ends from where it does in double precision, m, in so many frames.
static double slide_far(int frames) {
    char text[700], step[20];
    ck_Trajectory fine, path;
    const uint32_t substeps = 10 * steps[0] / (uint32_t)frames;
    const ck_Settings wide = settings_of(substeps, false, 0), narrow = settings_of(substeps, true, 0);
    write_scene(text, "",
                "velocity: [1000, 0, 300]\nnoise: {amplitude: 1e-3, seed: 3}\n"
                "colliders: [{plane: {point: [0, -0.002, 0], normal: [0, 1, 0], friction: 0.1}}]\n",
                9);
    snprintf(step, sizeof step, "step: %.2f}\n", 0.2 / frames);
    memcpy(strstr(text, "step: "), step, strlen(step));
    run(&fine, text, engines[0], &wide);
    run(&path, text, engines[0], &narrow);
    double off = 0;
    const int last = path.frame_count - 1;
    for (int k = 0; k < 3 * path.particle_count; k++)
        off = fmax(
            off, fabs(ck_trajectory_position(&fine, fine.frame_count - 1)[k] - ck_trajectory_position(&path, last)[k]));
    ck_trajectory_free(&fine);
    ck_trajectory_free(&path);
    return off;
}

// The origin follows within a frame, too. Places of 2 m, which it may be from there, are told to 1.2e-7 m, and 500
// substeps add that up at random, to 2.7e-6 m, of which twice is allowed; those of 200 m are told to 1.5e-5 m.
static void test_long_frame(void **state) {
    (void)state;
    for (int frames = 1; frames <= 10; frames += 9) {
        const double off = slide_far(frames);
        assert_near("slide", off, 0, 5.4e-6);
        assert_true(off > 0);
    }
}

// A cloth that leans on a slope, within what friction holds, stays where it is to what places of 2 m are told in: 4 s
// of rounding at every substep do not let it creep.
static void test_rest(void **state) {
    (void)state;
    fixture_skip_sanitized();
    for (size_t i = 0; i < sizeof engines / sizeof *engines; i++) {
        char text[700];
        ck_Trajectory path;
        const ck_Settings narrow = settings_of(steps[i], true, 0);
        write_scene(text, ", across: [0.8, 0.6, 0]",
                    "colliders: [{plane: {point: [0, 0, 0], normal: [-0.6, 0.8, 0], friction: 0.9}}]\n", 9);
        memcpy(strstr(text, "0.2, step"), "4.0, step", strlen("4.0, step"));
        run(&path, text, engines[i], &narrow);
        const double *from = ck_trajectory_position(&path, 0), *x = ck_trajectory_position(&path, path.frame_count - 1);
        for (int k = 0; k < 3 * path.particle_count; k++) assert_near(engines[i], x[k], from[k], 2e-7);
        ck_trajectory_free(&path);
    }
}

// A ball that comes up from below, which native-verlet alone takes in single precision.
static void test_moving_collider(void **state) {
    (void)state;
    char text[700];
    ck_Trajectory fine, path;
    const ck_Settings wide = settings_of(steps[0], false, 0), narrow = settings_of(steps[0], true, 0);
    write_scene(text, "",
                "noise: {amplitude: 1e-4, seed: 3}\ncolliders: [{sphere: {center: [0.4, -0.6, 0.6], radius: 0.4, "
                "friction: 0.3}, path: {velocity: [0, 1, 0]}}]\n",
                9);
    run(&fine, text, engines[0], &wide);
    run(&path, text, engines[0], &narrow);
    assert_near(engines[0], apart(&fine, &path, nowhere), 0, 1e-5);
    assert_true(apart(&fine, &path, nowhere) > 0);
    ck_trajectory_free(&fine);
    ck_trajectory_free(&path);
}

// Refused, with a word of what would do, where a body is no regular cloth, or touches what moves.
static void test_refusals(void **state) {
    (void)state;
    static const char *const scenes[] = {
        "name: rope\nrope: {particles: 5, spacing: 0.1, mass: 1}\nsprings: {stiffness: 100}\npins: [first]\n"
        "time: {duration: 1, step: 0.1}\n",
        "name: floor\ncloth: {rows: 5, columns: 5, spacing: 0.1, mass: 1}\nsprings: {stiffness: 100}\n"
        "colliders: [{plane: {point: [0, -1, 0], normal: [0, 1, 0]}, path: {velocity: [0, 1, 0]}}]\n"
        "time: {duration: 1, step: 0.1}\n"};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++)
        for (size_t k = i; k < sizeof engines / sizeof *engines; k++) {
            Fixture fixture;
            ck_Error error;
            ck_Settings used;
            void *created;
            const ck_Settings settings = settings_of(steps[k], true, 0);
            fixture_load(&fixture, scenes[i]);
            assert_int_equal(
                ck_engine_create(ck_engine_find(engines[k]), &created, &fixture.model, &settings, &used, NULL, &error),
                CK_REFUSED);
            assert_non_null(strstr(error.message, "is for regular cloths"));
            fixture_free(&fixture);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_precision), cmocka_unit_test(test_flight),    cmocka_unit_test(test_bits),
        cmocka_unit_test(test_let_go),    cmocka_unit_test(test_contact),   cmocka_unit_test(test_let_go_in_contact),
        cmocka_unit_test(test_slide),     cmocka_unit_test(test_rest),      cmocka_unit_test(test_moving_collider),
        cmocka_unit_test(test_refusals),  cmocka_unit_test(test_long_frame)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
