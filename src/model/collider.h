// Where a collider's surface is: a half-space or a ball, exactly.
#ifndef CK_COLLIDER_H
#define CK_COLLIDER_H

#include "model.h"

#ifdef __cplusplus
extern "C" {
#endif

// The collider where it is at a time, s, that stays there; its velocity and acceleration then, [3] m/s and m/s².
//   side  of a jump of its velocity, as ck_path_at has it
ck_Collider ck_collider_at(const ck_Collider *collider, double time, int side, double *velocity, double *acceleration);

// The distance of a point from the surface, in m, negative inside; normal: out, unit, away from the collider.
double ck_collider_gap(const ck_Collider *collider, const double *point, double *normal);

// The first time in (0, duration] at which a point that moves by x + v·t + a·t²/2 comes to touch the surface from
// outside, in s; INFINITY where it does not. A point that starts within slack (m) of it is outside as long as it
// leaves.
double ck_collider_hit(const ck_Collider *collider, const double *x, const double *v, const double *a, double duration,
                       double slack);

// For solvers that step by their last speed, and whose positions are therefore those of a speed half a step's pull
// ahead: the speed, in m/s, to give a particle for its next step so that it leaves the surface with e times the speed
// that it meets it with.
//   depth  m, inside; negative: it is still outside;  speed  m/s, into the collider;  pull  m/s², of the field into it
// Exact in a uniform field. 0 where it would not get off the surface.
double ck_collider_rebound(double restitution, double depth, double speed, double pull, double dt);

#ifdef __cplusplus
}
#endif

#endif
