// Scenes that start at rest, and what is let go from there.
#include "fixture_truth.h"

#include "runge_kutta.h"
#include "start.h"
#include "vector.h"

#include <unistd.h>

static void load(Fixture *fixture, const char *text, ck_Status wanted, const char *says) {
    ck_Error error = {0};
    char *path = fixture_file(text);
    *fixture = (Fixture){0};
    assert_int_equal(ck_scene_load(&fixture->scene, path, &error), CK_OK);
    ck_Status status = ck_start_build(&fixture->model, &fixture->scene, &error);
    if (status != wanted || (says && !strstr(error.message, says)))
        fail_msg("status %d, \"%s\"; wanted %d and \"%s\"", status, error.message, wanted, says ? says : "");
    unlink(path);
    free(path);
}

static const char slinky[] = "name: s\nrope: {particles: 21, spacing: 0.05, mass: 0.42}\nsprings: {stiffness: %g}\n"
                             "pins: [first]\nstart: equilibrium\ngravity: [0, -9.81, 0]\n"
                             "release: [{at: 0, pins: [first]}]\ntime: {duration: %g, fps: 120}\ntruth: slinky\n";

// Cross and Wheatland: the bottom stays until the wave arrives, the centre falls as if nothing held together.
static void test_slinky(void **state) {
    (void)state;
    char text[600];
    Fixture fixture;
    ck_Truth truth;
    ck_Error error = {0};
    snprintf(text, sizeof text, slinky, 260.0, 0.35);
    load(&fixture, text, CK_OK, NULL);
    const ck_Model *model = &fixture.model;
    const int last = model->particle_count - 1;
    // every spring carries what is below it
    for (int i = 1; i <= last; i++)
        assert_near("hung", model->position[3 * i - 2] - model->position[3 * i + 1],
                    0.05 + (last - i + 1) * 0.02 * 9.81 / 260, 1e-12);
    if (ck_truth_create(&truth, model, NULL, NULL, &error)) fail_msg("%s", error.message);
    ck_ReferencePath reference;
    if (ck_reference_path_create(&reference, model, &error)) fail_msg("%s", error.message);
    const double arrives = sqrt(0.42 / (260.0 / 20));
    double off = 0, before = 0, after = 0;
    for (int frame = 0; frame <= model->frame_count; frame++) {
        const double *x = ck_trajectory_position(&truth.paths[0], frame), time = frame * model->step;
        const double *v = ck_trajectory_velocity(&truth.paths[0], frame);
        double centre = 0;
        for (int i = 0; i <= last; i++) {
            off = fmax(off, ck_distance(x + 3 * i, ck_trajectory_position(&reference.fine, frame) + 3 * i));
            off =
                fmax(off, ck_distance(v + 3 * i, ck_trajectory_velocity(&reference.fine, frame) + 3 * i) * model->step);
            centre += (x[3 * i + 1] - model->position[3 * i + 1]) / (last + 1);
        }
        assert_near("centre", centre, -0.5 * 9.81 * time * time, 1e-12);
        const double moved = fabs(x[3 * last + 1] - model->position[3 * last + 1]);
        if (time < 0.7 * arrives) before = fmax(before, moved);
        if (time < 1.3 * arrives) after = fmax(after, moved);
    }
    print_message("off the reference by %.2g m; the bottom moved %.2g m at 0.7 of the wave's time, %.2g m at 1.3\n",
                  off, before, after);
    // the reference agrees with itself to 1e-9 of its size
    assert_true(off < 2e-9);
    // free fall would be 2e-2 m at 0.7: the chain of beads spreads the front, and lets this much ahead of it
    assert_true(before < 1e-5 && after > 3e-2);
    ck_reference_path_free(&reference);
    ck_truth_free(&truth);
    fixture_free(&fixture);
    snprintf(text, sizeof text, slinky, 60.0, 3.0);
    load(&fixture, text, CK_OK, NULL);
    assert_int_equal(ck_truth_create(&truth, &fixture.model, NULL, NULL, &error), CK_BAD_INPUT);
    assert_non_null(strstr(error.message, "where coils meet"));
    ck_truth_free(&truth);
    fixture_free(&fixture);
}

// At rest from the start nothing moves: a net that is bent and slack in places, too.
static void test_stays(void **state) {
    (void)state;
    Fixture fixture;
    ck_Trajectory path;
    ck_Error error = {0};
    load(&fixture,
         "name: n\ncloth: {rows: 6, columns: 6, spacing: 0.1, mass: 0.1, down: [0, 0, 1]}\n"
         "springs: {stiffness: 300, shear: 100, pull_only: true}\nbending: {stiffness: 1.0e-3}\n"
         "pins: [top_left, top_right]\nnoise: {amplitude: 1.0e-4, seed: 1}\n"
         "start: equilibrium\ngravity: [0, -9.81, 0]\ntime: {duration: 0.5, fps: 60}\n",
         CK_OK, NULL);
    if (ck_reference_integrate(&path, &fixture.model, 64, 0, 0, &error)) fail_msg("%s", error.message);
    double moved = 0;
    for (int i = 0; i < fixture.model.particle_count; i++)
        moved = fmax(moved, ck_distance(ck_trajectory_position(&path, path.frame_count - 1) + 3 * i,
                                        fixture.model.position + 3 * i));
    assert_int_equal(path.frame_count, fixture.model.frame_count + 1);
    // forces are balanced to 1e-10 of the weight: g·t²/2 of that
    assert_near("moved", moved, 0, 1e-8);
    ck_trajectory_free(&path);
    fixture_free(&fixture);
}

#define ROPE                                                                                                           \
    "name: r\nrope: {particles: 5, spacing: 0.1, mass: 0.1}\ngravity: [0, -9.81, 0]\ntime: {duration: 1, fps: 60}\n"

static void test_refused(void **state) {
    (void)state;
    static const struct {
        const char *text, *says;
    } cases[] = {
        {ROPE "springs: {stiffness: 100}\nstart: equilibrium\n", "start equilibrium needs pins"},
        {ROPE "springs: {stiffness: 100}\npins: [first]\nstart: rest\n", "it must be equilibrium"},
        {"name: w\ncloth: {rows: 2, columns: 2, spacing: 1, mass: 1}\nsprings: {stiffness: 100}\npins: [top_edge]\n"
         "gravity: [0, -9.81, 0]\nwind: {velocity: [1, 0, 0], drag: 1}\nstart: equilibrium\n"
         "time: {duration: 1, fps: 60}\n",
         "still air"},
        {ROPE "springs: {rigid: true}\npins: [first]\nstart: equilibrium\n", "springs that stretch"},
        {ROPE "springs: {stiffness: 1}\npins: [first]\nstart: equilibrium\n"
              "colliders: [{plane: {point: [0, -0.5, 0], normal: [0, 1, 0]}}]\n",
         "of which a start at equilibrium knows nothing"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Fixture fixture;
        load(&fixture, cases[i].text, CK_BAD_INPUT, cases[i].says);
        fixture_free(&fixture);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_slinky), cmocka_unit_test(test_stays),
                                       cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
