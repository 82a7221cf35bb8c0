#include "claims.h"

#include "csv_child.h"
#include "engines.h"
#include "files.h"
#include "model.h"
#include "process.h"
#include "scene.h"
#include "seed.h"
#include "vector.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Beyond this many times its length a bar has blown up, finite or not.
#define BLOWN_UP 1000

typedef enum Parameter { SWEEPS, FRAME_RATE, SUBSTEPS, NOTHING } Parameter;
static const char *const parameter_names[] = {"sweeps", "frame_rate", "substeps", ""};

typedef struct Claim {
    const char *text, *scene, *engine;
    uint32_t mended;
    Parameter parameter;
    double seconds;    // of the run
    double values[16]; // of the parameter, ended by 0
    bool is_bare;      // without damping, drag and colliders
} Claim;

#define SWEEP_VALUES                                                                                                   \
    { 1, 2, 4, 5, 10, 20, 50, 100, 120, 200, 201, 250, 300, 400 }
#define SUBSTEP_VALUES                                                                                                 \
    { 6, 8, 9, 10, 11, 12, 15, 30, 60, 90, 105, 120, 150, 200 }

static const Claim claims[] = {
    {"4 to 10 sweeps look convincing", "seed_tecido_flag", "seed-tecido", 0, SWEEPS, 20, SWEEP_VALUES, false},
    {"4 to 10 sweeps look convincing", "seed_tecido_flag", "seed-tecido", CK_TECIDO_HALF_CORRECTION, SWEEPS, 20,
     SWEEP_VALUES, false},
    {"4 to 10 sweeps look convincing",
     "seed_tecido_rope",
     "seed-tecido",
     0,
     SWEEPS,
     20,
     {4, 5, 10, 20, 50, 200},
     false},
    {"the cloth does not depend on the frame rate",
     "seed_tecido_flag",
     "seed-tecido",
     0,
     FRAME_RATE,
     20,
     {10, 15, 30, 60, 144, 240},
     false},
    {"a frame must be cut into steps", "seed_cloth_drape", "seed-cloth", 0, SUBSTEPS, 10, SUBSTEP_VALUES, false},
    {"a frame must be cut into steps", "seed_cloth_drape", "seed-cloth", CK_CLOTH_FORWARD_EULER, SUBSTEPS, 10,
     SUBSTEP_VALUES, false},
    {"150 steps a frame are enough",
     "seed_cloth_drape",
     "seed-cloth",
     0,
     FRAME_RATE,
     10,
     {60, 30, 15, 5, 3, 2, 1},
     false},
    {"150 steps a frame are enough, without what takes energy",
     "seed_cloth_drape",
     "seed-cloth",
     0,
     SUBSTEPS,
     10,
     {150},
     true},
    {"150 steps a frame are enough, without what takes energy",
     "seed_cloth_drape",
     "seed-cloth",
     CK_CLOTH_FORWARD_EULER,
     SUBSTEPS,
     10,
     {150},
     true},
    {"it slides off the ball when both pins go", "seed_cloth_dropped", "seed-cloth", 0, SUBSTEPS, 2.9, {150}, false},
    {"generic for any masses and bars", "network_truss", "seed-tecido", 0, SWEEPS, 5, {5, 50, 200}, false},
    {"generic for any masses and bars", "hammock", "seed-tecido", 0, SWEEPS, 5, {5, 50, 200}, false},
    {"generic for any masses and bars", "rope_heavy_end", "seed-tecido", 0, SWEEPS, 5, {5, 50, 200}, false},
    {"generic for any masses and bars",
     "rope_heavy_end",
     "seed-tecido",
     CK_TECIDO_HALF_CORRECTION | CK_TECIDO_MASSLESS_BARS,
     SWEEPS,
     5,
     {5, 50, 200},
     false},
};

// What is followed of a run.
typedef enum Measure { LONGEST, TIP, LOWEST, HIGHEST, SPEED, ENERGY, MEASURE_COUNT } Measure;
static const char *const measure_names[] = {"longest_bar", "tip_x", "y_min", "y_max", "speed_rms", "energy"};
static const char *const measure_units[] = {"1", "m", "m", "m", "m/s", "J"};

typedef struct Outcome {
    double value[MEASURE_COUNT], low[MEASURE_COUNT], high[MEASURE_COUNT];
    double blown_up_at; // s; NaN: never
    double frame_cpu;   // s, mean of a frame
    double frame;       // s, what it may take in real time
} Outcome;

static void measure(const ck_Model *model, const double *x, const double *v, double *value) {
    double squares = 0, energy = 0;
    value[LONGEST] = 0;
    value[TIP] = value[HIGHEST] = -INFINITY;
    value[LOWEST] = INFINITY;
    for (int i = 0; i < model->particle_count; i++) {
        double field[3];
        value[TIP] = fmax(value[TIP], x[3 * i]);
        value[LOWEST] = fmin(value[LOWEST], x[3 * i + 1]);
        value[HIGHEST] = fmax(value[HIGHEST], x[3 * i + 1]);
        squares += ck_dot(v + 3 * i, v + 3 * i);
        ck_model_field(model, i, field);
        energy += model->mass[i] * (0.5 * ck_dot(v + 3 * i, v + 3 * i) - ck_dot(field, x + 3 * i));
    }
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        double length = ck_distance(x + 3 * spring->a, x + 3 * spring->b), stretch = length - spring->rest;
        value[LONGEST] = fmax(value[LONGEST], length / spring->rest);
        if (isfinite(spring->stiffness)) energy += 0.5 * spring->stiffness * stretch * stretch;
    }
    value[SPEED] = sqrt(squares / model->particle_count);
    value[ENERGY] = energy;
}

static void start_range(Outcome *outcome) {
    for (int i = 0; i < MEASURE_COUNT; i++) {
        outcome->low[i] = INFINITY;
        outcome->high[i] = -INFINITY;
    }
}

// Steps an engine for so many frames; an engine that blows up ends early.
//   state  [6*n] scratch
static ck_Status follow(Outcome *outcome, const ck_Engine *engine, const ck_Model *model, const ck_Settings *wanted,
                        int frames, double *state, ck_Error *error) {
    ck_Settings used;
    void *world;
    ck_Status status = ck_engine_create(engine, &world, model, wanted, &used, NULL, error);
    if (status) return status;
    double *velocity = state + 3 * (size_t)model->particle_count, cpu = 0;
    int frame = 0;
    *outcome = (Outcome){.blown_up_at = NAN, .frame = model->step};
    start_range(outcome);
    for (; frame < frames && isnan(outcome->blown_up_at); frame++) {
        double start = ck_thread_cpu();
        ck_StepResult result = ck_engine_advance(engine, world, model, frame);
        cpu += ck_thread_cpu() - start;
        engine->read(world, state, velocity);
        measure(model, state, velocity, outcome->value);
        if (result != CK_STEP_OK || !(outcome->value[LONGEST] < BLOWN_UP))
            outcome->blown_up_at = (frame + 1) * model->step;
        for (int i = 0; i < MEASURE_COUNT && frame + 1 >= frames - frames / 4; i++) {
            outcome->low[i] = fmin(outcome->low[i], outcome->value[i]);
            outcome->high[i] = fmax(outcome->high[i], outcome->value[i]);
        }
    }
    outcome->frame_cpu = cpu / frame;
    engine->destroy(world);
    return CK_OK;
}

static void add_row(ck_Csv *csv, const Claim *claim, double parameter, const char *metric, const char *unit,
                    double value, double low, double high) {
    ck_csv_text(csv, claim->text);
    ck_csv_text(csv, claim->scene);
    ck_csv_text(csv, claim->engine);
    ck_csv_count(csv, claim->mended);
    ck_csv_text(csv, parameter_names[claim->parameter]);
    ck_csv_number(csv, parameter);
    ck_csv_text(csv, metric);
    ck_csv_text(csv, unit);
    ck_csv_number(csv, value);
    ck_csv_number(csv, low);
    ck_csv_number(csv, high);
}

static void add_outcome(ck_Csv *csv, const Claim *claim, double parameter, const Outcome *outcome) {
    bool blown_up = !isnan(outcome->blown_up_at);
    add_row(csv, claim, parameter, "blown_up", "1", blown_up, blown_up, blown_up);
    if (blown_up) add_row(csv, claim, parameter, "blown_up_at", "s", outcome->blown_up_at, NAN, NAN);
    for (int i = 0; i < MEASURE_COUNT && !blown_up; i++)
        add_row(csv, claim, parameter, measure_names[i], measure_units[i], outcome->value[i], outcome->low[i],
                outcome->high[i]);
    add_row(csv, claim, parameter, "cpu_per_frame", "s", outcome->frame_cpu, NAN, NAN);
    add_row(csv, claim, parameter, "realtime_factor", "1", outcome->frame / outcome->frame_cpu, NAN, NAN);
}

ck_Status ck_claims_load(ck_Scene *scene, ck_Model *model, const char *scenes, const char *name, ck_Error *error) {
    char file[100];
    snprintf(file, sizeof file, "%s.yaml", name);
    char *path = ck_path_join(scenes, file);
    if (!path) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Status status = ck_scene_load(scene, path, error);
    if (!status) status = ck_model_build(model, scene, error);
    free(path);
    return status;
}

// The same scene without damping, drag and colliders.
static void strip(ck_Model *model) {
    for (int i = 0; i < model->spring_count; i++) model->springs[i].damping = 0;
    model->drag = 0;
    model->collider_count = 0;
    model->terms &= ~(unsigned)(CK_TERM_DAMPING | CK_TERM_DRAG | CK_TERM_COLLIDERS);
}

static ck_Status sweep(ck_Csv *csv, const Claim *claim, const ck_Scene *scene, ck_Model *model,
                       void (*progress)(const char *claim, double value), ck_Error *error) {
    const ck_Engine *engine = ck_engine_find(claim->engine);
    double *state = malloc(6 * sizeof(double) * (size_t)model->particle_count), frame = model->step;
    ck_Status status = state ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (claim->is_bare) strip(model);
    for (int i = 0; claim->values[i] > 0 && !status; i++) {
        double value = claim->values[i];
        ck_Settings wanted = ck_engine_scene_settings(engine, scene);
        ck_settings_set(&wanted, ck_setting_find(engine->settings, "mended")->slot, claim->mended);
        if (claim->parameter == SWEEPS) wanted.iterations = (uint32_t)value;
        if (claim->parameter == SUBSTEPS) wanted.substeps = (uint32_t)value;
        model->step = claim->parameter == FRAME_RATE ? 1 / value : frame;
        Outcome outcome;
        if (progress) progress(claim->text, value);
        status = follow(&outcome, engine, model, &wanted, (int)round(claim->seconds / model->step), state, error);
        if (!status) add_outcome(csv, claim, value, &outcome);
    }
    free(state);
    return status;
}

typedef struct Case {
    const Claim *claim;
    const char *scenes;
    void (*progress)(const char *claim, double value);
} Case;

static ck_Status write_claim(ck_Csv *csv, void *context, ck_Error *error) {
    const Case *one = context;
    ck_Scene scene = {0};
    ck_Model model = {0};
    ck_Status status = ck_claims_load(&scene, &model, one->scenes, one->claim->scene, error);
    if (!status) status = sweep(csv, one->claim, &scene, &model, one->progress, error);
    ck_model_free(&model);
    ck_scene_free(&scene);
    return status;
}

ck_Status ck_claims_write(ck_Csv *csv, const char *scenes, void (*progress)(const char *claim, double value),
                          ck_Error *error) {
    const ck_Limits limits = ck_limits_default();
    ck_Status status = CK_OK;
    for (size_t i = 0; i < sizeof claims / sizeof *claims && !status; i++) {
        if (progress) progress(claims[i].text, claims[i].values[0]);
        status = ck_csv_from_child(csv, write_claim, &(Case){&claims[i], scenes, progress}, &limits, error);
        const ck_Error why = *error;
        if (status == CK_REFUSED)
            status = ck_fail(error, status, "%s on %s: %s", claims[i].engine, claims[i].scene, why.message);
    }
    return status;
}
