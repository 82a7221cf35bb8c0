// Surfaces as particles meet them, a lane each: how far one is, along what, and which may come to touch it within a
// substep. Included by the files that are compiled once for each kind of vectors.
#ifndef CK_NEAR_H
#define CK_NEAR_H

#include "lane_surface.h"
#include "lanes.h"

// A solid has a core with axes, a ball a point.
typedef enum ck_NearShape { CK_NEAR_PLANE, CK_NEAR_BALL, CK_NEAR_SOLID } ck_NearShape;

CK_INLINE ck_NearShape ck_near_shape(const ck_LaneSurface *surface) {
    return surface->is_plane ? CK_NEAR_PLANE : surface->axis_count ? CK_NEAR_SOLID : CK_NEAR_BALL;
}

// From a surface's core, or a plane's point.
CK_INLINE ck_Lanes3 ck_near_out(const ck_LaneSurface *surface, ck_Lanes3 x) {
    ck_Lanes3 from = ck_lanes3_subtract(x, ck_lanes3_all(surface->point)), out = from;
    for (int k = 0; k < surface->axis_count; k++) {
        const ck_Lanes half = ck_lanes_all(surface->half[k]);
        const ck_Lanes3 axis = ck_lanes3_all(surface->axes[k]);
        const ck_Lanes along = ck_lanes3_dot(from, axis);
        const ck_Lanes low = ck_lanes_choose(ck_lanes_less(along, -half), -half, along);
        out = ck_lanes3_subtract_scaled(out, ck_lanes_choose(ck_lanes_less(half, low), half, low), axis);
    }
    return out;
}

CK_INLINE ck_Lanes ck_near_gap(const ck_LaneSurface *surface, ck_Lanes3 x) {
    const ck_Lanes3 out = ck_near_out(surface, x);
    if (surface->is_plane) return ck_lanes3_dot(out, ck_lanes3_all(surface->normal));
    const ck_Lanes squared = ck_lanes3_dot(out, out);
    ck_Lanes inverse;
    ck_lanes_inverse_root(&inverse, &squared, 1);
    return squared * inverse - surface->radius;
}

// How far out of a core is more than a radius, and the normal there: good to rounding by a further step of Newton's, or
// what lies on a large ball would be seen in it.
CK_INLINE ck_Lanes ck_near_round_gap(ck_Lanes3 out, ck_Lanes radius, ck_Lanes3 *normal) {
    const ck_Lanes squared = ck_lanes3_dot(out, out);
    ck_Lanes guess;
    ck_lanes_inverse_root(&guess, &squared, 1);
    const ck_Lanes off = ck_lanes_minus(ck_lanes_all(1), squared * guess, guess);
    const ck_Lanes inverse = ck_lanes_plus(guess, (ck_Real)0.5 * guess, off);
    *normal = ck_lanes3_scale(inverse, out);
    return squared * inverse - radius;
}

// What of a vector leads along a surface.
CK_INLINE ck_Lanes3 ck_near_along(ck_Lanes3 vector, ck_Lanes3 normal) {
    return ck_lanes3_subtract_scaled(vector, ck_lanes3_dot(vector, normal), normal);
}

CK_INLINE ck_Lanes ck_near_sum(ck_Lanes3 a) {
    return ck_lanes_absolute(a.x) + ck_lanes_absolute(a.y) + ck_lanes_absolute(a.z);
}

// More than particles go in a substep, |v|·dt + |a|·dt²/2 and some rounding, by at most √3: without a root.
CK_INLINE ck_Lanes ck_near_most(ck_Lanes3 v, ck_Lanes3 a, double substep) {
    const ck_Real dt = (ck_Real)(substep * (1 + (CK_IS_SINGLE ? 1e-6 : 1e-9)));
    return dt * ck_near_sum(v) + (ck_Real)0.5 * dt * dt * ck_near_sum(a);
}

// Those that a surface cannot be in reach of. What is no number is near.
//   shape  a constant of the caller: what the surface is
CK_INLINE ck_LaneMask ck_near_far(ck_Lanes3 x, ck_Lanes most, const ck_LaneSurface *surface, const ck_NearShape shape) {
    const ck_Lanes reach = most + (surface->margin + surface->radius);
    const ck_Lanes3 out =
        shape == CK_NEAR_SOLID ? ck_near_out(surface, x) : ck_lanes3_subtract(x, ck_lanes3_all(surface->point));
    return shape == CK_NEAR_PLANE ? ck_lanes_less(reach, ck_lanes3_dot(out, ck_lanes3_all(surface->normal)))
                                  : ck_lanes_less(reach * reach, ck_lanes3_dot(out, out));
}

CK_INLINE ck_LaneMask ck_near_is_far(ck_Lanes3 x, ck_Lanes most, const ck_LaneSurface *surface) {
    switch (ck_near_shape(surface)) {
    case CK_NEAR_PLANE: return ck_near_far(x, most, surface, CK_NEAR_PLANE);
    case CK_NEAR_BALL: return ck_near_far(x, most, surface, CK_NEAR_BALL);
    default: return ck_near_far(x, most, surface, CK_NEAR_SOLID);
    }
}

// A bit for each that is not far.
CK_INLINE unsigned ck_near_bits(ck_LaneMask is_far) {
    return ~ck_lanes_bits(is_far) & ((1u << CK_LANES) - 1);
}

#endif
