#include "runge_kutta.h"

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

// One step on y = {x, v}: k1 … k4 are {v, a}, each [6*n]; stage is scratch of the same size.
static void runge_kutta(const ck_Model *model, double dt, double *y, double *k, double *stage) {
    static const double nodes[4] = {0, 0.5, 0.5, 1}, weights[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    const size_t half = 3 * (size_t)model->particle_count, whole = 2 * half;
    for (int i = 0; i < 4; i++) {
        double *now = k + (size_t)i * whole, *before = now - whole;
        for (size_t j = 0; j < whole; j++) stage[j] = y[j] + (i ? nodes[i] * dt * before[j] : 0);
        memcpy(now, stage + half, half * sizeof(double));
        ck_springs_accelerate(model, stage, stage + half, now + half);
    }
    for (size_t j = 0; j < whole; j++)
        y[j] += dt * (weights[0] * k[j] + weights[1] * k[whole + j] + weights[2] * k[2 * whole + j] +
                      weights[3] * k[3 * whole + j]);
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

ck_Status ck_reference_integrate(ck_Trajectory *trajectory, const ck_Model *model, int substeps, double nudge,
                                 uint64_t seed, ck_Error *error) {
    ck_Status status = ck_trajectory_create(trajectory, model, error);
    if (status) return status;
    const size_t half = 3 * (size_t)model->particle_count, whole = 2 * half;
    double *memory = malloc(6 * whole * sizeof(double));
    bool *pinned = malloc((size_t)model->particle_count * sizeof *pinned);
    if (!memory || !pinned) {
        free(memory);
        free(pinned);
        return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
    }
    double *y = memory, *stage = memory + whole, *k = memory + 2 * whole;
    ck_Model now = *model;
    now.pinned = pinned;
    memcpy(pinned, model->pinned, (size_t)model->particle_count * sizeof *pinned);
    memcpy(y, model->position, half * sizeof(double));
    memcpy(y + half, model->velocity, half * sizeof(double));
    if (nudge > 0) nudge_start(model, y, nudge, seed);
    for (int frame = 0; frame <= model->frame_count && !status; frame++) {
        if (frame) let_go(&now, frame - 1);
        for (int i = 0; frame && i < substeps && !ck_child_interrupted; i++)
            runge_kutta(&now, model->step / substeps, y, k, stage);
        status = ck_child_check(error);
        bool finite = true;
        for (size_t j = 0; j < whole; j++) finite &= isfinite(y[j]) != 0;
        if (!finite) break;
        memcpy(ck_trajectory_position(trajectory, frame), y, whole * sizeof(double)); // positions, then velocities
        trajectory->frame_count = frame + 1;
    }
    free(memory);
    free(pinned);
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
    ck_Status status = ck_stability_frequency(model, &frequency);
    *substeps = (int)ck_stability_substeps(model, fmin(model->step / 4, 0.7 / fmax(frequency, 1e-300)));
    return status;
}

double ck_reference_work(const ck_Model *model) {
    int substeps;
    if (first_substeps(model, &substeps)) return INFINITY;
    return 4.0 * substeps * model->frame_count * (model->spring_count + model->particle_count);
}

ck_Status ck_reference_path_create(ck_ReferencePath *path, const ck_Model *model, ck_Error *error) {
    *path = (ck_ReferencePath){0};
    unsigned beyond = CK_TERM_RIGID | CK_TERM_PLANE | CK_TERM_SPHERE;
    if (model->terms & beyond)
        return ck_fail(error, CK_REFUSED, "%s: the reference integrator has no rigid bars or colliders", model->name);
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
