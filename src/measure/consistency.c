#include "trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FINER 8        // times as many substeps in the finest run
#define PIECES 4       // restarts
#define APART 8        // frames from one restart to the next
#define PIECE_FRAMES 4 // frames of a piece
#define BLOWN_UP 10    // sizes: a step that parts further from the finest is unstable, and how far says nothing

const int ck_consistency_multiples[CK_CONSISTENCY_STEPS] = {1, 2, 4};
const char *const ck_consistency_names[CK_CONSISTENCY_STEPS] = {"self_consistency", "self_consistency_2",
                                                                "self_consistency_4"};

typedef struct Result {
    double deviation[CK_CONSISTENCY_STEPS]; // sums over pieces
    int pieces[CK_CONSISTENCY_STEPS];
} Result;

typedef struct Job {
    const ck_Run *run;
    Result *result;
} Job;

// Steps an engine from the model's start for some frames and reads the last; false where it does not get there.
static bool advance(const ck_Run *run, const ck_Model *model, uint32_t substeps, int frames, double *position,
                    double *velocity) {
    ck_Settings wanted = run->used, used;
    wanted.substeps = substeps;
    void *state;
    if (ck_engine_create(run->engine, &state, model, &wanted, &used, NULL, NULL)) return false;
    bool reached = true;
    for (int i = 0; i < frames && reached; i++) reached = run->engine->step(state) == CK_STEP_OK;
    run->engine->read(state, position, velocity);
    run->engine->destroy(state);
    return reached;
}

static double distance(const ck_Model *model, const double *one, const double *other) {
    double sum = 0;
    for (int i = 0; i < 3 * model->particle_count; i++) sum += (one[i] - other[i]) * (one[i] - other[i]);
    return sqrt(sum / model->particle_count) / model->size;
}

// One restart: a piece at the finest step, and one at each of the others.
static void compare_piece(const ck_Run *run, const ck_Model *start, double *memory, Result *result) {
    size_t count = 3 * (size_t)start->particle_count;
    double *fine = memory, *coarse = memory + count, *velocity = memory + 2 * count;
    if (!advance(run, start, FINER * run->used.substeps, PIECE_FRAMES, fine, velocity)) return;
    for (int i = 0; i < CK_CONSISTENCY_STEPS; i++) {
        uint32_t multiple = (uint32_t)ck_consistency_multiples[i];
        if (run->used.substeps % multiple && run->used.substeps < 4 * multiple) continue;
        if (!advance(run, start, run->used.substeps / multiple, PIECE_FRAMES, coarse, velocity)) continue;
        result->deviation[i] += distance(start, fine, coarse);
        result->pieces[i]++;
    }
}

static void restart_pieces(void *context) {
    const Job *job = context;
    const ck_Run *run = job->run;
    size_t count = 3 * (size_t)run->model->particle_count;
    double *state = malloc(2 * count * sizeof(double)), *memory = malloc(3 * count * sizeof(double));
    if (!state || !memory) return;
    memcpy(state, run->model->position, count * sizeof(double));
    memcpy(state + count, run->model->velocity, count * sizeof(double));
    ck_Model start = *run->model;
    start.position = state;
    start.velocity = state + count;
    for (int piece = 0; piece < PIECES; piece++) {
        compare_piece(run, &start, memory, job->result);
        // on along the finest run, to the next restart
        if (!advance(run, &start, FINER * run->used.substeps, APART, memory, memory + count)) break;
        memcpy(state, memory, 2 * count * sizeof(double));
    }
    free(state);
    free(memory);
}

// What a spring and substep, or a sweep where there are several, costs, ns, by the method alone: so that
// whether it is measured does not depend on the machine, nor on what else runs there.
static double cost_of(const ck_Engine *engine) {
    static const double costs[] = {[CK_METHOD_UNKNOWN] = 100,         [CK_METHOD_STILL] = 1,
                                   [CK_METHOD_VELOCITY_VERLET] = 2,   [CK_METHOD_STOERMER_BARS] = 3,
                                   [CK_METHOD_STOERMER_DIRECT] = 30,  [CK_METHOD_XPBD] = 3,
                                   [CK_METHOD_BULLET_PBD] = 10,       [CK_METHOD_IMPLICIT_EULER] = 500,
                                   [CK_METHOD_SYMPLECTIC_EULER] = 50, [CK_METHOD_SEED] = 10,
                                   [CK_METHOD_SEMI_IMPLICIT_ODE] = 60};
    return costs[engine->method];
}

// s of CPU that a run of so many frames takes, roughly.
static double work_of(const ck_Run *run, double frames) {
    const double sweeps = run->used.substeps * fmax(1, run->used.iterations);
    return 1e-9 * cost_of(run->engine) * frames * sweeps * (run->model->spring_count + run->model->particle_count);
}

ck_Status ck_consistency_measure(double *deviation, const ck_Run *run, double budget, const ck_Limits *limits,
                                 ck_Error *error) {
    for (int i = 0; i < CK_CONSISTENCY_STEPS; i++) deviation[i] = NAN;
    double frames = PIECES * (FINER * (PIECE_FRAMES + APART) + PIECE_FRAMES * 2);
    bool complete = ck_run_has_all_frames(run);
    // a restart knows nothing of pins let go before it, nor how rigid bodies are turned
    if (!complete || run->model->rigid_count || run->model->segment_count || !run->used.substeps ||
        run->model->release_count || work_of(run, frames) > budget)
        return CK_OK;
    Result *result = ck_shared_allocate(sizeof *result);
    if (!result) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_ChildResult child;
    ck_Limits own = *limits;
    own.spawns = run->engine->outside && run->engine->outside->spawns;
    ck_Status status = ck_child_run(&child, restart_pieces, &(Job){run, result}, &own, error);
    for (int i = 0; i < CK_CONSISTENCY_STEPS && !status && child.end == CK_CHILD_DONE; i++)
        if (result->pieces[i]) deviation[i] = result->deviation[i] / result->pieces[i];
    for (int i = 0; i < CK_CONSISTENCY_STEPS; i++)
        if (deviation[i] > BLOWN_UP) deviation[i] = INFINITY;
    ck_shared_free(result, sizeof *result);
    return status;
}
