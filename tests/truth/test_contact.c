// Contact: the surface and the native solver against closed forms, then every engine against the same scenes.
#include "fixture_truth.h"

#include "collider.h"
#include "contact.h"
#include "vector.h"

#define PULL "gravity: [0, -9.81, 0]\n"

static void load(TruthFixture *fixture, const char *text) {
    fixture_load_truth(fixture, text);
    assert_int_equal(ck_truth_create(&fixture->truth, &fixture->model, NULL, NULL, NULL), CK_OK);
}

static double value_of(const TruthFixture *fixture, const ck_Trajectory *trajectory, const char *metric) {
    return ck_metric_value(ck_metric_find(metric), &fixture->model, trajectory, &fixture->truth.reference);
}

// Runs every solver on a scene and checks one metric against its truth. allowed: by what share of the truth it may be
// off, 0 truths absolutely; by family.
typedef struct Allowed {
    double native, ode, bullet;
} Allowed;

static double allowed_for(const ck_Engine *engine, const Allowed *allowed) {
    if (!strcmp(engine->family, "native")) return allowed->native;
    return strcmp(engine->family, "ODE") ? allowed->bullet : allowed->ode;
}

static void check_all(const char *text, const char *metric, Allowed allowed) {
    TruthFixture fixture;
    int checked = 0;
    load(&fixture, text);
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!fixture_is_solver(engine) || !fixture_takes(engine, &fixture.model)) continue;
        checked++;
        ck_Trajectory trajectory;
        fixture_run(&trajectory, &fixture.model, engine, NULL, NULL);
        double value = value_of(&fixture, &trajectory, metric);
        double truth = ck_metric_truth(ck_metric_find(metric), &fixture.model, &fixture.truth.reference);
        char what[100];
        snprintf(what, sizeof what, "%s of %s", metric, engine->name);
        assert_near(what, value, truth, allowed_for(engine, &allowed) * (truth > 0 ? truth : 1));
        ck_trajectory_free(&trajectory);
    }
    assert_int_equal(checked, fixture_leaves_natives() ? 5 : 9); // all but native-rope
    fixture_free_truth(&fixture);
}

// Where a straight or falling path meets a surface, against the roots that one writes down by hand.
static void test_hit(void **state) {
    (void)state;
    const ck_Collider plane = {.shape = CK_PLANE, .normal = {0, 1, 0}};
    const ck_Collider ball = {.shape = CK_SPHERE, .radius = 0.5};
    const double still[3] = {0}, fall[3] = {0, -10, 0}, above[3] = {0, 1.25, 0}, away[3] = {0, 1, 0};
    const double at[3] = {-2, 0.3, 0}, fast[3] = {1000, 0, 0}, low[3] = {0, 0.5, 0};
    assert_near("free fall of 1.25 m", ck_collider_hit(&plane, above, still, fall, 1, 0), 0.5, 1e-15);
    assert_true(isinf(ck_collider_hit(&plane, above, still, fall, 0.49, 0)));
    assert_true(isinf(ck_collider_hit(&plane, above, away, still, 100, 0)));
    // x = −√(R² − 0.3²) is met at (2 − 0.4)/1000 s, all of it within one step
    assert_near("a shot at a ball", ck_collider_hit(&ball, at, fast, still, 1, 0), 1.6e-3, 1e-15);
    assert_true(isinf(ck_collider_hit(&ball, at, fast, still, 1.5e-3, 0)));
    // from the surface upwards and back: 2·v/g
    assert_near("a hop", ck_collider_hit(&plane, still, away, fall, 1, 1e-9), 0.2, 1e-15);
    assert_near("a hop on a ball", ck_collider_hit(&ball, low, away, fall, 1, 1e-9), 0.2, 1e-12);
}

// Δv_n = (1 + e)·|v_n|, Δv_t = min(μ·Δv_n, |v_t|), at 0° and at 45°; what leaves is not held.
static void test_impulse(void **state) {
    (void)state;
    ck_Collider plane = {.shape = CK_PLANE, .normal = {0, 1, 0}, .restitution = 0.2, .friction = 0.5};
    ck_Model model = {.colliders = &plane, .collider_count = 1, .spacing = 1};
    ck_Contact *contact;
    assert_int_equal(ck_contact_create(&contact, &model, 1e-3, NULL), CK_OK);
    const double none[3] = {0};
    for (int angle = 0; angle <= 45; angle += 45) {
        double x[3] = {0}, v[3] = {3 * cos(angle * M_PI / 180), -4, 3 * sin(angle * M_PI / 180)};
        ck_contact_advance(contact, 2, x, v, none);
        assert_near("rebound", v[1], 0.8, 1e-15);
        assert_near("slip", hypot(v[0], v[2]), 3 - 0.5 * 1.2 * 4, 1e-15);
    }
    // impulses sum to the change of momentum
    assert_near("impulse", contact->impulse[1], 2 * 2 * 4.8, 1e-12);
    double x[3] = {0}, v[3] = {1, 2, 0}, up[3] = {0, 5, 0};
    ck_contact_advance(contact, 1, x, v, up);
    assert_near("no glue", x[1], 2e-3 + 2.5e-6, 1e-15);
    assert_near("no rubbing", v[0], 1, 0);
    free(contact);
}

// A substep as long as several bounces: they are all there.
static void test_several_bounces(void **state) {
    (void)state;
    ck_Collider plane = {.shape = CK_PLANE, .normal = {0, 1, 0}, .restitution = 1};
    ck_Model model = {.colliders = &plane, .collider_count = 1, .spacing = 1};
    ck_Contact *contact;
    assert_int_equal(ck_contact_create(&contact, &model, 0.3, NULL), CK_OK);
    // half a hop takes 1 s: after 100 substeps of 0.3 s it has been down 15 times
    double x[3] = {0, 5, 0}, v[3] = {0}, a[3] = {0, -10, 0};
    for (int i = 0; i < 100; i++) ck_contact_advance(contact, 1, x, v, a);
    assert_near("height", x[1], 5, 1e-10);
    assert_near("energy", 0.5 * v[1] * v[1] + 10 * x[1], 50, 1e-10);
    free(contact);
}

// The apex is e² of the height before, so that e off by a share puts the apex off by twice that: 1 % and 5 % of the
// apex. The native ones follow each impact; XPBD's start is half a step's speed ahead, (g·dt/2)²/2gh.
static void test_bounce(void **state) {
    (void)state;
    check_all("name: bounce\n"
              "network: {nodes: [{at: [0, 0.5, 0], mass: 0.1}], bars: []}\n" PULL
              "colliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0], restitution: 0.6}}]\n"
              "time: {duration: 1.5, step: 0.004166666666666667}\ntruth: bounce\n",
              "restitution", (Allowed){0.005, 0.005, 0.025});
    check_all("name: elastic\n"
              "network: {nodes: [{at: [0, 0.5, 0], mass: 0.1}], bars: []}\n" PULL
              "colliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0], restitution: 1}}]\n"
              "time: {duration: 1.5, step: 0.004166666666666667}\ntruth: bounce\n",
              "restitution", (Allowed){5e-4, 5e-4, 5e-4});
}

// Symplectic methods slide v·dt/2 too far or too short: 2·dt/2 of 0.68 m is 0.6 %; friction is that share of 0.3.
static void test_slide(void **state) {
    (void)state;
    static const char *const velocities[] = {"[2, 0, 0]", "[1.4142135623730951, 0, 1.4142135623730951]"};
    for (int i = 0; i < 2; i++) {
        char text[500];
        snprintf(text, sizeof text,
                 "name: slide\nnetwork: {nodes: [{at: [0, 0, 0], mass: 0.1}], bars: []}\n" PULL "velocity: %s\n"
                 "colliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0], friction: 0.3}}]\n"
                 "time: {duration: 1, step: 0.004166666666666667}\ntruth: slide\n",
                 velocities[i]);
        check_all(text, "friction", (Allowed){0.01, 0.01, 0.01});
    }
}

#define SLOPE                                                                                                          \
    "network: {nodes: [{at: [0, 0, 0], mass: 0.1}], bars: []}\n" PULL                                                  \
    "time: {duration: 1, step: 0.004166666666666667}\ntruth: slide\n"                                                  \
    "colliders: [{plane: {point: [0, 0, 0], normal: [0.5, 0.8660254037844386, 0], friction: %s}}]\n"

// tan 30° = 0.577: 0.2 slips at g·(sin − μ·cos), 0.7 holds to 1e-4 m in a second.
static void test_slope(void **state) {
    (void)state;
    char text[500];
    snprintf(text, sizeof text, "name: slips\n" SLOPE, "0.2");
    check_all(text, "friction", (Allowed){0.01, 0.01, 0.01});
    snprintf(text, sizeof text, "name: sticks\n" SLOPE, "0.7");
    check_all(text, "position_rms", (Allowed){1e-4, 1e-4, 1e-4});
}

// On a ball without friction the native solver keeps its energy and leaves where cos θ is 2/3 of that of its start: the
// closed form's path to second order in the step, (v·dt/R)² = 3e-4 of the way.
static void test_ball(void **state) {
    (void)state;
    TruthFixture fixture;
    load(&fixture, "name: ball\nnetwork: {nodes: [{at: [0.01, 0.2998332870110419, 0], mass: 0.1}], bars: []}\n" PULL
                   "colliders: [{sphere: {center: [0, 0, 0], radius: 0.3}}]\n"
                   "time: {duration: 0.9, step: 0.004166666666666667}\ntruth: sphere_slide\n");
    const ck_Model *model = &fixture.model;
    double off[2];
    for (uint32_t n = 1; n <= 2; n++) {
        ck_Trajectory trajectory;
        fixture_run(&trajectory, model, ck_engine_find("native-verlet"), &(ck_Settings){.substeps = n}, NULL);
        off[n - 1] = value_of(&fixture, &trajectory, "position_rms");
        assert_near("gained energy", value_of(&fixture, &trajectory, "energy_drift"), 0, 1e-12);
        ck_trajectory_free(&trajectory);
    }
    assert_near("the path", off[0], 0, 3e-4);
    assert_true(off[1] < 0.35 * off[0]);
    fixture_free_truth(&fixture);
}

// The closed form itself: energy is kept on the ball and in the air, and it leaves at cos θ = 2/3·cos θ_0.
static void test_sphere_truth(void **state) {
    (void)state;
    fixture_skip_sanitized();
    // long, and in memory what shorter ones do
    if (fixture_leaves_natives()) skip();
    TruthFixture fixture;
    load(&fixture, "name: ball\nnetwork: {nodes: [{at: [0.01, 0.2998332870110419, 0], mass: 0.1}], bars: []}\n" PULL
                   "colliders: [{sphere: {center: [0, 0, 0], radius: 0.3}}]\n"
                   "time: {duration: 0.9, step: 0.0005}\ntruth: sphere_slide\n");
    const ck_Trajectory *path = &fixture.truth.reference.trajectory;
    double highest = 0.2998332870110419, leaving = 0;
    for (int frame = 0; frame < path->frame_count; frame++) {
        const double *x = ck_trajectory_position(path, frame), *v = ck_trajectory_velocity(path, frame);
        assert_near("energy", 0.5 * ck_dot(v, v) + 9.81 * x[1], 9.81 * highest, 1e-10);
        if (ck_length(x) <= 0.3 + 1e-9) leaving = x[1] / 0.3;
    }
    // the last frame on the ball is at most one frame, v·dt/R = 0.002 rad, before it leaves
    assert_near("cos theta", leaving, 2.0 / 3 * highest / 0.3, 0.002);
    fixture_free_truth(&fixture);
}

// A shot at a small ball: a step of 100 m/s passes it by 8 times. Only what tests the way between steps sees it.
static void test_tunnelling(void **state) {
    (void)state;
    TruthFixture fixture;
    load(&fixture, "name: shot\nnetwork: {nodes: [{at: [-1, 0, 0], mass: 0.1}], bars: []}\nvelocity: [1000, 0, 0]\n"
                   "colliders: [{sphere: {center: [0, 0, 0], radius: 0.05, restitution: 0.5}}]\n"
                   "time: {duration: 0.1, step: 0.004166666666666667}\ntruth: strike\n");
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!fixture_is_solver(engine) || !fixture_takes(engine, &fixture.model)) continue;
        ck_Trajectory trajectory;
        fixture_run(&trajectory, &fixture.model, engine, NULL, NULL);
        double tunnelled = value_of(&fixture, &trajectory, "tunnelled");
        if (!strcmp(engine->family, "native")) {
            assert_near(engine->name, tunnelled, 0, 0);
            assert_near(engine->name, value_of(&fixture, &trajectory, "position_rms"), 0, 1e-12);
        } else if (strcmp(engine->name, "bullet-explicit")) {
            // which clamps the speed
            assert_near(engine->name, tunnelled, 1, 0);
        }
        ck_trajectory_free(&trajectory);
    }
    fixture_free_truth(&fixture);
}

// A level cloth falls, bounces and lies: unstretched, on the floor, carried by it. Penetration: the native ones none;
// others v·dt = 2 m/s/240 at the most, which is 0.17 of the spacing; at the end all 1 % of it.
static void test_cloth_on_floor(void **state) {
    (void)state;
    // long, and in memory what shorter ones do
    if (fixture_leaves_natives()) skip();
    TruthFixture fixture;
    load(&fixture,
         "name: floor\ncloth: {rows: 5, columns: 5, spacing: 0.05, mass: 0.025, origin: [0, 0.2, 0], down: [0, 0, 1]}\n"
         "springs: {stiffness: 500, damping: 0.02, shear: 250}\n" PULL
         "colliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0], restitution: 0.3, friction: 0.5}}]\n"
         "time: {duration: 1, step: 0.008333333333333333}\ntruth: bounce\n");
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!fixture_is_solver(engine) || !fixture_takes(engine, &fixture.model)) continue;
        ck_Trajectory trajectory;
        fixture_run(&trajectory, &fixture.model, engine, NULL, NULL);
        bool native = !strcmp(engine->family, "native");
        assert_near(engine->name, value_of(&fixture, &trajectory, "penetration_max"), 0, native ? 1e-9 : 0.17);
        assert_near(engine->name, value_of(&fixture, &trajectory, "rest_height"), 0, 0.01);
        assert_near(engine->name, value_of(&fixture, &trajectory, "stretch_max"), 0, 1e-6);
        assert_near(engine->name, value_of(&fixture, &trajectory, "energy_drift"), 0, 1e-9);
        double force = value_of(&fixture, &trajectory, "contact_force");
        assert_true(isnan(force) == !engine->contact);
        if (engine->contact) assert_near(engine->name, force, 1, 0.01);
        ck_trajectory_free(&trajectory);
    }
    fixture_free_truth(&fixture);
}

// A draped cloth at rest: penetration at most 1 % of the spacing, the ball carries the weight to 1 %.
static void test_cloth_on_ball(void **state) {
    (void)state;
    TruthFixture fixture;
    load(&fixture, "name: drape\ncloth: {rows: 8, columns: 8, spacing: 0.1, mass: 0.256, origin: [-0.35, 0.32, -0.35], "
                   "down: [0, 0, 1]}\nsprings: {stiffness: 200, damping: 0.1, shear: 100}\n"
                   "noise: {amplitude: 1.0e-4, seed: 1}\n" PULL "drag: 6\n"
                   "colliders: [{sphere: {center: [0, 0, 0], radius: 0.3, friction: 0.9}}]\n"
                   "time: {duration: 3, step: 0.016666666666666666}\ntruth: rest\n");
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!fixture_is_solver(engine) || !fixture_takes(engine, &fixture.model)) continue;
        if (!strcmp(engine->name, "ode-direct")) continue; // whose cost is that of all tests
        ck_Trajectory trajectory;
        fixture_run(&trajectory, &fixture.model, engine, NULL, NULL);
        assert_near(engine->name, value_of(&fixture, &trajectory, "rest_height"), 0, 0.01);
        if (engine->contact) assert_near(engine->name, value_of(&fixture, &trajectory, "contact_force"), 1, 0.01);
        ck_trajectory_free(&trajectory);
    }
    fixture_free_truth(&fixture);
}

// A pin let go: until then the body hangs, from then on its centre falls as a free body's does.
static void test_release(void **state) {
    (void)state;
    TruthFixture fixture;
    load(&fixture, "name: let_go\nrope: {particles: 4, spacing: 0.1, mass: 0.4}\nsprings: {stiffness: 1000}\n"
                   "pins: [first]\n" PULL "release: [{at: 0.1, pins: [first]}]\n"
                   "time: {duration: 0.3, step: 0.01}\ntruth: trajectory\n");
    const ck_Model *model = &fixture.model;
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!fixture_is_solver(engine) || !fixture_takes(engine, &fixture.model)) continue;
        ck_Trajectory trajectory;
        fixture_run(&trajectory, model, engine, &(ck_Settings){.substeps = 64}, NULL);
        assert_near(engine->name, ck_trajectory_position(&trajectory, 10)[1], 0, 0);
        assert_true(ck_trajectory_position(&trajectory, 12)[1] < -1e-3);
        // centre of mass from the frame of release on, from its place and speed there
        double fall[2][2] = {{0}};
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 2; k++) {
                fall[k][0] += 0.25 * ck_trajectory_position(&trajectory, k ? 30 : 10)[3 * j + 1];
                fall[k][1] += 0.25 * ck_trajectory_velocity(&trajectory, k ? 30 : 10)[3 * j + 1];
            }
        // symplectic methods are off by g·t·dt/2 = 1.5e-4 m; bars' reading of speed by a·dt
        assert_near(engine->name, fall[1][0], fall[0][0] + 0.2 * fall[0][1] - 0.5 * 9.81 * 0.04, 4e-4);
        ck_trajectory_free(&trajectory);
    }
    fixture_free_truth(&fixture);
}

// A groove of two planes, acute: a particle comes to rest at its bottom, in neither of them.
static void test_groove(void **state) {
    (void)state;
    TruthFixture fixture;
    load(&fixture, "name: groove\nnetwork: {nodes: [{at: [0.02, 0.3, 0], mass: 0.1}], bars: []}\n" PULL
                   "colliders:\n  - plane: {point: [0, 0, 0], normal: [0.9396926207859084, 0.3420201433256687, 0]}\n"
                   "  - plane: {point: [0, 0, 0], normal: [-0.9396926207859084, 0.3420201433256687, 0]}\n"
                   "time: {duration: 2, step: 0.004166666666666667}\ntruth: rest\n");
    const char *const natives[] = {"native-verlet", "native-bars", "native-xpbd"};
    for (int i = 0; i < 3; i++) {
        ck_Trajectory trajectory;
        fixture_run(&trajectory, &fixture.model, ck_engine_find(natives[i]), NULL, NULL);
        const double *x = ck_trajectory_position(&trajectory, fixture.model.frame_count);
        // a substep's fall, g·dt², may come back each step, divided by the sine of half the angle
        assert_near(natives[i], ck_length(x), 0, 1e-3);
        assert_near(natives[i], value_of(&fixture, &trajectory, "penetration_max"), 0, 1e-4);
        ck_trajectory_free(&trajectory);
    }
    fixture_free_truth(&fixture);
}

// A ball that a fast particle passes by is no obstacle, to any engine.
static void test_passing_by(void **state) {
    (void)state;
    TruthFixture fixture;
    load(&fixture, "name: by\nnetwork: {nodes: [{at: [-1, 0.12, 0], mass: 0.1}], bars: []}\nvelocity: [5, 0, 0]\n"
                   "colliders: [{sphere: {center: [0, 0, 0], radius: 0.1, friction: 0.5}}]\n"
                   "time: {duration: 0.4, step: 0.02}\n");
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!fixture_is_solver(engine) || !fixture_takes(engine, &fixture.model)) continue;
        ck_Trajectory trajectory;
        fixture_run(&trajectory, &fixture.model, engine, NULL, NULL);
        const double *v = ck_trajectory_velocity(&trajectory, fixture.model.frame_count);
        // bullet-explicit clamps the speed, but not its direction
        assert_near(engine->name, v[1], 0, 1e-12);
        if (strcmp(engine->name, "bullet-explicit")) assert_near(engine->name, v[0], 5, 1e-9);
        ck_trajectory_free(&trajectory);
    }
    fixture_free_truth(&fixture);
}

// More colliders, all different, than a ledger has rows for.
static void test_many_colliders(void **state) {
    (void)state;
    char text[6000] = "name: many\nnetwork: {nodes: [{at: [0, 1, 0], mass: 0.1}], bars: []}\n" PULL
                      "time: {duration: 0.1, step: 0.01}\ncolliders:\n";
    for (int i = 0; i < 40; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text),
                 "  - sphere: {center: [%d, -1, 0], radius: 0.3, friction: 0.%02d}\n", i, i + 1);
    TruthFixture fixture;
    load(&fixture, text);
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!fixture_takes(engine, &fixture.model)) continue;
        ck_Ledger ledger = {0};
        ck_Settings used, wanted = {0};
        void *world;
        assert_int_equal(ck_engine_create(engine, &world, &fixture.model, &wanted, &used, &ledger, NULL), CK_OK);
        engine->destroy(world);
        assert_true(ledger.count <= CK_LEDGER_CAPACITY);
    }
    fixture_free_truth(&fixture);
}

// What a scene does not mention costs nothing: without colliders there is no contact to ask.
static void test_costs_nothing(void **state) {
    (void)state;
    ck_Model model = {0};
    ck_Contact *contact = (ck_Contact *)&model;
    assert_int_equal(ck_contact_create(&contact, &model, 1, NULL), CK_OK);
    assert_null(contact);
}

// A coefficient that explains a straight slide says nothing of one along a curve: there is none of it then.
static void test_friction_is_straight(void **state) {
    (void)state;
    static const char text[] =
        "name: slide\nnetwork: {nodes: [{at: [0, %g, 0], mass: 1}], bars: []}\nvelocity: [1, 0, 0]\n"
        "gravity: [0, -9.81, 0]\ncolliders: [%s]\ntime: {duration: 0.3, step: 0.005}\n";
    for (int is_ball = 0; is_ball < 2; is_ball++) {
        char scene[500];
        snprintf(scene, sizeof scene, text, is_ball ? 1.0 : 0.0,
                 is_ball ? "{sphere: {center: [0, 0, 0], radius: 1, friction: 0.4}}"
                         : "{plane: {point: [0, 0, 0], normal: [0, 1, 0], friction: 0.4}}");
        TruthFixture fixture;
        ck_Trajectory trajectory;
        fixture_load_truth(&fixture, scene);
        fixture_run(&trajectory, &fixture.model, ck_engine_find("native-verlet"), NULL, NULL);
        double friction =
            ck_metric_value(ck_metric_find("friction"), &fixture.model, &trajectory, &fixture.truth.reference);
        if (is_ball)
            assert_true(isnan(friction));
        else
            assert_near("friction of a straight slide", friction, 0.4, 0.01);
        ck_trajectory_free(&trajectory);
        fixture_free_truth(&fixture);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hit),
        cmocka_unit_test(test_impulse),
        cmocka_unit_test(test_several_bounces),
        cmocka_unit_test(test_bounce),
        cmocka_unit_test(test_slide),
        cmocka_unit_test(test_slope),
        cmocka_unit_test(test_ball),
        cmocka_unit_test(test_sphere_truth),
        cmocka_unit_test(test_tunnelling),
        cmocka_unit_test(test_cloth_on_floor),
        cmocka_unit_test(test_cloth_on_ball),
        cmocka_unit_test(test_release),
        cmocka_unit_test(test_costs_nothing),
        cmocka_unit_test(test_friction_is_straight),
        cmocka_unit_test(test_groove),
        cmocka_unit_test(test_passing_by),
        cmocka_unit_test(test_many_colliders),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
