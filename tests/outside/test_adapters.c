// Engines in programs of their own that come with the program: Bullet in single precision, and Jolt where npm brings
// it.
#include "fixture_comparison.h"

#include "outside.h"

#include <float.h>

static void shell(const char *format, const char *a, const char *b) {
    char command[2000];
    snprintf(command, sizeof command, format, a, b);
    if (system(command)) fail_msg("failed: %s", command);
}

// The symbols of Bullet in single and in double precision have the same names: a process that held both would compute
// wrong numbers in silence.
static void test_one_bullet_each(void **state) {
    (void)state;
    static const char *const programs[] = {"bullet-pbd-float", "bullet-stock-float", "bullet-implicit-float",
                                           "bullet-explicit-float"};
    for (size_t i = 0; i < sizeof programs / sizeof *programs; i++)
        shell("ldd %s/%s >/tmp/ck-$$ && grep -q libBulletSoftBody /tmp/ck-$$ && ! grep float64 /tmp/ck-$$; "
              "status=$?; rm /tmp/ck-$$; exit $status",
              ADAPTERS, programs[i]);
    shell("! ldd %s%s | grep Bullet | grep -v float64", PROGRAM, "");
}

// Opens an adapter by its path; skips the test where it is not there.
static ck_Engine *open_adapter(const char *name, const char *directory) {
    char path[4200];
    ck_Engine *engine;
    ck_Error error = {0};
    snprintf(path, sizeof path, "%s/%s", directory, name);
    if (ck_outside_command(&engine, name, path, true, &error)) fail_msg("%s", error.message);
    assert_true(engine->is_single);
    return engine;
}

static void measure(ck_Run *run, const ck_Model *model, const ck_Engine *engine, const ck_Settings *settings) {
    ck_Error error = {0};
    const ck_Limits limits = ck_limits_default();
    if (ck_run_measure(run, model, engine, settings ? settings : &(ck_Settings){0}, &limits, &error))
        fail_msg("%s", error.message);
    if (run->status != CK_RUN_OK) fail_msg("%s: %s", engine->name, run->reason);
}

static double lowest(const ck_Run *run) {
    const ck_Trajectory *path = &run->trajectory;
    const double *position = ck_trajectory_position(path, path->frame_count - 1);
    double low = INFINITY;
    for (int i = 0; i < path->particle_count; i++) low = fmin(low, position[3 * i + 1]);
    return low;
}

static void load(Fixture *fixture, const char *scene) {
    char path[400];
    ck_Error error = {0};
    snprintf(path, sizeof path, SCENE_DIRECTORY "/%s.yaml", scene);
    if (fixture_open(fixture, path, &error)) fail_msg("%s", error.message);
}

// How far floats may put the end of the rope from where doubles put it, at the same settings. An engine that keeps
// velocities moves points by sums of h·v, and is off by some spacings s of floats a particle. One that makes velocities
// from positions loses what moves a point by less than s/2 in a substep, an acceleration of s/(2h²): with that error in
// the field each of n springs carries up to n·m·s/(2h²) more or less, which is n²·m·s/(4h²k) at the end.
static void test_float_floor(void **state) {
    (void)state;
    static const struct {
        const char *engine, *adapter;
        bool is_position_based;
    } pairs[] = {{"bullet-pbd", "bullet-pbd-float", true},
                 {"bullet-implicit", "bullet-implicit-float", false},
                 {"bullet-explicit", "bullet-explicit-float", false}};
    Fixture fixture;
    load(&fixture, "rope_hanging");
    const ck_Model *model = &fixture.model;
    const double n = model->particle_count, spacing = 2 * FLT_EPSILON; // from 2 m on
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        ck_Engine *engine = open_adapter(pairs[i].adapter, ADAPTERS);
        ck_Run in_double, in_float;
        measure(&in_double, model, ck_engine_find(pairs[i].engine), NULL);
        measure(&in_float, model, engine, &in_double.used);
        assert_int_equal(in_float.used.substeps, in_double.used.substeps);
        // the ledger is told, and ends with what talking costs
        assert_int_equal(in_float.ledger.count, in_double.ledger.count + 1);
        for (int row = 0; row < in_double.ledger.count; row++)
            assert_string_equal(in_float.ledger.rows[row].native_parameter,
                                in_double.ledger.rows[row].native_parameter);
        double h = model->step / in_double.used.substeps, lost = n * spacing;
        if (pairs[i].is_position_based)
            lost += n * n * model->mass[0] * spacing / (4 * h * h * model->springs[0].stiffness);
        assert_true(lowest(&in_float) != lowest(&in_double));
        assert_near(pairs[i].adapter, lowest(&in_float), lowest(&in_double), lost);
        ck_run_free(&in_double);
        ck_run_free(&in_float);
        ck_outside_free(engine);
    }
    fixture_free(&fixture);
}

// Hinges and air go through the words of the protocol: in single precision they are the same to what floats resolve of
// the body's path, some 1e-6 of it a thousand substeps on.
static void test_bending_and_wind(void **state) {
    (void)state;
    static const char *const scenes[] = {"cantilever", "air_fall"};
    ck_Engine *engine = open_adapter("bullet-explicit-float", ADAPTERS);
    for (int i = 0; i < 2; i++) {
        Fixture fixture;
        ck_Run in_double, in_float;
        load(&fixture, scenes[i]);
        measure(&in_double, &fixture.model, ck_engine_find("bullet-explicit"), NULL);
        measure(&in_float, &fixture.model, engine, &in_double.used);
        print_message("%s: %.6f and %.6f m\n", scenes[i], lowest(&in_double), lowest(&in_float));
        assert_true(lowest(&in_float) != lowest(&in_double));
        assert_near(scenes[i], lowest(&in_float) / lowest(&in_double), 1, 1e-3);
        ck_run_free(&in_double);
        ck_run_free(&in_float);
        fixture_free(&fixture);
    }
    ck_outside_free(engine);
}

// Jolt from npm, in a directory of the test's own; NULL where this machine has no npm.
static ck_Engine *fetch_jolt(char *directory) {
    if (system("npm --version >/dev/null 2>&1")) return NULL;
    assert_non_null(mkdtemp(directory));
    shell("%s/fetch jolt %s >/dev/null", BRIDGE, directory);
    char adapters[300];
    snprintf(adapters, sizeof adapters, "%s/adapters", directory);
    return open_adapter("jolt", adapters);
}

// XPBD by symplectic Euler: a body that falls for t is ½·g·h·t below where it should be.
static void check_fall(const ck_Engine *jolt) {
    Fixture fixture;
    ck_Run run;
    load(&fixture, "free_fall");
    const ck_Model *model = &fixture.model;
    measure(&run, model, jolt, &(ck_Settings){.substeps = 5});
    const double *x = ck_trajectory_position(&run.trajectory, run.trajectory.frame_count - 1), t = model->duration;
    const double right = model->position[1] + model->velocity[1] * t + 0.5 * model->gravity[1] * t * t,
                 ahead = 0.5 * model->gravity[1] * t * model->step / 5;
    // N substeps round a position, from 2 m on of spacing s, and with it the velocity that is made of it, by s/(2·√3)
    // as it falls: a walk whose sum walks, s/√12·N^(3/2)/√3 in all; thrice that
    const double steps = 5.0 * model->frame_count, walk = 2 * FLT_EPSILON / sqrt(12) * pow(steps, 1.5) / sqrt(3);
    assert_near("fall", x[1], right + ahead, 3 * walk);
    ck_run_free(&run);
    fixture_free(&fixture);
}

// One sweep leaves a rest off by the square of the substep; a rope of 2 m.
static void check_rest(const ck_Engine *jolt) {
    Fixture fixture;
    ck_Run coarse, fine, best;
    load(&fixture, "rope_hanging");
    measure(&coarse, &fixture.model, jolt, &(ck_Settings){.substeps = 4});
    measure(&fine, &fixture.model, jolt, &(ck_Settings){.substeps = 8});
    measure(&best, &fixture.model, ck_engine_find("native-verlet"), NULL);
    double ratio = (lowest(&coarse) - lowest(&best)) / (lowest(&fine) - lowest(&best));
    assert_near("order of a rest", log2(ratio), 2, 0.25);
    ck_run_free(&coarse);
    ck_run_free(&fine);
    ck_run_free(&best);
    fixture_free(&fixture);
}

// Measured by others: a cloth of 20×20 hangs less the more iterations there are, as gravity moves a point by less than
// floats tell apart.
static void check_rounding(const ck_Engine *jolt) {
    static const struct {
        uint32_t iterations;
        double sag;
    } cases[] = {{20, 0.944}, {800, 0.488}};
    Fixture fixture;
    ck_Run run;
    load(&fixture, "cloth_release");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        measure(&run, &fixture.model, jolt, &(ck_Settings){.substeps = cases[i].iterations});
        assert_near("sag", -lowest(&run) / 0.95, cases[i].sag, 0.05 * cases[i].sag);
        ck_run_free(&run);
    }
    fixture_free(&fixture);
}

static void check_contact(const ck_Engine *jolt) {
    static const char *const scenes[] = {"bounce", "slide_0", "slide_45", "incline_sticks", "cloth_on_sphere"};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        Fixture fixture;
        ck_Run run;
        load(&fixture, scenes[i]);
        measure(&run, &fixture.model, jolt, NULL);
        ck_run_free(&run);
        fixture_free(&fixture);
    }
}

static void test_jolt(void **state) {
    (void)state;
    char directory[] = "/tmp/clothcheck-jolt-XXXXXX";
    ck_Engine *jolt = fetch_jolt(directory);
    if (!jolt) {
        print_message("without npm there is no Jolt\n");
        skip();
    }
    check_fall(jolt);
    check_rest(jolt);
    check_rounding(jolt);
    check_contact(jolt);
    ck_outside_free(jolt);
    shell("rm -r %s%s", directory, "");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_one_bullet_each), cmocka_unit_test(test_float_floor),
                                       cmocka_unit_test(test_bending_and_wind), cmocka_unit_test(test_jolt)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
