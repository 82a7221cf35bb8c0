#include "runge_kutta.h"

#include "bars.h"
#include "path.h"
#include "process.h"
#include "springs.h"
#include "statistics.h"
#include "tableau.h"
#include "time_scale.h"
#include "touch.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

#define AGREEMENT 1e-9
// Of forces with a kink, of a face that turns its other side to the wind or a spring that goes slack: there the method
// is of the second order.
#define AGREEMENT_WITH_KINKS 1e-6
// In contact, where the method is of the second to third order: what a nudge grows to up to the horizon.
#define AGREEMENT_IN_CONTACT 1e-5
#define GROWTH 1e4
// Stages of a whole path that are tried at most; one takes a 20×20 cloth some 12 µs.
#define MOST_FORCES 1.6e7

// A path on its way: y = {x, v}, [6*n].
typedef struct Walk {
    ck_Model now;  // without what is a bar, and with the pins there still are
    ck_Bars *bars; // NULL: none
    const ck_Tableau *method;
    double *y, *stage, *begun, *k; // k_1, k_2, … are {v, a}, each [6*n]
    bool has_failed;               // bars hold one another
    const char *refusal;           // NULL: none; what no smaller step mends
    ck_Touches *touches;           // NULL: no colliders
    double *free;                  // [3*n] accelerations without contact, of the derivative taken last
    int substeps;                  // of a whole frame
    int level;                     // steps at least between two jumps of what moves
    int events;                    // of this frame
} Walk;

// Accelerations of the state there but for contact and bars, into free, with what moves pins.
//   y  [6*n] in, where moved pins are put
static void push(Walk *walk, double time, int side, double *y) {
    const size_t half = 3 * (size_t)walk->now.particle_count;
    if (walk->now.driven_count) ck_driven_place(&walk->now, time, side, y, y + half);
    ck_springs_accelerate(&walk->now, y, y + half, walk->free);
}

// The derivative of a state whose free accelerations are known: with what colliders and bars allow of them.
//   k  [6*n] out
static void constrain(Walk *walk, double time, int side, const double *y, double *k) {
    const size_t half = 3 * (size_t)walk->now.particle_count;
    memcpy(k, y + half, half * sizeof(double));
    memcpy(k + half, walk->free, half * sizeof(double));
    if (walk->touches) ck_touches_accelerate(walk->touches, time, side, y, y + half, k + half);
    if (!walk->bars) return;
    // bars follow the pins that move; a pin's own motion is not integrated
    if (walk->now.driven_count) ck_driven_accelerate(&walk->now, time, side, k + half);
    walk->has_failed |= !ck_bars_accelerate(walk->bars, y, y + half, k + half);
}

// Of a frame, of a first path by a method.
static ck_Status substeps_by(const ck_Tableau *method, const ck_Model *model, int *substeps) {
    const double longest = model->step / method->first_steps;
    double frequency;
    // bars do not stretch; waves across them are as fast as their tension makes them
    if (model->terms & CK_TERM_RIGID) {
        *substeps = (int)ck_stability_substeps(
            model, fmin(longest, 0.5 * method->first_swing * ck_stability_transverse_time(model)));
        return CK_OK;
    }
    ck_Status status = ck_stability_frequency(model, &frequency);
    const double stable = fmin(method->first_swing / fmax(frequency, 1e-300),
                               method->first_decay / fmax(ck_stability_damping_rate(model), 1e-300));
    *substeps = (int)ck_stability_substeps(model, fmin(longest, stable));
    return status;
}

// The eighth order where forces are smooth: the method sees the kinks of colliders, air and slack springs. Nor where
// dampers keep steps short, which more stages would only make dearer.
static const ck_Tableau *method_of(const ck_Model *model) {
    const bool has_kinks = model->collider_count || (model->terms & (CK_TERM_WIND | CK_TERM_PULL_ONLY));
    int few, many;
    if (has_kinks || substeps_by(&ck_tableau_eighth, model, &few) || substeps_by(&ck_tableau_fourth, model, &many))
        return &ck_tableau_fourth;
    const double dearer = (double)ck_tableau_eighth.stages * few / (ck_tableau_fourth.stages * many);
    return dearer > 1.5 ? &ck_tableau_fourth : &ck_tableau_eighth;
}

// y + dt·Σ shares_m·k_m, of so many, into sum: y itself, or the stage. The sum comes first, as y has the larger digits.
static void add_stages(const Walk *walk, int count, const double *shares, double dt, double *sum) {
    const size_t whole = 6 * (size_t)walk->now.particle_count;
    double *stage = walk->stage;
    memset(stage, 0, whole * sizeof *stage);
    for (int m = 0; m < count; m++) {
        const double share = shares[m], *k = walk->k + (size_t)m * whole;
        for (size_t j = 0; j < whole && share != 0; j++) stage[j] += share * k[j];
    }
    for (size_t j = 0; j < whole; j++) sum[j] = walk->y[j] + dt * stage[j];
}

// One step, from a state whose free accelerations are known.
static void runge_kutta(Walk *walk, double time, double dt) {
    const ck_Tableau *method = walk->method;
    const size_t whole = 6 * (size_t)walk->now.particle_count;
    double *y = walk->y;
    constrain(walk, time, 1, y, walk->k);
    for (int i = 1; i < method->stages; i++) {
        const double at = time + method->nodes[i] * dt;
        const int side = method->nodes[i] < 1 ? 1 : -1;
        add_stages(walk, i, method->matrix[i], dt, walk->stage);
        push(walk, at, side, walk->stage);
        constrain(walk, at, side, walk->stage, walk->k + (size_t)i * whole);
    }
    add_stages(walk, method->stages, method->weights, dt, y);
    if (walk->now.driven_count) ck_driven_place(&walk->now, time + dt, -1, y, y + whole / 2);
    if (walk->bars) walk->has_failed |= !ck_bars_project(walk->bars, y, y + whole / 2);
    if (walk->touches) ck_touches_project(walk->touches, time + dt, y, y + whole / 2);
}

// Steps that make no way, and events of a frame: beyond, they follow one another for ever.
#define MOST_STUCK 10000
#define MOST_EVENTS 100000

static const char between_two[] = "a particle comes between two colliders",
                  without_end[] = "impacts follow one another without end";

static bool is_over(const Walk *walk) {
    return walk->has_failed || walk->refusal || ck_child_interrupted;
}

// As steps of dt, each of which ends where the first event comes. Cost: four passes over springs a step, and three more
// an event.
static void walk_events(Walk *walk, double time, double until, double dt) {
    const size_t half = 3 * (size_t)walk->now.particle_count, whole = 2 * half;
    double *y = walk->y, *begun = walk->begun;
    int stuck = 0;
    push(walk, time, 1, y);
    while (until - time > 1e-12 * dt && !is_over(walk)) {
        const double step = until - time < dt * (1 + 1e-9) ? until - time : dt;
        memcpy(begun, y, whole * sizeof(double));
        memcpy(begun + whole, walk->free, half * sizeof(double));
        ck_touches_start(walk->touches, time, step, y, y + half, walk->free);
        runge_kutta(walk, time, step);
        push(walk, time + step, -1, y);
        const double share = ck_touches_first_event(walk->touches, step, y, y + half, walk->free);
        if (share > 1) {
            time += step;
            stuck = 0;
            continue;
        }
        memcpy(y, begun, whole * sizeof(double));
        memcpy(walk->free, begun + whole, half * sizeof(double));
        if (share > 0) runge_kutta(walk, time, share * step);
        time += share * step;
        if (!ck_touches_change(walk->touches, time, y, y + half)) walk->refusal = between_two;
        push(walk, time, 1, y);
        ck_touches_settle(walk->touches, time, y, y + half, walk->free);
        stuck = share < 1e-9 ? stuck + 1 : 0;
        if (stuck > MOST_STUCK || ++walk->events > MOST_EVENTS) walk->refusal = without_end;
    }
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

static bool lets_go(const ck_Model *model, int frame) {
    for (int i = 0; i < model->release_count; i++)
        if (model->releases[i].frame == frame) return true;
    return false;
}

static double next_jump(const ck_Model *model, double time) {
    double next = INFINITY;
    for (int i = 0; i < model->path_count; i++) next = fmin(next, ck_path_next_jump(&model->paths[i], time));
    return next;
}

// A body anew where what moves it begins, lets it go or jumps: what it touches, and how its bars jerk.
static void begin_again(Walk *walk, double time) {
    double *y = walk->y, *velocity = y + 3 * (size_t)walk->now.particle_count;
    if (walk->touches) {
        if (!ck_touches_begin(walk->touches, time, y, velocity)) walk->refusal = between_two;
        push(walk, time, 1, y);
        ck_touches_settle(walk->touches, time, y, velocity, walk->free);
    }
    if (!walk->bars || !walk->now.driven_count) return;
    ck_driven_place(&walk->now, time, 1, y, velocity);
    walk->has_failed |= !ck_bars_project(walk->bars, y, velocity);
}

// From one frame to the next, in pieces between which what moves jumps: so it keeps its order. Each piece is halved
// with the frame, however short it is.
//   begins  it is the first, or pins were let go
static void walk_frame(Walk *walk, int frame, bool begins) {
    const ck_Model *model = &walk->now;
    const double start = frame * model->step, end = (frame + 1) * model->step;
    walk->events = 0;
    for (double time = start; time < end * (1 - 1e-15) && !is_over(walk);) {
        double until = model->path_count ? fmin(end, next_jump(model, time)) : end;
        if (end - until < 1e-9 * model->step) until = end;
        const bool is_whole = until == end && time == start;
        const double share = (until - time) / model->step;
        const int steps = is_whole ? walk->substeps : (int)fmax(walk->level, ceil(walk->substeps * share));
        const double dt = is_whole ? model->step / steps : (until - time) / steps;
        if (begins || time > start || ck_driven_jump(model, time)) begin_again(walk, time);
        if (walk->touches)
            walk_events(walk, time, until, dt);
        else
            for (int i = 0; i < steps && !is_over(walk); i++) {
                push(walk, time + i * dt, 1, walk->y);
                runge_kutta(walk, time + i * dt, dt);
            }
        time = until;
    }
}

static void end_walk(Walk *walk) {
    ck_bars_destroy(walk->bars);
    ck_touches_destroy(walk->touches);
    free(walk->now.pinned);
    free(walk->now.springs);
    free(walk->y);
}

static ck_Status first_substeps(const ck_Model *model, int *substeps) {
    return substeps_by(method_of(model), model, substeps);
}

static ck_Status start_walk(Walk *walk, const ck_Model *model, const ck_Tableau *method, int substeps,
                            ck_Error *error) {
    const size_t count = (size_t)model->particle_count, whole = 6 * count;
    int first;
    *walk = (Walk){.now = *model, .substeps = substeps, .method = method};
    walk->y = malloc((5 + (size_t)method->stages) * whole * sizeof(double));
    walk->now.pinned = malloc(count * sizeof(bool));
    walk->now.springs = malloc(((size_t)model->spring_count + 1) * sizeof(ck_Spring));
    if (!walk->y || !walk->now.pinned || !walk->now.springs)
        return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
    walk->stage = walk->y + whole;
    walk->begun = walk->y + 2 * whole;
    walk->free = walk->y + 4 * whole;
    walk->k = walk->y + 5 * whole;
    memcpy(walk->now.pinned, model->pinned, count * sizeof(bool));
    walk->now.spring_count = 0;
    for (int i = 0; i < model->spring_count; i++)
        if (isfinite(model->springs[i].stiffness)) walk->now.springs[walk->now.spring_count++] = model->springs[i];
    memcpy(walk->y, model->position, 3 * count * sizeof(double));
    memcpy(walk->y + 3 * count, model->velocity, 3 * count * sizeof(double));
    ck_Status status = first_substeps(model, &first);
    walk->level = substeps > first ? substeps / first : 1;
    if (!status) status = ck_bars_create(&walk->bars, model, walk->now.pinned, error);
    return status ? status : ck_touches_create(&walk->touches, model, walk->now.pinned, error);
}

static ck_Status integrate(ck_Trajectory *trajectory, const ck_Model *model, const ck_Tableau *method, int substeps,
                           double nudge, uint64_t seed, ck_Error *error) {
    Walk walk = {.y = NULL};
    ck_Status status = ck_trajectory_create(trajectory, model, error);
    if (!status) status = start_walk(&walk, model, method, substeps, error);
    const size_t whole = 6 * (size_t)model->particle_count;
    if (!status && nudge > 0) nudge_start(model, walk.y, nudge, seed);
    if (!status && walk.bars) walk.has_failed = !ck_bars_project(walk.bars, walk.y, walk.y + whole / 2);
    for (int frame = 0; frame <= model->frame_count && !status; frame++) {
        const bool begins = frame == 1 || (frame && lets_go(model, frame - 1));
        if (frame) let_go(&walk.now, frame - 1);
        if (frame) walk_frame(&walk, frame - 1, begins);
        status = ck_child_check(error);
        if (walk.refusal && !status)
            status = ck_fail(error, CK_REFUSED, "%s: %s by t = %.3g s", model->name, walk.refusal, frame * model->step);
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

ck_Status ck_reference_integrate(ck_Trajectory *trajectory, const ck_Model *model, int substeps, double nudge,
                                 uint64_t seed, ck_Error *error) {
    return integrate(trajectory, model, method_of(model), substeps, nudge, seed, error);
}

ck_Status ck_reference_follow(ck_Trajectory *trajectory, const ck_Model *model, int substeps, ck_Error *error) {
    return integrate(trajectory, model, &ck_tableau_fourth, substeps, 0, 0, error);
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
    if (path->fine.frame_count <= model->frame_count || path->coarse.frame_count <= last) return INFINITY;
    double largest = 0;
    for (int frame = 1; frame <= last; frame++)
        largest = fmax(largest, distance(model, &path->fine, &path->coarse, frame));
    return largest;
}

// A path and one from a nudged start, side by side.
typedef struct Pair {
    ck_ReferencePath *path;
    const ck_Model *model;
    ck_Trajectory nudged;
} Pair;

static ck_Status integrate_one(void *context, int index, ck_Error *error) {
    Pair *pair = context;
    const double nudge = index ? CK_REFERENCE_NUDGE * pair->model->size : 0;
    return ck_reference_integrate(index ? &pair->nudged : &pair->path->fine, pair->model, pair->path->substeps, nudge,
                                  1, error);
}

// The finest path so far, and how far it can be trusted.
static ck_Status integrate_with_horizon(ck_ReferencePath *path, const ck_Model *model, ck_Error *error) {
    Pair pair = {.path = path, .model = model};
    ck_Status status = ck_parallel(2, 0, integrate_one, &pair, error);
    int frames = pair.nudged.frame_count < path->fine.frame_count ? pair.nudged.frame_count : path->fine.frame_count;
    path->horizon = 0;
    while (!status && path->horizon + 1 < frames &&
           distance(model, &path->fine, &pair.nudged, path->horizon + 1) < GROWTH * CK_REFERENCE_NUDGE)
        path->horizon++;
    ck_trajectory_free(&pair.nudged);
    return status;
}

double ck_reference_work(const ck_Model *model) {
    int substeps;
    if (first_substeps(model, &substeps)) return INFINITY;
    // a bar's share of a sparse factor
    const double bar = model->terms & CK_TERM_RIGID ? 200 : 1;
    return (double)method_of(model)->stages * substeps * model->frame_count *
           (bar * model->spring_count + model->particle_count);
}

// Steps of a path at twice its substeps, which are at least two between two jumps of what moves.
static double steps_of_next(const ck_ReferencePath *path, const ck_Model *model) {
    int jumps = 0, first;
    for (int i = 0; i < model->path_count; i++) jumps += model->paths[i].point_count + 2;
    if (first_substeps(model, &first)) return INFINITY;
    return 2.0 * path->substeps * (model->frame_count + (double)jumps / first);
}

static bool is_beyond(const ck_ReferencePath *path, const ck_Model *model) {
    return method_of(model)->stages * steps_of_next(path, model) > MOST_FORCES;
}

static double wanted_agreement(const ck_Model *model) {
    if (model->collider_count) return AGREEMENT_IN_CONTACT;
    return model->terms & (CK_TERM_WIND | CK_TERM_PULL_ONLY) ? AGREEMENT_WITH_KINKS : AGREEMENT;
}

// Halves the step from path's substeps on until two paths agree up to their horizon, or to the last frame.
static ck_Status refine(ck_ReferencePath *path, const ck_Model *model, ck_Error *error) {
    ck_Status status = ck_reference_integrate(&path->fine, model, path->substeps, 0, 0, error);
    path->agreement = INFINITY;
    while (!status && path->agreement > wanted_agreement(model)) {
        if (is_beyond(path, model))
            return ck_fail(error, CK_REFUSED, "%s: two references still differ by %.2g of the size at %d steps a frame",
                           model->name, path->agreement, path->substeps);
        ck_trajectory_free(&path->coarse);
        path->coarse = path->fine;
        path->fine = (ck_Trajectory){0};
        path->substeps *= 2;
        status = integrate_with_horizon(path, model, error);
        path->agreement = disagreement(path, model);
    }
    return status;
}

typedef struct Whole {
    ck_ReferencePath *path;
    const ck_Model *model;
} Whole;

static ck_Status integrate_whole(void *context, int index, ck_Error *error) {
    const Whole *whole = context;
    ck_Trajectory *path = index ? &whole->path->coarse : &whole->path->fine;
    ck_trajectory_free(path);
    return ck_reference_integrate(path, whole->model, whole->path->substeps / (index ? 2 : 1), 0, 0, error);
}

static ck_Status check_model(const ck_Model *model, const ck_ReferencePath *path, ck_Error *error) {
    if (model->collider_count && (model->terms & CK_TERM_RIGID))
        return ck_fail(error, CK_REFUSED, "%s: the reference integrator has no rigid bars in contact", model->name);
    if ((model->terms & CK_TERM_RIGID) && !ck_springs_start_at_rest(model))
        return ck_fail(error, CK_REFUSED, "%s: its bars do not start at their lengths: how they snap is not known",
                       model->name);
    if (is_beyond(path, model))
        return ck_fail(error, CK_REFUSED, "%s: a reference takes more than %g evaluations of its forces", model->name,
                       MOST_FORCES);
    return CK_OK;
}

// The first part of a path in contact that is refined: its horizon is often short, and beyond it steps need not agree.
#define FIRST_PART 8

ck_Status ck_reference_path_create(ck_ReferencePath *path, const ck_Model *model, ck_Error *error) {
    *path = (ck_ReferencePath){0};
    ck_Status status = first_substeps(model, &path->substeps);
    if (!status) status = check_model(model, path, error);
    ck_Model part = *model;
    int calm = 0, begun = 0; // frames of the last part that was, and the substeps that it leaves to begin with
    if (model->collider_count && model->frame_count > 10 * FIRST_PART) part.frame_count /= FIRST_PART;
    while (!status) {
        status = refine(path, &part, error);
        if (status == CK_REFUSED && calm && part.frame_count > 2 * calm) {
            // the whole takes more steps than there may be: its horizon may be within a part
            status = CK_OK;
            part.frame_count = 2 * calm;
        } else {
            if (status || part.frame_count == model->frame_count || path->horizon < part.frame_count) break;
            calm = part.frame_count;
            begun = path->substeps / 2;
            part.frame_count = model->frame_count;
        }
        path->substeps = begun;
        ck_reference_path_free(path);
    }
    if (!status && part.frame_count < model->frame_count)
        status = ck_parallel(2, 0, integrate_whole, &(Whole){path, model}, error);
    if (!status && path->horizon < 1)
        return ck_fail(error, CK_REFUSED, "%s: two references part within the first frame", model->name);
    return status;
}

void ck_reference_path_free(ck_ReferencePath *path) {
    ck_trajectory_free(&path->fine);
    ck_trajectory_free(&path->coarse);
}
