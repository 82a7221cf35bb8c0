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

// Where a point is along a shape's axes, m, from the middle of its core.
static double local_of(const ck_Collider *collider, int axis, const double *from) {
    return ck_dot(collider->axes[axis], from);
}

static bool is_box(const ck_Collider *collider) {
    return collider->half[0] > 0 && collider->half[1] > 0 && collider->half[2] > 0;
}

// The face of a box that a point inside of its core is nearest to.
static double face_gap(const ck_Collider *collider, const double *from, double *normal) {
    double least = INFINITY, sign = 1;
    int face = 0;
    for (int k = 0; k < 3; k++) {
        const double local = local_of(collider, k, from), depth = collider->half[k] - fabs(local);
        if (depth >= least) continue;
        least = depth;
        face = k;
        sign = local < 0 ? -1 : 1;
    }
    for (int axis = 0; axis < 3; axis++) normal[axis] = sign * collider->axes[face][axis];
    return -least - collider->radius;
}

// Apart, so that planes and balls do not pay for its registers.
__attribute__((noinline)) static double solid_gap(const ck_Collider *collider, const double *from, double *normal) {
    double out[3] = {from[0], from[1], from[2]};
    int beyond = 0, last = 0;
    for (int k = 0; k < 3 && is_box(collider); k++) {
        if (!(fabs(local_of(collider, k, from)) > collider->half[k])) continue;
        beyond++;
        last = k;
    }
    // off one face the way out is known, whatever a difference of rounded places points to
    if (beyond == 1) {
        const double local = local_of(collider, last, from), sign = local < 0 ? -1 : 1;
        for (int axis = 0; axis < 3; axis++) normal[axis] = sign * collider->axes[last][axis];
        return fabs(local) - collider->half[last] - collider->radius;
    }
    for (int k = 0; k < 3; k++) {
        const double local = local_of(collider, k, from);
        if (collider->half[k] > 0)
            ck_add_scaled(out, -fmax(-collider->half[k], fmin(collider->half[k], local)), collider->axes[k]);
    }
    const double distance = ck_length(out);
    // out of rounding alone points anywhere
    if (is_box(collider) && distance <= 1e-14 * ck_length(from)) return face_gap(collider, from, normal);
    for (int axis = 0; axis < 3; axis++) normal[axis] = distance > 0 ? out[axis] / distance : collider->axes[1][axis];
    return distance - collider->radius;
}

double ck_collider_gap(const ck_Collider *collider, const double *point, double *normal) {
    double from[3];
    ck_subtract(from, point, collider->point);
    if (collider->shape == CK_PLANE) {
        memcpy(normal, collider->normal, 3 * sizeof(double));
        return ck_dot(from, normal);
    }
    if (collider->shape != CK_SPHERE) return solid_gap(collider, from, normal);
    double distance = ck_length(from);
    // the centre has no direction out of its own: any will do
    for (int axis = 0; axis < 3; axis++) normal[axis] = distance > 0 ? from[axis] / distance : axis == 1;
    return distance - collider->radius;
}

double ck_collider_breadth(const ck_Collider *collider) {
    if (collider->shape == CK_PLANE) return INFINITY;
    return collider->radius +
           (is_box(collider) ? fmin(collider->half[0], fmin(collider->half[1], collider->half[2])) : 0);
}

unsigned ck_collider_terms(const ck_Collider *collider) {
    static const unsigned terms[CK_SHAPE_COUNT] = {CK_TERM_PLANE, CK_TERM_SPHERE, CK_TERM_SOLIDS, CK_TERM_SOLIDS,
                                                   CK_TERM_SOLIDS};
    return terms[collider->shape] | (collider->path ? (unsigned)CK_TERM_MOVING_COLLIDERS : 0);
}

double ck_collider_part_excess(const ck_Collider *collider, int axis, const double *point) {
    double from[3];
    ck_subtract(from, point, collider->point);
    return fabs(local_of(collider, axis, from)) - collider->half[axis];
}

ck_Part ck_collider_part(const ck_Collider *collider, const double *point, const double *velocity) {
    ck_Part part = {{0, 0, 0}};
    double from[3], normal[3], speed = ck_length(velocity);
    if (collider->shape == CK_PLANE || collider->shape == CK_SPHERE) return part;
    ck_subtract(from, point, collider->point);
    bool is_inside = true;
    for (int k = 0; k < 3; k++) {
        const double local = local_of(collider, k, from), half = collider->half[k], sign = local < 0 ? -1 : 1;
        const double border = isfinite(half) ? 1e-9 * (half + collider->radius) : 0, past = fabs(local) - half;
        if (!(half > 0) || past < -border) continue;
        // at the border it is where it goes; without going it is beyond, as a particle on a sharp face is
        const bool comes_in = past <= border && sign * ck_dot(collider->axes[k], velocity) < -1e-9 * speed;
        if (!comes_in) part.beyond[k] = sign < 0 ? -1 : 1;
        is_inside &= comes_in;
    }
    if (!is_box(collider) || !is_inside || part.beyond[0] || part.beyond[1] || part.beyond[2]) return part;
    face_gap(collider, from, normal);
    for (int k = 0; k < 3; k++) {
        const double out = ck_dot(normal, collider->axes[k]);
        part.beyond[k] = out > 0.5 ? 1 : out < -0.5 ? -1 : 0;
    }
    return part;
}

bool ck_collider_is_flat(const ck_Collider *collider, ck_Part part) {
    int beyond = 0;
    for (int k = 0; k < 3; k++) beyond += part.beyond[k] != 0;
    return collider->shape == CK_PLANE || (is_box(collider) && beyond == 1);
}

double ck_collider_part_gap(const ck_Collider *collider, ck_Part part, const double *point, double *normal) {
    double out[3];
    int last = 0;
    if (collider->shape == CK_PLANE || collider->shape == CK_SPHERE) return ck_collider_gap(collider, point, normal);
    ck_subtract(out, point, collider->point);
    for (int k = 0; k < 3; k++) {
        const double local = local_of(collider, k, out);
        if (collider->half[k] > 0)
            ck_add_scaled(out, part.beyond[k] ? -part.beyond[k] * collider->half[k] : -local, collider->axes[k]);
        if (part.beyond[k]) last = k;
    }
    // a face is flat: out of it is one direction, inside of it, too
    if (ck_collider_is_flat(collider, part)) {
        for (int axis = 0; axis < 3; axis++) normal[axis] = part.beyond[last] * collider->axes[last][axis];
        return ck_dot(out, normal) - collider->radius;
    }
    const double distance = ck_length(out);
    for (int axis = 0; axis < 3; axis++) normal[axis] = distance > 0 ? out[axis] / distance : collider->axes[1][axis];
    return distance - collider->radius;
}

void ck_collider_across(const ck_Collider *collider, ck_Part part, const double *along, double *across) {
    const bool is_flat = ck_collider_is_flat(collider, part);
    for (int axis = 0; axis < 3; axis++) across[axis] = is_flat ? 0 : along[axis];
    for (int k = 0; k < 3 && !is_flat && collider->shape != CK_SPHERE; k++)
        if (collider->half[k] > 0 && !part.beyond[k])
            ck_add_scaled(across, -ck_dot(across, collider->axes[k]), collider->axes[k]);
}

double ck_collider_turn(const ck_Collider *collider, ck_Part part, const double *along) {
    if (ck_collider_is_flat(collider, part)) return 0;
    if (collider->shape == CK_SPHERE) return ck_dot(along, along) / collider->radius;
    double across[3];
    ck_collider_across(collider, part, along, across);
    const double squared = ck_dot(across, across);
    // a sharp edge is turned by nothing
    return squared > 1e-18 * ck_dot(along, along) ? squared / collider->radius : 0;
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

// rate: of the gap there, m/s
static double gap_at(const ck_Collider *collider, const Path *path, double time, double *rate) {
    double point[3], normal[3];
    point_at(point, path, time);
    const double gap = ck_collider_gap(collider, point, normal);
    *rate = ck_dot(path->v, normal) + time * ck_dot(path->a, normal);
    return gap;
}

// The time between outside and inside at which the gap closes, to 1e-15 of it: Newton's steps, and halves where one
// would leave what is known. From what is convex the gap is all but convex, and steps come to it from outside.
static double close_in(const ck_Collider *collider, const Path *path, double outside, double inside) {
    const double enough = 1e-15 * inside;
    double time = inside, rate;
    while (inside - outside > enough) {
        const double gap = gap_at(collider, path, time, &rate), next = time - gap / rate;
        if (!(fabs(next - time) > enough)) return time;
        if (gap > 0)
            outside = time;
        else
            inside = time;
        time = next > outside && next < inside ? next : 0.5 * (outside + inside);
    }
    return outside;
}

// When the chord of a path between two times comes closest to a ball's centre.
static double closest_to_centre(const ck_Collider *collider, const double *start, const double *chord) {
    double way[3];
    ck_subtract(way, collider->point, start);
    const double squared = ck_dot(chord, chord);
    return squared > 0 ? fmax(0, fmin(1, ck_dot(way, chord) / squared)) : 1;
}

// The same of any shape: along a chord the distance from what is convex has one minimum. Source: Kiefer 1953.
//   enough  m: a gap that is as good as the least
static double closest_to_core(const ck_Collider *collider, const double *start, const double *chord, double enough) {
    const double golden = 0.61803398874989485;
    double low = 0, high = 1, point[3], normal[3], gap[2], at[2];
    for (int round = 0; round < 40; round++) {
        for (int i = 0; i < 2; i++) {
            at[i] = i ? low + golden * (high - low) : high - golden * (high - low);
            memcpy(point, start, sizeof point);
            ck_add_scaled(point, at[i], chord);
            gap[i] = ck_collider_gap(collider, point, normal);
            if (gap[i] < enough) return at[i];
        }
        if (gap[0] < gap[1])
            high = at[1];
        else
            low = at[0];
    }
    return 0.5 * (low + high);
}

double ck_collider_least_gap(const ck_Collider *collider, const double *from, const double *to) {
    double chord[3], point[3], normal[3];
    ck_subtract(chord, to, from);
    const double gap = ck_collider_gap(collider, from, normal);
    // it comes no nearer than it goes
    if (gap > ck_length(chord)) return gap - ck_length(chord);
    memcpy(point, from, sizeof point);
    ck_add_scaled(point,
                  collider->shape == CK_SPHERE ? closest_to_centre(collider, from, chord)
                                               : closest_to_core(collider, from, chord, -INFINITY),
                  chord);
    return ck_collider_gap(collider, point, normal);
}

// The time between two at which the chord of the path is nearest, or already inside.
static double closest_time(const ck_Collider *collider, const Path *path, double from, double to) {
    double start[3], chord[3];
    point_at(start, path, from);
    point_at(chord, path, to);
    ck_subtract(chord, chord, start);
    const double share = collider->shape == CK_SPHERE ? closest_to_centre(collider, start, chord)
                                                      : closest_to_core(collider, start, chord, 0);
    return from + share * (to - from);
}

// A parabola meets a ball in up to four points. Within a step it is all but straight: where its chord comes closest it
// is inside, or it is at the end, or it misses. Error: a parabola that dips in by less than a·duration²/8.
static double hit_solid(const ck_Collider *collider, const Path *path, double duration, double slack) {
    double normal[3], outside = 0;
    const double gap = ck_collider_gap(collider, path->x, normal);
    // nothing comes nearer than it goes
    if (gap > duration * (ck_length(path->v) + 0.5 * duration * ck_length(path->a))) return INFINITY;
    if (gap <= slack) {
        double v = ck_dot(path->v, normal), a = ck_dot(path->a, normal);
        // it only comes back where it turns within the step
        if (!(v > 0 && a < 0)) return INFINITY;
        outside = fmin(duration, -v / a);
    }
    double inside = closest_time(collider, path, outside, duration), rate;
    if (!(gap_at(collider, path, inside, &rate) < 0)) inside = duration;
    if (!(gap_at(collider, path, inside, &rate) < 0)) return INFINITY;
    return close_in(collider, path, outside, inside);
}

double ck_collider_hit(const ck_Collider *collider, const double *x, const double *v, const double *a, double duration,
                       double slack) {
    double normal[3];
    if (collider->shape != CK_PLANE) return hit_solid(collider, &(Path){x, v, a}, duration, slack);
    double gap = ck_collider_gap(collider, x, normal);
    return hit_plane(gap, ck_dot(v, normal), ck_dot(a, normal), duration, slack);
}

double ck_collider_rebound(double restitution, double depth, double speed, double pull, double dt) {
    double now = speed + 0.5 * pull * dt, surface_squared = fmax(0, now * now - 2 * pull * depth);
    double after_squared = restitution * restitution * surface_squared + 2 * pull * depth;
    return fmax(0, sqrt(fmax(0, after_squared)) - 0.5 * pull * dt);
}
