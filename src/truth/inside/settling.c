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

// Half of the step at which the stiffest motion grows, and a quarter of the time in which drag takes a speed.
static ck_Status choose_step(const ck_Model *model, uint32_t *substeps) {
    double frequency;
    ck_Status status = ck_stability_frequency(model, &frequency);
    if (status) return status;
    double damping = frequency * frequency * ck_stability_damping_time(model) + model->drag;
    double limit = fmin(ck_stability_drag_time(model, 0.25), 0.5 * ck_stability_verlet_limit(frequency, damping));
    *substeps = ck_stability_substeps(model, limit);
    return CK_OK;
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

ck_Status ck_settle(const ck_Model *model, double nudge, uint64_t seed, double stiffness, double *position,
                    ck_Error *error) {
    size_t count = 3 * (size_t)model->particle_count;
    double *memory = malloc(3 * count * sizeof *memory);
    ck_Model moved = *model;
    // without damping it would swing for ever: then the drag that is critical for a pendulum of its size
    if (moved.drag == 0 && !(moved.terms & CK_TERM_DAMPING))
        moved.drag = 2 * sqrt(ck_stability_load(model) / ck_model_free_mass(model) / model->size);
    uint32_t substeps;
    if (!memory || choose_step(&moved, &substeps)) {
        free(memory);
        return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
    }
    ck_Touching *touching;
    const double origin[3] = {0, 0, 0};
    if (ck_touching_create(&touching, model, origin, stiffness)) {
        free(memory);
        return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
    }
    const Fall fall = {&moved, model->step / substeps, position, memory, memory + count, memory + 2 * count, touching};
    memcpy(position, model->position, count * sizeof *position);
    memcpy(fall.velocity, model->velocity, count * sizeof *memory);
    ck_Random random = ck_random_seed(seed);
    for (size_t i = 0; i < count; i++) {
        double offset = nudge * (2 * ck_random_unit(&random) - 1);
        if (!model->pinned[i / 3]) position[i] += offset;
    }
    accelerate(&fall, fall.velocity);
    ck_Status status = CK_OK;
    double still = ck_metric_still_speed(model), speed = INFINITY;
    for (int frame = 0; frame < model->frame_count && !(frame > 10 && speed < still) && !status; frame++) {
        for (uint32_t i = 0; i < substeps && !ck_child_interrupted; i++) fall_by_a_step(&fall);
        speed = fastest(&fall);
        status = speed >= 0 ? ck_child_check(error)
                            : ck_fail(error, CK_REFUSED, "%s: diverges on the way to its equilibrium", model->name);
    }
    ck_touching_free(touching);
    free(memory);
    return status;
}
