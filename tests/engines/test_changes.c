// Scenes that change while they run: every engine goes on from where all is.
#include "fixture_comparison.h"

#include "runner.h"
#include "segment.h"
#include "vector.h"

static void run(ck_Run *of, const ck_Model *model, const ck_Engine *engine) {
    const ck_Limits limits = ck_limits_default();
    ck_Error error = {0};
    if (ck_run_measure(of, model, engine, &(ck_Settings){0}, &limits, &error)) fail_msg("%s", error.message);
}

static bool takes(const ck_Engine *engine, const ck_Model *model) {
    return engine->method != CK_METHOD_STILL && engine->method != CK_METHOD_SEED && fixture_takes(engine, model);
}

// A weight that falls, first down and then aside: two parabolas, which first-order steps miss by g·dt·t/2.
static void test_field(void **state) {
    (void)state;
    Fixture fixture;
    int taken = 0;
    fixture_load(&fixture, "name: f\nrope: {particles: 1, spacing: 1, mass: 1}\ngravity: [0, -10, 0]\n"
                           "changes: [{at: 0.5, set: '@gravity=[4, 0, 0]'}]\ntime: {duration: 1, fps: 60}\n");
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        ck_Run of;
        if (!takes(engine, &fixture.model)) continue;
        run(&of, &fixture.model, engine);
        if (of.status) fail_msg("%s: %s", engine->name, of.reason);
        const double *end = ck_trajectory_position(&of.trajectory, 60), step = 1.0 / 60 / of.used.substeps;
        print_message("%-16s %.6f %.6f\n", engine->name, end[0], end[1]);
        // 10·0.5²/2 and then 5 m/s for 0.5 s
        assert_near(engine->name, end[0], 0.5, 4 * step);
        assert_near(engine->name, end[1], -3.75, 10 * step);
        ck_run_free(&of);
        taken++;
    }
    assert_true(taken > 5);
    fixture_free(&fixture);
}

// A change to what is already so leaves an undamped path as it is, to rounding; pins that are left out let go.
static void test_goes_on(void **state) {
    (void)state;
    static const char text[] = "name: g\nrope: {particles: 4, spacing: 0.2, mass: 0.4, along: [1, 0, 0]}\n"
                               "springs: {stiffness: 300}\npins: [first, last]\ngravity: [0, -10, 0]\n"
                               "%stime: {duration: 0.5, fps: 60}\n";
    char changed[600], plain[600], freed[600];
    snprintf(plain, sizeof plain, text, "");
    snprintf(changed, sizeof changed, text, "changes: [{at: 0.25, set: 'springs.stiffness=300'}]\n");
    snprintf(freed, sizeof freed, text, "changes: [{at: 0.25, set: 'pins=[first]'}]\n");
    Fixture one, other, third;
    ck_Run of, with, without;
    fixture_load(&one, plain);
    fixture_load(&other, changed);
    fixture_load(&third, freed);
    run(&of, &one.model, ck_engine_find("native-verlet"));
    run(&with, &other.model, ck_engine_find("native-verlet"));
    run(&without, &third.model, ck_engine_find("native-verlet"));
    for (int i = 0; i < 12; i++) {
        assert_near("a coordinate", ck_trajectory_position(&with.trajectory, 30)[i],
                    ck_trajectory_position(&of.trajectory, 30)[i], 1e-13);
        assert_near("before", ck_trajectory_position(&without.trajectory, 15)[i],
                    ck_trajectory_position(&of.trajectory, 15)[i], 0);
    }
    assert_true(ck_trajectory_position(&without.trajectory, 30)[10] < -0.1);
    // it is no pin that stays: what is measured of free particles counts it
    assert_false(ck_model_is_held(&third.model, 3));
    ck_run_free(&of);
    ck_run_free(&with);
    ck_run_free(&without);
    fixture_free(&one);
    fixture_free(&other);
    fixture_free(&third);
}

// How far a body has turned, and a path has come, goes on through a change.
static void test_clocks(void **state) {
    (void)state;
    Fixture fixture;
    int taken = 0;
    fixture_load(&fixture,
                 "name: c\nrope: {particles: 2, spacing: 1, mass: 1}\nsprings: {stiffness: 10}\npins: [first, last]\n"
                 "moves: [{pins: [last], path: {amplitude: [0.2, 0, 0], frequency: 0.7}}]\n"
                 "bodies: [{box: {center: [5, 0, 0], size: [0.4, 0.2, 0.3]}, mass: 1, spin: [0, 4, 0]}]\n"
                 "changes: [{at: 0.2, set: drag=0.0}, {at: 0.4, set: 'gravity=[0, -1, 0]'}]\n"
                 "time: {duration: 0.6, fps: 60}\n");
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        ck_Run of;
        if (!takes(engine, &fixture.model)) continue;
        run(&of, &fixture.model, engine);
        if (of.status) fail_msg("%s: %s", engine->name, of.reason);
        const double *q = ck_trajectory_turn(&of.trajectory, 36)->rotation, sign = q[0] < 0 ? -1 : 1;
        assert_near(engine->name, sign * q[2], sin(0.5 * 4 * 0.6), 2e-3);
        assert_near(engine->name, ck_trajectory_position(&of.trajectory, 36)[3], 0.2 * sin(2 * M_PI * 0.7 * 0.6),
                    engine->is_stock ? 1e-6 : 1e-12);
        ck_run_free(&of);
        taken++;
    }
    assert_true(taken > 5);
    fixture_free(&fixture);
}

static void expect_refusal(const char *changes, const char *wanted) {
    char text[500];
    snprintf(text, sizeof text,
             "name: bad\nrope: {particles: 3, spacing: 0.5, mass: 1}\nsprings: {stiffness: 1}\n%s"
             "time: {duration: 1, fps: 60}\n",
             changes);
    fixture_expect_refusal(text, wanted);
}

static void test_refuses(void **state) {
    (void)state;
    expect_refusal("changes: [{at: 0.51, set: drag=1}]\n", "whole number of frames");
    expect_refusal("changes: [{at: 1, set: drag=1}]\n", "before the end");
    expect_refusal("changes: [{at: 0.5, set: drag=1}, {at: 0.5, set: drag=2}]\n", "no later than the change before");
    expect_refusal("changes: [{at: 0.5, set: rope.particles=4}]\n", "keeps particles, bodies and frames");
    expect_refusal("changes: [{at: 0.5, set: time.fps=30}]\n", "keeps particles, bodies and frames");
    expect_refusal("changes: [{at: 0.5, set: drag=-1}]\n", "drag is -1; it must be");
    expect_refusal("changes: [{at: 0.5, set: '@dragg=1'}]\n", "unknown key dragg");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_field), cmocka_unit_test(test_goes_on),
                                       cmocka_unit_test(test_clocks), cmocka_unit_test(test_refuses)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
