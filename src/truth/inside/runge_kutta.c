#include "runge_kutta.h"

#include "bars.h"
#include "path.h"
#include "process.h"
#include "springs.h"
#include "statistics.h"
#include "time_scale.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

#define AGREEMENT 1e-9
// Of forces with a kink, of a face that turns its other side to the wind or a spring that goes slack: there the method
// is of the second order.
#define AGREEMENT_WITH_KINKS 1e-6
#define GROWTH 1e4
// Steps of a whole path that are tried at most; a 20×20 cloth takes some 50 µs each.
#define MAX_STEPS 4e6

// A path on its way: y = {x, v}, [6*n].
typedef struct Walk {
    ck_Model now;          // without what is a bar, and with the pins there still are
    ck_Bars *bars;         // NULL: none
    double *y, *stage, *k; // k1 … k4 are {v, a}, each [6*n]
    bool has_failed;       // bars hold one another
} Walk;

// Accelerations of the state there, with what moves pins and what bars pull with.
//   y  [6*n] in, where moved pins are put;  k  [6*n] out
static void derive(Walk *walk, double time, int side, double *y, double *k) {
    const size_t half = 3 * (size_t)walk->now.particle_count;
    if (walk->now.driven_count) ck_driven_place(&walk->now, time, side, y, y + half);
    memcpy(k, y + half, half * sizeof(double));
    ck_springs_accelerate(&walk->now, y, y + half, k + half);
    if (!walk->bars) return;
    // bars follow the pins that move; a pin's own motion is not integrated
    if (walk->now.driven_count) ck_driven_accelerate(&walk->now, time, side, k + half);
    walk->has_failed |= !ck_bars_accelerate(walk->bars, y, y + half, k + half);
}

// One step. Source: Kutta 1901.
static void runge_kutta(Walk *walk, double time, double dt) {
    static const double nodes[4] = {0, 0.5, 0.5, 1}, weights[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    const size_t whole = 6 * (size_t)walk->now.particle_count;
    double *y = walk->y, *k = walk->k;
    for (int i = 0; i < 4; i++) {
        double *now = k + (size_t)i * whole, *before = now - whole;
        for (size_t j = 0; j < whole; j++) walk->stage[j] = y[j] + (i ? nodes[i] * dt * before[j] : 0);
        derive(walk, time + nodes[i] * dt, i < 3 ? 1 : -1, walk->stage, now);
    }
    for (size_t j = 0; j < whole; j++)
        y[j] += dt * (weights[0] * k[j] + weights[1] * k[whole + j] + weights[2] * k[2 * whole + j] +
                      weights[3] * k[3 * whole + j]);
    if (walk->now.driven_count) ck_driven_place(&walk->now, time + dt, -1, y, y + whole / 2);
    if (walk->bars) walk->has_failed |= !ck_bars_project(walk->bars, y, y + whole / 2);
}

static void nudge_start(const ck_Model *model, double *position, double nudge, uint64_t seed) {
    ck_Random random = ck_random_seed(seed);
    for (int i = 0; i < 3 * model->particle_count; i++) {
        double sign = ck_random_unit(&random) < 0.5 ? -1 : 1;
        if (!model->pinned[i / 3]) position[i] += sign * nudge;
    }
}

static void let_go(const ck_Model *now, int frame) {
    for (int i = 0; i < now->release_count; i++)
        for (int j = 0; j < now->releases[i].particle_count && now->releases[i].frame == frame; j++)
            now->pinned[now->releases[i].particles[j]] = false;
}

static double next_jump(const ck_Model *model, double time) {
    double next = INFINITY;
    for (int i = 0; i < model->path_count; i++) next = fmin(next, ck_path_next_jump(&model->paths[i], time));
    return next;
}

// From one frame to the next, in pieces between which what moves pins jumps: so it keeps its order.
static void walk_frame(Walk *walk, int frame, int substeps) {
    const ck_Model *model = &walk->now;
    const double end = (frame + 1) * model->step;
    for (double time = frame * model->step; time < end * (1 - 1e-15) && !walk->has_failed;) {
        double until = model->path_count ? fmin(end, next_jump(model, time)) : end;
        if (end - until < 1e-9 * model->step) until = end;
        const bool is_whole = until == end && time == frame * model->step;
        const int steps = is_whole ? substeps : (int)ceil(substeps * (until - time) / model->step);
        const double dt = is_whole ? model->step / substeps : (until - time) / steps;
        // where a pin's speed jumps, bars jerk
        if (walk->bars && model->driven_count) {
            ck_driven_place(model, time, 1, walk->y, walk->y + 3 * (size_t)model->particle_count);
            walk->has_failed |= !ck_bars_project(walk->bars, walk->y, walk->y + 3 * (size_t)model->particle_count);
        }
        for (int i = 0; i < steps && !ck_child_interrupted && !walk->has_failed; i++)
            runge_kutta(walk, time + i * dt, dt);
        time = until;
    }
}

static void end_walk(Walk *walk) {
    ck_bars_destroy(walk->bars);
    free(walk->now.pinned);
    free(walk->now.springs);
    free(walk->y);
}

static ck_Status start_walk(Walk *walk, const ck_Model *model, ck_Error *error) {
    const size_t count = (size_t)model->particle_count, whole = 6 * count;
    *walk = (Walk){.now = *model};
    walk->y = malloc(6 * whole * sizeof(double));
    walk->now.pinned = malloc(count * sizeof(bool));
    walk->now.springs = malloc(((size_t)model->spring_count + 1) * sizeof(ck_Spring));
    if (!walk->y || !walk->now.pinned || !walk->now.springs)
        return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
    walk->stage = walk->y + whole;
    walk->k = walk->y + 2 * whole;
    memcpy(walk->now.pinned, model->pinned, count * sizeof(bool));
    walk->now.spring_count = 0;
    for (int i = 0; i < model->spring_count; i++)
        if (isfinite(model->springs[i].stiffness)) walk->now.springs[walk->now.spring_count++] = model->springs[i];
    memcpy(walk->y, model->position, 3 * count * sizeof(double));
    memcpy(walk->y + 3 * count, model->velocity, 3 * count * sizeof(double));
    return ck_bars_create(&walk->bars, model, walk->now.pinned, error);
}

ck_Status ck_reference_integrate(ck_Trajectory *trajectory, const ck_Model *model, int substeps, double nudge,
                                 uint64_t seed, ck_Error *error) {
    Walk walk = {.y = NULL};
    ck_Status status = ck_trajectory_create(trajectory, model, error);
    if (!status) status = start_walk(&walk, model, error);
    const size_t whole = 6 * (size_t)model->particle_count;
    if (!status && nudge > 0) nudge_start(model, walk.y, nudge, seed);
    if (!status && walk.bars) walk.has_failed = !ck_bars_project(walk.bars, walk.y, walk.y + whole / 2);
    for (int frame = 0; frame <= model->frame_count && !status; frame++) {
        if (frame) let_go(&walk.now, frame - 1);
        if (frame) walk_frame(&walk, frame - 1, substeps);
        status = ck_child_check(error);
        bool finite = !walk.has_failed;
        for (size_t j = 0; j < whole; j++) finite &= isfinite(walk.y[j]) != 0;
        if (!finite) break;
        // positions, then velocities
        memcpy(ck_trajectory_position(trajectory, frame), walk.y, whole * sizeof(double));
        trajectory->frame_count = frame + 1;
    }
    end_walk(&walk);
    return status;
}

// largest distance of a particle between two paths at one frame, / size
static double distance(const ck_Model *model, const ck_Trajectory *one, const ck_Trajectory *other, int frame) {
    double largest = 0;
    for (int i = 0; i < model->particle_count; i++)
        largest = fmax(largest, ck_distance(ck_trajectory_position(one, frame) + 3 * i,
                                            ck_trajectory_position(other, frame) + 3 * i));
    return largest / model->size;
}

static double disagreement(const ck_ReferencePath *path, const ck_Model *model) {
    // the first frame counts even beyond the horizon: paths always agree at the start
    int last = path->horizon > 1 ? path->horizon : 1;
    if (path->fine.frame_count <= last || path->coarse.frame_count <= last) return INFINITY;
    double largest = 0;
    for (int frame = 1; frame <= last; frame++)
        largest = fmax(largest, distance(model, &path->fine, &path->coarse, frame));
    return largest;
}

// How far the finest path so far can be trusted.
static ck_Status find_horizon(ck_ReferencePath *path, const ck_Model *model, ck_Error *error) {
    ck_Trajectory nudged;
    double nudge = CK_REFERENCE_NUDGE * model->size;
    ck_Status status = ck_reference_integrate(&nudged, model, path->substeps, nudge, 1, error);
    int frames = nudged.frame_count < path->fine.frame_count ? nudged.frame_count : path->fine.frame_count;
    path->horizon = 0;
    while (!status && path->horizon + 1 < frames &&
           distance(model, &path->fine, &nudged, path->horizon + 1) < GROWTH * CK_REFERENCE_NUDGE)
        path->horizon++;
    ck_trajectory_free(&nudged);
    return status;
}

// The method is stable to 2.78/ω; it starts at a quarter of that.
static ck_Status first_substeps(const ck_Model *model, int *substeps) {
    double frequency;
    // bars do not stretch; waves across them are as fast as their tension makes them
    if (model->terms & CK_TERM_RIGID) {
        *substeps =
            (int)ck_stability_substeps(model, fmin(model->step / 4, 0.35 * ck_stability_transverse_time(model)));
        return CK_OK;
    }
    ck_Status status = ck_stability_frequency(model, &frequency);
    *substeps = (int)ck_stability_substeps(model, fmin(model->step / 4, 0.7 / fmax(frequency, 1e-300)));
    return status;
}

double ck_reference_work(const ck_Model *model) {
    int substeps;
    if (first_substeps(model, &substeps)) return INFINITY;
    // a bar's share of a sparse factor
    const double bar = model->terms & CK_TERM_RIGID ? 200 : 1;
    return 4.0 * substeps * model->frame_count * (bar * model->spring_count + model->particle_count);
}

ck_Status ck_reference_path_create(ck_ReferencePath *path, const ck_Model *model, ck_Error *error) {
    *path = (ck_ReferencePath){0};
    if (model->terms & (CK_TERM_PLANE | CK_TERM_SPHERE))
        return ck_fail(error, CK_REFUSED, "%s: the reference integrator has no colliders", model->name);
    if ((model->terms & CK_TERM_RIGID) && !ck_springs_start_at_rest(model))
        return ck_fail(error, CK_REFUSED, "%s: its bars do not start at their lengths: how they snap is not known",
                       model->name);
    ck_Status status = first_substeps(model, &path->substeps);
    if ((double)path->substeps * 2 * model->frame_count > MAX_STEPS)
        return ck_fail(error, CK_REFUSED, "%s: a reference takes more than %g steps", model->name, MAX_STEPS);
    if (!status) status = ck_reference_integrate(&path->fine, model, path->substeps, 0, 0, error);
    path->agreement = INFINITY;
    const bool has_kinks = model->terms & (CK_TERM_WIND | CK_TERM_PULL_ONLY);
    while (!status && path->agreement > (has_kinks ? AGREEMENT_WITH_KINKS : AGREEMENT)) {
        if ((double)path->substeps * 2 * model->frame_count > MAX_STEPS)
            return ck_fail(error, CK_REFUSED, "%s: two references still differ by %.2g of the size at %d steps a frame",
                           model->name, path->agreement, path->substeps);
        ck_trajectory_free(&path->coarse);
        path->coarse = path->fine;
        path->fine = (ck_Trajectory){0};
        path->substeps *= 2;
        status = ck_reference_integrate(&path->fine, model, path->substeps, 0, 0, error);
        if (!status) status = find_horizon(path, model, error);
        path->agreement = disagreement(path, model);
    }
    if (!status && path->horizon < 1)
        return ck_fail(error, CK_REFUSED, "%s: two references part within the first frame", model->name);
    return status;
}

void ck_reference_path_free(ck_ReferencePath *path) {
    ck_trajectory_free(&path->fine);
    ck_trajectory_free(&path->coarse);
}
