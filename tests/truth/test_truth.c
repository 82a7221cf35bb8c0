// Every truth against another way to the same: closed forms against the equilibrium solver and the reference
// integrator.
#include "fixture_truth.h"

#include "equilibrium.h"
#include "runge_kutta.h"
#include "time_scale.h"
#include "truth_cache.h"
#include "vector.h"

#include <float.h>
#include <glob.h>
#include <unistd.h>

// largest distance of two sets of positions, / size
static double apart(const ck_Model *model, const double *one, const double *other) {
    double largest = 0;
    for (int i = 0; i < model->particle_count; i++) largest = fmax(largest, ck_distance(one + 3 * i, other + 3 * i));
    return largest / model->size;
}

#define HANGING_TIME "gravity: [0, -9.81, 0]\ndrag: 8\ntime: {duration: 2, step: 0.02}\n"

// Closed forms of rest against the energy minimum.
static void test_rest(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double tolerance; // of the size
    } cases[] = {
        {"name: chain\nrope: {particles: 20, spacing: 0.1, mass: 1}\nsprings: {stiffness: 1000}\npins: [first]\ntruth: "
         "vertical_chain\n" HANGING_TIME,
         1e-10},
        {"name: heavy\nrope: {particles: 20, spacing: 0.1, mass: 0.2, end_mass: 10}\nsprings: {stiffness: "
         "1.0e+5}\npins: [first]\ntruth: vertical_chain\n" HANGING_TIME,
         1e-10},
        {"name: level\nrope: {particles: 20, spacing: 0.1, mass: 1, along: [1, 0, 0]}\nsprings: {stiffness: "
         "1000}\npins: [first, last]\ntruth: catenary\n" HANGING_TIME,
         1e-10},
        {"name: oblique\nrope: {particles: 15, spacing: 0.2, mass: 2, along: [1, 2, -1]}\nsprings: {stiffness: "
         "400}\npins: [first, last]\ntruth: catenary\n" HANGING_TIME,
         1e-10},
        // slack: longer than its chord
        {"name: slack\nnetwork: {nodes: [{at: [0, 0, 0], mass: 1}, {at: [1, -1, 0], mass: 1}, {at: [2, -1.5, 0], mass: "
         "2}, {at: [3, -1, 0], mass: 1}, {at: [4, 0.5, 0], mass: 1}],\n"
         "  bars: [[0, 1], [1, 2], [2, 3], [3, 4]]}\nsprings: {stiffness: 3000}\npins: [0, 4]\ntruth: "
         "catenary\n" HANGING_TIME,
         1e-10},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        TruthFixture fixture;
        fixture_load_truth(&fixture, cases[i].text);
        ck_Error error = {0};
        ck_Equilibrium equilibrium;
        if (ck_equilibrium_release(&equilibrium, &fixture.model, 0, 0, &error)) fail_msg("%s", error.message);
        assert_int_equal(ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, &error), CK_OK);
        assert_near(fixture.model.name, apart(&fixture.model, equilibrium.position, fixture.truth.paths[0].data), 0,
                    cases[i].tolerance);
        assert_true(equilibrium.residual <= CK_EQUILIBRIUM_RESIDUAL && equilibrium.is_minimum);
        ck_equilibrium_free(&equilibrium);
        fixture_free_truth(&fixture);
    }
}

// The inextensible catenary is that of bars. Springs come to it as strain ε = load/(k·d), here 7e-5 and half that; what
// both together extrapolate to is off by some ε².
static void test_inextensible_catenary(void **state) {
    (void)state;
    static const char text[] =
        "name: bars\nnetwork: {nodes: [{at: [0, 0, 0], mass: 1}, {at: [1, -1, 0], mass: 1}, {at: [2, -1.5, 0], mass: "
        "2}, {at: [3, -1, 0], mass: 1}, {at: [4, 0.5, 0], mass: 1}],\n"
        "  bars: [[0, 1], [1, 2], [2, 3], [3, 4]]}\nsprings: {%s}\npins: [0, 4]\n%s" HANGING_TIME;
    static const char *const springs[] = {"rigid: true", "stiffness: 1.0e+6", "stiffness: 2.0e+6"};
    TruthFixture fixture[3];
    ck_Equilibrium equilibrium[3] = {0};
    for (int i = 0; i < 3; i++) {
        char scene[800];
        snprintf(scene, sizeof scene, text, springs[i], i ? "" : "truth: catenary\n");
        fixture_load_truth(&fixture[i], scene);
        ck_Error error = {0};
        if (!i) assert_int_equal(ck_truth_create(&fixture[0].truth, &fixture[0].model, NULL, NULL, NULL), CK_OK);
        if (i && ck_equilibrium_solve(&equilibrium[i], &fixture[i].model, fixture[0].truth.paths[0].data, &error))
            fail_msg("%s", error.message);
    }
    const ck_Model *bars = &fixture[0].model;
    double limit[15];
    for (int i = 0; i < 3 * bars->particle_count; i++)
        limit[i] = 2 * equilibrium[2].position[i] - equilibrium[1].position[i];
    assert_near("the limit of stiff springs", apart(bars, limit, fixture[0].truth.paths[0].data), 0, 4 * 7e-5 * 7e-5);
    // the limit is needed: the springs alone are farther off
    assert_true(apart(bars, equilibrium[2].position, fixture[0].truth.paths[0].data) > 1e-6);
    for (int i = 0; i < 3; i++) {
        ck_equilibrium_free(&equilibrium[i]);
        fixture_free_truth(&fixture[i]);
    }
}

// Closed forms of motion against the reference integrator, within what the form itself says it is off.
static void test_motion(void **state) {
    (void)state;
    static const char *const texts[] = {
        "name: fall\ncloth: {rows: 3, columns: 3, spacing: 0.1, mass: 0.1}\nsprings: {stiffness: 50, shear: "
        "20}\ngravity: [1, -9.81, 0]\nvelocity: [0.5, 2, -1]\n"
        "time: {duration: 0.5, step: 0.05}\ntruth: free_fall\n",
        "name: drag\ncloth: {rows: 3, columns: 3, spacing: 0.1, mass: 0.1}\nsprings: {stiffness: 50, shear: "
        "20}\ngravity: [1, -9.81, 0]\nvelocity: [0.5, 2, -1]\ndrag: 3\n"
        "time: {duration: 1, step: 0.05}\ntruth: terminal_speed\n",
        "name: one\nrope: {particles: 2, spacing: 1, mass: 2, along: [1, 2, 2]}\nsprings: {stiffness: 100, damping: "
        "0.5}\npins: [first]\nvelocity: [0.1, 0.2, 0.2]\n"
        "drag: 0.3\ntime: {duration: 2, step: 0.05}\ntruth: oscillator\n",
        "name: many\nrope: {particles: 9, spacing: 0.2, mass: 0.9, along: [0, 0, 1]}\nsprings: {stiffness: 300, "
        "damping: 0.4}\npins: [first]\nvelocity: [0, 0, 0.2]\n"
        "drag: 0.2\ntime: {duration: 1, step: 0.05}\ntruth: longitudinal_modes\n",
        // spring damping beyond critical in the higher modes
        "name: damped\nrope: {particles: 6, spacing: 0.2, mass: 0.6, along: [0, 0, 1]}\nsprings: {stiffness: 300, "
        "damping: 8}\npins: [first]\nvelocity: [0, 0, 0.2]\n"
        "time: {duration: 1, step: 0.05}\ntruth: longitudinal_modes\n",
        "name: string\nrope: {particles: 12, spacing: 0.1, mass: 0.12, along: [1, 0, 0]}\nsprings: {stiffness: 500, "
        "prestretch: 0.25}\npins: [first, last]\nvelocity: [0, 0.001, 0]\n"
        "drag: 0.5\ntime: {duration: 0.5, step: 0.01}\ntruth: taut_string\n",
        "name: chain\nrope: {particles: 11, spacing: 0.1, mass: 0.11, along: [0, -1, 0]}\nsprings: {stiffness: "
        "1.0e+6}\npins: [first]\ngravity: [0, -9.81, 0]\nvelocity: [0.01, 0, 0]\n"
        "time: {duration: 1, step: 0.02}\ntruth: hanging_chain_modes\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        TruthFixture fixture;
        fixture_load_truth(&fixture, texts[i]);
        const ck_Model *model = &fixture.model;
        ck_Error error = {0};
        ck_ReferencePath path;
        if (ck_reference_path_create(&path, model, &error)) fail_msg("%s", error.message);
        assert_int_equal(ck_truth_create(&fixture.truth, model, NULL, NULL, &error), CK_OK);
        double largest = 0, speed = 0;
        for (int frame = 0; frame <= model->frame_count; frame++) {
            largest = fmax(largest, apart(model, ck_trajectory_position(&path.fine, frame),
                                          ck_trajectory_position(&fixture.truth.paths[0], frame)));
            speed = fmax(speed, apart(model, ck_trajectory_velocity(&path.fine, frame),
                                      ck_trajectory_velocity(&fixture.truth.paths[0], frame)));
        }
        // a linear theory is off by what it says of itself
        const ck_TruthForm *form = fixture.truth.form;
        assert_near(model->name, largest, 0, 1e-9 + (form->off ? form->off(model) : 0));
        // velocities are off by the highest of the frequencies times as much
        if (!form->off) assert_near(model->name, speed, 0, 1e-6);
        ck_reference_path_free(&path);
        fixture_free_truth(&fixture);
    }
}

// A pendulum of a spring of 1e11 N/m in place of the bar: 1e-10 longer. The reference integrator keeps the period to
// 1e-9.
static void test_pendulum(void **state) {
    (void)state;
    static const char text[] = "name: pendulum\nrope: {particles: 2, spacing: 1, mass: 2, along: [1, 0, 0]}\nsprings: "
                               "{%s}\npins: [first]\ngravity: [0, -9.81, 0]\n"
                               "time: {duration: 4, step: 0.00390625}\n%s";
    char rigid[400], stiff[400];
    snprintf(rigid, sizeof rigid, text, "rigid: true", "truth: pendulum\n");
    snprintf(stiff, sizeof stiff, text, "stiffness: 1.0e+11", "");
    TruthFixture bar, spring;
    fixture_load_truth(&bar, rigid);
    fixture_load_truth(&spring, stiff);
    assert_int_equal(ck_truth_create(&bar.truth, &bar.model, NULL, NULL, NULL), CK_OK);
    ck_Trajectory path;
    // ω·dt = 0.6: the spring itself is followed, though it hardly moves
    assert_int_equal(ck_reference_integrate(&path, &spring.model, 2048, 0, 0, NULL), CK_OK);
    const ck_Metric *period = ck_metric_find("period");
    // 2π√(L/g)/AGM(1, cos 45°), by hand
    double a = 1, b = sqrt(0.5);
    for (int i = 0; i < 8; i++) {
        double mean = 0.5 * (a + b);
        b = sqrt(a * b);
        a = mean;
    }
    double exact = 2 * 3.14159265358979323846 / sqrt(9.81) / a;
    assert_near("the closed form's period", ck_metric_truth(period, &bar.model, &bar.truth.reference), exact,
                1e-9 * exact);
    assert_near("the reference's period", ck_metric_value(period, &spring.model, &path, &bar.truth.reference), exact,
                1e-9 * exact);
    ck_trajectory_free(&path);
    fixture_free_truth(&bar);
    fixture_free_truth(&spring);
}

// Bars exactly as long as what they span have one place, and it is known.
static void test_taut_bars(void **state) {
    (void)state;
    TruthFixture fixture;
    fixture_load_truth(&fixture, "name: taut\nrope: {particles: 11, spacing: 0.1, mass: 1, along: [1, 0, 0]}\nsprings: "
                                 "{rigid: true}\npins: [first, last]\ngravity: [0, -9.81, 0]\n"
                                 "time: {duration: 1, step: 0.02}\ntruth: catenary\n");
    const ck_Model *model = &fixture.model;
    assert_int_equal(ck_truth_create(&fixture.truth, model, NULL, NULL, NULL), CK_OK);
    assert_near("a taut catenary", apart(model, model->position, fixture.truth.paths[0].data), 0, 1e-15);
    assert_true(ck_truth_uncertainty(&fixture.truth, model, ck_metric_find("position_rms")) < 1e-7);
    fixture_free_truth(&fixture);
}

// A truth is solved once; a cache that is damaged anywhere is not believed.
static void test_cache(void **state) {
    (void)state;
    char directory[] = "/tmp/clothcheck-truth-XXXXXX", pattern[100];
    assert_non_null(mkdtemp(directory));
    TruthFixture fixture;
    fixture_load_truth(&fixture,
                       "name: net\ncloth: {rows: 4, columns: 4, spacing: 0.1, mass: 0.1}\nsprings: {stiffness: "
                       "100, shear: 50}\npins: [top_left, top_right]\ntruth: equilibrium\n" HANGING_TIME);
    const ck_Model *model = &fixture.model;
    ck_Truth solved, cached = {.form = ck_truth_form_find("equilibrium")};
    assert_int_equal(ck_truth_create(&solved, model, directory, NULL, NULL), CK_OK);
    assert_true(ck_truth_cache_load(&cached, model, directory));
    assert_int_equal(cached.path_count, solved.path_count);
    assert_memory_equal(cached.paths[0].data, solved.paths[0].data, solved.paths[0].bytes);
    ck_truth_free(&cached);

    glob_t found;
    snprintf(pattern, sizeof pattern, "%s/*.truth", directory);
    assert_int_equal(glob(pattern, 0, NULL, &found), 0);
    assert_int_equal(found.gl_pathc, 1);
    FILE *file = fopen(found.gl_pathv[0], "r+b");
    fseek(file, 0, SEEK_END);
    long length = ftell(file);
    for (long at = 0; at < length; at += length / 37) {
        fseek(file, at, SEEK_SET);
        int byte = fgetc(file);
        fseek(file, at, SEEK_SET);
        fputc(byte ^ 0x10, file);
        fflush(file);
        cached = (ck_Truth){.form = solved.form};
        if (ck_truth_cache_load(&cached, model, directory))
            fail_msg("believed a cache with byte %ld of %ld changed", at, length);
        fseek(file, at, SEEK_SET);
        fputc(byte, file);
        fflush(file);
    }
    assert_int_equal(ftruncate(fileno(file), length / 2), 0);
    fclose(file);
    assert_false(ck_truth_cache_load(&cached, model, directory));
    // and is made anew
    ck_Truth again;
    assert_int_equal(ck_truth_create(&again, model, directory, NULL, NULL), CK_OK);
    assert_memory_equal(again.paths[0].data, solved.paths[0].data, solved.paths[0].bytes);
    cached = (ck_Truth){.form = solved.form};
    assert_true(ck_truth_cache_load(&cached, model, directory));
    // another model is another truth
    fixture.model.mass[5] *= 1.0001;
    ck_truth_free(&cached);
    cached = (ck_Truth){.form = solved.form};
    assert_false(ck_truth_cache_load(&cached, model, directory));
    unlink(found.gl_pathv[0]);
    rmdir(directory);
    globfree(&found);
    ck_truth_free(&solved);
    ck_truth_free(&again);
    fixture_free_truth(&fixture);
}

// The start in the plane of symmetry ends on a saddle, which is no rest position: the truth leaves it and says nothing
// false.
static void test_saddle(void **state) {
    (void)state;
    TruthFixture fixture;
    // two bars in line, pushed together: the middle node balances on the line
    fixture_load_truth(&fixture, "name: strut\nnetwork: {nodes: [{at: [0, 0, 0], mass: 1}, {at: [0, -1, 0], mass: 1}, "
                                 "{at: [0, -2, 0], mass: 1}], bars: [[0, 1], [1, 2]]}\n"
                                 "springs: {stiffness: 20, damping: 3}\npins: [2]\ntruth: equilibrium\n" HANGING_TIME);
    ck_Equilibrium equilibrium;
    ck_Error error = {0};
    // standing on its pin: in balance, and not a minimum
    assert_int_equal(ck_equilibrium_release(&equilibrium, &fixture.model, 0, 0, &error), CK_REFUSED);
    assert_non_null(strstr(error.message, "no minimum"));
    ck_equilibrium_free(&equilibrium);
    fixture_free_truth(&fixture);
}

// A curtain let go level and straight stays symmetric, where the energy has a saddle: Newton leaves it once nothing
// moves any more, and does not try two thousand steps. Where rounding leads off it, there is the minimum.
static void test_standstill(void **state) {
    (void)state;
    fixture_skip_sanitized();
    Fixture fixture;
    ck_Equilibrium equilibrium;
    ck_Error error = {0};
    if (fixture_open(&fixture, SCENE_DIRECTORY "/cloth_curtain.yaml", &error)) fail_msg("%s", error.message);
    const ck_Status status = ck_equilibrium_release(&equilibrium, &fixture.model, 0, 0, &error);
    assert_true(status == CK_OK || status == CK_REFUSED);
    assert_int_equal(equilibrium.is_minimum, status == CK_OK);
    assert_in_range(equilibrium.iterations, 1, 800);
    ck_equilibrium_free(&equilibrium);
    fixture_free(&fixture);
}

// Every shipped scene with a truth at rest: the forces balance to 1e-10 of the load.
static void test_shipped_equilibria(void **state) {
    (void)state;
    fixture_skip_long();
    glob_t found;
    assert_int_equal(glob(SCENE_DIRECTORY "/*.yaml", 0, NULL, &found), 0);
    int checked = 0;
    for (size_t i = 0; i < found.gl_pathc; i++) {
        ck_Error error = {0};
        TruthFixture fixture;
        assert_int_equal(fixture_open_truth(&fixture, found.gl_pathv[i], &error), CK_OK);
        // 64×64 takes a minute of its own, the skirt a quarter with the sanitizers
        bool at_rest =
            fixture.model.truth && !strcmp(fixture.model.truth, "equilibrium") && fixture.model.particle_count < 500;
        if (at_rest) {
            if (ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, &error)) fail_msg("%s", error.message);
            if (!fixture.truth.path_count) fail_msg("%s", fixture.truth.kind);
            double residual = ck_equilibrium_residual(&fixture.model, fixture.truth.paths[0].data);
            // and what a place is rounded to there, at both ends of every spring
            const ck_Model *model = &fixture.model;
            double farthest = 0, stiffest = 0;
            for (int k = 0; k < 3 * model->particle_count; k++) farthest = fmax(farthest, fabs(model->position[k]));
            for (int k = 0; k < model->spring_count; k++) stiffest = fmax(stiffest, model->springs[k].stiffness);
            double rounding =
                sqrt(2.0 * model->spring_count) * stiffest * farthest * DBL_EPSILON / ck_stability_load(model);
            assert_near(model->name, residual, 0, CK_EQUILIBRIUM_RESIDUAL + rounding);
            checked++;
        }
        fixture_free_truth(&fixture);
    }
    globfree(&found);
    assert_true(checked >= 4);
}

// A rope over a ball with a weight at each end, by numbers: nodes on the arc and straight down both sides.
static void write_rope_over_ball(char *text, size_t size, double density, double friction) {
    const int on_ball = 31, below = 14, count = on_ball + 2 * below;
    const double radius = 0.25, spring = 3.14159265358979323846 * radius / (on_ball - 1);
    size_t used = (size_t)snprintf(text, size, "name: over\nnetwork:\n  nodes:\n");
    for (int i = 0; i < count; i++) {
        double x = -radius, y = -spring * (below - i), angle = (i - below) * spring / radius;
        if (i >= below && i < below + on_ball) x = -radius * cos(angle), y = radius * sin(angle);
        if (i >= below + on_ball) x = radius, y = -spring * (i - below - on_ball + 1);
        double weight = i == 0 ? 1 : i == count - 1 ? 8 : 0;
        used += (size_t)snprintf(text + used, size - used, "    - {at: [%.17g, %.17g, 0], mass: %.17g}\n", x, y,
                                 density * spring + weight);
    }
    used += (size_t)snprintf(text + used, size - used, "  bars: [");
    for (int i = 0; i + 1 < count; i++)
        used += (size_t)snprintf(text + used, size - used, "%s[%d, %d]", i ? ", " : "", i, i + 1);
    snprintf(text + used, size - used,
             "]\nsprings: {stiffness: 1.0e+6, damping: 5, prestretch: 1.0e-4}\ngravity: [0, -9.81, 0]\n"
             "colliders: [{sphere: {center: [0, 0, 0], radius: %g, friction: %g}}]\n"
             "time: {duration: 0.25, step: 0.01}\ntruth: capstan\n",
             radius, friction);
}

// The friction that explains how a rope slides is that of the ball, whatever the rope weighs: to the polygon's
// δ²/12·(1 + μ²), 0.1 %, and to the waves that a rope as heavy as its weights still carries, some 1 % of the tension.
// And the truth along the arc is where a whole time stepping in space comes to, within what it says of itself.
static void test_capstan(void **state) {
    (void)state;
    fixture_skip_long();
    const double densities[] = {0.1, 0.5, 2, 5};
    const ck_Metric *friction = ck_metric_find("wrap_friction"), *sag = ck_metric_find("sag");
    for (size_t i = 0; i < sizeof densities / sizeof *densities; i++) {
        static char text[20000];
        TruthFixture fixture;
        ck_Trajectory path;
        write_rope_over_ball(text, sizeof text, densities[i], 0.3);
        fixture_load_truth(&fixture, text);
        const ck_Model *model = &fixture.model;
        const ck_Reference *reference = &fixture.truth.reference;
        assert_int_equal(ck_truth_create(&fixture.truth, model, NULL, NULL, NULL), CK_OK);
        fixture_run(&path, model, ck_engine_find("native-verlet"), NULL, NULL);
        assert_near("friction of the truth", ck_metric_truth(friction, model, reference), 0.3, 0.01 * 0.3);
        assert_near("friction of an engine", ck_metric_value(friction, model, &path, reference), 0.3, 0.01 * 0.3);
        assert_near("sag", ck_metric_value(sag, model, &path, reference), ck_metric_truth(sag, model, reference),
                    ck_truth_uncertainty(&fixture.truth, model, sag));
        ck_trajectory_free(&path);
        fixture_free_truth(&fixture);
    }
}

// On a smooth ball nothing holds a rope sideways: a truth that says how it slides on says also until when.
static void test_unstable(void **state) {
    (void)state;
    fixture_skip_long();
    static char text[20000];
    TruthFixture fixture;
    write_rope_over_ball(text, sizeof text, 0.02, 0);
    fixture_load_truth(&fixture, text);
    assert_int_equal(ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, NULL), CK_OK);
    assert_true(fixture.truth.reference.ends);
    assert_in_range(fixture.truth.reference.horizon, 1, 15);
    assert_true(isnan(ck_metric_truth(ck_metric_find("sag"), &fixture.model, &fixture.truth.reference)));
    fixture_free_truth(&fixture);
    // a pendulum let go all but upside down: each nudge grows by e^(√(g/L)·t) until it has fallen
    fixture_load_truth(&fixture,
                       "name: upside\nrope: {particles: 2, spacing: 1, mass: 2, along: [1.0e-4, 1, 0]}\nsprings: "
                       "{rigid: true}\npins: [first]\ngravity: [0, -9.81, 0]\ntime: {duration: 20, step: 0.02}\n"
                       "truth: pendulum\n");
    assert_int_equal(ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, NULL), CK_OK);
    assert_true(fixture.truth.reference.ends);
    // ln(1e4)/√(g/L) = 2.9 s, less what a turned bar is ahead by at once
    assert_near("horizon", fixture.truth.reference.horizon * 0.02, log(1e4) / sqrt(9.81), 0.5);
    fixture_free_truth(&fixture);
}

// A rest does not depend on where it is: a kilometre away it is the same to the spacing of doubles there.
static void test_far(void **state) {
    (void)state;
    static const char scene[] = "name: far\ncloth: {rows: 6, columns: 6, spacing: 0.1, mass: 0.1, origin: [%d, %d, 0], "
                                "down: [0, 0, 1]}\nsprings: {stiffness: 100, shear: 50}\npins: [top_left, "
                                "top_right]\ngravity: [0, -9.81, 0]\ntime: {duration: 1, fps: 60}\n";
    Fixture fixture[2];
    ck_Equilibrium rest[2];
    for (int i = 0; i < 2; i++) {
        char text[400];
        ck_Error error = {0};
        snprintf(text, sizeof text, scene, 1000 * i, 1000 * i);
        fixture_load(&fixture[i], text);
        if (ck_equilibrium_release(&rest[i], &fixture[i].model, 0, 0, &error)) fail_msg("%s", error.message);
    }
    for (int i = 0; i < 3 * fixture[0].model.particle_count; i++)
        assert_near("place", rest[1].position[i] - (i % 3 < 2 ? 1000 : 0), rest[0].position[i], 1e-9);
    for (int i = 0; i < 2; i++) {
        ck_equilibrium_free(&rest[i]);
        fixture_free(&fixture[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rest),
        cmocka_unit_test(test_far),
        cmocka_unit_test(test_inextensible_catenary),
        cmocka_unit_test(test_motion),
        cmocka_unit_test(test_pendulum),
        cmocka_unit_test(test_taut_bars),
        cmocka_unit_test(test_cache),
        cmocka_unit_test(test_saddle),
        cmocka_unit_test(test_standstill),
        cmocka_unit_test(test_shipped_equilibria),
        cmocka_unit_test(test_capstan),
        cmocka_unit_test(test_unstable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
