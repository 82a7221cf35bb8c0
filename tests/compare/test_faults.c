// Faults put into an engine on purpose: the comparison finds each of them, in the column where it must show.
#include "fixture_comparison.h"

#include "comparison.h"
#include "engine.h"
#include "springs.h"
#include "vector.h"

typedef enum Fault { NO_FAULT, STIFFNESS, GRAVITY, SPRING_MISSING, DAMPING_DIRECTION } Fault;

// A model of the engine's own, faulty, and native-verlet on it.
typedef struct Faulty {
    ck_Model model;
    void *engine;
} Faulty;

static ck_Status create_faulty(void **state, const ck_Model *model, ck_Settings *used, const ck_Settings *wanted,
                               ck_Ledger *ledger, ck_Error *error, Fault fault) {
    Faulty *faulty = calloc(1, sizeof *faulty);
    faulty->model = *model;
    faulty->model.springs = malloc(sizeof *model->springs * (size_t)model->spring_count);
    memcpy(faulty->model.springs, model->springs, sizeof *model->springs * (size_t)model->spring_count);
    for (int i = 0; i < model->spring_count && fault == STIFFNESS; i++) faulty->model.springs[i].stiffness *= 1.01;
    for (int axis = 0; axis < 3 && fault == GRAVITY; axis++) faulty->model.gravity[axis] *= 1.001;
    if (fault == SPRING_MISSING) {
        int middle = model->spring_count / 3;
        faulty->model.springs[middle] = faulty->model.springs[--faulty->model.spring_count];
    }
    *state = faulty;
    return ck_engine_find("native-verlet")->create(&faulty->engine, &faulty->model, wanted, used, ledger, error);
}

static ck_StepResult step_faulty(void *state) {
    return ck_engine_find("native-verlet")->step(((Faulty *)state)->engine);
}

static void read_faulty(const void *state, double *position, double *velocity) {
    ck_engine_find("native-verlet")->read(((const Faulty *)state)->engine, position, velocity);
}

static void destroy_faulty(void *state) {
    Faulty *faulty = state;
    ck_engine_find("native-verlet")->destroy(faulty->engine);
    free(faulty->model.springs);
    free(faulty);
}

#define FAULTY_CREATE(name, fault)                                                                                     \
    static ck_Status name(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,           \
                          ck_Ledger *ledger, ck_Error *error) {                                                        \
        return create_faulty(state, model, used, wanted, ledger, error, fault);                                        \
    }

FAULTY_CREATE(create_healthy, NO_FAULT)
FAULTY_CREATE(create_stiffness, STIFFNESS)
FAULTY_CREATE(create_gravity, GRAVITY)
FAULTY_CREATE(create_missing, SPRING_MISSING)

// An engine of its own for the damping: midpoint steps with damping along the spring, or along the whole relative
// velocity.
typedef struct Damped {
    const ck_Model *model;
    bool wrong;
    double *position, *velocity; // [3*n]
} Damped;

static void accelerate(const Damped *damped, const double *position, const double *velocity, double *acceleration) {
    const ck_Model *model = damped->model;
    ck_springs_accelerate(model, position, velocity, acceleration);
    for (int i = 0; i < model->spring_count && damped->wrong; i++) {
        const ck_Spring *spring = &model->springs[i];
        double d[3], across[3];
        ck_subtract(d, position + 3 * spring->b, position + 3 * spring->a);
        ck_subtract(across, velocity + 3 * spring->b, velocity + 3 * spring->a);
        ck_add_scaled(across, -ck_dot(across, d) / ck_dot(d, d), d);
        if (!model->pinned[spring->a])
            ck_add_scaled(acceleration + 3 * spring->a, spring->damping / model->mass[spring->a], across);
        if (!model->pinned[spring->b])
            ck_add_scaled(acceleration + 3 * spring->b, -spring->damping / model->mass[spring->b], across);
    }
}

static ck_Status create_damped(void **state, const ck_Model *model, ck_Settings *used, bool wrong) {
    size_t bytes = 3 * sizeof(double) * (size_t)model->particle_count;
    Damped *damped = calloc(1, sizeof *damped);
    *damped = (Damped){model, wrong, malloc(bytes), malloc(bytes)};
    memcpy(damped->position, model->position, bytes);
    memcpy(damped->velocity, model->velocity, bytes);
    *used = (ck_Settings){.substeps = 200};
    *state = damped;
    return CK_OK;
}

static ck_Status create_along(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                              ck_Ledger *ledger, ck_Error *error) {
    (void)wanted, (void)ledger, (void)error;
    return create_damped(state, model, used, false);
}

static ck_Status create_across(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                               ck_Ledger *ledger, ck_Error *error) {
    (void)wanted, (void)ledger, (void)error;
    return create_damped(state, model, used, true);
}

static ck_StepResult step_damped(void *state) {
    Damped *damped = state;
    int count = 3 * damped->model->particle_count;
    double dt = damped->model->step / 200, *middle = malloc(3 * sizeof(double) * (size_t)count),
           *speed = middle + count, *acceleration = speed + count;
    for (int step = 0; step < 200; step++) {
        accelerate(damped, damped->position, damped->velocity, acceleration);
        for (int i = 0; i < count; i++) {
            middle[i] = damped->position[i] + 0.5 * dt * damped->velocity[i];
            speed[i] = damped->velocity[i] + 0.5 * dt * acceleration[i];
        }
        accelerate(damped, middle, speed, acceleration);
        for (int i = 0; i < count; i++) {
            damped->position[i] += dt * speed[i];
            damped->velocity[i] += dt * acceleration[i];
        }
    }
    free(middle);
    return CK_STEP_OK;
}

static void read_damped(const void *state, double *position, double *velocity) {
    const Damped *damped = state;
    memcpy(position, damped->position, 3 * sizeof(double) * (size_t)damped->model->particle_count);
    memcpy(velocity, damped->velocity, 3 * sizeof(double) * (size_t)damped->model->particle_count);
}

static void destroy_damped(void *state) {
    Damped *damped = state;
    free(damped->position);
    free(damped->velocity);
    free(damped);
}

static const char *version(void) {
    return "test";
}

#define ENGINE(engine_name, create_function, kind)                                                                     \
    {                                                                                                                  \
        .name = engine_name, .about = "faulty", .family = "test", .version = version,                                  \
        .method = CK_METHOD_VELOCITY_VERLET,                                                                           \
        .terms = CK_TERM_SPRINGS | CK_TERM_DAMPING | CK_TERM_GRAVITY | CK_TERM_DRAG, .order = 2,                       \
        .create = create_function, .step = step_##kind, .read = read_##kind, .destroy = destroy_##kind                 \
    }

static const ck_Engine healthy = ENGINE("healthy", create_healthy, faulty),
                       stiffer = ENGINE("stiffer", create_stiffness, faulty),
                       heavier = ENGINE("heavier", create_gravity, faulty),
                       torn = ENGINE("torn", create_missing, faulty), along = ENGINE("along", create_along, damped),
                       across = ENGINE("across", create_across, damped);

#define CLOTH                                                                                                          \
    "cloth: {rows: 5, columns: 5, spacing: 0.1, mass: 0.25, down: [0, 0, 1]}\nsprings: {stiffness: 100, damping: "     \
    "0.05, shear: 50}\npins: [top_left, top_right]\ngravity: [0, -9.81, 0]\n"
static const char hanging[] = "name: hanging\n" CLOTH "drag: 6\ntime: {duration: 5, step: 0.02}\ntruth: equilibrium\n";
static const char moving[] = "name: moving\n" CLOTH "drag: 1\ntime: {duration: 0.4, step: 0.02}\ntruth: trajectory\n";

// How far a run's error in a metric is beyond what the truth's uncertainty and the method's theory leave room for.
static double unexplained(const ck_Comparison *comparison, int run, const char *name) {
    const ck_Metric *metric = ck_metric_find(name);
    double value =
        ck_metric_value(metric, &comparison->model, &comparison->runs[run].trajectory, &comparison->truth.reference);
    double truth = ck_metric_truth(metric, &comparison->model, &comparison->truth.reference);
    return fabs(value - truth) / ck_truth_uncertainty(&comparison->truth, &comparison->model, metric);
}

static void compare(ck_Comparison *comparison, const char *text, const ck_Engine *const *engines, int count) {
    fixture_load_comparison(comparison, text);
    ck_CompareOptions options = ck_compare_options_default();
    options.engines = engines;
    options.engine_count = count;
    options.repeats = 0;
    ck_Error error = {0};
    if (ck_comparison_run(comparison, &options, &error)) fail_msg("%s", error.message);
    for (int i = 0; i < count; i++)
        if (comparison->runs[i].status != CK_RUN_OK) fail_msg("%s: %s", engines[i]->name, comparison->runs[i].reason);
}

// At rest the healthy engine is off by what is left of the motion, which is the truth's uncertainty (twice that allows
// for the phase of it). Each fault shows beyond ten of them, where physics says it must: sag and stretch.
static void test_faults_at_rest(void **state) {
    (void)state;
    const ck_Engine *const engines[] = {&healthy, &stiffer, &heavier, &torn};
    ck_Comparison comparison;
    compare(&comparison, hanging, engines, 4);
    const char *const columns[] = {"sag", "stretch_max", "stretch_rms", "position_rms"};
    for (int column = 0; column < 4; column++) {
        double fine = unexplained(&comparison, 0, columns[column]);
        if (!(fine <= 2)) fail_msg("the healthy engine's %s is off by %.3g uncertainties", columns[column], fine);
        for (int fault = 1; fault < 4; fault++) {
            double found = unexplained(&comparison, fault, columns[column]);
            if (!(found > 10))
                fail_msg("%s does not show in %s: %.3g uncertainties", engines[fault]->name, columns[column], found);
        }
    }
    // and by how much: 1 % of stiffness takes 1 % of the strain, to first order
    const ck_Metric *stretch = ck_metric_find("stretch_rms");
    double right =
        ck_metric_value(stretch, &comparison.model, &comparison.runs[0].trajectory, &comparison.truth.reference);
    double stiff =
        ck_metric_value(stretch, &comparison.model, &comparison.runs[1].trajectory, &comparison.truth.reference);
    assert_near("the strain of springs 1 % stiffer", stiff / right, 1 / 1.01, 3e-3);
    // a missing spring makes an outlier; 1 % of gravity changes strain by 2e-4, and that is none yet
    double apart = ck_metric_deviation(stretch, &comparison.model, &comparison.runs[0].trajectory,
                                       &comparison.runs[1].trajectory, &comparison.truth.reference);
    assert_true(apart > 5e-3 * right);
    for (int i = 0; i < 2; i++) {
        const ck_Engine *const three[] = {&healthy, ck_engine_find("bullet-implicit"), ck_engine_find("ode-direct"),
                                          i ? &torn : &heavier};
        ck_Comparison others;
        compare(&others, hanging, three, 4);
        ck_Outlier outlier = ck_outlier_find(&others, stretch);
        assert_int_equal(outlier.run, i ? 3 : -1);
        assert_true(!i || outlier.distance > 10 * outlier.rest);
        ck_comparison_free(&others);
    }
    ck_comparison_free(&comparison);
}

// With a truth in the table the outlier is the one that is off from it, not the one that others are off from; and what
// is below the truth's uncertainty, or a thousandth, is none.
static void test_outlier_by_truth(void **state) {
    (void)state;
    const ck_Metric *stretch = ck_metric_find("stretch_rms");
    const ck_Engine *const engines[] = {&healthy, &heavier, &torn, &stiffer};
    ck_Comparison comparison;
    compare(&comparison, hanging, engines, 4);
    ck_Outlier outlier = ck_outlier_find(&comparison, stretch);
    assert_true(outlier.has_truth);
    assert_int_not_equal(outlier.run, 0);
    ck_comparison_free(&comparison);
    const ck_Engine *const alike[] = {&healthy, ck_engine_find("native-verlet"), ck_engine_find("bullet-explicit")};
    compare(&comparison, hanging, alike, 3);
    assert_true(ck_outlier_find(&comparison, stretch).run < 0);
    ck_comparison_free(&comparison);
}

// Damping along the whole relative velocity changes no rest position: it shows in motion, in position_rms and
// energy_path, a hundred times beyond the step error that the same engine has with damping along the spring.
static void test_damping_direction(void **state) {
    (void)state;
    const ck_Engine *const engines[] = {&along, &across};
    ck_Comparison comparison;
    compare(&comparison, moving, engines, 2);
    assert_true(comparison.truth.path_count == 2);
    const char *const columns[] = {"position_rms", "energy_path", "sag_path"};
    for (int column = 0; column < 3; column++) {
        double right = unexplained(&comparison, 0, columns[column]),
               wrong = unexplained(&comparison, 1, columns[column]);
        if (!(wrong > 100 * right))
            fail_msg("damping across the springs does not show in %s: %.3g against %.3g uncertainties", columns[column],
                     wrong, right);
    }
    ck_comparison_free(&comparison);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_faults_at_rest), cmocka_unit_test(test_outlier_by_truth),
                                       cmocka_unit_test(test_damping_direction)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
