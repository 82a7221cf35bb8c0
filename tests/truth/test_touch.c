// The reference in contact: against closed forms, and against a second integrator that shares no code of its step.
#include "fixture_truth.h"

#include "collider.h"
#include "runge_kutta.h"

#include "springs.h"
#include "statistics.h"
#include "vector.h"

#include <float.h>

// The largest distance of the reference from the closed form of a scene up to its horizon, / size.
static double off_of(const char *scene, int *frames) {
    TruthFixture fixture;
    ck_Error error = {0};
    ck_ReferencePath path;
    char file[300];
    snprintf(file, sizeof file, SCENE_DIRECTORY "/%s.yaml", scene);
    if (fixture_open_truth(&fixture, file, &error)) fail_msg("%s", error.message);
    if (ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, &error)) fail_msg("%s", error.message);
    if (ck_reference_path_create(&path, &fixture.model, &error)) fail_msg("%s: %s", scene, error.message);
    double largest = 0;
    *frames = path.horizon;
    for (int frame = 0; frame <= path.horizon && frame <= fixture.truth.reference.horizon; frame++)
        for (int i = 0; i < fixture.model.particle_count; i++)
            largest = fmax(largest, ck_distance(ck_trajectory_position(&fixture.truth.paths[0], frame) + 3 * i,
                                                ck_trajectory_position(&path.fine, frame) + 3 * i));
    largest /= fixture.model.size;
    print_message("%-18s %.1e of the size off up to frame %d of %d, %d substeps, agrees to %.1e\n", scene, largest,
                  path.horizon, fixture.model.frame_count, path.substeps, path.agreement);
    ck_reference_path_free(&path);
    fixture_free_truth(&fixture);
    return largest;
}

static void test_closed_forms(void **state) {
    (void)state;
    static const char *const scenes[] = {
        "bounce",         "bounce_elastic",   "slide_0",         "slide_45",          "incline_slips",
        "incline_sticks", "sphere_slide_off", "bullet_speed_10", "bullet_speed_1000", "cloth_on_floor"};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        int frames;
        // a reference agrees with itself to 1e-9 of the size
        assert_near(scenes[i], off_of(scenes[i], &frames), 0, 2e-9);
    }
}

// The sanitizers, which make it ten times as slow, need not see them all.
#ifdef __SANITIZE_ADDRESS__
#define SEEDS 2
#else
#define SEEDS 50
#endif

static double pick(ck_Random *random, double from, double to) {
    return from + (to - from) * ck_random_unit(random);
}

// A rope or a small cloth that falls on a ball, a floor or a slope, by seed.
static void write_scene(char *text, size_t size, uint64_t seed) {
    ck_Random random = ck_random_seed(seed);
    char body[200], collider[240];
    const double x = pick(&random, -0.1, 0.1), z = pick(&random, -0.1, 0.1);
    if (ck_random_unit(&random) < 0.5)
        snprintf(body, sizeof body,
                 "rope: {particles: %d, spacing: 0.1, mass: 0.1, along: [1, %.3f, 0.1], origin: [%.4f, 0.45, %.4f]}",
                 3 + (int)(6 * ck_random_unit(&random)), pick(&random, -0.3, 0.3), x - 0.3, z);
    else
        snprintf(body, sizeof body,
                 "cloth: {rows: %d, columns: 4, spacing: 0.1, mass: 0.1, across: [1, 0, 0.1], down: [-0.1, %.3f, 1], "
                 "origin: [%.4f, 0.5, %.4f]}",
                 2 + (int)(3 * ck_random_unit(&random)), pick(&random, -0.2, 0.2), x - 0.15, z - 0.15);
    const double friction = ck_random_unit(&random) < 0.3 ? 0 : pick(&random, 0.1, 1),
                 restitution = ck_random_unit(&random) < 0.5 ? 0 : pick(&random, 0.1, 0.8);
    const double shape = ck_random_unit(&random), tilt = pick(&random, -0.3, 0.3);
    if (shape < 0.25)
        snprintf(collider, sizeof collider,
                 "sphere: {center: [0, 0, 0], radius: 0.3, friction: %.3f, restitution: %.3f}", friction, restitution);
    else if (shape < 0.4)
        snprintf(
            collider, sizeof collider,
            "capsule: {from: [-0.2, 0.1, %.3f], to: [0.1, 0, 0.1], radius: 0.2, friction: %.3f, restitution: %.3f}",
            tilt, friction, restitution);
    else if (shape < 0.55)
        snprintf(collider, sizeof collider,
                 "cylinder: {point: [0, 0, 0], axis: [0.2, %.3f, 1], radius: 0.25, friction: %.3f, restitution: %.3f}",
                 tilt, friction, restitution);
    else if (shape < 0.8)
        snprintf(
            collider, sizeof collider,
            "box: {center: [0, 0, 0], size: [0.3, 0.4, 0.35], along: [1, %.3f, 0.2], rounding: %s, friction: %.3f, "
            "restitution: %.3f}",
            tilt, shape < 0.7 ? "0.05" : "0", friction, restitution);
    else
        snprintf(collider, sizeof collider,
                 "plane: {point: [0, 0.2, 0], normal: [%.3f, 1, 0.1], friction: %.3f, restitution: %.3f}",
                 pick(&random, -0.2, 0.2), friction, restitution);
    // in some scenes it swings, in some it sets off and stops, under what lies on it by then
    char path[120] = "";
    if (seed % 3 == 0)
        snprintf(path, sizeof path, ", path: {amplitude: [%.3f, %.3f, 0], frequency: 1.5}", pick(&random, -0.1, 0.1),
                 pick(&random, -0.05, 0.05));
    if (seed % 3 == 1)
        snprintf(path, sizeof path, ", path: {velocity: [%.3f, %.3f, 0], from: %.3f, to: %.3f}",
                 pick(&random, -0.8, 0.8), pick(&random, -0.8, 0.8), pick(&random, 0.2, 0.35),
                 pick(&random, 0.36, 0.55));
    snprintf(
        text, size,
        "name: r%d\n%s\nsprings: {stiffness: %.1f, shear: %.1f, damping: %.3f}\ngravity: [0, -9.81, 0]\ndrag: %.2f\n"
        "colliders: [{%s%s}]\ntime: {duration: 0.6, fps: 60}\ntruth: trajectory\n",
        (int)seed, body, pick(&random, 50, 300), *body == 'c' ? pick(&random, 20, 100) : 0, pick(&random, 0, 0.05),
        pick(&random, 0, 2), collider, path);
}

static double apart(const ck_Model *model, const ck_Trajectory *one, const ck_Trajectory *other, int last) {
    double largest = 0;
    for (int frame = 0; frame <= last; frame++)
        for (int i = 0; i < model->particle_count; i++)
            largest = fmax(largest, ck_distance(ck_trajectory_position(one, frame) + 3 * i,
                                                ck_trajectory_position(other, frame) + 3 * i));
    return largest / model->size;
}

// native-verlet follows each particle's impacts through a step; the reference locates every event of the body. They
// share where a surface is and nothing of a step.
static void test_random_scenes(void **state) {
    (void)state;
    const ck_Engine *engine = ck_engine_find("native-verlet");
    const uint64_t seeds = fixture_asks_all() ? SEEDS : (SEEDS + 2) / 3;
    int whole = 0;
    for (uint64_t seed = 1; seed <= seeds; seed++) {
        char text[1500];
        Fixture fixture;
        ck_ReferencePath path;
        ck_Trajectory coarse, fine;
        ck_Error error = {0};
        write_scene(text, sizeof text, seed);
        fixture_load(&fixture, text);
        const ck_Model *model = &fixture.model;
        if (ck_reference_path_create(&path, model, &error)) fail_msg("%s\n%s", error.message, text);
        fixture_run(&coarse, model, engine, &(ck_Settings){.substeps = 512}, NULL);
        fixture_run(&fine, model, engine, &(ck_Settings){.substeps = 4096}, NULL);
        const double own = apart(model, &coarse, &fine, path.horizon),
                     off = apart(model, &fine, &path.fine, path.horizon);
        whole += path.horizon == model->frame_count;
        print_message("%2d: %.1e apart, own step %.1e, reference %.1e up to frame %d\n", (int)seed, off, own,
                      path.agreement, path.horizon);
        // at an eighth of the step a method of order a half, the least that events leave, is off by half of that
        if (!(off <= 2 * own + 2 * path.agreement)) fail_msg("seed %d is %.2g apart\n%s", (int)seed, off, text);
        ck_trajectory_free(&coarse);
        ck_trajectory_free(&fine);
        ck_reference_path_free(&path);
        fixture_free(&fixture);
    }
    // what the bound is of would be small where all had parted early; sharp edges part many
    assert_true(whole >= 0.75 * (double)seeds);
}

#define ROPE_ON_A_BALL                                                                                                 \
    "name: g\nrope: {particles: 9, spacing: 0.1, mass: 0.09, along: [1, 0, 0.1], origin: [-0.387, 0.35, 0.03]}\n"      \
    "springs: {stiffness: 200, damping: 0.05}\ngravity: [0, -9.81, 0]\ntime: {duration: 0.5, fps: 60}\n"

// Galileo: a ball that goes at one speed does to a body what one at rest does to a body that comes at it.
static void test_from_the_ball(void **state) {
    (void)state;
    Fixture moving, coming;
    fixture_load(&moving, ROPE_ON_A_BALL "colliders: [{sphere: {center: [0, 0, 0], radius: 0.3, friction: 0.5, "
                                         "restitution: 0.2}, path: {velocity: [0.5, 0.1, 0]}}]\n");
    fixture_load(&coming, ROPE_ON_A_BALL "colliders: [{sphere: {center: [0, 0, 0], radius: 0.3, friction: 0.5, "
                                         "restitution: 0.2}}]\nvelocity: [-0.5, -0.1, 0]\n");
    // to rounding where contact is of the bridge's own making; ODE's joints are soft. Bullet's deformable worlds and
    // MuJoCo look for contact by speeds, which differ.
    static const struct {
        const char *engine;
        double tolerance;
    } engines[] = {{"native-verlet", 1e-10}, {"native-xpbd", 1e-10}, {"native-bars", 1e-10},
                   {"bullet-pbd", 1e-10},    {"ode-direct", 1e-4},   {"ode-quick", 1e-4}};
    for (size_t i = 0; i < sizeof engines / sizeof *engines; i++) {
        const ck_Engine *engine = ck_engine_find(engines[i].engine);
        ck_Trajectory one, other;
        ck_Settings settings = {.substeps = 64};
        double largest = 0;
        fixture_run(&one, &moving.model, engine, &settings, NULL);
        fixture_run(&other, &coming.model, engine, &settings, NULL);
        for (int frame = 0; frame <= moving.model.frame_count; frame++)
            for (int p = 0; p < moving.model.particle_count; p++) {
                double apart[3];
                ck_subtract(apart, ck_trajectory_position(&one, frame) + 3 * p,
                            ck_trajectory_position(&other, frame) + 3 * p);
                apart[0] -= 0.5 * frame / 60;
                apart[1] -= 0.1 * frame / 60;
                largest = fmax(largest, ck_length(apart));
            }
        print_message("%-16s %.1e m\n", engine->name, largest);
        assert_near(engine->name, largest, 0, engines[i].tolerance);
        ck_trajectory_free(&one);
        ck_trajectory_free(&other);
    }
    fixture_free(&moving);
    fixture_free(&coming);
}

static void make_path(ck_ReferencePath *path, const Fixture *fixture) {
    ck_Error error = {0};
    if (ck_reference_path_create(path, &fixture->model, &error)) fail_msg("%s", error.message);
}

// What lies on a lift that stops flies on: by v²/2g above it. Its speed jumps at a frame's end and within one.
static void test_lift_that_stops(void **state) {
    (void)state;
    static const double stops[] = {0.4, 0.391};
    for (int i = 0; i < 2; i++) {
        char text[400];
        Fixture fixture;
        ck_ReferencePath path;
        snprintf(text, sizeof text,
                 "name: g\nnetwork: {nodes: [{at: [0, 0, 0], mass: 0.1}], size: 1, spacing: 0.1}\n"
                 "gravity: [0, -9.81, 0]\ntime: {duration: 1, fps: 60}\n"
                 "colliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0]}, path: {velocity: [0, 2, 0], to: %g}}]\n",
                 stops[i]);
        fixture_load(&fixture, text);
        make_path(&path, &fixture);
        for (int frame = 1; frame <= 60; frame++) {
            const double since = frame / 60.0 - stops[i], floor = 2 * stops[i];
            const double height =
                since < 0 ? 2 * frame / 60.0 : fmax(floor, floor + 2 * since - 0.5 * 9.81 * since * since);
            assert_near("height", ck_trajectory_position(&path.fine, frame)[1], height, 1e-12);
        }
        ck_reference_path_free(&path);
        fixture_free(&fixture);
    }
}

// A floor that starts towards what slides on it hits it: the impulse of the jump, and friction's share of that.
static void test_floor_that_starts(void **state) {
    (void)state;
    const double mu = 0.3, jump = 0.5, start = 0.4, g = 9.81;
    Fixture fixture;
    ck_ReferencePath path;
    fixture_load(&fixture, "name: u\nnetwork: {nodes: [{at: [0, 0, 0], mass: 0.1, velocity: [3, 0, 0]}], size: 1, "
                           "spacing: 0.1}\ngravity: [0, -9.81, 0]\ntime: {duration: 0.6, fps: 60}\n"
                           "colliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0], friction: 0.3}, path: {velocity: "
                           "[0, 0.5, 0], from: 0.4}}]\n");
    make_path(&path, &fixture);
    for (int frame = 1; frame <= 36; frame++) {
        const double time = frame / 60.0, since = fmax(0, time - start);
        const double way = 3 * time - 0.5 * mu * g * time * time - mu * jump * since;
        assert_near("way", ck_trajectory_position(&path.fine, frame)[0], way, 1e-12);
        assert_near("height", ck_trajectory_position(&path.fine, frame)[1], jump * since, 1e-12);
    }
    ck_reference_path_free(&path);
    fixture_free(&fixture);
}

// Points so dense that each is a step of its own: halving must halve those, too. The distance of the two paths, which
// the method's order takes to a sixteenth of itself, is then no smaller than that to a path of far smaller steps.
static void test_dense_points(void **state) {
    (void)state;
    char text[40000];
    Fixture fixture;
    ck_ReferencePath path;
    ck_Trajectory finer;
    int length = snprintf(text, sizeof text,
                          "name: fc\nrope: {particles: 6, spacing: 0.1, mass: 0.06}\nsprings: {stiffness: 20}\n"
                          "pins: [first]\ngravity: [0, -9.81, 0]\ntime: {duration: 1, fps: 10}\n"
                          "moves: [{pins: [first], path: {points: [");
    for (int i = 0; i <= 250; i++)
        length += snprintf(text + length, sizeof text - (size_t)length, "%s[%.17g, 0, %.17g, 0]", i ? ", " : "",
                           0.004 * i, 0.05 * sin(75 * 0.004 * i));
    snprintf(text + length, sizeof text - (size_t)length, "]}}]\n");
    fixture_load(&fixture, text);
    make_path(&path, &fixture);
    assert_int_equal(ck_reference_integrate(&finer, &fixture.model, 16 * path.substeps, 0, 0, NULL), CK_OK);
    const double off = apart(&fixture.model, &path.fine, &finer, path.horizon);
    print_message("agrees to %.1e, off by %.1e at %d substeps\n", path.agreement, off, path.substeps);
    assert_true(path.agreement > 0);
    // and what as many steps round, at random
    assert_true(off <= path.agreement + DBL_EPSILON * sqrt(16.0 * path.substeps * fixture.model.frame_count));
    ck_trajectory_free(&finer);
    ck_reference_path_free(&path);
    fixture_free(&fixture);
}

// A plate and a rod that are far thinner than a step is long stop what falls on them all the same.
static void test_thin(void **state) {
    (void)state;
    static const char *const colliders[] = {
        "{box: {center: [0, -0.0025, 0], size: [1, 0.005, 1]}}",
        "{capsule: {from: [-1, -0.003, 0], to: [1, -0.003, 0], radius: 0.003}}",
        "{box: {center: [0, -1.0025, 0], size: [1, 0.005, 1]}, path: {velocity: [0, 10, 0], to: 0.1}}"};
    for (int i = 0; i < 3; i++) {
        char text[500];
        Fixture fixture;
        ck_ReferencePath path;
        snprintf(
            text, sizeof text,
            "name: p\nnetwork: {nodes: [{at: [0, 1, 0], mass: 0.1, velocity: [0, -20, 0]}], size: 1, spacing: 0.1}\n"
            "time: {duration: 0.2, fps: 60}\ncolliders: [%s]\n",
            colliders[i]);
        fixture_load(&fixture, text);
        make_path(&path, &fixture);
        for (int frame = 7; frame <= 12; frame++) {
            // what is met by the third, rises with it, and flies on when that stops
            const double height = i < 2 ? 0 : 10 * frame / 60.0 - 1;
            assert_near(colliders[i], ck_trajectory_position(&path.fine, frame)[1], height, 1e-12);
        }
        ck_reference_path_free(&path);
        fixture_free(&fixture);
    }
}

// Between planes that close, nothing is known from some time on; that is said at once.
static void test_closing_planes(void **state) {
    (void)state;
    static const double restitutions[] = {0, 0.999, 1};
    for (int i = 0; i < 3; i++) {
        char text[600];
        Fixture fixture;
        ck_ReferencePath path;
        ck_Error error = {0};
        snprintf(
            text, sizeof text,
            "name: h\nnetwork: {nodes: [{at: [0, 0.5, 0], mass: 0.1}], size: 1, spacing: 0.1}\n"
            "time: {duration: 1, fps: 60}\ncolliders:\n"
            "  - {plane: {point: [0, 0, 0], normal: [0, 1, 0], restitution: %g}, path: {velocity: [0, 0.6, 0]}}\n"
            "  - {plane: {point: [0, 1, 0], normal: [0, -1, 0], restitution: %g}, path: {velocity: [0, -0.6, 0]}}\n",
            restitutions[i], restitutions[i]);
        fixture_load(&fixture, text);
        assert_int_equal(ck_reference_path_create(&path, &fixture.model, &error), CK_REFUSED);
        print_message("e = %g: %s\n", restitutions[i], error.message);
        ck_reference_path_free(&path);
        fixture_free(&fixture);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_closed_forms),
                                       cmocka_unit_test(test_random_scenes),
                                       cmocka_unit_test(test_from_the_ball),
                                       cmocka_unit_test(test_lift_that_stops),
                                       cmocka_unit_test(test_floor_that_starts),
                                       cmocka_unit_test(test_dense_points),
                                       cmocka_unit_test(test_thin),
                                       cmocka_unit_test(test_closing_planes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
