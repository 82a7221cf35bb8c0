#include "slide.h"

#include "collider.h"
#include "vector.h"

#include <string.h>

double ck_slide_press(const ck_Collider *collider, const double *normal, const double *x, const double *v,
                      const double *a) {
    // planes and balls, which are most, have one part
    const double turn = collider->shape == CK_PLANE ? 0
                        : collider->shape == CK_SPHERE
                            ? ck_dot(v, v) / collider->radius
                            : ck_collider_turn(collider, ck_collider_part(collider, x, v), v);
    return -ck_dot(a, normal) - turn;
}

// m/s: what is slower than this lies still, but for the rounding of a collider's own speed.
static double still_speed(double friction, double dt) {
    return friction * dt * 1e-9;
}

bool ck_slide_hold(const ck_Collider *collider, const double *normal, double dt, const double *x, const double *v,
                   double *a) {
    double press = ck_slide_press(collider, normal, x, v, a), along[3], drive[3];
    if (!(press > 0)) return false;
    ck_tangential(along, v, normal);
    ck_add_scaled(a, -ck_dot(a, normal), normal);
    memcpy(drive, a, sizeof drive);
    double sliding = ck_length(along), driving = ck_length(drive), friction = collider->friction * press;
    if (sliding > still_speed(friction, dt)) {
        if (ck_dot(along, drive) > 0) ck_add_scaled(along, 0.5 * dt, drive);
        ck_add_scaled(a, -friction / ck_length(along), along);
    } else if (driving > 0) {
        ck_add_scaled(a, -fmin(1, friction / driving), drive);
    }
    return true;
}

void ck_slide_place(const ck_Collider *collider, double *x, double *normal) {
    double gap = ck_collider_gap(collider, x, normal);
    ck_add_scaled(x, -gap, normal);
}

double ck_slide_stop_time(double friction, double dt, const double *v, const double *push, const double *left,
                          ck_Ending *ending) {
    const double speed = ck_length(v), rate = ck_dot(v, left);
    *ending = CK_GOES_ON;
    if (!(speed > still_speed(friction, dt))) return INFINITY;
    const double f = ck_length(push);
    *ending = friction > f ? CK_STOPS : rate < 0 ? CK_TURNS : CK_GOES_ON;
    if (*ending == CK_STOPS) return (speed * friction + ck_dot(v, push)) / ((friction - f) * (friction + f));
    return *ending == CK_TURNS ? -speed * speed / rate : INFINITY;
}

// Takes the speed along a direction, which need not be of length 1.
static void stop_along(double *v, const double *way) {
    const double squared = ck_dot(way, way);
    if (squared > 0) ck_add_scaled(v, -ck_dot(v, way) / squared, way);
}

// What an acceleration, less friction, does on the way over a curved surface that begins by leading straight on by
// flat, m²/s²: the way turns by an angle whose tangent is flat's part across over the radius.
static double work_over(const ck_Collider *carrier, ck_Part part, const double *normal, const double *flat,
                        const double *a, double friction) {
    const double radius = carrier->radius;
    double across[3];
    ck_collider_across(carrier, part, flat, across);
    const double squared = ck_dot(across, across) / (radius * radius);
    const double cosine = 1 / sqrt(1 + squared), less = squared * cosine * cosine / (1 + cosine); // 1 − cosine
    const double length = ck_dot(flat, flat) - radius * radius * (squared - 2 * less);
    return ck_dot(a, flat) - less * (ck_dot(a, across) + radius * ck_dot(a, normal)) - friction * sqrt(fmax(0, length));
}

// True where a way is known from how it begins: on a ball, and where it is so short that nothing else is reached. From
// where it ends it is known to rounding, which of a creep of 1e-8 m/s would leave nothing.
static bool is_foreseen(const ck_Collider *carrier, const double *flat) {
    return carrier->shape == CK_SPHERE || ck_dot(flat, flat) < 1e-12 * carrier->radius * carrier->radius;
}

void ck_slide(const ck_Collider *carrier, double *x, double *v, const double *a, const double *left, double time,
              ck_Ending ending) {
    double flat[3] = {0, 0, 0}, from[3], slid[3], normal[3], way[3], speed_squared = ck_dot(v, v);
    const ck_Part part = ck_collider_part(carrier, x, v);
    memcpy(from, x, sizeof from);
    memcpy(slid, v, sizeof slid);
    ck_collider_gap(carrier, x, normal);
    const double friction = carrier->friction * ck_slide_press(carrier, normal, x, v, a);
    ck_add_scaled(flat, time, v);
    ck_add_scaled(flat, 0.5 * time * time, left);
    ck_add_scaled(x, 1, flat);
    ck_add_scaled(v, time, left);
    if (ending == CK_STOPS) memset(v, 0, 3 * sizeof(double));
    if (ending == CK_TURNS) stop_along(v, slid);
    if (ck_collider_is_flat(carrier, part)) return;
    double worked = is_foreseen(carrier, flat) ? work_over(carrier, part, normal, flat, a, friction) : NAN;
    ck_slide_place(carrier, x, normal);
    ck_add_scaled(v, -ck_dot(v, normal), normal);
    if (ending != CK_GOES_ON) return;
    ck_subtract(way, x, from);
    if (isnan(worked)) worked = ck_dot(a, way) - friction * ck_length(way);
    double speed = ck_length(v);
    double scale = speed > 0 ? sqrt(fmax(0, speed_squared + 2 * worked)) / speed : 0;
    for (int axis = 0; axis < 3; axis++) v[axis] *= scale;
}

// The first time after which c + v·t + a·t²/2 is above 0, from below it; INFINITY: never.
static double rise_time(double c, double v, double a) {
    const double root = v * v - 2 * a * c;
    if (root < 0) return INFINITY;
    const double time = v > 0 ? -2 * c / (v + sqrt(root)) : a > 0 ? (sqrt(root) - v) / a : INFINITY;
    return time > 0 ? time : INFINITY;
}

double ck_slide_border_time(const ck_Collider *collider, const double *x, const double *v, const double *a) {
    if (collider->shape != CK_BOX) return INFINITY;
    const ck_Part part = ck_collider_part(collider, x, v);
    double first = INFINITY, from[3];
    ck_subtract(from, x, collider->point);
    for (int k = 0; k < 3; k++) {
        const double *axis = collider->axes[k], local = ck_dot(axis, from);
        if (part.beyond[k]) continue;
        for (int sign = -1; sign <= 1; sign += 2)
            first = fmin(first, rise_time(fmin(0, sign * local - collider->half[k]), sign * ck_dot(axis, v),
                                          sign * ck_dot(axis, a)));
    }
    return first;
}
