// Which particles may come to touch a surface within a substep, a lane each. Included by the files that are compiled
// once for each kind of vectors.
#ifndef CK_NEAR_H
#define CK_NEAR_H

#include "lanes.h"
#include "loops.h"

// How far particles go in a substep at most, |v|·dt + |a|·dt²/2, and some rounding.
CK_INLINE ck_Lanes ck_near_way(ck_Lanes3 v, ck_Lanes3 a, double substep) {
    const ck_Lanes squared[] = {ck_lanes3_dot(v, v), ck_lanes3_dot(a, a)};
    ck_Lanes inverse[2];
    ck_lanes_inverse_root(inverse, squared, 2);
    const double dt = substep * (1 + 1e-9);
    return dt * (squared[0] * inverse[0]) + 0.5 * dt * dt * (squared[1] * inverse[1]);
}

CK_INLINE ck_Lanes ck_near_gap(const ck_NearSurface *surface, ck_Lanes3 x) {
    ck_Lanes3 from = ck_lanes3_subtract(x, ck_lanes3_all(surface->point)), out = from;
    if (surface->is_plane) return ck_lanes3_dot(from, ck_lanes3_all(surface->normal));
    for (int k = 0; k < surface->axis_count; k++) {
        const ck_Lanes half = ck_lanes_all(surface->half[k]);
        const ck_Lanes3 axis = ck_lanes3_all(surface->axes[k]);
        const ck_Lanes along = ck_lanes3_dot(from, axis);
        const ck_Lanes low = ck_lanes_choose(ck_lanes_less(along, -half), -half, along);
        out = ck_lanes3_subtract_scaled(out, ck_lanes_choose(ck_lanes_less(half, low), half, low), axis);
    }
    const ck_Lanes squared = ck_lanes3_dot(out, out);
    ck_Lanes inverse;
    ck_lanes_inverse_root(&inverse, &squared, 1);
    return squared * inverse - surface->radius;
}

// 1 where a surface is within the way, else 0. What is no number is near.
CK_INLINE ck_Lanes ck_near_any(ck_Lanes3 x, ck_Lanes way, const ck_NearSurface *surfaces, int count) {
    ck_Lanes is_near = ck_lanes_all(0);
    for (int k = 0; k < count; k++)
        is_near = ck_lanes_choose(ck_lanes_less(way + surfaces[k].margin, ck_near_gap(&surfaces[k], x)), is_near,
                                  ck_lanes_all(1));
    return is_near;
}

#endif
