#include "collider.h"

#include "path.h"
#include "vector.h"

#include <string.h>

ck_Collider ck_collider_at(const ck_Collider *collider, double time, int side, double *velocity, double *acceleration) {
    ck_Collider now = *collider;
    double moved[3];
    memset(velocity, 0, 3 * sizeof(double));
    memset(acceleration, 0, 3 * sizeof(double));
    if (!collider->path) return now;
    ck_path_at(collider->path, time, side, moved, velocity, acceleration);
    ck_add_scaled(now.point, 1, moved);
    now.path = NULL;
    return now;
}

double ck_collider_gap(const ck_Collider *collider, const double *point, double *normal) {
    double from[3];
    ck_subtract(from, point, collider->point);
    if (collider->shape == CK_PLANE) {
        memcpy(normal, collider->normal, 3 * sizeof(double));
        return ck_dot(from, normal);
    }
    double distance = ck_length(from);
    // the centre has no direction out of its own: any will do
    for (int axis = 0; axis < 3; axis++) normal[axis] = distance > 0 ? from[axis] / distance : axis == 1;
    return distance - collider->radius;
}

static double hit_plane(double gap, double v, double a, double duration, double slack) {
    // from the surface itself, only a fall back onto it is a hit
    if (gap <= slack) return v > 0 && a < 0 && -2 * v / a <= duration ? -2 * v / a : INFINITY;
    double root = v * v - 2 * a * gap;
    if (root < 0) return INFINITY;
    // of both ways to write the smaller positive root, the one that does not cancel
    double time = v < 0 ? 2 * gap / (sqrt(root) - v) : a < 0 ? (v + sqrt(root)) / -a : INFINITY;
    return time <= duration ? time : INFINITY;
}

typedef struct Path {
    const double *x, *v, *a;
} Path;

static void point_at(double *point, const Path *path, double time) {
    memcpy(point, path->x, 3 * sizeof(double));
    ck_add_scaled(point, time, path->v);
    ck_add_scaled(point, 0.5 * time * time, path->a);
}

static double gap_at(const ck_Collider *collider, const Path *path, double time) {
    double point[3], normal[3];
    point_at(point, path, time);
    return ck_collider_gap(collider, point, normal);
}

// The time between outside and inside at which the gap closes, to the last bit.
static double bisect(const ck_Collider *collider, const Path *path, double outside, double inside) {
    for (;;) {
        double middle = 0.5 * (outside + inside);
        if (middle <= outside || middle >= inside) return outside;
        if (gap_at(collider, path, middle) > 0)
            outside = middle;
        else
            inside = middle;
    }
}

// When the chord of a path between two times comes closest to the ball's centre.
static double closest_time(const ck_Collider *collider, const Path *path, double from, double to) {
    double start[3], chord[3], way[3];
    point_at(start, path, from);
    point_at(chord, path, to);
    ck_subtract(chord, chord, start);
    ck_subtract(way, collider->point, start);
    double length_squared = ck_dot(chord, chord);
    double share = length_squared > 0 ? fmax(0, fmin(1, ck_dot(way, chord) / length_squared)) : 1;
    return from + share * (to - from);
}

// A parabola meets a ball in up to four points. Within a step it is all but straight: where its chord comes closest it
// is inside, or it is at the end, or it misses. Error: a parabola that dips in by less than a·duration²/8.
static double hit_sphere(const ck_Collider *collider, const Path *path, double duration, double slack) {
    double normal[3], outside = 0;
    if (ck_collider_gap(collider, path->x, normal) <= slack) {
        double v = ck_dot(path->v, normal), a = ck_dot(path->a, normal);
        // it only comes back where it turns within the step
        if (!(v > 0 && a < 0)) return INFINITY;
        outside = fmin(duration, -v / a);
    }
    double inside = closest_time(collider, path, outside, duration);
    if (!(gap_at(collider, path, inside) < 0)) inside = duration;
    if (!(gap_at(collider, path, inside) < 0)) return INFINITY;
    return bisect(collider, path, outside, inside);
}

double ck_collider_hit(const ck_Collider *collider, const double *x, const double *v, const double *a, double duration,
                       double slack) {
    double normal[3];
    if (collider->shape == CK_SPHERE) return hit_sphere(collider, &(Path){x, v, a}, duration, slack);
    double gap = ck_collider_gap(collider, x, normal);
    return hit_plane(gap, ck_dot(v, normal), ck_dot(a, normal), duration, slack);
}

double ck_collider_rebound(double restitution, double depth, double speed, double pull, double dt) {
    double now = speed + 0.5 * pull * dt, surface_squared = fmax(0, now * now - 2 * pull * depth);
    double after_squared = restitution * restitution * surface_squared + 2 * pull * depth;
    return fmax(0, sqrt(fmax(0, after_squared)) - 0.5 * pull * dt);
}
