// Physics does not depend on its author's units, nor friction on the method. What does not depend on place, direction
// or the order of a list is tests/conform.
#include "fixture_truth.h"

#include "prediction.h"
#include "statistics.h"
#include "vector.h"

typedef void Transform(ck_Model *model);

static void each_vector(ck_Model *model, void (*change)(double *vector)) {
    for (int i = 0; i < model->particle_count; i++) {
        change(model->position + 3 * i);
        change(model->velocity + 3 * i);
    }
    change(model->gravity);
    change(model->force);
}

static void scale_vector(double *vector, double factor) {
    for (int axis = 0; axis < 3; axis++) vector[axis] *= factor;
}

// lengths and accelerations alike: the same motion, larger
static void scale(ck_Model *model, void (*change)(double *vector), double factor) {
    each_vector(model, change);
    for (int i = 0; i < model->spring_count; i++) model->springs[i].rest *= factor;
    model->size *= factor;
    model->spacing *= factor;
}

static void enlarge_vector(double *vector) {
    scale_vector(vector, 1024);
}

static void reduce_vector(double *vector) {
    scale_vector(vector, 1.0 / 1024);
}

// Collider by collider, as models share none.
static void scale_all(ck_Model *model, void (*change)(double *vector), double factor) {
    scale(model, change, factor);
    for (int i = 0; i < model->collider_count; i++) {
        change(model->colliders[i].point);
        model->colliders[i].radius *= factor;
    }
}

static void enlarge(ck_Model *model) {
    scale_all(model, enlarge_vector, 1024);
}

static void reduce(ck_Model *model) {
    scale_all(model, reduce_vector, 1.0 / 1024);
}

// masses and what acts on them alike: the same motion
static void weigh(ck_Model *model, double factor) {
    for (int i = 0; i < model->particle_count; i++) model->mass[i] *= factor;
    scale_vector(model->force, factor);
    for (int i = 0; i < model->spring_count; i++) {
        model->springs[i].stiffness *= factor;
        model->springs[i].damping *= factor;
    }
}

static void load(ck_Model *model) {
    weigh(model, 1048576);
}

static void lighten(ck_Model *model) {
    weigh(model, 1.0 / 1048576);
}

static const char *const measured[] = {"sag", "stretch_max", "stretch_rms", "energy_drift"};
#define MEASURED 4

static void measure(double *values, const char *text, Transform *transform, const ck_Engine *engine) {
    TruthFixture fixture;
    ck_Trajectory trajectory;
    fixture_load_truth(&fixture, text);
    if (transform) transform(&fixture.model);
    fixture_run(&trajectory, &fixture.model, engine, NULL, NULL);
    for (int i = 0; i < MEASURED; i++)
        values[i] = ck_metric_value(ck_metric_find(measured[i]), &fixture.model, &trajectory, &fixture.truth.reference);
    ck_trajectory_free(&trajectory);
    fixture_free_truth(&fixture);
}

// Units are the author's: a millimetre or a kilometre in place of a metre, a milligram or a ton in place of a kilogram.
// Powers of two round nothing, so that an engine with no length and mass of its own gives the same to the last bit.
static void test_units(void **state) {
    (void)state;
    static const char *const texts[] = {
        "name: drop\ncloth: {rows: 5, columns: 5, spacing: 0.05, mass: 0.144, origin: [0, 0.2, 0], down: [0, 0.6, "
        "0.8]}\n"
        "springs: {stiffness: 500, damping: 0.02, shear: 250}\ngravity: [0, -9.81, 0]\nforce: [0.001, 0, 0.002]\n"
        "colliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0], restitution: 0.3, friction: 0.5}}, "
        "{sphere: {center: [0.1, 0.05, 0.1], radius: 0.1, restitution: 0.2, friction: 0.3}}]\n"
        "time: {duration: 0.6, step: 0.01}\n",
        "name: bars\nrope: {particles: 6, spacing: 0.1, mass: 0.6, along: [1, 0, 0]}\nsprings: {rigid: true}\n"
        "pins: [first]\ngravity: [0, -9.81, 0]\ndrag: 1\ntime: {duration: 1, step: 0.01}\n"};
    static const struct {
        const char *name;
        Transform *transform;
    } units[] = {{"1024 times larger", enlarge},
                 {"1024 times smaller", reduce},
                 {"2^20 times heavier", load},
                 {"2^20 times lighter", lighten}};
    for (size_t text = 0; text < sizeof texts / sizeof *texts; text++)
        for (int i = 0; i < ck_engine_count(); i++) {
            TruthFixture fixture;
            fixture_load_truth(&fixture, texts[text]);
            bool takes = fixture_is_solver(ck_engine_at(i)) && fixture_takes(ck_engine_at(i), &fixture.model);
            fixture_free_truth(&fixture);
            double before[MEASURED], after[MEASURED];
            if (takes) measure(before, texts[text], NULL, ck_engine_at(i));
            for (size_t unit = 0; unit < sizeof units / sizeof *units && takes; unit++) {
                measure(after, texts[text], units[unit].transform, ck_engine_at(i));
                for (int metric = 0; metric < 3; metric++) {
                    char what[120];
                    snprintf(what, sizeof what, "%s, %s: %s", ck_engine_at(i)->name, units[unit].name,
                             measured[metric]);
                    assert_near(what, after[metric], before[metric], 0);
                }
            }
        }
}

// Methods that have nothing in common find the same friction of a rope over a ball: springs followed through contact,
// Bullet's projection with an edited cone, ODE's contact joints. Each is off by the order of its own step; the rope's
// start, which no closed form has, is the same for all.
static void test_rope_over_edge(void **state) {
    (void)state;
    TruthFixture fixture;
    ck_Error error = {0};
    if (fixture_open_truth(&fixture, SCENE_DIRECTORY "/rope_over_edge.yaml", &error)) fail_msg("%s", error.message);
    const char *const names[] = {"native-verlet", "bullet-pbd", "ode-quick"};
    double friction[3];
    for (int i = 0; i < 3; i++) {
        ck_Trajectory trajectory;
        fixture_run(&trajectory, &fixture.model, ck_engine_find(names[i]), NULL, NULL);
        friction[i] =
            ck_metric_value(ck_metric_find("wrap_friction"), &fixture.model, &trajectory, &fixture.truth.reference);
        ck_trajectory_free(&trajectory);
        print_message("%s: %.4f\n", names[i], friction[i]);
        assert_near(names[i], friction[i], friction[0], 0.01 * 0.3);
        // a polygon of corners of δ = 0.1 holds δ²/12·(1 + μ²) more than the round rope, and its weights bounce
        assert_near(names[i], friction[i], 0.3, 0.003);
    }
    fixture_free_truth(&fixture);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_units), cmocka_unit_test(test_rope_over_edge)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
