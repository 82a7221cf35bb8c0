// What is read off paths whose answer is known: periods, energies, sags.
#include "fixture_truth.h"

#include "runge_kutta.h"
#include "springs.h"

static double metric_of(const TruthFixture *fixture, const ck_Trajectory *path, const char *name) {
    const ck_Reference none = {0};
    return ck_metric_value(ck_metric_find(name), &fixture->model, path, &none);
}

static void integrate(TruthFixture *fixture, ck_Trajectory *path, const char *text, int substeps) {
    ck_Error error = {0};
    fixture_load_truth(fixture, text);
    if (ck_reference_integrate(path, &fixture->model, substeps, 0, 0, &error)) fail_msg("%s", error.message);
}

#define CLIMBER                                                                                                        \
    "name: climber\nrope: {particles: 2, spacing: 20, mass: 2.0e-6, end_mass: 60, along: [0, -1, 0], origin: %s}\n"    \
    "springs: {stiffness: 560.5714285714286, damping: %g}\npins: [first]\nvelocity: %s\ngravity: [0, -9.81, 0]\n"      \
    "time: {duration: %g, step: 0.01}\n"

// A weight on a spring swings in 2π√(m/k), with damping in 2π/√(k/m − (c/2m)²), wherever its rest is, however it
// starts, wherever the origin is, and however long the path goes on once the swing has died.
static void test_period(void **state) {
    (void)state;
    static const struct {
        const char *origin, *velocity;
        double damping, duration;
    } cases[] = {
        {"[0, 0, 0]", "[0, -0.5, 0]", 0, 5},   {"[0, 0, 0]", "[0, -0.5, 0]", 0, 20},
        {"[0, 0, 0]", "[0, 0, 0]", 0, 10},     {"[1000, 1000, -500]", "[0, -0.5, 0]", 0, 10},
        {"[0, 0, 0]", "[0, -0.5, 0]", 20, 10}, {"[0, 0, 0]", "[0, 0, 0]", 40, 120},
        {"[3, 5, 7]", "[0, -2, 0]", 40, 120},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[600];
        TruthFixture fixture;
        ck_Trajectory path;
        snprintf(text, sizeof text, CLIMBER, cases[i].origin, cases[i].damping, cases[i].velocity, cases[i].duration);
        integrate(&fixture, &path, text, 16);
        double k = fixture.model.springs[0].stiffness, m = fixture.model.mass[1], decay = cases[i].damping / m / 2;
        double exact = 2 * 3.14159265358979323846 / sqrt(k / m - decay * decay);
        double unsure = ck_metric_find("period")->unsure(&fixture.model, &path);
        assert_near("period", metric_of(&fixture, &path, "period"), exact, 1e-9 * exact + unsure);
        assert_near("what is unsure of it", unsure, 0, 1e-6 * exact);
        ck_trajectory_free(&path);
        fixture_free_truth(&fixture);
    }
}

// A pendulum in a side wind swings about where both pull it: as one without wind under |g + F/m|, from that angle.
static void test_period_in_wind(void **state) {
    (void)state;
    TruthFixture fixture;
    ck_Trajectory path;
    fixture_load_truth(
        &fixture, "name: wind\nrope: {particles: 2, spacing: 1, mass: 2, along: [0, -1, 0]}\nsprings: {rigid: true}\n"
                  "pins: [first]\ngravity: [0, -9.81, 0]\nforce: [4, 0, 0]\ntime: {duration: 12, step: 0.01}\n");
    fixture_run(&path, &fixture.model, ck_engine_find("native-rope"), &(ck_Settings){.substeps = 100}, NULL);
    double pull = hypot(9.81, 4), start = atan2(4, 9.81), a = 1, b = cos(0.5 * start);
    for (int i = 0; i < 8; i++) {
        double mean = 0.5 * (a + b);
        b = sqrt(a * b);
        a = mean;
    }
    // second order in ω·dt = 3e-4: off by (ω·dt)²/24
    assert_near("period", metric_of(&fixture, &path, "period"), 2 * 3.14159265358979323846 / sqrt(pull) / a, 1e-6);
    ck_trajectory_free(&path);
    fixture_free_truth(&fixture);
}

// A bar that hangs still has no period, whatever rounding leaves of motion.
static void test_no_period(void **state) {
    (void)state;
    TruthFixture fixture;
    fixture_load_truth(&fixture, "name: still\nrope: {particles: 2, spacing: 1, mass: 1, along: [0, -1, 0]}\n"
                                 "springs: {rigid: true}\npins: [first]\ngravity: [0, -9.81, 0]\n"
                                 "time: {duration: 5, step: 0.016666666666666666}\ntruth: vertical_chain\n");
    for (int i = 0; i < ck_engine_count(); i++) {
        ck_Trajectory path;
        if (!fixture_is_solver(ck_engine_at(i)) || !fixture_takes(ck_engine_at(i), &fixture.model)) continue;
        fixture_run(&path, &fixture.model, ck_engine_at(i), NULL, NULL);
        if (!isnan(metric_of(&fixture, &path, "period"))) fail_msg("%s has a period", ck_engine_at(i)->name);
        // at an error of 1e-8 of its size it has gained no energy either
        assert_near(ck_engine_at(i)->name, ck_energy_motion_gain(&fixture.model, &path), 0, 1e-3);
        ck_trajectory_free(&path);
    }
    fixture_free_truth(&fixture);
}

// A pendulum that loses what it swings with has drifted as far as one that gains it; what drag takes is no drift.
static void test_energy_drift(void **state) {
    (void)state;
    TruthFixture fixture;
    ck_Trajectory path;
    static const char swing[] =
        "name: swing\nrope: {particles: 2, spacing: 0.8, mass: 2.0, along: [1, 0, 0]}\nsprings: {stiffness: 4000, "
        "damping: %g}\npins: [first]\ngravity: [0, -9.81, 0]\ndrag: %g\ntime: {duration: 3, step: 0.001}\n";
    for (int damped = 0; damped < 2; damped++) {
        char text[400];
        snprintf(text, sizeof text, swing, damped ? 2.0 : 0.0, damped ? 0.5 : 0.0);
        integrate(&fixture, &path, text, 16);
        // frames of 1 ms sum the damping to 1e-5 of it
        assert_near("right", metric_of(&fixture, &path, "energy_drift"), 0, 1e-6);
        // the same places passed at half the speed: three quarters of the kinetic energy are gone, which at the
        // bottom is all that there was but for the spring's (3·m·g)²/2k, 1.4 % of m·g·L
        for (int frame = 1; frame < path.frame_count; frame++)
            for (int i = 0; i < 6; i++) ck_trajectory_velocity(&path, frame)[i] *= 0.5;
        double lost = metric_of(&fixture, &path, "energy_drift");
        if (!damped) assert_near("half the speed", lost, 0.75, 0.015);
        if (damped && !(lost > 0.1)) fail_msg("losing half the speed scores %g", lost);
        ck_trajectory_free(&path);
        fixture_free_truth(&fixture);
    }
}

// Only free particles sag: a rope whose lowest point is a pin sags by what hangs between.
static void test_sag_of_free(void **state) {
    (void)state;
    TruthFixture fixture;
    fixture_load_truth(&fixture,
                       "name: slope\nnetwork: {nodes: [{at: [0, 0, 0], mass: 1}, {at: [1, -1, 0], mass: 1}, {at: "
                       "[2, -3, 0], mass: 1}], bars: [[0, 1], [1, 2]]}\nsprings: {stiffness: 100}\n"
                       "pins: [first, last]\ngravity: [0, -10, 0]\ntime: {duration: 1, step: 0.1}\n");
    ck_Trajectory path;
    assert_int_equal(ck_trajectory_create(&path, &fixture.model, NULL), CK_OK);
    memcpy(path.data, fixture.model.position, 9 * sizeof(double));
    path.frame_count = 1;
    assert_near("sag", metric_of(&fixture, &path, "sag"), 1 / fixture.model.size, 1e-12);
    path.data[3 + 1] = -2.5;
    assert_near("sag", metric_of(&fixture, &path, "sag"), 2.5 / fixture.model.size, 1e-12);
    ck_trajectory_free(&path);
    fixture_free_truth(&fixture);
}

// What a swinging body accelerates by is no jitter; the largest strain of a run is not the last one's.
static void test_moving(void **state) {
    (void)state;
    TruthFixture fixture;
    ck_Trajectory path;
    char text[600];
    snprintf(text, sizeof text, CLIMBER, "[0, 0, 0]", 0.0, "[0, 0, 0]", 6.0);
    integrate(&fixture, &path, text, 16);
    assert_true(isnan(metric_of(&fixture, &path, "jitter")));
    // let go unstretched it bounces to twice the strain at rest
    double rest = 60 * 9.81 / 560.5714285714286 / 20;
    assert_near("peak", metric_of(&fixture, &path, "stretch_peak"), 2 * rest, 1e-4 * rest);
    // and pulls with twice its weight, which is what the pin holds then; a frame may be half a one off the turn,
    // and the pin's force is the mean of one
    assert_near("tension", metric_of(&fixture, &path, "tension_peak"), 2 * 60 * 9.81, 1e-3 * 60 * 9.81);
    assert_near("pin", metric_of(&fixture, &path, "pin_force_peak"), 2, 1e-3);
    assert_near("deepest", metric_of(&fixture, &path, "sag_peak"), (20 + 40 * rest) / 20, 1e-4 * rest);
    ck_trajectory_free(&path);
    fixture_free_truth(&fixture);
}

static double truth_of_pins(const TruthFixture *fixture) {
    return ck_metric_truth(ck_metric_find("pin_force"), &fixture->model, &fixture->truth.reference);
}

// At rest pins hold the weight, hinges' share with it: a strip clamped at its end, a net by two corners.
static void test_pins_hold_the_weight(void **state) {
    (void)state;
    static const char *const cases[] = {
        "name: strip\nrope: {particles: 12, spacing: 0.05, mass: 0.1, along: [1, 0, 0]}\nsprings: {stiffness: 3000}\n"
        "bending: {stiffness: 0.05}\npins: ['0', '1']\ngravity: [0, -9.81, 0]\ndrag: 4\n"
        "time: {duration: 3, fps: 60}\ntruth: equilibrium\n",
        "name: net\ncloth: {rows: 6, columns: 6, spacing: 0.1, mass: 0.2, down: [0, 0, 1]}\n"
        "springs: {stiffness: 200, shear: 100}\npins: [top_left, top_right]\ngravity: [1, -9.81, 0]\ndrag: 4\n"
        "time: {duration: 3, fps: 60}\ntruth: equilibrium\n",
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        TruthFixture fixture;
        ck_Error error = {0};
        fixture_load_truth(&fixture, cases[i]);
        if (ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, &error)) fail_msg("%s", error.message);
        // forces are balanced to 1e-10 of the load
        assert_near("pulled", metric_of(&fixture, &fixture.truth.reference.trajectory, "pin_force"), 1, 1e-9);
        assert_near("held", truth_of_pins(&fixture), 1, 1e-12);
        fixture_free_truth(&fixture);
    }
}

// Of a beam that does not stretch, what its springs pull is not known, and what its clamp holds is: the weight. On a
// path that a collider pushes at it is not, as the reference does not tell how hard.
static void test_pins_of_other_truths(void **state) {
    (void)state;
    static const char *const cases[] = {
        "name: beam\nrope: {particles: 22, spacing: 0.02, mass: 0.022, along: [1, 0, 0]}\nsprings: {stiffness: "
        "20000}\nbending: {stiffness: 0.005}\npins: [0, 1]\ngravity: [0, -9.81, 0]\ndrag: 10\n"
        "time: {duration: 1, fps: 60}\ntruth: cantilever\n",
        "name: floor\ncloth: {rows: 4, columns: 4, spacing: 0.1, mass: 0.1, origin: [0, 0.1, 0], down: [0, 0, 1]}\n"
        "springs: {stiffness: 50, shear: 25, damping: 0.02}\npins: [top_edge]\ngravity: [0, -9.81, 0]\ndrag: 4\n"
        "colliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0]}}]\ntime: {duration: 0.5, fps: 30}\n"
        "truth: trajectory\n"};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        TruthFixture fixture;
        ck_Error error = {0};
        fixture_load_truth(&fixture, cases[i]);
        if (ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, &error)) fail_msg("%s", error.message);
        assert_true(fixture.truth.reference.trajectory.frame_count > 0);
        if (i == 0)
            assert_near("clamp", truth_of_pins(&fixture), 1, 1e-12);
        else if (!isnan(truth_of_pins(&fixture)))
            fail_msg("%g is known beside a floor", truth_of_pins(&fixture));
        fixture_free_truth(&fixture);
    }
}

// The pull that springs and hinges have at a frame, where a path of it alone starts.
static double pull_at(const TruthFixture *fixture, const ck_Trajectory *path, int frame) {
    ck_Trajectory alone = *path;
    alone.data += 6 * (size_t)path->particle_count * (size_t)frame;
    alone.frame_count = 1;
    return metric_of(fixture, &alone, "pin_force");
}

static double held_until(const TruthFixture *fixture, const ck_Trajectory *path, int frame) {
    ck_Trajectory until = *path;
    until.frame_count = frame + 1;
    return metric_of(fixture, &until, "pin_force");
}

// The farthest that the force by momentum is from the mean of springs' pulls at both ends of a frame.
static double force_gap(const char *text, int fps) {
    TruthFixture fixture;
    ck_Trajectory path;
    double gap = 0;
    char whole[1200];
    snprintf(whole, sizeof whole, text, fps);
    integrate(&fixture, &path, whole, 6400 / fps);
    for (int frame = 1; frame < path.frame_count; frame++) {
        const double mean = 0.5 * (pull_at(&fixture, &path, frame - 1) + pull_at(&fixture, &path, frame));
        gap = fmax(gap, fabs(held_until(&fixture, &path, frame) - mean));
    }
    ck_trajectory_free(&path);
    fixture_free_truth(&fixture);
    return gap;
}

// What momentum says of the pins is what springs and hinges pull, whatever else drives a body: both differ by what the
// rule of two ends leaves, of second order in the frame.
static void test_momentum_tells_the_pins(void **state) {
    (void)state;
    static const char *const cases[] = {
        "name: wind\ncloth: {rows: 4, columns: 5, spacing: 0.1, mass: 0.1, down: [0, -1, 0]}\n"
        "springs: {stiffness: 60, shear: 30, damping: 0.05}\nbending: {stiffness: 0.02}\npins: [left_edge]\n"
        "wind: {velocity: [3, 0, 2], drag: 1.2, lift: 0.6}\ngravity: [0, -9.81, 0]\ndrag: 0.7\n"
        "time: {duration: 0.5, fps: %d}\n",
        "name: moved\ncloth: {rows: 4, columns: 4, spacing: 0.1, mass: 0.1, down: [0, -1, 0]}\n"
        "springs: {stiffness: 60, shear: 30}\npins: [top_edge]\n"
        "moves: [{pins: [top_edge], path: {amplitude: [0, 0.004, 0], frequency: 2}}]\ngravity: [0, -9.81, 0]\n"
        "drag: 2\ntime: {duration: 0.5, fps: %d}\n",
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double coarse = force_gap(cases[i], 200), fine = force_gap(cases[i], 400);
        if (!(coarse < 0.02 && fine < coarse / 3)) fail_msg("case %zu: %g and %g apart", i, coarse, fine);
    }
}

// What holds is asked of the solver, not of its springs: a pendulum of a rigid bar that is let go level holds three
// times its weight at the bottom, and bars that rest hold all of it. Once a pin has let
// go the other holds what it held, and that of the freed particle: four of what were three at the start.
static void test_force_of_the_solver(void **state) {
    (void)state;
    static const char *const pendulum =
        "name: pendulum\nrope: {particles: 2, spacing: 1, mass: 2, along: [1, 0, 0]}\nsprings: {rigid: true}\n"
        "pins: [first]\ngravity: [0, -9.81, 0]\ntime: {duration: 1, fps: 200}\n";
    static const char *const net =
        "name: net\ncloth: {rows: 6, columns: 6, spacing: 0.1, mass: 0.2, down: [0, 0, 1]}\n"
        "springs: {stiffness: 200, shear: 100}\npins: [top_left, top_right]\ngravity: [0, -9.81, 0]\ndrag: 4\n"
        "time: {duration: 6, fps: 60}\n";
    static const char *const dropped =
        "name: dropped\nrope: {particles: 5, spacing: 0.1, mass: 0.1, along: [1, 0, 0]}\nsprings: {stiffness: 500}\n"
        "pins: ['0', '4']\nrelease: [{at: 0.5, pins: ['4']}]\ngravity: [0, -9.81, 0]\ndrag: 8\n"
        "time: {duration: 4, fps: 60}\n";
    static const struct {
        const char *text, *engine, *metric;
        double force, within;
    } cases[] = {
        // the lowest point is at most half a frame off: 3·(ω·h/2)²/2, and a mean over one costs a third of it
        {pendulum, "native-rope", "pin_force_peak", 3, 3 * (2 * 9.81) * 0.0025 * 0.0025},
        {pendulum, "native-bars", "pin_force_peak", 3, 3 * (2 * 9.81) * 0.0025 * 0.0025},
        {net, "native-bars", "pin_force", 1, 1e-3},
        {net, "native-xpbd", "pin_force", 1, 1e-3},
        {net, "native-lines", "pin_force", 1, 1e-3},
        {net, "ode-quick", "pin_force", 1, 1e-3},
        {dropped, "native-verlet", "pin_force", 4 / 3.0, 1e-3},
        {dropped, "native-bars", "pin_force", 4 / 3.0, 1e-3},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        TruthFixture fixture;
        ck_Trajectory path;
        fixture_load_truth(&fixture, cases[i].text);
        fixture_run(&path, &fixture.model, ck_engine_find(cases[i].engine), NULL, NULL);
        assert_near(cases[i].engine, metric_of(&fixture, &path, cases[i].metric), cases[i].force, cases[i].within);
        ck_trajectory_free(&path);
        fixture_free_truth(&fixture);
    }
}

// A cloth that is held by its edge and lies on the floor with the rest: what pins and floor bear is the weight. Where
// an engine tells no force of the floor, or of parts of a frame alone, and where a scene changes, the pins' is not
// known, at no frame.
static void test_pins_beside_a_floor(void **state) {
    (void)state;
    static const struct {
        const char *engine, *more;
        bool is_known;
    } cases[] = {{"native-verlet", "", true},
                 {"ode-direct", "", true},
                 {"bullet-pbd", "", false},
                 {"native-verlet", "jitter: 0.3", false},
                 {"native-verlet", "changes", false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        TruthFixture fixture;
        ck_Trajectory path;
        char text[800];
        const bool changes = !strcmp(cases[i].more, "changes");
        snprintf(text, sizeof text,
                 "name: floor\ncloth: {rows: 5, columns: 5, spacing: 0.1, mass: 0.1, origin: [0, 0.1, 0], down: "
                 "[0, 0, 1]}\nsprings: {stiffness: 50, shear: 25, damping: 0.02}\npins: [top_edge]\ngravity: [0, "
                 "-9.81, 0]\ndrag: 4\n%stime: {duration: 4, fps: 30%s%s}\n",
                 changes ? "changes: [{at: 2, set: '@gravity=[0, -5, 0]'}]\n"
                         : "colliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0]}}]\n",
                 *cases[i].more && !changes ? ", " : "", changes ? "" : cases[i].more);
        fixture_load_truth(&fixture, text);
        fixture_run(&path, &fixture.model, ck_engine_find(cases[i].engine), NULL, NULL);
        const double force = metric_of(&fixture, &path, "pin_force"),
                     most = metric_of(&fixture, &path, "pin_force_peak");
        if (cases[i].is_known != !isnan(force) || cases[i].is_known != !isnan(most))
            fail_msg("%s %s: %g, at most %g", cases[i].engine, cases[i].more, force, most);
        if (cases[i].is_known) {
            const double weight = ck_model_free_mass(&fixture.model) * 9.81,
                         floor = path.contact[3 * (path.frame_count - 1) + 1] / weight;
            assert_true(floor > 0.1);
            // nothing pulls aside on what lies without friction
            assert_near(cases[i].engine, force + floor, 1, 1e-3);
        }
        ck_trajectory_free(&path);
        fixture_free_truth(&fixture);
    }
}

// A cloth that lies on the floor is all on it; one that is moved into it by three spacings is inside as long.
static void test_on_the_floor(void **state) {
    (void)state;
    TruthFixture fixture;
    ck_Trajectory path;
    fixture_load_truth(&fixture, "name: floor\ncloth: {rows: 3, columns: 3, spacing: 0.1, mass: 0.1, down: [0, 0, 1]}\n"
                                 "springs: {stiffness: 50}\ngravity: [0, -9.81, 0]\ntime: {duration: 1, fps: 10}\n"
                                 "colliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0]}}]\ntruth: rest\n");
    fixture_run(&path, &fixture.model, ck_engine_find("native-verlet"), NULL, NULL);
    assert_near("share", metric_of(&fixture, &path, "contact_share"), 1, 0);
    assert_near("inside", metric_of(&fixture, &path, "penetration_time"), 0, 0);
    for (int frame = 3; frame < 6; frame++) ck_trajectory_position(&path, frame)[1] = -0.3;
    assert_near("inside", metric_of(&fixture, &path, "penetration_time"), 0.3, 1e-15);
    ck_trajectory_free(&path);
    fixture_free_truth(&fixture);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_period),
        cmocka_unit_test(test_period_in_wind),
        cmocka_unit_test(test_no_period),
        cmocka_unit_test(test_energy_drift),
        cmocka_unit_test(test_sag_of_free),
        cmocka_unit_test(test_moving),
        cmocka_unit_test(test_pins_hold_the_weight),
        cmocka_unit_test(test_pins_of_other_truths),
        cmocka_unit_test(test_momentum_tells_the_pins),
        cmocka_unit_test(test_force_of_the_solver),
        cmocka_unit_test(test_pins_beside_a_floor),
        cmocka_unit_test(test_on_the_floor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
