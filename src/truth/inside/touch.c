#include "touch.h"

#include "touch_surface.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

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

static void scale_to_one(double *vector) {
    const double length = ck_length(vector);
    for (int axis = 0; axis < 3; axis++) vector[axis] = length > 0 ? vector[axis] / length : 0;
}

// The direction that friction acts against: that of sliding; where it has none yet, that in which it is pushed. A slow
// one turns into the push at once, in a time v/friction that no step follows: below friction·dt it goes over to it. One
// that has turned round since the start of the step keeps the way it had, until the event of that.
static void direction(const ck_Touches *touches, const ck_TouchState *touch, const double *along,
                      const ck_TouchPush *push, double *way) {
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
        const ck_TouchState *touch = &touches->touch[i];
        double along[3], way[3], *a = acceleration + 3 * i;
        if (touch->collider < 0) continue;
        const ck_TouchSurface surface = ck_touch_surface_of(touches, touch, time, side, position + 3 * i);
        if (touch->sticks) {
            memcpy(a, surface.acceleration, sizeof surface.acceleration);
            continue;
        }
        const ck_TouchPush push = ck_touch_push(&surface, velocity + 3 * i, a, along);
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
        ck_TouchState *touch = &touches->touch[i];
        memset(touch->way, 0, sizeof touch->way);
        if (touch->collider < 0 || touch->sticks) continue;
        const ck_TouchSurface surface = ck_touch_surface_of(touches, touch, time, 1, position + 3 * i);
        double along[3], way[3];
        const ck_TouchPush push = ck_touch_push(&surface, velocity + 3 * i, acceleration + 3 * i, along);
        direction(touches, touch, along, &push, way);
        memcpy(touch->way, way, sizeof way);
    }
}

static void put(const ck_TouchSurface *surface, double *x, double *v) {
    double relative[3];
    ck_add_scaled(x, -surface->gap, surface->normal);
    ck_subtract(relative, v, surface->velocity);
    ck_add_scaled(v, -ck_dot(relative, surface->normal), surface->normal);
}

void ck_touches_project(ck_Touches *touches, double time, double *position, double *velocity) {
    for (int i = 0; i < touches->model->particle_count; i++) {
        const ck_TouchState *touch = &touches->touch[i];
        if (touch->collider < 0) continue;
        const ck_TouchSurface surface = ck_touch_surface_of(touches, touch, time, -1, position + 3 * i);
        put(&surface, position + 3 * i, velocity + 3 * i);
        if (touch->sticks) memcpy(velocity + 3 * i, surface.velocity, sizeof surface.velocity);
    }
}

// e times the speed back, and friction's share of the impulse. What does not leave again rests there.
static void strike(ck_Touches *touches, int particle, int collider, double time, double *x, double *v) {
    ck_TouchState *touch = &touches->touch[particle];
    const ck_TouchSurface surface = ck_touch_surface_at(touches, collider, time, 1, x);
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
    touch->event = rests ? CK_STOP : CK_NO_EVENT;
}

// Over a border, onto the next part of the surface; off a sharp edge.
static void turn_over(ck_Touches *touches, ck_TouchState *touch, double time, const double *x) {
    const ck_TouchSurface surface = ck_touch_surface_of(touches, touch, time, 1, x);
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
        ck_TouchState *touch = &touches->touch[i];
        double *x = position + 3 * i, *v = velocity + 3 * i;
        if (touch->event == CK_IMPACT) {
            if (touch->collider >= 0) return false;
            strike(touches, i, touch->hit, time, x, v);
        } else if (touch->event == CK_LIFT) {
            touch->collider = -1;
        } else if (touch->event == CK_BORDER) {
            turn_over(touches, touch, time, x);
        } else if (touch->event == CK_STOP || touch->event == CK_SLIP) {
            const ck_TouchSurface surface = ck_touch_surface_of(touches, touch, time, 1, x);
            put(&surface, x, v);
            if (touch->event == CK_STOP) memcpy(v, surface.velocity, sizeof surface.velocity);
            touch->sticks = false;
        }
    }
    return true;
}

void ck_touches_settle(ck_Touches *touches, double time, const double *position, double *velocity,
                       const double *acceleration) {
    for (int i = 0; i < touches->model->particle_count; i++) {
        ck_TouchState *touch = &touches->touch[i];
        double along[3], *v = velocity + 3 * i;
        const ck_TouchEvent event = touch->event;
        touch->event = CK_NO_EVENT;
        if ((event != CK_STOP && event != CK_BORDER) || touch->collider < 0) continue;
        const ck_TouchSurface surface = ck_touch_surface_of(touches, touch, time, 1, position + 3 * i);
        const ck_TouchPush push = ck_touch_push(&surface, v, acceleration + 3 * i, along);
        const bool is_still = event == CK_STOP && ck_length(along) <= 1e-3 * touches->rest;
        touch->sticks = push.press > 0 && is_still && push.friction > 0 && ck_touch_margin(&push) >= 0;
        if (!(push.press > 0)) touch->collider = -1;
        if (touch->sticks) memcpy(v, surface.velocity, sizeof surface.velocity);
    }
}

bool ck_touches_begin(ck_Touches *touches, double time, double *position, double *velocity) {
    for (int i = 0; i < touches->model->particle_count; i++) {
        ck_TouchState *touch = &touches->touch[i];
        double *x = position + 3 * i, *v = velocity + 3 * i;
        touch->collider = -1;
        touch->event = CK_NO_EVENT;
        for (int c = 0; c < touches->model->collider_count && !touches->pinned[i]; c++) {
            const ck_TouchSurface surface = ck_touch_surface_at(touches, c, time, 1, x);
            double relative[3];
            ck_subtract(relative, v, surface.velocity);
            if (surface.gap > 1e3 * touches->thin || ck_dot(relative, surface.normal) > touches->rest) continue;
            if (touch->collider >= 0) return false;
            strike(touches, i, c, time, x, v);
        }
    }
    return true;
}
