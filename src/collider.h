// Where a collider's surface is: a half-space or a ball, exactly.
#ifndef CK_COLLIDER_H
#define CK_COLLIDER_H

#include "model.h"

#ifdef __cplusplus
extern "C" {
#endif

// The distance of a point from the surface, in m, negative inside; normal: out, unit, away from the collider.
double ck_collider_gap(const ck_Collider *collider, const double *point, double *normal);

// The first time in (0, duration] at which a point that moves by x + v·t + a·t²/2 comes to touch the surface from
// outside, in s; INFINITY where it does not. A point that starts within slack (m) of it is outside as long as it
// leaves.
double ck_collider_hit(const ck_Collider *collider, const double *x, const double *v, const double *a, double duration,
                       double slack);

#ifdef __cplusplus
}
#endif

#endif
