#include "touch_surface.h"

#include "path.h"
#include "vector.h"

#include <string.h>

ck_TouchSurface ck_touch_look(const ck_Touches *touches, int collider, double time, int side, const double *point,
                              double *seen) {
    ck_TouchSurface surface = {.collider = &touches->model->colliders[collider]};
    memcpy(seen, point, 3 * sizeof(double));
    if (!surface.collider->path) return surface;
    ck_path_at(surface.collider->path, time, side, surface.moved, surface.velocity, surface.acceleration);
    ck_add_scaled(seen, -1, surface.moved);
    return surface;
}

ck_TouchSurface ck_touch_surface_at(const ck_Touches *touches, int collider, double time, int side,
                                    const double *point) {
    double seen[3];
    ck_TouchSurface surface = ck_touch_look(touches, collider, time, side, point, seen);
    surface.gap = ck_collider_gap(surface.collider, seen, surface.normal);
    return surface;
}

ck_TouchSurface ck_touch_surface_of(const ck_Touches *touches, const ck_TouchState *touch, double time, int side,
                                    const double *point) {
    double seen[3];
    ck_TouchSurface surface = ck_touch_look(touches, touch->collider, time, side, point, seen);
    surface.part = touch->part;
    surface.gap = ck_collider_part_gap(surface.collider, touch->part, seen, surface.normal);
    return surface;
}

// The acceleration along the normal that keeps it on the surface, less what it would have: how hard it is pressed on,
// per mass. along: its velocity to the surface's, tangential.
static double pressing(const ck_TouchSurface *surface, const double *velocity, const double *acceleration,
                       double *along) {
    double relative[3];
    ck_subtract(relative, velocity, surface->velocity);
    ck_tangential(along, relative, surface->normal);
    const double turn = ck_collider_turn(surface->collider, surface->part, along);
    return -turn + ck_dot(surface->acceleration, surface->normal) - ck_dot(acceleration, surface->normal);
}

ck_TouchPush ck_touch_push(const ck_TouchSurface *surface, const double *velocity, const double *acceleration,
                           double *slip) {
    ck_TouchPush push;
    double relative[3];
    push.press = pressing(surface, velocity, acceleration, slip);
    push.friction = surface->collider->friction * fmax(0, push.press);
    ck_subtract(relative, acceleration, surface->acceleration);
    ck_tangential(push.along, relative, surface->normal);
    return push;
}

double ck_touch_margin(const ck_TouchPush *push) {
    return push->press < 0 ? push->press : push->friction - ck_length(push->along);
}
