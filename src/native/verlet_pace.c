#include "verlet_pace.h"

#include "path.h"
#include "time_scale.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Substeps after which the error is looked at, which costs as much as half of one; and while they grow.
#define TOGETHER 16
#define TOGETHER_GROWING 2
// The share of a frame that a step is at least: what flies apart would ask for ever shorter ones.
#define LEAST 1e-6
// The share of an even step that the first ones are: nothing is known then.
#define FIRST 0.03
// Frames after which stability is looked at: what a cloth's folding does to its highest frequency is slow.
#define LOOK_FRAMES 8
// The share of the largest stable step that is taken: what folds within those frames stays inside.
#define SAFETY 0.85
// What an error within the tolerance lets a step grow by at once, and one beyond it shrink.
#define GROWTH 1.5
#define SHRINKAGE 0.25
// The share of what was seen that holds at the next look: twice a swing a jerk is 0.
#define MEMORY 0.8
// The error, as a share of the tolerance, that is aimed at.
#define AIM 0.8

struct ck_VerletPace {
    double tolerance;  // 1/s, of the size
    double size;       // m
    double wanted;     // s, as long as the error allows
    double limit;      // s, as long as is stable
    double slowest;    // s, what drag and pins that move allow
    double least;      // s, whatever the error says
    double jerk;       // 1/s³: the acceleration's change, over the size
    bool grows;        // it is still longer each time
    int frames, moved; // since stability was looked at; free particles
    uint64_t count;    // substeps so far
    double shortest, longest;
    double *before; // acceleration, as many as its kind has
    size_t room;
    char told[120];
};

ck_Status ck_verlet_pace_create(ck_VerletPace **out, const ck_Native *native, ck_Error *error) {
    const ck_Model *model = native->model;
    const double tolerance = ck_settings_own(&native->used, CK_NATIVE_TOLERANCE, 0);
    *out = NULL;
    if (!(tolerance > 0)) return CK_OK;
    ck_VerletPace *pace = calloc(1, sizeof *pace);
    if (!pace) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    pace->tolerance = tolerance;
    pace->size = model->size;
    pace->wanted = FIRST * native->dt;
    pace->grows = true;
    pace->slowest = fmin(ck_stability_drag_time(model, 0.25), ck_path_longest_step(model));
    pace->least = LEAST * model->step;
    pace->frames = LOOK_FRAMES;
    for (int i = 0; i < model->particle_count; i++) pace->moved += native->inverse_mass[i] > 0;
    pace->shortest = INFINITY;
    *out = pace;
    return CK_OK;
}

void ck_verlet_pace_destroy(ck_VerletPace *pace) {
    if (!pace) return;
    free(pace->before);
    free(pace);
}

ck_Status ck_verlet_pace_look(ck_VerletPace *pace, const ck_Native *native) {
    const ck_Model *model = native->model;
    double frequency;
    if (++pace->frames < LOOK_FRAMES) return CK_OK;
    pace->frames = 0;
    ck_Status status = ck_stability_frequency_at(model, native->position, &frequency);
    if (status) return status;
    const double damping = frequency * frequency * ck_stability_damping_time(model) + model->drag;
    pace->limit = frequency > 0 ? SAFETY * ck_stability_verlet_limit(frequency, damping) : INFINITY;
    return CK_OK;
}

uint32_t ck_verlet_pace_next(ck_VerletPace *pace, double left, double *dt) {
    const double longest = fmax(pace->least, fmin(pace->wanted, fmin(pace->limit, pace->slowest))),
                 count = fmax(2, ceil(left / longest * (1 - 1e-12)));
    *dt = left / count;
    const uint32_t most = pace->grows ? TOGETHER_GROWING : TOGETHER,
                   // no single one is left for the end, whose error nothing would tell
        together = count < most + 2 ? (uint32_t)count : most;
    pace->count += together;
    pace->shortest = fmin(pace->shortest, *dt);
    pace->longest = fmax(pace->longest, *dt);
    return together;
}

void ck_verlet_pace_before(ck_VerletPace *pace, const double *acceleration, size_t count) {
    if (count > pace->room) {
        double *before = realloc(pace->before, count * sizeof *before);
        if (!before) return; // then the step stays as it is
        pace->before = before;
        pace->room = count;
    }
    memcpy(pace->before, acceleration, count * sizeof *acceleration);
}

// In eight sums, so that it is a vector's work and the same on all processors.
static double square_change(const double *before, const double *after, size_t count) {
    double sums[8] = {0}, sum = 0;
    size_t i = 0;
    for (; i + 8 <= count; i += 8)
        for (int k = 0; k < 8; k++) sums[k] += (after[i + k] - before[i + k]) * (after[i + k] - before[i + k]);
    for (; i < count; i++) sum += (after[i] - before[i]) * (after[i] - before[i]);
    for (int k = 0; k < 8; k++) sum += sums[k];
    return sum;
}

void ck_verlet_pace_after(ck_VerletPace *pace, double dt, const double *acceleration, size_t count) {
    if (count > pace->room || !pace->moved) return;
    const double change = sqrt(square_change(pace->before, acceleration, count) / pace->moved),
                 jerk = change / dt / pace->size;
    pace->jerk = fmax(jerk, MEMORY * pace->jerk);
    // the error a second is dt²/6 times the jerk
    const double allowed = pace->jerk > 0 ? sqrt(6 * AIM * pace->tolerance / pace->jerk) : INFINITY;
    pace->grows = GROWTH * dt < fmin(allowed, fmin(pace->limit, pace->slowest));
    pace->wanted = fmin(GROWTH * dt, fmax(SHRINKAGE * dt, allowed));
}

const char *ck_verlet_pace_tell(ck_VerletPace *pace) {
    snprintf(pace->told, sizeof pace->told, "took %llu substeps of %.3g to %.3g s", (unsigned long long)pace->count,
             pace->shortest, pace->longest);
    return pace->told;
}
