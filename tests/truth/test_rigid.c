// Rigid bodies: momentum, bounces, rolling and turning by closed forms, in every engine that has them; rest in a dent
// by the least energy.
#include "fixture_truth.h"

#include "equilibrium.h"
#include "export.h"
#include "metric.h"
#include "rigid.h"
#include "springs.h"
#include "vector.h"

// A cloth is far away where only the body counts.
#define AWAY                                                                                                           \
    "name: r\nrope: {particles: 2, spacing: 1, mass: 1, origin: [50, 50, 0]}\nsprings: {stiffness: 10}\npins: "        \
    "[first, last]\n"
#define FLOOR "gravity: [0, -9.81, 0]\ncolliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0]}}]\n"

static const char thrown[] =
    "name: thrown\ncloth: {rows: 7, columns: 7, spacing: 0.1, mass: 0.1, down: [0, 0, 1]}\n"
    "springs: {stiffness: 500, shear: 250, damping: 0.05}\n"
    "bodies: [{sphere: {center: [0.25, 0.3, 0.3], radius: 0.15, restitution: 0.5, friction: 0.3}, mass: 0.5,\n"
    "  velocity: [0, -3, 0], spin: [5, 0, 2]}]\ntime: {duration: 0.4, fps: 60}\n";

static bool has_bodies(const ck_Engine *engine, const ck_Model *model) {
    return fixture_supports(engine, model) && fixture_takes(engine, model) && engine->method != CK_METHOD_STILL;
}

static double measure(const char *metric, const ck_Model *model, const ck_Trajectory *path) {
    return ck_metric_value(ck_metric_find(metric), model, path, &(ck_Reference){0});
}

// Newton's third law: whoever gives both sides one impulse keeps momentum to the rounding of a few thousand sums; where
// speeds are differences of places over a substep of 1e-4 s, it is that of places over it.
static void test_momentum(void **state) {
    (void)state;
    static const struct {
        const char *engine;
        double linear, angular;
    } known[] = {{"native-verlet", 1e-12, 1e-12}, {"native-bars", 1e-11, 1},    {"native-xpbd", 1e-9, 1},
                 {"ode-quick", 1e-12, 1e-12},     {"ode-direct", 1e-12, 1e-12}, {"mujoco", 1e-12, 1}};
    Fixture fixture;
    fixture_load(&fixture, thrown);
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        ck_Trajectory path;
        if (!has_bodies(engine, &fixture.model)) continue;
        fixture_run(&path, &fixture.model, engine, NULL, NULL);
        const double linear = measure("momentum_drift", &fixture.model, &path),
                     angular = measure("angular_momentum_drift", &fixture.model, &path);
        print_message("%-16s momentum %.1e, angular momentum %.1e\n", engine->name, linear, angular);
        for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
            if (strcmp(known[k].engine, engine->name)) continue;
            assert_near(engine->name, linear, 0, known[k].linear);
            assert_near(engine->name, angular, 0, known[k].angular);
        }
        // it was met: a ball that flew through would have kept its speed
        const double *v = ck_trajectory_velocity(&path, path.frame_count - 1) + 3 * fixture.model.rigid[0].particle;
        assert_true(v[1] > -2.9);
        ck_trajectory_free(&path);
    }
    fixture_free(&fixture);
}

// A ball that slides on a plane with friction is slowed and spun until it rolls, at 5/7 of its speed.
static void test_rolls(void **state) {
    (void)state;
    Fixture fixture;
    fixture_load(&fixture, AWAY FLOOR "bodies: [{sphere: {center: [0, 0.2, 0], radius: 0.2, friction: 0.3}, mass: 2,\n"
                                      "  velocity: [1.4, 0, 0]}]\ntime: {duration: 0.5, fps: 60}\n");
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        ck_Trajectory path;
        if (!has_bodies(engine, &fixture.model)) continue;
        fixture_run(&path, &fixture.model, engine, NULL, NULL);
        const double *v = ck_trajectory_velocity(&path, path.frame_count - 1) + 3 * fixture.model.rigid[0].particle;
        const ck_Turn *turn = ck_trajectory_turn(&path, path.frame_count - 1);
        print_message("%-16s rolls at %.4f m/s, spins at %.4f rad/s\n", engine->name, v[0], turn->spin[2]);
        // from sliding to rolling takes 2·v/(7·μ·g) = 0.136 s: a step of 1/240 s is 3 % of it; a stock engine's
        // friction is a product with that of the floor
        if (!engine->is_stock) {
            assert_near(engine->name, v[0], 1, 0.03);
            assert_near(engine->name, turn->spin[2], -v[0] / 0.2, 0.15);
        }
        ck_trajectory_free(&path);
    }
    fixture_free(&fixture);
}

// A spin about one of a box's axes stays, whatever else happens: also where a pin is let go on the way, for which some
// engines build their world again.
static void test_turns(void **state) {
    (void)state;
    Fixture fixture;
    fixture_load(&fixture,
                 AWAY "release: [{at: 0.25, pins: [last]}]\n"
                      "bodies: [{box: {center: [0, 0, 0], size: [0.4, 0.2, 0.3], along: [1, 1, 0]}, mass: 1,\n"
                      "  spin: [3, 3, 0]}]\ntime: {duration: 0.5, fps: 60}\n");
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        ck_Trajectory path;
        if (!has_bodies(engine, &fixture.model)) continue;
        fixture_run(&path, &fixture.model, engine, NULL, NULL);
        const double *q = ck_trajectory_turn(&path, path.frame_count - 1)->rotation, half = 0.5 * sqrt(18) * 0.5,
                     sign = q[0] < 0 ? -1 : 1;
        print_message("%-16s turned to %.5f %.5f %.5f %.5f\n", engine->name, q[0], q[1], q[2], q[3]);
        // float engines and damping by default of others' worlds; an angle of 1 rad
        assert_near(engine->name, sign * q[0], cos(half), 2e-3);
        assert_near(engine->name, sign * q[1], sin(half) / sqrt(2), 2e-3);
        assert_near(engine->name, sign * q[2], sin(half) / sqrt(2), 2e-3);
        assert_near(engine->name, sign * q[3], 0, 2e-3);
        ck_trajectory_free(&path);
    }
    fixture_free(&fixture);
}

// Without restitution lost, a ball that falls on a plane has the energy that it had, to rounding: velocity Verlet is
// exact in a uniform field, and an impact reverses the speed where it is. Two equal balls exchange their speeds.
static void test_bounces(void **state) {
    (void)state;
    Fixture fixture;
    ck_Trajectory path;
    fixture_load(&fixture, AWAY FLOOR "bodies: [{sphere: {center: [0, 1, 0], radius: 0.1, restitution: 1}, mass: 1}]\n"
                                      "time: {duration: 2.8, fps: 60}\n");
    fixture_run(&path, &fixture.model, ck_engine_find("native-verlet"), NULL, NULL);
    int turns = 0;
    const int body = fixture.model.rigid[0].particle;
    for (int frame = 1; frame < path.frame_count; frame++) {
        const double *x = ck_trajectory_position(&path, frame) + 3 * body,
                     *v = ck_trajectory_velocity(&path, frame) + 3 * body;
        assert_near("energy a kg, J", 0.5 * v[1] * v[1] + 9.81 * x[1], 9.81, 1e-11);
        turns += v[1] > 0 && ck_trajectory_velocity(&path, frame - 1)[3 * body + 1] < 0;
    }
    // it falls for 0.43 s
    assert_int_equal(turns, 3);
    ck_trajectory_free(&path);
    fixture_free(&fixture);
    fixture_load(
        &fixture,
        AWAY "bodies:\n  - {sphere: {center: [0, 0, 0], radius: 0.1, restitution: 1}, mass: 1, velocity: [2, 0, 0]}\n"
             "  - {sphere: {center: [0.5, 0, 0], radius: 0.1, restitution: 1}, mass: 1}\n"
             "time: {duration: 0.5, fps: 60}\n");
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!has_bodies(engine, &fixture.model)) continue;
        fixture_run(&path, &fixture.model, engine, NULL, NULL);
        const double *v = ck_trajectory_velocity(&path, path.frame_count - 1) + 3 * fixture.model.rigid[0].particle;
        print_message("%-16s %.4f and %.4f m/s after\n", engine->name, v[0], v[3]);
        // MuJoCo's impact is a spring over eight steps; the others' are at once
        assert_near(engine->name, v[0], 0, strcmp(engine->name, "mujoco") ? 1e-6 : 0.1);
        assert_near(engine->name, v[3], 2, strcmp(engine->name, "mujoco") ? 1e-6 : 0.1);
        ck_trajectory_free(&path);
    }
    fixture_free(&fixture);
}

static double spin_energy(const ck_Model *model, const ck_Trajectory *path) {
    const ck_Energy energy = ck_energy_at(model, path, path->frame_count - 1);
    return energy.kinetic;
}

// Euler's top: its angular momentum stays to rounding, its energy to the second order of the step.
static void test_tumbles(void **state) {
    (void)state;
    Fixture fixture;
    fixture_load(&fixture, "name: t\nrope: {particles: 1, spacing: 1, mass: 1, origin: [9, 0, 0]}\n"
                           "bodies: [{box: {center: [0, 0, 0], size: [0.4, 0.2, 0.3]}, mass: 1, spin: [0.1, 6, 1]}]\n"
                           "time: {duration: 2, fps: 60}\n");
    double off[2];
    for (uint32_t k = 0; k < 2; k++) {
        ck_Settings settings = {.substeps = 4u << k};
        ck_Trajectory path;
        fixture_run(&path, &fixture.model, ck_engine_find("native-verlet"), &settings, NULL);
        off[k] = fabs(spin_energy(&fixture.model, &path) - ck_energy_at(&fixture.model, &path, 0).kinetic);
        assert_near("angular momentum", measure("angular_momentum_drift", &fixture.model, &path), 0, 1e-13);
        ck_trajectory_free(&path);
    }
    print_message("energy is off by %.2e and %.2e J\n", off[0], off[1]);
    assert_true(off[0] > 3.5 * off[1]);
    fixture_free(&fixture);
}

// A weight on a spring that a plane holds up lies on it; one that hangs free is stretched by m·g/k.
static void test_least_energy(void **state) {
    (void)state;
    static const char hangs[] = "name: h\nrope: {particles: 2, spacing: 1, mass: 2}\nsprings: {stiffness: 100}\n"
                                "pins: [first]\ngravity: [0, -9.81, 0]\ndrag: 3\ntime: {duration: 4, fps: 60}\n"
                                "colliders: [{plane: {point: [0, %s, 0], normal: [0, 1, 0]}}]\n";
    static const struct {
        const char *height;
        double rest;
    } cases[] = {{"-1.05", -1.05}, {"-3", -1.0981}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[400];
        Fixture fixture;
        ck_Equilibrium equilibrium;
        ck_Error error = {0};
        snprintf(text, sizeof text, hangs, cases[i].height);
        fixture_load(&fixture, text);
        if (ck_equilibrium_release(&equilibrium, &fixture.model, 0, 0, &error)) fail_msg("%s", error.message);
        assert_near("height, m", equilibrium.position[4], cases[i].rest, 1e-12);
        ck_equilibrium_free(&equilibrium);
        fixture_free(&fixture);
    }
}

static const char dent[] = "name: dent\ncloth: {rows: 7, columns: 7, spacing: 0.1, mass: 0.1, down: [0, 0, 1]}\n"
                           "springs: {stiffness: 1000, shear: 500, damping: 0.3}\n"
                           "pins: [top_edge, bottom_edge, left_edge, right_edge]\ngravity: [0, -9.81, 0]\ndrag: 6\n"
                           "bodies: [{sphere: {center: [0.3, 0.2, 0.3], radius: 0.2%s}, mass: 2}]\n"
                           "time: {duration: 5, fps: 60}\ntruth: equilibrium\n";

// What engines come to rest at is where the energy is least; by symmetry the ball stays in the middle.
static void test_dent(void **state) {
    (void)state;
    char text[600];
    TruthFixture fixture;
    ck_Error error = {0};
    snprintf(text, sizeof text, dent, "");
    fixture_load_truth(&fixture, text);
    if (ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, &error)) fail_msg("%s", error.message);
    assert_int_not_equal(fixture.truth.path_count, 0);
    const double *truth = ck_trajectory_position(&fixture.truth.paths[0], 0);
    const int body = fixture.model.rigid[0].particle;
    assert_near("x", truth[3 * body], 0.3, 1e-9);
    static const char *const engines[] = {"native-verlet", "ode-quick", "mujoco"};
    for (size_t i = 0; i < sizeof engines / sizeof *engines; i++) {
        const ck_Engine *engine = ck_engine_find(engines[i]);
        ck_Trajectory path;
        if (!engine || !has_bodies(engine, &fixture.model)) continue;
        fixture_run(&path, &fixture.model, engine, NULL, NULL);
        const double *rest = ck_trajectory_position(&path, path.frame_count - 1);
        // what drag of 6/s leaves after 5 s, e^-15 of some 0.1 m, and MuJoCo's soft contact
        assert_near(engines[i], rest[3 * body + 1], truth[3 * body + 1], 5e-6);
        ck_trajectory_free(&path);
    }
    fixture_free_truth(&fixture);
    // with friction it could rest elsewhere
    snprintf(text, sizeof text, dent, ", friction: 0.5");
    fixture_load_truth(&fixture, text);
    assert_int_equal(ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, &error), CK_OK);
    assert_int_equal(fixture.truth.path_count, 0);
    assert_non_null(strstr(fixture.truth.kind, "many places"));
    fixture_free_truth(&fixture);
}

// To the reference a body is its centre: that is right of one that hangs and touches nothing.
static void test_hangs(void **state) {
    (void)state;
    static const char text[] = "name: hangs\nrope: {particles: 5, spacing: 0.2, mass: 0.1, along: [1, 0, 0]}\n"
                               "springs: {stiffness: 2000, damping: 0.2}\npins: [first]\ngravity: [0, -9.81, 0]\n"
                               "bodies: [{%s: {center: [%s, 0, 0], %s}, mass: 1, hang: [last]}]\n"
                               "time: {duration: 0.5, fps: 60}\ntruth: trajectory\n";
    char of[600];
    TruthFixture fixture;
    ck_Error error = {0};
    snprintf(of, sizeof of, text, "sphere", "1.1", "radius: 0.1");
    fixture_load_truth(&fixture, of);
    if (ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, &error)) fail_msg("%s", error.message);
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        ck_Trajectory path;
        if (!has_bodies(engine, &fixture.model) || !engine->order) continue;
        fixture_run(&path, &fixture.model, engine, NULL, NULL);
        const double off =
            ck_metric_value(ck_metric_find("position_rms"), &fixture.model, &path, &fixture.truth.reference);
        print_message("%-16s %.1e from the truth\n", engine->name, off);
        assert_true(off < 0.02);
        ck_trajectory_free(&path);
    }
    fixture_free_truth(&fixture);
    // one that the rope swings into is refused, and says so
    snprintf(of, sizeof of, text, "sphere", "0.55", "radius: 0.04");
    fixture_load_truth(&fixture, of);
    assert_int_equal(ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, &error), CK_OK);
    if (fixture.truth.path_count == 0) assert_non_null(strstr(fixture.truth.kind, "touches something"));
    fixture_free_truth(&fixture);
}

static void expect_refusal(const char *bodies, const char *wanted) {
    char text[900];
    snprintf(text, sizeof text,
             "name: bad\nrope: {particles: 3, spacing: 0.5, mass: 1}\npins: [first]\n"
             "colliders: [{capsule: {from: [3, 0, 0], to: [4, 0, 0], radius: 0.1}}]\n%s"
             "time: {duration: 1, fps: 60}\n",
             bodies);
    fixture_expect_refusal(text, wanted);
}

static void test_refuses(void **state) {
    (void)state;
    expect_refusal("bodies: [{mass: 1}]\n", "has none of sphere and box");
    expect_refusal("bodies: [{sphere: {center: [1, 0, 0], radius: 0.1}}]\n", "lacks the key mass");
    expect_refusal("bodies: [{sphere: {center: [0, -0.5, 0], radius: 0.1}, mass: 1}]\n",
                   "starts 0.1 m inside this body");
    expect_refusal("bodies: [{sphere: {center: [3.5, 0.1, 0], radius: 0.1}, mass: 1}]\n",
                   "inside another or a collider");
    expect_refusal("bodies: [{box: {center: [9, 0, 0], size: [1, 1, 1]}, mass: 1}]\n", "not modelled");
    expect_refusal("bodies: [{sphere: {center: [1, 0, 0], radius: 0.1}, mass: 1, hang: [last]}]\n",
                   "give springs.stiffness");
    expect_refusal(
        "springs: {stiffness: 1}\nbodies: [{sphere: {center: [1, 0, 0], radius: 0.1}, mass: 1, hang: [last, '2']}]\n",
        "named twice");
}

// What is exported reads back to the same model, to the last bit.
static void test_exports(void **state) {
    (void)state;
    static const char text[] = "name: out\nrope: {particles: 4, spacing: 0.3, mass: 0.1}\nsprings: {stiffness: 77, "
                               "damping: 0.1}\npins: [first]\n"
                               "gravity: [0, -9.81, 0]\nbodies:\n"
                               "  - {sphere: {center: [0.1, -1.4, 0.2], radius: 0.13, friction: 0.2}, mass: 0.7, hang: "
                               "[last, '2'], spin: [1, 2, 3]}\n"
                               "  - {box: {center: [2, 0, 0], size: [0.3, 0.2, 0.5], along: [1, 2, 0.3], restitution: "
                               "0.4}, mass: 3, velocity: [1, 0, 2]}\n"
                               "time: {duration: 1, fps: 60}\n";
    Fixture fixture, again;
    ck_Error error = {0};
    char *json = NULL;
    size_t size;
    fixture_load(&fixture, text);
    FILE *out = open_memstream(&json, &size);
    assert_int_equal(ck_export_json(out, &fixture.model, &error), CK_OK);
    fclose(out);
    fixture_load(&again, json);
    assert_int_equal(again.model.rigid_count, 2);
    assert_true(ck_model_hash(&again.model) == ck_model_hash(&fixture.model));
    free(json);
    fixture_free(&again);
    fixture_free(&fixture);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_momentum), cmocka_unit_test(test_rolls),   cmocka_unit_test(test_turns),
        cmocka_unit_test(test_bounces),  cmocka_unit_test(test_tumbles), cmocka_unit_test(test_least_energy),
        cmocka_unit_test(test_dent),     cmocka_unit_test(test_hangs),   cmocka_unit_test(test_refuses),
        cmocka_unit_test(test_exports),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
