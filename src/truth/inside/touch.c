#include "touch.h"

#include "collider.h"
#include "path.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

// A particle that turns only begins a step there.
typedef enum Event { NO_EVENT, IMPACT, LIFT, STOP, SLIP, TURN, BORDER } Event;

// What a particle touches.
typedef struct Touch {
    int collider;  // −1: nothing
    ck_Part part;  // of that
    bool sticks;   // held by friction
    double way[3]; // unit: the direction in which it slid at the start of the step; 0: it did not
    Event event;
    int hit;               // of an impact the collider, of a border the axis
    double when;           // share of the step
    double from[3], clear; // m: a place, and how far from there all colliders are but one; 0: not known
    int but;
} Touch;

struct ck_Touches {
    const ck_Model *model;
    const bool *pinned;
    Touch *touch;                               // [n]
    double rest;                                // m/s: CK_TOUCH_REST
    double thin;                                // m: what coordinates resolve
    double time, dt;                            // s, of the start of a step, and its length
    double *position, *velocity, *acceleration; // [3*n] there
};

// Where a particle is to a collider at a time, which has moved so far by then.
typedef struct Surface {
    const ck_Collider *collider;
    ck_Part part; // of one that is touched, which goes on beyond its borders
    double moved[3], velocity[3], acceleration[3];
    double normal[3], gap;
} Surface;

//   seen  out: the particle's place, less how far the collider has moved
static Surface look_at(const ck_Touches *touches, int collider, double time, int side, const double *point,
                       double *seen) {
    Surface surface = {.collider = &touches->model->colliders[collider]};
    memcpy(seen, point, 3 * sizeof(double));
    if (!surface.collider->path) return surface;
    ck_path_at(surface.collider->path, time, side, surface.moved, surface.velocity, surface.acceleration);
    ck_add_scaled(seen, -1, surface.moved);
    return surface;
}

static Surface surface_at(const ck_Touches *touches, int collider, double time, int side, const double *point) {
    double seen[3];
    Surface surface = look_at(touches, collider, time, side, point, seen);
    surface.gap = ck_collider_gap(surface.collider, seen, surface.normal);
    return surface;
}

// That which a particle touches.
static Surface surface_of(const ck_Touches *touches, const Touch *touch, double time, int side, const double *point) {
    double seen[3];
    Surface surface = look_at(touches, touch->collider, time, side, point, seen);
    surface.part = touch->part;
    surface.gap = ck_collider_part_gap(surface.collider, touch->part, seen, surface.normal);
    return surface;
}

ck_Status ck_touches_create(ck_Touches **out, const ck_Model *model, const bool *pinned, ck_Error *error) {
    *out = NULL;
    if (!model->collider_count) return CK_OK;
    const size_t count = (size_t)model->particle_count;
    ck_Touches *touches = calloc(1, sizeof *touches);
    double field[3];
    ck_model_mean_field(model, field);
    if (touches) {
        *touches = (ck_Touches){.model = model,
                                .pinned = pinned,
                                .rest = CK_TOUCH_REST * sqrt(ck_length(field) * model->size),
                                .thin = 1e-13 * model->size};
        touches->touch = calloc(count, sizeof *touches->touch);
        touches->position = malloc(9 * count * sizeof(double));
    }
    if (!touches || !touches->touch || !touches->position) {
        ck_touches_destroy(touches);
        return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
    }
    touches->velocity = touches->position + 3 * count;
    touches->acceleration = touches->position + 6 * count;
    for (size_t i = 0; i < count; i++) {
        touches->touch[i].collider = -1;
        touches->thin = fmax(touches->thin, 1e-15 * ck_length(model->position + 3 * i));
    }
    *out = touches;
    return CK_OK;
}

void ck_touches_destroy(ck_Touches *touches) {
    if (!touches) return;
    free(touches->touch);
    free(touches->position);
    free(touches);
}

// The acceleration along the normal that keeps it on the surface, less what it would have: how hard it is pressed on,
// per mass. along: its velocity to the surface's, tangential.
static double pressing(const Surface *surface, const double *velocity, const double *acceleration, double *along) {
    double relative[3];
    ck_subtract(relative, velocity, surface->velocity);
    ck_tangential(along, relative, surface->normal);
    const double turn = ck_collider_turn(surface->collider, surface->part, along);
    return -turn + ck_dot(surface->acceleration, surface->normal) - ck_dot(acceleration, surface->normal);
}

// What pushes a particle along a surface, m/s², and what friction does at most.
typedef struct Push {
    double along[3], friction, press;
} Push;

//   slip  out: its velocity to the surface's, tangential
static Push push_of(const Surface *surface, const double *velocity, const double *acceleration, double *slip) {
    Push push;
    double relative[3];
    push.press = pressing(surface, velocity, acceleration, slip);
    push.friction = surface->collider->friction * fmax(0, push.press);
    ck_subtract(relative, acceleration, surface->acceleration);
    ck_tangential(push.along, relative, surface->normal);
    return push;
}

static void scale_to_one(double *vector) {
    const double length = ck_length(vector);
    for (int axis = 0; axis < 3; axis++) vector[axis] = length > 0 ? vector[axis] / length : 0;
}

// The direction that friction acts against: that of sliding; where it has none yet, that in which it is pushed. A slow
// one turns into the push at once, in a time v/friction that no step follows: below friction·dt it goes over to it. One
// that has turned round since the start of the step keeps the way it had, until the event of that.
static void direction(const ck_Touches *touches, const Touch *touch, const double *along, const Push *push,
                      double *way) {
    const double speed = ck_length(along), slow = push->friction * touches->dt - speed;
    double pushed[3];
    memcpy(pushed, push->along, sizeof pushed);
    scale_to_one(pushed);
    if (speed <= touches->rest && ck_dot(pushed, pushed) > 0) {
        memcpy(way, pushed, sizeof pushed);
    } else if (ck_dot(touch->way, touch->way) > 0 && ck_dot(along, touch->way) <= 0) {
        memcpy(way, touch->way, 3 * sizeof(double));
    } else {
        memcpy(way, along, 3 * sizeof(double));
        if (slow > 0 && ck_dot(along, pushed) > 0) ck_add_scaled(way, slow, pushed);
        scale_to_one(way);
    }
}

void ck_touches_accelerate(ck_Touches *touches, double time, int side, const double *position, const double *velocity,
                           double *acceleration) {
    for (int i = 0; i < touches->model->particle_count; i++) {
        const Touch *touch = &touches->touch[i];
        double along[3], way[3], *a = acceleration + 3 * i;
        if (touch->collider < 0) continue;
        const Surface surface = surface_of(touches, touch, time, side, position + 3 * i);
        if (touch->sticks) {
            memcpy(a, surface.acceleration, sizeof surface.acceleration);
            continue;
        }
        const Push push = push_of(&surface, velocity + 3 * i, a, along);
        direction(touches, touch, along, &push, way);
        ck_add_scaled(a, push.press, surface.normal);
        ck_add_scaled(a, -push.friction, way);
    }
}

void ck_touches_start(ck_Touches *touches, double time, double dt, const double *position, const double *velocity,
                      const double *acceleration) {
    const size_t bytes = 3 * sizeof(double) * (size_t)touches->model->particle_count;
    touches->time = time;
    touches->dt = dt;
    memcpy(touches->position, position, bytes);
    memcpy(touches->velocity, velocity, bytes);
    memcpy(touches->acceleration, acceleration, bytes);
    for (int i = 0; i < touches->model->particle_count; i++) {
        Touch *touch = &touches->touch[i];
        memset(touch->way, 0, sizeof touch->way);
        if (touch->collider < 0 || touch->sticks) continue;
        const Surface surface = surface_of(touches, touch, time, 1, position + 3 * i);
        double along[3], way[3];
        const Push push = push_of(&surface, velocity + 3 * i, acceleration + 3 * i, along);
        direction(touches, touch, along, &push, way);
        memcpy(touch->way, way, sizeof way);
    }
}

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
    return surface_at(touches, collider, touches->time + s * dt, 1, point).gap;
}

// True where it has speed into the surface at the start of the step.
static bool comes_in(const ck_Touches *touches, int particle, int collider) {
    const Surface surface = surface_at(touches, collider, touches->time, 1, touches->position + 3 * particle);
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

static void note(Touch *touch, Event event, int hit, double when) {
    if (when > 1 || when >= touch->when) return;
    touch->event = event;
    touch->hit = hit;
    touch->when = when;
}

// Where a number falls through zero between the ends of a step.
static double crossing(double start, double end) {
    return start > 0 ? start / (start - end) : 0;
}

// What friction can hold less what it must.
static double margin(const Push *push) {
    return push->press < 0 ? push->press : push->friction - ck_length(push->along);
}

// When a particle that slides stops, where push and friction stay as they are: T = v·(q + f·cos θ)/(q² − f²), by
// v' = f·cos θ − q and v·θ' = −f·sin θ, as it turns into the push while it slows down.
static double stop_time(const double *along, const Push *push) {
    const double speed = ck_length(along), f = ck_length(push->along), q = push->friction;
    if (!(q > f)) return INFINITY;
    return (speed * q + ck_dot(push->along, along)) / ((q - f) * (q + f));
}

// The share of the step after which it stops: of what push and friction are in the middle of that time.
static double stop_share(const double *along, const Push *start, const Push *end, double dt) {
    double time = stop_time(along, start);
    for (int round = 0; round < 3 && time < 2 * dt; round++) {
        const double share = 0.5 * time / dt;
        Push mean = {.friction = start->friction + share * (end->friction - start->friction)};
        for (int axis = 0; axis < 3; axis++)
            mean.along[axis] = start->along[axis] + share * (end->along[axis] - start->along[axis]);
        time = stop_time(along, &mean);
    }
    return time / dt;
}

static double excess_at(const ck_Touches *touches, const Touch *touch, int axis, double time, const double *point) {
    double seen[3];
    const Surface surface = look_at(touches, touch->collider, time, 1, point, seen);
    return ck_collider_part_excess(surface.collider, axis, seen);
}

// Where a particle goes over the border of the part of the surface that it is on, there curved otherwise.
static void note_border(ck_Touches *touches, int particle, double dt, const double *position, const double *velocity) {
    Touch *touch = &touches->touch[particle];
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
        note(touch, BORDER, axis, high);
    }
}

// The event of a particle that touches already: it lifts, stops or slips.
static void note_change(ck_Touches *touches, int particle, double dt, const double *position, const double *velocity,
                        const double *acceleration) {
    Touch *touch = &touches->touch[particle];
    const int at = 3 * particle;
    const Surface start = surface_of(touches, touch, touches->time, 1, touches->position + at);
    const Surface end = surface_of(touches, touch, touches->time + dt, -1, position + at);
    double slip[3], left[3];
    const Push before = push_of(&start, touches->velocity + at, touches->acceleration + at, slip);
    const Push after = push_of(&end, velocity + at, acceleration + at, left);
    note_border(touches, particle, dt, position, velocity);
    if (after.press < 0) note(touch, LIFT, 0, crossing(before.press, after.press));
    if (touch->sticks) {
        if (margin(&after) < 0) note(touch, SLIP, 0, crossing(margin(&before), margin(&after)));
        return;
    }
    if (!(end.collider->friction > 0)) return;
    if (ck_length(slip) > touches->rest) note(touch, STOP, 0, stop_share(slip, &before, &after, dt));
    const double on = ck_dot(slip, touch->way), back = ck_dot(left, touch->way);
    if (back <= 0) note(touch, on > touches->rest ? TURN : STOP, 0, fmax(LEAST, crossing(on, back)));
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
    look_at(touches, collider, touches->time, 1, x, from);
    look_at(touches, collider, touches->time + dt, -1, end, to);
    if (!(ck_collider_least_gap(solid, from, to) < -touches->thin)) return 2;
    for (int i = 1; i < SHARES; i++) {
        const double share = i / (double)SHARES;
        if (gap_at(touches, particle, collider, dt, end, end_velocity, share) < -touches->thin) return share;
    }
    return 2;
}

// True where nothing that it does not touch can be met on the chord to a place: gaps change by no more than the way.
static bool is_clear(const ck_Touches *touches, int particle, const double *end) {
    const Touch *touch = &touches->touch[particle];
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
    Touch *touch = &touches->touch[particle];
    double clear = INFINITY;
    if (is_clear(touches, particle, x)) return;
    for (int c = 0; c < touches->model->collider_count; c++) {
        if (c == touch->collider) continue;
        const double gap = surface_at(touches, c, touches->time + dt, -1, x).gap;
        const double inside = gap < -touches->thin ? 1 : passing_share(touches, particle, c, dt, x, v, gap);
        if (inside <= 1) note(touch, IMPACT, c, impact_share(touches, particle, c, dt, x, v, inside));
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
        Touch *touch = &touches->touch[i];
        touch->event = NO_EVENT;
        touch->when = 2;
        if (touches->pinned[i]) continue;
        if (touch->collider >= 0) note_change(touches, i, dt, position, velocity, acceleration);
        note_impacts(touches, i, dt, position + 3 * i, velocity + 3 * i);
        first = fmin(first, touch->when);
    }
    // those at the same time are one event
    for (int i = 0; i < touches->model->particle_count; i++)
        if (touches->touch[i].when > first + 1e-9) touches->touch[i].event = NO_EVENT;
    return first;
}

static void put(const Surface *surface, double *x, double *v) {
    double relative[3];
    ck_add_scaled(x, -surface->gap, surface->normal);
    ck_subtract(relative, v, surface->velocity);
    ck_add_scaled(v, -ck_dot(relative, surface->normal), surface->normal);
}

void ck_touches_project(ck_Touches *touches, double time, double *position, double *velocity) {
    for (int i = 0; i < touches->model->particle_count; i++) {
        const Touch *touch = &touches->touch[i];
        if (touch->collider < 0) continue;
        const Surface surface = surface_of(touches, touch, time, -1, position + 3 * i);
        put(&surface, position + 3 * i, velocity + 3 * i);
        if (touch->sticks) memcpy(velocity + 3 * i, surface.velocity, sizeof surface.velocity);
    }
}

// e times the speed back, and friction's share of the impulse. What does not leave again rests there.
static void strike(ck_Touches *touches, int particle, int collider, double time, double *x, double *v) {
    Touch *touch = &touches->touch[particle];
    const Surface surface = surface_at(touches, collider, time, 1, x);
    double relative[3], along[3];
    ck_add_scaled(x, -surface.gap, surface.normal);
    ck_subtract(relative, v, surface.velocity);
    const double speed = -ck_dot(relative, surface.normal), back = surface.collider->restitution * fmax(0, speed);
    const bool rests = back <= touches->rest;
    const double jump = fmax(0, speed) + (rests ? 0 : back);
    ck_tangential(along, relative, surface.normal);
    const double sliding = ck_length(along);
    if (speed > 0) ck_add_scaled(v, jump, surface.normal);
    if (sliding > 0) ck_add_scaled(v, -fmin(1, surface.collider->friction * jump / sliding), along);
    ck_subtract(relative, v, surface.velocity);
    double seen[3] = {x[0], x[1], x[2]};
    ck_add_scaled(seen, -1, surface.moved);
    touch->part = ck_collider_part(surface.collider, seen, relative);
    touch->collider = rests ? collider : -1;
    touch->sticks = false;
    touch->event = rests ? STOP : NO_EVENT;
}

// Over a border, onto the next part of the surface; off a sharp edge.
static void turn_over(ck_Touches *touches, Touch *touch, double time, const double *x) {
    const Surface surface = surface_of(touches, touch, time, 1, x);
    double from[3];
    int beyond = 0;
    ck_subtract(from, x, surface.collider->point);
    ck_add_scaled(from, -1, surface.moved);
    const double local = ck_dot(from, surface.collider->axes[touch->hit]);
    touch->part.beyond[touch->hit] = touch->part.beyond[touch->hit] ? 0 : local < 0 ? -1 : 1;
    for (int axis = 0; axis < 3; axis++) beyond += touch->part.beyond[axis] != 0;
    if (!(surface.collider->radius > 0) && beyond > 1) touch->collider = -1;
}

bool ck_touches_change(ck_Touches *touches, double time, double *position, double *velocity) {
    for (int i = 0; i < touches->model->particle_count; i++) {
        Touch *touch = &touches->touch[i];
        double *x = position + 3 * i, *v = velocity + 3 * i;
        if (touch->event == IMPACT) {
            if (touch->collider >= 0) return false;
            strike(touches, i, touch->hit, time, x, v);
        } else if (touch->event == LIFT) {
            touch->collider = -1;
        } else if (touch->event == BORDER) {
            turn_over(touches, touch, time, x);
        } else if (touch->event == STOP || touch->event == SLIP) {
            const Surface surface = surface_of(touches, touch, time, 1, x);
            put(&surface, x, v);
            if (touch->event == STOP) memcpy(v, surface.velocity, sizeof surface.velocity);
            touch->sticks = false;
        }
    }
    return true;
}

void ck_touches_settle(ck_Touches *touches, double time, const double *position, double *velocity,
                       const double *acceleration) {
    for (int i = 0; i < touches->model->particle_count; i++) {
        Touch *touch = &touches->touch[i];
        double along[3], *v = velocity + 3 * i;
        const Event event = touch->event;
        touch->event = NO_EVENT;
        if ((event != STOP && event != BORDER) || touch->collider < 0) continue;
        const Surface surface = surface_of(touches, touch, time, 1, position + 3 * i);
        const Push push = push_of(&surface, v, acceleration + 3 * i, along);
        const bool is_still = event == STOP && ck_length(along) <= 1e-3 * touches->rest;
        touch->sticks = push.press > 0 && is_still && push.friction > 0 && margin(&push) >= 0;
        if (!(push.press > 0)) touch->collider = -1;
        if (touch->sticks) memcpy(v, surface.velocity, sizeof surface.velocity);
    }
}

bool ck_touches_begin(ck_Touches *touches, double time, double *position, double *velocity) {
    for (int i = 0; i < touches->model->particle_count; i++) {
        Touch *touch = &touches->touch[i];
        double *x = position + 3 * i, *v = velocity + 3 * i;
        touch->collider = -1;
        touch->event = NO_EVENT;
        for (int c = 0; c < touches->model->collider_count && !touches->pinned[i]; c++) {
            const Surface surface = surface_at(touches, c, time, 1, x);
            double relative[3];
            ck_subtract(relative, v, surface.velocity);
            if (surface.gap > 1e3 * touches->thin || ck_dot(relative, surface.normal) > touches->rest) continue;
            if (touch->collider >= 0) return false;
            strike(touches, i, c, time, x, v);
        }
    }
    return true;
}
