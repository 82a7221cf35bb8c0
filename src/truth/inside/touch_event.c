// When something happens to what particles touch.
#include "touch_surface.h"

#include "vector.h"

#include <math.h>
#include <string.h>

// The least share of a step between two events of a particle that is on the verge of one: it may lift and come back, or
// slip and stop, without end. By then it has a speed of that squared of what a step's change of its acceleration makes.
#define LEAST (1.0 / 32)

// The place of a particle after a share of the step, by Hermite's cubic between its ends.
static void point_on(const ck_Touches *touches, int particle, double dt, const double *end, const double *end_velocity,
                     double s, double *point) {
    const double *x = touches->position + 3 * particle, *v = touches->velocity + 3 * particle;
    for (int axis = 0; axis < 3; axis++) {
        const double m = dt * v[axis], n = dt * end_velocity[axis], way = end[axis] - x[axis];
        point[axis] = x[axis] + s * (m + s * (3 * way - 2 * m - n + s * (m + n - 2 * way)));
    }
}

// The gap to a collider after a share s of the step.
static double gap_at(const ck_Touches *touches, int particle, int collider, double dt, const double *end,
                     const double *end_velocity, double s) {
    double point[3];
    point_on(touches, particle, dt, end, end_velocity, s, point);
    return ck_touch_surface_at(touches, collider, touches->time + s * dt, 1, point).gap;
}

// True where it has speed into the surface at the start of the step.
static bool comes_in(const ck_Touches *touches, int particle, int collider) {
    const ck_TouchSurface surface =
        ck_touch_surface_at(touches, collider, touches->time, 1, touches->position + 3 * particle);
    double relative[3];
    ck_subtract(relative, touches->velocity + 3 * particle, surface.velocity);
    return ck_dot(relative, surface.normal) < -touches->rest;
}

// The share of the step at which it last comes in from outside; one that is never outside comes in at once.
//   inside  the share at which it is inside
static double impact_share(const ck_Touches *touches, int particle, int collider, double dt, const double *end,
                           const double *end_velocity, double inside) {
    double outside = inside;
    do outside -= 1.0 / 16;
    while (outside > 0 && gap_at(touches, particle, collider, dt, end, end_velocity, outside) <= 0);
    const double start = outside > 0 ? INFINITY : gap_at(touches, particle, collider, dt, end, end_velocity, 0);
    if (start < -touches->thin) return 0;
    // from the surface itself it first leaves, if at all
    if (start <= touches->thin) {
        for (outside = 1.0 / 32; outside > 1e-9; outside *= 0.25)
            if (gap_at(touches, particle, collider, dt, end, end_velocity, outside) > 0) break;
        if (outside <= 1e-9) return comes_in(touches, particle, collider) ? 0 : LEAST;
    }
    for (;;) {
        const double middle = 0.5 * (outside + inside);
        if (middle <= outside || middle >= inside) return outside;
        if (gap_at(touches, particle, collider, dt, end, end_velocity, middle) > 0)
            outside = middle;
        else
            inside = middle;
    }
}

static void note(ck_TouchState *touch, ck_TouchEvent event, int hit, double when) {
    if (when > 1 || when >= touch->when) return;
    touch->event = event;
    touch->hit = hit;
    touch->when = when;
}

// Where a number falls through zero between the ends of a step.
static double crossing(double start, double end) {
    return start > 0 ? start / (start - end) : 0;
}

// When a particle that slides stops, where push and friction stay as they are: T = v·(q + f·cos θ)/(q² − f²), by
// v' = f·cos θ − q and v·θ' = −f·sin θ, as it turns into the push while it slows down.
static double stop_time(const double *along, const ck_TouchPush *push) {
    const double speed = ck_length(along), f = ck_length(push->along), q = push->friction;
    if (!(q > f)) return INFINITY;
    return (speed * q + ck_dot(push->along, along)) / ((q - f) * (q + f));
}

// The share of the step after which it stops: of what push and friction are in the middle of that time.
static double stop_share(const double *along, const ck_TouchPush *start, const ck_TouchPush *end, double dt) {
    double time = stop_time(along, start);
    for (int round = 0; round < 3 && time < 2 * dt; round++) {
        const double share = 0.5 * time / dt;
        ck_TouchPush mean = {.friction = start->friction + share * (end->friction - start->friction)};
        for (int axis = 0; axis < 3; axis++)
            mean.along[axis] = start->along[axis] + share * (end->along[axis] - start->along[axis]);
        time = stop_time(along, &mean);
    }
    return time / dt;
}

static double excess_at(const ck_Touches *touches, const ck_TouchState *touch, int axis, double time,
                        const double *point) {
    double seen[3];
    const ck_TouchSurface surface = ck_touch_look(touches, touch->collider, time, 1, point, seen);
    return ck_collider_part_excess(surface.collider, axis, seen);
}

// Where a particle goes over the border of the part of the surface that it is on, there curved otherwise.
static void note_border(ck_Touches *touches, int particle, double dt, const double *position, const double *velocity) {
    ck_TouchState *touch = &touches->touch[particle];
    const ck_Collider *collider = &touches->model->colliders[touch->collider];
    const double *x = position + 3 * particle, *v = velocity + 3 * particle;
    for (int axis = 0; axis < 3 && collider->shape != CK_PLANE && collider->shape != CK_SPHERE; axis++) {
        const double side = touch->part.beyond[axis] ? -1 : 1;
        if (!(collider->half[axis] > 0) || !isfinite(collider->half[axis]) ||
            !(side * excess_at(touches, touch, axis, touches->time + dt, x) > touches->thin))
            continue;
        double low = 0, high = 1, point[3];
        while (high - low > 1e-15) {
            const double middle = 0.5 * (low + high);
            point_on(touches, particle, dt, x, v, middle, point);
            if (side * excess_at(touches, touch, axis, touches->time + middle * dt, point) > 0)
                high = middle;
            else
                low = middle;
        }
        note(touch, CK_BORDER, axis, high);
    }
}

// The event of a particle that touches already: it lifts, stops or slips.
static void note_change(ck_Touches *touches, int particle, double dt, const double *position, const double *velocity,
                        const double *acceleration) {
    ck_TouchState *touch = &touches->touch[particle];
    const int at = 3 * particle;
    const ck_TouchSurface start = ck_touch_surface_of(touches, touch, touches->time, 1, touches->position + at);
    const ck_TouchSurface end = ck_touch_surface_of(touches, touch, touches->time + dt, -1, position + at);
    double slip[3], left[3];
    const ck_TouchPush before = ck_touch_push(&start, touches->velocity + at, touches->acceleration + at, slip);
    const ck_TouchPush after = ck_touch_push(&end, velocity + at, acceleration + at, left);
    note_border(touches, particle, dt, position, velocity);
    if (after.press < 0) note(touch, CK_LIFT, 0, crossing(before.press, after.press));
    if (touch->sticks) {
        if (ck_touch_margin(&after) < 0)
            note(touch, CK_SLIP, 0, crossing(ck_touch_margin(&before), ck_touch_margin(&after)));
        return;
    }
    if (!(end.collider->friction > 0)) return;
    if (ck_length(slip) > touches->rest) note(touch, CK_STOP, 0, stop_share(slip, &before, &after, dt));
    const double on = ck_dot(slip, touch->way), back = ck_dot(left, touch->way);
    if (back <= 0) note(touch, on > touches->rest ? CK_TURN : CK_STOP, 0, fmax(LEAST, crossing(on, back)));
}

// Of a step whose end is outside: the first share of so many at which the particle is inside a solid that it passes
// through; above 1: at none. Looked for only where the chord goes through, as the collider sees it.
#define SHARES 64

//   gap  at the end
static double passing_share(const ck_Touches *touches, int particle, int collider, double dt, const double *end,
                            const double *end_velocity, double gap) {
    const double *x = touches->position + 3 * particle;
    const ck_Collider *solid = &touches->model->colliders[collider];
    double from[3], to[3];
    // from one that stays nothing was nearer than it has come
    if (solid->shape == CK_PLANE || (!solid->path && gap > ck_distance(x, end))) return 2;
    ck_touch_look(touches, collider, touches->time, 1, x, from);
    ck_touch_look(touches, collider, touches->time + dt, -1, end, to);
    if (!(ck_collider_least_gap(solid, from, to) < -touches->thin)) return 2;
    for (int i = 1; i < SHARES; i++) {
        const double share = i / (double)SHARES;
        if (gap_at(touches, particle, collider, dt, end, end_velocity, share) < -touches->thin) return share;
    }
    return 2;
}

// True where nothing that it does not touch can be met on the chord to a place: gaps change by no more than the way.
static bool is_clear(const ck_Touches *touches, int particle, const double *end) {
    const ck_TouchState *touch = &touches->touch[particle];
    const double *x = touches->position + 3 * particle;
    double since = 0, chord = 0;
    for (int axis = 0; axis < 3; axis++) {
        since += (end[axis] - touch->from[axis]) * (end[axis] - touch->from[axis]);
        chord += (end[axis] - x[axis]) * (end[axis] - x[axis]);
    }
    // (a + b)² ≤ 2·(a² + b²)
    return touch->but == touch->collider && touch->clear * touch->clear > 2 * (since + chord);
}

// The first impact of a particle in the step, but on what it touches already.
static void note_impacts(ck_Touches *touches, int particle, double dt, const double *x, const double *v) {
    ck_TouchState *touch = &touches->touch[particle];
    double clear = INFINITY;
    if (is_clear(touches, particle, x)) return;
    for (int c = 0; c < touches->model->collider_count; c++) {
        if (c == touch->collider) continue;
        const double gap = ck_touch_surface_at(touches, c, touches->time + dt, -1, x).gap;
        const double inside = gap < -touches->thin ? 1 : passing_share(touches, particle, c, dt, x, v, gap);
        if (inside <= 1) note(touch, CK_IMPACT, c, impact_share(touches, particle, c, dt, x, v, inside));
        clear = fmin(clear, touches->model->colliders[c].path ? 0 : gap);
    }
    touch->clear = fmax(0, clear);
    touch->but = touch->collider;
    memcpy(touch->from, x, sizeof touch->from);
}

double ck_touches_first_event(ck_Touches *touches, double dt, const double *position, const double *velocity,
                              const double *acceleration) {
    double first = 2;
    for (int i = 0; i < touches->model->particle_count; i++) {
        ck_TouchState *touch = &touches->touch[i];
        touch->event = CK_NO_EVENT;
        touch->when = 2;
        if (touches->pinned[i]) continue;
        if (touch->collider >= 0) note_change(touches, i, dt, position, velocity, acceleration);
        note_impacts(touches, i, dt, position + 3 * i, velocity + 3 * i);
        first = fmin(first, touch->when);
    }
    // those at the same time are one event
    for (int i = 0; i < touches->model->particle_count; i++)
        if (touches->touch[i].when > first + 1e-9) touches->touch[i].event = CK_NO_EVENT;
    return first;
}
