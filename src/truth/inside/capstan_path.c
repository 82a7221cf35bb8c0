#include "capstan_path.h"

#include "process.h"
#include "rest_forms.h"
#include "shape.h"
#include "statistics.h"
#include "time_scale.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

// Of the fastest spring's period/2π a step; and the most steps of a path.
#define STEP 0.1
#define MOST_STEPS 4e6
// A nudge sideways that has grown so much ends the horizon, as for the reference path.
#define GROWTH 1e4

ck_Status ck_truth_capstan_check(const ck_Model *model, ck_Error *error) {
    ck_Capstan capstan;
    return ck_truth_need(ck_capstan_read(&capstan, model) && !(model->terms & CK_TERM_RIGID), model, error,
                         "a chain of equal nodes but for its end weights, over the upper half of one ball and hanging "
                         "down on both sides to the end, the last side heavier, of springs, in gravity alone");
}

double ck_truth_capstan_off(const ck_Model *model) {
    ck_Capstan capstan;
    if (!ck_capstan_read(&capstan, model)) return 0;
    double angle = model->springs[1].rest / capstan.radius;
    return 0.3 * capstan.radius * angle * angle / 8 / model->size;
}

// The chain along its arc, and a nudge of it sideways. A node touches as long as its spring towards the ball leans on
// it: those of the ends may then lie up to half a spring below the ball's middle. What hangs does so straight down from
// the last that touches; its arc is its depth, counted on from the tangent point.
typedef struct Chain {
    const ck_Model *model;
    ck_Capstan capstan;
    int count, first, last;       // nodes, and the first and the last that touch
    double *arc, *speed;          // [count] m, m/s along the rope
    double *side, *side_speed;    // [count] of the nudge, which the rest does not see
    double *force, *side_force;   // [3*count], [count] N
    double *position, *direction; // [3*count] m, unit
} Chain;

// A place on the ball at an angle that may be beyond its tangent points.
static void place_at(const ck_Capstan *capstan, double theta, double *position, double *direction) {
    for (int axis = 0; axis < 3; axis++) {
        double up = capstan->up[axis], level = capstan->level[axis];
        position[axis] = capstan->center[axis] + capstan->radius * (sin(theta) * up - cos(theta) * level);
        direction[axis] = cos(theta) * up + sin(theta) * level;
    }
}

static void place_chain(Chain *chain) {
    const ck_Capstan *capstan = &chain->capstan;
    for (int i = chain->first; i <= chain->last; i++)
        place_at(capstan, chain->arc[i] / capstan->radius, chain->position + 3 * i, chain->direction + 3 * i);
    for (int i = 0; i < chain->count; i++) {
        bool before = i < chain->first;
        if (!before && i <= chain->last) continue;
        int edge = before ? chain->first : chain->last;
        double above = (before ? 1 : -1) * (chain->arc[i] - (before ? 0 : M_PI * capstan->radius));
        double from[3];
        ck_subtract(from, chain->position + 3 * edge, capstan->center);
        memcpy(chain->position + 3 * i, chain->position + 3 * edge, 3 * sizeof(double));
        ck_add_scaled(chain->position + 3 * i, above - ck_dot(from, capstan->up), capstan->up);
        for (int axis = 0; axis < 3; axis++) chain->direction[3 * i + axis] = (before ? 1 : -1) * capstan->up[axis];
    }
}

// Depth becomes arc, or arc depth, as a node comes to touch or leaves: at the same place and speed but for second
// order.
static void switch_node(Chain *chain, int i, bool is_first_side, bool touches) {
    double radius = chain->capstan.radius, beyond = is_first_side ? chain->arc[i] : M_PI * radius - chain->arc[i];
    beyond = touches ? radius * asin(fmax(-1, fmin(1, beyond / radius))) : radius * sin(beyond / radius);
    chain->arc[i] = is_first_side ? beyond : M_PI * radius - beyond;
}

// Which nodes touch now; the rope moves on from its first side to its last.
static void find_touching(Chain *chain) {
    double half = M_PI * chain->capstan.radius;
    while (chain->first > 0 && chain->arc[chain->first - 1] + chain->arc[chain->first] > 0)
        switch_node(chain, --chain->first, true, true);
    while (chain->last > chain->first + 1 && chain->arc[chain->last] + chain->arc[chain->last - 1] > 2 * half)
        switch_node(chain, chain->last--, false, false);
}

static void pull(Chain *chain) {
    const ck_Model *model = chain->model;
    place_chain(chain);
    for (int i = 0; i < chain->count; i++) {
        chain->side_force[i] = 0;
        for (int axis = 0; axis < 3; axis++) chain->force[3 * i + axis] = model->mass[i] * model->gravity[axis];
    }
    for (int i = 0; i + 1 < chain->count; i++) {
        const ck_Spring *spring = &model->springs[i];
        double d[3], v[3] = {0};
        ck_subtract(d, chain->position + 3 * i + 3, chain->position + 3 * i);
        ck_add_scaled(v, chain->speed[i + 1], chain->direction + 3 * i + 3);
        ck_add_scaled(v, -chain->speed[i], chain->direction + 3 * i);
        double length = ck_length(d);
        double tension = spring->stiffness * (length - spring->rest) + spring->damping * ck_dot(d, v) / length;
        double sideways = tension / length * (chain->side[i + 1] - chain->side[i]);
        ck_add_scaled(chain->force + 3 * i, tension / length, d);
        ck_add_scaled(chain->force + 3 * i + 3, -tension / length, d);
        chain->side_force[i] += sideways;
        chain->side_force[i + 1] -= sideways;
    }
}

// What the ball presses a node with, N.
static double pressing(const Chain *chain, int i) {
    if (i < chain->first || i > chain->last) return 0;
    double out[3], radius = chain->capstan.radius, speed = chain->speed[i];
    ck_subtract(out, chain->position + 3 * i, chain->capstan.center);
    return fmax(0, -ck_dot(out, chain->force + 3 * i) / radius - chain->model->mass[i] * speed * speed / radius);
}

// Symplectic Euler: friction takes at most the whole speed, its direction is that of the slide, so that sideways it
// acts as a drag of μ·N/|v|. A surface leans with a node that is off to the side, and pushes it on.
static void step(Chain *chain, double dt) {
    pull(chain);
    for (int i = 0; i < chain->count; i++) {
        double mass = chain->model->mass[i], press = pressing(chain, i);
        double taken = dt * chain->capstan.friction * press / mass;
        chain->speed[i] += dt * ck_dot(chain->force + 3 * i, chain->direction + 3 * i) / mass;
        double sliding = fabs(chain->speed[i]), keep = sliding > taken ? 1 - taken / sliding : taken > 0 ? 0 : 1;
        chain->speed[i] *= keep;
        chain->side_speed[i] += dt * (chain->side_force[i] + press * chain->side[i] / chain->capstan.radius) / mass;
        chain->side_speed[i] *= keep;
        chain->arc[i] += dt * chain->speed[i];
        chain->side[i] += dt * chain->side_speed[i];
    }
    find_touching(chain);
}

static ck_Status start_chain(Chain *chain, const ck_Model *model, ck_Error *error) {
    size_t count = (size_t)model->particle_count;
    *chain = (Chain){.model = model, .count = model->particle_count};
    double *memory = calloc(14 * count, sizeof *memory);
    if (!memory) return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
    ck_capstan_read(&chain->capstan, model);
    chain->arc = memory;
    chain->speed = memory + count;
    chain->side = memory + 2 * count;
    chain->side_speed = memory + 3 * count;
    chain->side_force = memory + 4 * count;
    chain->force = memory + 5 * count;
    chain->position = memory + 8 * count;
    chain->direction = memory + 11 * count;
    ck_Random random = ck_random_seed(1);
    double half = M_PI * chain->capstan.radius;
    for (int i = 0; i < chain->count; i++) {
        chain->arc[i] = ck_capstan_arc(&chain->capstan, model, i);
        chain->side[i] = ck_random_unit(&random) < 0.5 ? -1 : 1;
        if (chain->arc[i] < 0) chain->first = i + 1;
        if (chain->arc[i] <= half) chain->last = i;
    }
    // a node below the last side's tangent point may touch as well
    if (chain->last + 1 < chain->count && chain->arc[chain->last] + chain->arc[chain->last + 1] < 2 * half)
        switch_node(chain, ++chain->last, false, true);
    find_touching(chain);
    return CK_OK;
}

// is_settled: what hangs is written where it is in the mean of a spring's way over the ball's edge, which a weight that
// cannot follow is closer to.
static void write_frame(Chain *chain, ck_Trajectory *path, int frame, bool is_settled) {
    const ck_Capstan *capstan = &chain->capstan;
    double *velocity = ck_trajectory_velocity(path, frame), *position = ck_trajectory_position(path, frame);
    double half_spring = 0.5 * chain->model->springs[1].rest / capstan->radius;
    place_chain(chain);
    memcpy(position, chain->position, 3 * sizeof(double) * (size_t)chain->count);
    for (int i = 0; i < chain->count; i++) {
        memset(velocity + 3 * i, 0, 3 * sizeof(double));
        ck_add_scaled(velocity + 3 * i, chain->speed[i], chain->direction + 3 * i);
        if (!is_settled || (i >= chain->first && i <= chain->last)) continue;
        double from[3], out = capstan->radius * sin(half_spring) / half_spring;
        ck_subtract(from, position + 3 * i, capstan->center);
        ck_add_scaled(position + 3 * i, copysign(out, ck_dot(from, capstan->level)) - ck_dot(from, capstan->level),
                      capstan->level);
    }
    path->frame_count = frame + 1;
}

// Follows the chain; horizon is the last frame at which the nudge has not grown too much.
static ck_Status follow(ck_Trajectory *path, int *horizon, const ck_Model *model, int substeps, bool is_settled,
                        ck_Error *error) {
    Chain chain = {0};
    ck_Status status = ck_trajectory_create(path, model, error);
    if (!status) status = start_chain(&chain, model, error);
    if (!status) write_frame(&chain, path, 0, is_settled);
    *horizon = 0;
    for (int frame = 1; frame <= model->frame_count && !status; frame++) {
        status = ck_child_check(error);
        double largest = 0;
        for (int i = 0; i < substeps; i++) step(&chain, model->step / substeps);
        for (int i = 0; i < chain.count; i++) largest = fmax(largest, fabs(chain.side[i]));
        if (largest < GROWTH && *horizon == frame - 1) *horizon = frame;
        write_frame(&chain, path, frame, is_settled);
        if (!status && chain.first == 0)
            status =
                ck_fail(error, CK_REFUSED, "%s: the rope's first end reaches the ball at %g s; end the scene before",
                        model->name, frame * model->step);
    }
    free(chain.arc);
    return status;
}

ck_Status ck_truth_solve_capstan(ck_Truth *truth, const ck_Model *model, ck_Error *error) {
    double frequency;
    int other;
    ck_Status status = ck_stability_frequency(model, &frequency);
    double limit = STEP / (frequency + frequency * frequency * ck_stability_damping_time(model));
    int substeps = 2 * (int)ck_stability_substeps(model, limit);
    if ((double)substeps * model->frame_count > MOST_STEPS)
        return ck_fail(error, CK_REFUSED, "%s: the rope takes more than %g steps to follow", model->name, MOST_STEPS);
    if (!status)
        status = follow(&truth->paths[truth->path_count++], &truth->reference.horizon, model, substeps, true, error);
    if (!status) status = follow(&truth->paths[truth->path_count++], &other, model, substeps / 2, false, error);
    return status;
}
