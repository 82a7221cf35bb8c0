// One suite that every engine of the table passes. Tolerances come from theory: rounding, or a method's own prediction.
#include "fixture_truth.h"

#include "prediction.h"
#include "runner.h"
#include "trial.h"
#include "vector.h"

#include <glob.h>

static const char fall[] =
    "name: fall\ncloth: {rows: 3, columns: 3, spacing: 0.1, mass: 0.1, down: [0, 0, 1]}\nsprings: {stiffness: 50, "
    "shear: 20}\n"
    "gravity: [1, -9.81, 0]\nvelocity: [0.5, 2, -1]\ntime: {duration: 0.5, step: 0.01}\ntruth: free_fall\n";
static const char swing[] = "name: swing\nrope: {particles: 2, spacing: 1, mass: 2, along: [1, 0, 0]}\nsprings: "
                            "{stiffness: 100, damping: 0.5}\npins: [first]\n"
                            "velocity: [0.1, 0, 0]\ntime: {duration: 1, step: 0.02}\ntruth: oscillator\n";
static const char hang[] = "name: hang\nrope: {particles: 8, spacing: 0.1, mass: 0.4}\nsprings: {stiffness: 2000, "
                           "damping: 0.2}\npins: [first]\n"
                           "gravity: [0, -9.81, 0]\ndrag: 12\ntime: {duration: 4, step: 0.02}\ntruth: vertical_chain\n";
static const char drift[] =
    "name: drift\ncloth: {rows: 4, columns: 4, spacing: 0.1, mass: 0.16}\nsprings: {stiffness: 40, damping: 0.01, "
    "shear: 20}\n"
    "noise: {amplitude: 0.02, seed: 3}\nvelocity: [1, -2, 0.5]\ntime: {duration: 0.5, step: 0.01}\n";
static const char net[] = "name: net\ncloth: {rows: 4, columns: 5, spacing: 0.1, mass: 0.2, down: [0, -1, "
                          "0]}\nsprings: {stiffness: 300, damping: 0.05, shear: 100}\n"
                          "pins: [top_edge]\nforce: [0.02, 0, 0.05]\ngravity: [0, -9.81, 0]\ndrag: 6\ntime: {duration: "
                          "6, step: 0.02}\ntruth: equilibrium\n";
// a pendulum of one spring, which also turns: nothing about it is linear
static const char turn[] = "name: turn\nrope: {particles: 2, spacing: 1, mass: 2, along: [1, 0, 0]}\nsprings: "
                           "{stiffness: 400, damping: 1}\npins: [first]\n"
                           "gravity: [0, -9.81, 0]\ntime: {duration: 0.4, step: 0.02}\n";
static const char turn_rigid[] = "name: turn_rigid\nrope: {particles: 2, spacing: 1, mass: 2, along: [1, 0, "
                                 "0]}\nsprings: {rigid: true}\npins: [first]\n"
                                 "gravity: [0, -9.81, 0]\ntime: {duration: 0.4, step: 0.02}\n";

// The rms distance, / size, of a run to what theory predicts of it; NaN where there is no theory.
static double distance_to_prediction(const TruthFixture *fixture, const ck_Trajectory *trajectory,
                                     const ck_Engine *engine, const ck_Settings *used) {
    ck_Reference prediction;
    assert_int_equal(ck_prediction_create(&prediction, &fixture->model, engine, used, &fixture->truth, NULL, NULL),
                     CK_OK);
    double distance = ck_metric_value(ck_metric_find("position_rms"), &fixture->model, trajectory, &prediction);
    ck_trajectory_free(&prediction.trajectory);
    return distance;
}

static void check_prediction(const char *text, const ck_Settings *settings, double tolerance) {
    TruthFixture fixture;
    fixture_load_truth(&fixture, text);
    assert_int_equal(ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, NULL), CK_OK);
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!fixture_is_solver(engine) || !fixture_takes(engine, &fixture.model)) continue;
        ck_Trajectory trajectory;
        ck_Settings used;
        fixture_run(&trajectory, &fixture.model, engine, settings, &used);
        double distance = distance_to_prediction(&fixture, &trajectory, engine, &used);
        if (!isnan(distance)) assert_near(engine->name, distance, 0, tolerance);
        if (isnan(distance) && engine->order) fail_msg("%s has no theory on %s", engine->name, fixture.model.name);
        ck_trajectory_free(&trajectory);
    }
    fixture_free_truth(&fixture);
}

// Free fall has a closed form for each method: only rounding may be left, some 1e-16 for each of ~1e3 substeps.
static void test_free_fall(void **state) {
    (void)state;
    check_prediction(fall, NULL, 1e-11);
}

// A fall with drag, too, and so the energy: the speed is that at the time of the place, whatever a method keeps.
// Rounding of positions of 10 m, 1e-15, in a difference over a substep of 1e-3 s, and in a drift of 1e-6 of the energy.
static void test_drag(void **state) {
    (void)state;
    static const char sheet[] =
        "name: dragged\ncloth: {rows: 3, columns: 4, spacing: 0.1, mass: 1}\nsprings: {stiffness: "
        "10}\nvelocity: [1, 0, 0.5]\ngravity: [0, -9.81, 0]\ndrag: 2\n"
        "time: {duration: 1, step: 0.02}\ntruth: terminal_speed\n";
    const ck_Metric *energy = ck_metric_find("energy_drift");
    check_prediction(sheet, NULL, 1e-11);
    TruthFixture fixture;
    fixture_load_truth(&fixture, sheet);
    assert_int_equal(ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, NULL), CK_OK);
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        ck_Trajectory path;
        ck_Settings used;
        ck_Reference prediction;
        if (!fixture_is_solver(engine) || !fixture_takes(engine, &fixture.model)) continue;
        fixture_run(&path, &fixture.model, engine, NULL, &used);
        assert_int_equal(ck_prediction_create(&prediction, &fixture.model, engine, &used, &fixture.truth, NULL, NULL),
                         CK_OK);
        const double measured = ck_metric_value(energy, &fixture.model, &path, &fixture.truth.reference),
                     foretold = ck_metric_value(energy, &fixture.model, &prediction.trajectory, &prediction);
        if (!isnan(foretold)) assert_near(engine->name, measured / foretold, 1, 1e-6);
        ck_trajectory_free(&path);
        ck_trajectory_free(&prediction.trajectory);
    }
    fixture_free_truth(&fixture);
}

// One spring along one line can be followed substep by substep with pencil and paper: only rounding may be left.
static void test_oscillator(void **state) {
    (void)state;
    check_prediction(swing, NULL, 1e-12);
}

// At rest every method's stretch is known, whatever its sweeps and the forces are, to what drag has left of the motion:
// exp(−12·4/2) = 4e-11 of a length, but 1e-8 of those that QuickStep's iterations leave of a spring.
static void test_static_hang(void **state) {
    (void)state;
    static const char pushed[] = "name: pushed\nrope: {particles: 8, spacing: 0.1, mass: 0.4}\nsprings: {stiffness: "
                                 "2000, damping: 0.2}\npins: [first]\ngravity: [0, -9.81, 0]\nforce: [0.1, 0.05, 0.2]\n"
                                 "drag: 6\ntime: {duration: 12, step: 0.02}\ntruth: vertical_chain\n";
    check_prediction(hang, NULL, 1e-8);
    check_prediction(pushed, NULL, 1e-8);
    // sweeps say nothing to those that have none
    for (uint32_t sweeps = 2; sweeps <= 8; sweeps *= 2)
        for (int i = 0; i < 3; i++) {
            static const char *const names[] = {"native-bars", "native-xpbd", "bullet-pbd"};
            TruthFixture fixture;
            ck_Trajectory path;
            ck_Settings used;
            fixture_load_truth(&fixture, hang);
            assert_int_equal(ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, NULL), CK_OK);
            const ck_Engine *engine = ck_engine_find(names[i]);
            fixture_run(&path, &fixture.model, engine, &(ck_Settings){.iterations = sweeps}, &used);
            assert_near(names[i], distance_to_prediction(&fixture, &path, engine, &used), 0, 1e-8);
            ck_trajectory_free(&path);
            fixture_free_truth(&fixture);
        }
}

// A rigid chain of N links under n sweeps, half of them back, stretches by g·dt²/2n times N² − N, N² + N − 2 and
// N² + N/3 − 26/9 for n = 1, 2 and 3: what the linear substep leaves at rest, solved exactly for N of 6 to 24. So much
// more sweeps help.
static void test_sweeps(void **state) {
    (void)state;
    static const char chain[] =
        "name: chain\nrope: {particles: 31, spacing: 0.1, mass: 3.1}\nsprings: {rigid: true}\npins: [first]\n"
        "gravity: [0, -9.81, 0]\ndrag: 20\ntime: {duration: 3, step: 0.02}\ntruth: vertical_chain\n";
    TruthFixture fixture;
    fixture_load_truth(&fixture, chain);
    assert_int_equal(ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, NULL), CK_OK);
    const ck_Engine *bars = ck_engine_find("native-bars");
    const double links = 30,
                 pushes[] = {links * links - links, links * links + links - 2, links * links + links / 3 - 26.0 / 9};
    for (uint32_t n = 1; n <= 4; n++) {
        ck_Settings settings = {.substeps = 40, .iterations = n}, used;
        ck_Trajectory trajectory;
        ck_Reference prediction;
        fixture_run(&trajectory, &fixture.model, bars, &settings, &used);
        assert_int_equal(ck_prediction_create(&prediction, &fixture.model, bars, &used, &fixture.truth, NULL, NULL),
                         CK_OK);
        const ck_Metric *sag = ck_metric_find("sag");
        double dt = fixture.model.step / settings.substeps, size = fixture.model.size;
        double stretch = size * (ck_metric_value(sag, &fixture.model, &trajectory, &prediction) - 1);
        double foretold = size * (ck_metric_value(sag, &fixture.model, &prediction.trajectory, &prediction) - 1);
        // drag eases gravity's push by 1/(1 + drag·dt/2) = 0.5 %, and bars strained by up to 0.2 % before a sweep,
        // which takes L² for d·d_start, are corrected by that much more
        if (n < 4)
            assert_near("the stretch of swept bars, as a share of the law's",
                        stretch / (9.81 * dt * dt * pushes[n - 1] / (2 * n)), 1, 0.01);
        // of four sweeps the law has no short form
        assert_near("the predicted stretch, as a share", foretold / stretch, 1, 1e-4);
        ck_trajectory_free(&trajectory);
        ck_trajectory_free(&prediction.trajectory);
    }
    fixture_free_truth(&fixture);
}

// A network at rest: the exact methods find the minimum of its energy, and what the sweeping ones miss, theory
// explains, to what drag has left of the motion.
static void test_network_at_rest(void **state) {
    (void)state;
    TruthFixture fixture;
    fixture_load_truth(&fixture, net);
    assert_int_equal(ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, NULL), CK_OK);
    assert_true(fixture.truth.path_count > 0);
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!fixture_is_solver(engine) || !fixture_takes(engine, &fixture.model)) continue;
        ck_Trajectory trajectory;
        ck_Settings used;
        // the theory is that of one sweep; bars would choose four here
        fixture_run(&trajectory, &fixture.model, engine, engine->order ? NULL : &(ck_Settings){.iterations = 1}, &used);
        double error =
            ck_metric_value(ck_metric_find("position_rms"), &fixture.model, &trajectory, &fixture.truth.reference);
        double unexplained = distance_to_prediction(&fixture, &trajectory, engine, &used);
        print_message("%-16s off by %.1e, unexplained %.1e\n", engine->name, error, unexplained);
        assert_near(engine->name, unexplained, 0, 1e-7);
        ck_trajectory_free(&trajectory);
    }
    fixture_free_truth(&fixture);
}

static void center_of_mass(const ck_Model *model, const double *position, double *center) {
    double total = 0;
    memset(center, 0, 3 * sizeof(double));
    for (int i = 0; i < model->particle_count; i++) {
        ck_add_scaled(center, model->mass[i], position + 3 * i);
        total += model->mass[i];
    }
    for (int axis = 0; axis < 3; axis++) center[axis] /= total;
}

// Internal forces cannot move the centre of mass, nor turn the body. Bullet's conjugate gradient stops at 2e-16 of the
// squared residual, so that 1e-8 of the speed may be left per step.
static void test_momentum(void **state) {
    (void)state;
    TruthFixture fixture;
    fixture_load_truth(&fixture, drift);
    const ck_Model *model = &fixture.model;
    double start[3], end[3];
    center_of_mass(model, model->position, start);
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!fixture_is_solver(engine) || !fixture_takes(engine, &fixture.model)) continue;
        ck_Trajectory trajectory;
        fixture_run(&trajectory, model, engine, NULL, NULL);
        center_of_mass(model, ck_trajectory_position(&trajectory, model->frame_count), end);
        for (int axis = 0; axis < 3; axis++)
            assert_near(engine->name, end[axis] - start[axis], model->duration * model->velocity[axis], 1e-8);
        // the noise has moved it: a frozen body would pass as well
        double first = ck_metric_find("stretch_rms")->at(model, &trajectory, 0, &fixture.truth.reference);
        double last =
            ck_metric_find("stretch_rms")->at(model, &trajectory, model->frame_count, &fixture.truth.reference);
        assert_true(fabs(last - first) > 0.1 * first);
        ck_trajectory_free(&trajectory);
    }
    fixture_free_truth(&fixture);
}

// Order from three runs at dt, dt/2 and dt/4, without any truth: log2 of the ratio of their differences. The next term
// of the error, at these steps some ω·dt = 0.01 of the first, allows 0.15.
static void test_order(void **state) {
    (void)state;
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!fixture_is_solver(engine)) continue;
        TruthFixture fixture;
        fixture_load_truth(&fixture, engine->order ? turn : turn_rigid);
        if (!fixture_takes(engine, &fixture.model)) {
            fixture_free_truth(&fixture);
            continue;
        }
        ck_Trajectory trajectory[3];
        for (int level = 0; level < 3; level++) {
            ck_Settings settings = {.substeps = 40u << level};
            fixture_run(&trajectory[level], &fixture.model, engine, &settings, NULL);
        }
        const ck_Metric *distance = ck_metric_find("position_rms");
        double coarse = distance->between(&fixture.model, &trajectory[0], &trajectory[1]);
        double fine = distance->between(&fixture.model, &trajectory[1], &trajectory[2]);
        char what[100];
        snprintf(what, sizeof what, "the order of %s (differences %.3g and %.3g)", engine->name, coarse, fine);
        // bars follow the field to second order, and have no elastic motion to be counted by
        assert_near(what, log2(coarse / fine), engine->order ? engine->order : 2, 0.15);
        for (int level = 0; level < 3; level++) ck_trajectory_free(&trajectory[level]);
        fixture_free_truth(&fixture);
    }
}

// The same bits twice in one process, which shares what engines keep in globals.
static void test_bitwise_repeat(void **state) {
    (void)state;
    const char *const texts[] = {hang, drift, turn};
    for (size_t text = 0; text < sizeof texts / sizeof *texts; text++) {
        TruthFixture fixture;
        fixture_load_truth(&fixture, texts[text]);
        for (int i = 0; i < ck_engine_count(); i++) {
            ck_Trajectory first, second;
            if (!fixture_takes(ck_engine_at(i), &fixture.model)) continue;
            fixture_run(&first, &fixture.model, ck_engine_at(i), NULL, NULL);
            fixture_run(&second, &fixture.model, ck_engine_at(i), NULL, NULL);
            if (memcmp(first.data, second.data, first.bytes))
                fail_msg("%s on %s differs between two runs", ck_engine_at(i)->name, fixture.model.name);
            ck_trajectory_free(&first);
            ck_trajectory_free(&second);
        }
        fixture_free_truth(&fixture);
    }
}

// An engine's distance to its own finest run grows with its step as its order says. At these pieces some ω·dt = 0.05 of
// the next term is left, and from the finest run 1/8: 2^order within 35 %. Softened springs change with the step too.
static void test_self_consistency(void **state) {
    (void)state;
    // long, and in memory what shorter ones do
    if (fixture_leaves_natives()) skip();
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (engine->method == CK_METHOD_SEED || engine->is_stock) continue;
        TruthFixture fixture;
        fixture_load_truth(&fixture, engine->order ? turn : turn_rigid);
        if (!fixture_takes(engine, &fixture.model)) {
            fixture_free_truth(&fixture);
            continue;
        }
        ck_Settings wanted = {.substeps = 64};
        ck_Limits limits = ck_limits_default();
        ck_Run run;
        assert_int_equal(ck_run_measure(&run, &fixture.model, engine, &wanted, &limits, NULL), CK_OK);
        assert_int_equal(run.status, CK_RUN_OK);
        double deviation[CK_CONSISTENCY_STEPS];
        assert_int_equal(ck_consistency_measure(deviation, &run, 100, &limits, NULL), CK_OK);
        int order = engine->order ? engine->order : engine->method == CK_METHOD_STILL ? 0 : 2;
        // the engine that stands still is consistent, and wrong
        if (!order) assert_near(engine->name, deviation[0], 0, 0);
        for (int step = 0; order && step + 1 < CK_CONSISTENCY_STEPS; step++)
            assert_near(engine->name, deviation[step + 1] / deviation[step], 1 << order, 0.35 * (1 << order));
        ck_run_free(&run);
        fixture_free_truth(&fixture);
    }
}

// Each engine says what it made of every quantity of the scene, and nothing of what the scene does not name.
static void test_ledger(void **state) {
    (void)state;
    TruthFixture fixture;
    fixture_load_truth(&fixture, "name: hang\nrope: {particles: 8, spacing: 0.1, mass: 0.4, end_mass: 0.3}\nsprings: "
                                 "{stiffness: 2000, damping: 0.2}\npins: [first]\ngravity: [0, -9.81, 0]\ndrag: 12\n"
                                 "time: {duration: 4, step: 0.02}\n");
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!fixture_is_solver(engine) || !fixture_takes(engine, &fixture.model)) continue;
        ck_Ledger ledger = {0};
        ck_Settings used, wanted = {0};
        void *world;
        assert_int_equal(ck_engine_create(engine, &world, &fixture.model, &wanted, &used, &ledger, NULL), CK_OK);
        engine->destroy(world);
        const char *const quantities[] = {
            "time step", "mass", "mass of the last", "gravity", "drag", "structural stiffness", "spring damping"};
        for (size_t quantity = 0; quantity < sizeof quantities / sizeof *quantities; quantity++) {
            bool found = false;
            for (int row = 0; row < ledger.count; row++)
                found |= !strcmp(ledger.rows[row].quantity, quantities[quantity]);
            if (!found) fail_msg("%s says nothing of %s", engine->name, quantities[quantity]);
        }
        for (int row = 0; row < ledger.count; row++) {
            assert_string_not_equal(ledger.rows[row].quantity, "shear stiffness");
            assert_string_not_equal(ledger.rows[row].quantity, "force");
        }
    }
    fixture_free_truth(&fixture);
}

// The direct solve holds a rope whatever hangs on it: a weight of 1000 times a node's, rope and all, 1 ms steps, to
// rounding; and finds the rigid catenary to what drag has left of the motion, exp(−6·5) = 1e-13.
static void test_rope(void **state) {
    (void)state;
    static const char heavy[] =
        "name: heavy\nrope: {particles: 20, spacing: 0.1, mass: 0.2, end_mass: 10, along: [1, 0, "
        "0]}\nsprings: {rigid: true}\npins: [first]\ngravity: [0, -9.81, 0]\n"
        "time: {duration: 1, step: 0.001}\n";
    static const char slack[] =
        "name: slack\nnetwork: {nodes: [{at: [0, 0, 0], mass: 0.1}, {at: [0.3, -0.4, 0], mass: 0.1}, {at: [0.8, -0.4, "
        "0], mass: 0.1}, {at: [1.1, 0, 0], mass: 0.1}], bars: [[0, 1], [1, 2], [2, 3]]}\nsprings: {rigid: true}\n"
        "pins: [first, last]\ngravity: [1, -9.81, 0]\ndrag: 12\ntime: {duration: 5, step: 0.01}\ntruth: catenary\n";
    const ck_Engine *rope = ck_engine_find("native-rope");
    TruthFixture fixture;
    ck_Trajectory trajectory;
    fixture_load_truth(&fixture, heavy);
    fixture_run(&trajectory, &fixture.model, rope, &(ck_Settings){.substeps = 1}, NULL);
    for (int frame = 0; frame <= fixture.model.frame_count; frame++)
        assert_near("stretch", ck_metric_find("stretch_max")->at(&fixture.model, &trajectory, frame, NULL), 0, 1e-10);
    // it swings: a frozen rope would not stretch either
    assert_true(ck_trajectory_position(&trajectory, 500)[3 * 19 + 1] < -0.5);
    ck_trajectory_free(&trajectory);
    fixture_free_truth(&fixture);

    fixture_load_truth(&fixture, slack);
    assert_int_equal(ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, NULL), CK_OK);
    fixture_run(&trajectory, &fixture.model, rope, NULL, NULL);
    assert_near("the rigid catenary",
                ck_metric_value(ck_metric_find("position_rms"), &fixture.model, &trajectory, &fixture.truth.reference),
                0, 1e-9);
    ck_trajectory_free(&trajectory);
    fixture_free_truth(&fixture);
}

// A level rope of 19 rigid bars that is let go: the depth of its tip after 1 s, in lengths, by an integration of the
// angles (Runge-Kutta) is 0.4384706. Where an engine chooses its own step it comes through the whip of three seconds;
// with a quarter of that step a first-order method is off by a quarter, of which half as much again is allowed.
static void test_level_rope(void **state) {
    (void)state;
    // long, and in memory what shorter ones do
    if (fixture_leaves_natives()) skip();
    static const char text[] = "name: level\nrope: {particles: 20, spacing: 0.1, mass: 1, along: [1, 0, 0]}\nsprings: "
                               "{rigid: true}\npins: [first]\ngravity: [0, -9.81, 0]\n"
                               "time: {duration: 3, step: 0.016666666666666666}\n";
    TruthFixture fixture;
    fixture_load_truth(&fixture, text);
    const ck_Model *model = &fixture.model;
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!fixture_is_solver(engine) || !fixture_takes(engine, model)) continue;
        double off[2];
        ck_Settings wanted = {0};
        for (int finer = 0; finer < 2; finer++) {
            ck_Run run;
            const ck_Limits limits = ck_limits_default();
            const ck_Reference *none = &fixture.truth.reference;
            assert_int_equal(ck_verdict_run(&run, model, none, engine, &wanted, &limits, NULL), CK_OK);
            if (run.status != CK_RUN_OK) fail_msg("%s: %s", engine->name, run.reason);
            off[finer] = fabs(-ck_trajectory_position(&run.trajectory, 60)[3 * 19 + 1] / model->size - 0.4384706);
            wanted.substeps = 4 * run.used.substeps;
            ck_run_free(&run);
        }
        assert_near(engine->name, off[1], 0, fmax(1.5 * 0.25 * off[0], 1e-5));
    }
    fixture_free_truth(&fixture);
}

static bool hangs_bodies(const ck_Model *model) {
    bool hangs = false;
    for (int i = 0; i < model->rigid_count; i++) hangs |= model->rigid[i].hung_count > 0;
    return hangs;
}

// Who refuses a shipped scene whose terms it has: native-rope what is no rope of bars, native-lines what is no regular
// cloth, native-narrow what is not stepped in vectors, Bullet what hangs bodies on springs, and nobody else; or a test
// that skips what is refused would pass by running nothing.
static void test_who_refuses(void **state) {
    (void)state;
    glob_t found;
    int taken = 0;
    if (fixture_leaves_natives()) skip();
    assert_int_equal(glob(SCENE_DIRECTORY "/*.yaml", 0, NULL, &found), 0);
    for (size_t scene = 0; scene < found.gl_pathc; scene++) {
        TruthFixture fixture;
        assert_int_equal(fixture_open_truth(&fixture, found.gl_pathv[scene], NULL), CK_OK);
        for (int i = 0; i < ck_engine_count(); i++) {
            const char *name = ck_engine_at(i)->name;
            if (!fixture_supports(ck_engine_at(i), &fixture.model)) continue;
            if (fixture_takes(ck_engine_at(i), &fixture.model))
                taken++;
            else if (strcmp(name, "native-rope") && strcmp(name, "native-lines") && strcmp(name, "native-narrow") &&
                     !(!strncmp(name, "bullet", 6) && hangs_bodies(&fixture.model)) &&
                     (strcmp(name, "mujoco") || fixture.model.spring_count < 10000) &&
                     (strcmp(name, "ode-direct") || fixture.model.spring_count < 1000))
                fail_msg("%s refuses %s", name, fixture.model.name);
        }
        fixture_free_truth(&fixture);
    }
    assert_true(taken > 8 * (int)found.gl_pathc);
    globfree(&found);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_free_fall),
        cmocka_unit_test(test_drag),
        cmocka_unit_test(test_oscillator),
        cmocka_unit_test(test_static_hang),
        cmocka_unit_test(test_momentum),
        cmocka_unit_test(test_order),
        cmocka_unit_test(test_bitwise_repeat),
        cmocka_unit_test(test_ledger),
        cmocka_unit_test(test_who_refuses),
        cmocka_unit_test(test_self_consistency),
        cmocka_unit_test(test_network_at_rest),
        cmocka_unit_test(test_sweeps),
        cmocka_unit_test(test_rope),
        cmocka_unit_test(test_level_rope),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
