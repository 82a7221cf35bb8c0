#include "bench_front.h"

#include "engines.h"
#include "process.h"
#include "statistics.h"
#include "time_scale.h"
#include "vector.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FRAMES 30
#define FRAME (1.0 / 60)
// m, by which particles are off a plane: what folds does so alike in all engines.
#define NOISE 1e-4
// Substeps a frame at most.
#define MOST_SUBSTEPS (1 << 15)

const double ck_bench_targets[CK_BENCH_TARGETS] = {1e-2, 1e-3};
static const uint32_t sweeps[] = {1, 2, 4, 10, 30};

static void roughen(ck_Model *model) {
    ck_Random random = ck_random_seed(1);
    for (int i = 0; i < 3 * model->particle_count; i++)
        if (!model->pinned[i / 3]) model->position[i] += NOISE * (2 * ck_random_unit(&random) - 1);
}

void ck_bench_front_free(ck_BenchFront *front) {
    free(front->reference);
    ck_model_free(&front->model);
}

// The error of so large a sum of squares, m², over all frames.
static double error_of(const ck_BenchFront *front, double sum) {
    return sqrt(sum / front->model.particle_count / front->frames) / front->model.size;
}

// A run, frame by frame: kept, where keeps, else told the error against what is kept, NaN for what fails, takes longer
// than the budget, or is beyond every target already.
static double follow(const ck_BenchFront *front, const ck_Engine *engine, void *state, bool keeps, double budget,
                     double *seconds) {
    const size_t count = 3 * (size_t)front->model.particle_count;
    double *x = malloc(2 * count * sizeof *x), sum = x ? 0 : NAN, spent = 0;
    int frame = 0;
    while (frame < front->frames && !isnan(sum)) {
        const double start = ck_thread_cpu();
        const ck_StepResult result = ck_engine_advance(engine, state, &front->model, frame);
        spent += ck_thread_cpu() - start;
        double *kept = front->reference + count * (size_t)frame++;
        engine->read(state, x, x + count);
        if (keeps) memcpy(kept, x, count * sizeof *x);
        for (size_t i = 0; i < count; i++) sum += (x[i] - kept[i]) * (x[i] - kept[i]);
        if (result != CK_STEP_OK || spent > budget || !(error_of(front, sum) <= ck_bench_targets[0])) sum = NAN;
    }
    *seconds = spent / (frame * FRAME);
    free(x);
    return error_of(front, sum);
}

double ck_bench_front_run(const ck_BenchFront *front, const ck_Engine *engine, const ck_Settings *wanted, double budget,
                          double *seconds, char reason[200]) {
    void *state;
    ck_Settings used;
    ck_Error why = {0};
    *seconds = NAN;
    if (ck_engine_create(engine, &state, &front->model, wanted, &used, NULL, &why)) {
        snprintf(reason, 200, "%.199s", why.message);
        return NAN;
    }
    const double error = follow(front, engine, state, false, budget, seconds);
    engine->destroy(state);
    return error;
}

ck_Status ck_bench_front_build(ck_BenchFront *front, const ck_BenchBody *body, double stiffness, ck_Error *error) {
    *front = (ck_BenchFront){.frames = FRAMES};
    ck_Model *model = &front->model;
    const ck_Engine *verlet = ck_engine_find("native-verlet");
    double frequency = 0, seconds;
    ck_Status status = ck_bench_body_build(model, body, true, error);
    if (status) return status;
    model->step = FRAME;
    roughen(model);
    for (int i = 0; i < model->spring_count; i++)
        model->springs[i].stiffness = model->springs[i].kind == CK_SHEAR ? 0.5 * stiffness : stiffness;
    front->reference = malloc(3 * sizeof(double) * (size_t)model->particle_count * FRAMES);
    status = front->reference ? ck_stability_frequency(model, &frequency) : CK_NO_MEMORY;
    if (status) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    void *state;
    ck_Settings used, wanted = {.substeps = (uint32_t)ceil(2 * FRAME * frequency)};
    status = ck_engine_create(verlet, &state, model, &wanted, &used, NULL, error);
    if (status) return status;
    follow(front, verlet, state, true, INFINITY, &seconds);
    verlet->destroy(state);
    wanted.substeps /= 2;
    char reason[200];
    front->uncertainty = ck_bench_front_run(front, verlet, &wanted, INFINITY, &seconds, reason);
    return CK_OK;
}

static bool is_power(uint32_t number) {
    return (number & (number - 1)) == 0;
}

// 2, 3, 4, 6, 8, 12 …
static uint32_t next_substeps(uint32_t substeps) {
    return is_power(substeps) ? substeps / 2 * 3 : substeps / 3 * 4;
}

static void take(ck_BenchCost *costs, const ck_Settings *settings, double error, double seconds) {
    for (int i = 0; i < CK_BENCH_TARGETS; i++)
        if (error <= ck_bench_targets[i] && !(costs[i].seconds <= seconds))
            costs[i] = (ck_BenchCost){*settings, seconds};
}

// Between the cheapest and the number tried before it.
static void refine(const ck_BenchFront *front, const ck_Engine *engine, double budget, const ck_BenchCost *found,
                   ck_BenchCost *costs) {
    char why[200];
    double seconds;
    ck_Settings wanted = found->settings;
    if (isnan(found->seconds)) return;
    wanted.substeps = is_power(wanted.substeps) ? wanted.substeps / 8 * 7 : wanted.substeps / 6 * 5;
    if (!wanted.substeps) return;
    const double error = ck_bench_front_run(front, engine, &wanted, budget, &seconds, why);
    take(costs, &wanted, error, seconds);
}

void ck_bench_front_search(const ck_BenchFront *front, const ck_Engine *engine, const ck_Settings *base, double budget,
                           ck_BenchCost *costs, char reason[200]) {
    const bool sweeps_over = ck_setting_find(engine->settings, "iterations") != NULL;
    *reason = 0;
    for (int i = 0; i < CK_BENCH_TARGETS; i++) costs[i] = (ck_BenchCost){.seconds = NAN};
    if (ck_engine_lacks(engine, &front->model)) snprintf(reason, 200, "does not model it");
    for (size_t k = 0; k < (sweeps_over ? sizeof sweeps / sizeof *sweeps : 1) && !*reason; k++) {
        double seconds = 0;
        for (uint32_t substeps = 2; substeps <= MOST_SUBSTEPS && !*reason; substeps = next_substeps(substeps)) {
            ck_Settings wanted = *base;
            wanted.substeps = substeps;
            if (sweeps_over) wanted.iterations = sweeps[k];
            const double most = fmin(budget, costs[CK_BENCH_TARGETS - 1].seconds * FRAMES * FRAME);
            // more steps take longer by as much, or nearly
            if (1.2 * seconds * FRAMES * FRAME > most) break;
            const double error = ck_bench_front_run(front, engine, &wanted, budget, &seconds, reason);
            take(costs, &wanted, error, seconds);
        }
    }
    ck_BenchCost found[CK_BENCH_TARGETS];
    memcpy(found, costs, sizeof found);
    for (int i = 0; i < CK_BENCH_TARGETS && !*reason; i++)
        if (!i || found[i].settings.substeps != found[i - 1].settings.substeps ||
            found[i].settings.iterations != found[i - 1].settings.iterations)
            refine(front, engine, budget, &found[i], costs);
    if (!*reason && isnan(costs[0].seconds)) snprintf(reason, 200, "no settings within %g s a run get there", budget);
}
