#include "settling.h"

#include "metric.h"
#include "process.h"
#include "springs.h"
#include "statistics.h"
#include "time_scale.h"
#include "touching.h"
#include "vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A body on its way to rest; arrays [3*n].
typedef struct Fall {
    const ck_Model *model;
    uint32_t substeps; // a frame
    double dt;
    double *position, *velocity, *acceleration, *predicted;
    const ck_Touching *touching; // what is inside of a surface is pushed out by springs; NULL: nothing can be
} Fall;

static void accelerate(const Fall *fall, const double *velocity) {
    const ck_Model *model = fall->model;
    ck_springs_accelerate(model, fall->position, velocity, fall->acceleration);
    if (!fall->touching) return;
    // by mass, as accelerations are
    for (int i = 0; i < 3 * model->particle_count; i++) fall->acceleration[i] *= -model->mass[i / 3];
    ck_touching_energy(fall->touching, fall->position, fall->acceleration);
    for (int i = 0; i < 3 * model->particle_count; i++)
        fall->acceleration[i] *= model->pinned[i / 3] ? 0 : -1 / model->mass[i / 3];
}

// Velocity Verlet with the velocity predicted: of second order with damping, too. No engine's code: which rest a body
// falls into is for the truth to say. Source: Groot and Warren 1997, eq. 10 with λ = 1.
static void fall_by_a_step(const Fall *fall) {
    const double dt = fall->dt;
    for (int i = 0; i < 3 * fall->model->particle_count; i++) {
        fall->position[i] += dt * (fall->velocity[i] + 0.5 * dt * fall->acceleration[i]);
        fall->predicted[i] = fall->velocity[i] + dt * fall->acceleration[i];
        fall->velocity[i] += 0.5 * dt * fall->acceleration[i];
    }
    accelerate(fall, fall->predicted);
    for (int i = 0; i < 3 * fall->model->particle_count; i++) fall->velocity[i] += 0.5 * dt * fall->acceleration[i];
}

// Of the stiffest motion's frequency, the fastest rate of spring damping on the way to rest; twice of it is critical.
// More would only take more steps, without a bound: at this a step is an eighth of an undamped one.
#define MOST_DAMPING 4

// A copy of the springs whose dampers are as strong as they are worth stepping; NULL without memory.
static ck_Spring *damped_springs(const ck_Model *model, double frequency) {
    ck_Spring *springs = malloc(((size_t)model->spring_count + 1) * sizeof *springs);
    if (!springs) return NULL;
    const double share = fmin(1, MOST_DAMPING * frequency / ck_stability_damping_rate(model));
    for (int i = 0; i < model->spring_count; i++) {
        springs[i] = model->springs[i];
        springs[i].damping *= share;
    }
    return springs;
}

// Half of the step at which the stiffest motion grows, and a quarter of the time in which drag takes a speed.
static uint32_t choose_step(const ck_Model *model, double frequency) {
    double damping = ck_stability_damping_rate(model) + model->drag;
    double limit = fmin(ck_stability_drag_time(model, 0.25), 0.5 * ck_stability_verlet_limit(frequency, damping));
    return ck_stability_substeps(model, limit);
}

// The speed of the fastest particle, m/s; NaN where any has left the finite numbers.
static double fastest(const Fall *fall) {
    double largest = 0, sum = 0;
    for (int i = 0; i < fall->model->particle_count; i++) {
        double speed = ck_length(fall->velocity + 3 * i);
        largest = fmax(largest, speed);
        sum += speed;
    }
    return isfinite(sum) ? largest : NAN;
}

// Memory, dampers and the step of a fall; false without memory.
//   moved  of which springs become a copy
static bool prepare(Fall *fall, ck_Model *moved, double *position) {
    const size_t count = 3 * (size_t)moved->particle_count;
    double frequency, *memory = malloc(3 * count * sizeof *memory);
    const bool is_known = !ck_stability_frequency(moved, &frequency);
    moved->springs = is_known ? damped_springs(moved, frequency) : NULL;
    *fall = (Fall){.model = moved, .position = position, .velocity = memory};
    if (!memory || !moved->springs) return false;
    fall->acceleration = memory + count;
    fall->predicted = memory + 2 * count;
    fall->substeps = choose_step(moved, frequency);
    fall->dt = moved->step / fall->substeps;
    return true;
}

static void start_falling(const Fall *fall, double nudge, uint64_t seed) {
    const ck_Model *model = fall->model;
    const size_t count = 3 * (size_t)model->particle_count;
    memcpy(fall->position, model->position, count * sizeof *fall->position);
    memcpy(fall->velocity, model->velocity, count * sizeof *fall->velocity);
    ck_Random random = ck_random_seed(seed);
    for (size_t i = 0; i < count; i++) {
        double offset = nudge * (2 * ck_random_unit(&random) - 1);
        if (!model->pinned[i / 3]) fall->position[i] += offset;
    }
    accelerate(fall, fall->velocity);
}

static ck_Status go_on_until_still(const Fall *fall, ck_Error *error) {
    const ck_Model *model = fall->model;
    const double still = ck_metric_still_speed(model);
    double speed = INFINITY;
    ck_Status status = CK_OK;
    for (int frame = 0; frame < model->frame_count && !(frame > 10 && speed < still) && !status; frame++) {
        for (uint32_t i = 0; i < fall->substeps && !ck_child_interrupted; i++) fall_by_a_step(fall);
        speed = fastest(fall);
        status = speed >= 0 ? ck_child_check(error)
                            : ck_fail(error, CK_REFUSED, "%s: diverges on the way to its equilibrium", model->name);
    }
    return status;
}

ck_Status ck_settle(const ck_Model *model, double nudge, uint64_t seed, double stiffness, double *position,
                    ck_Error *error) {
    ck_Model moved = *model;
    ck_Touching *touching = NULL;
    const double origin[3] = {0, 0, 0};
    Fall fall = {0};
    ck_Status status = CK_OK;
    // without damping it would swing for ever: then the drag that is critical for a pendulum of its size
    if (moved.drag == 0 && !(moved.terms & CK_TERM_DAMPING))
        moved.drag = 2 * sqrt(ck_stability_load(model) / ck_model_free_mass(model) / model->size);
    if (!prepare(&fall, &moved, position) || ck_touching_create(&touching, model, origin, stiffness))
        status = ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
    fall.touching = touching;
    if (!status) start_falling(&fall, nudge, seed);
    if (!status) status = go_on_until_still(&fall, error);
    ck_touching_free(touching);
    free(fall.velocity);
    free(moved.springs);
    return status;
}
