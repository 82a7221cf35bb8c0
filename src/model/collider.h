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

// The least gap of a solid to the line between two points, m.
double ck_collider_least_gap(const ck_Collider *collider, const double *from, const double *to);

// Half of how thick a shape is where it is thinnest, m; INFINITY: a half-space.
double ck_collider_breadth(const ck_Collider *collider);

// The terms that a collider makes a scene have.
unsigned ck_collider_terms(const ck_Collider *collider);

// The part of a shape that a point is nearest to, by its axes: −1 or 1 where it is beyond that end of the core, 0
// between the two. Of a box: corners, edges and faces. Planes and spheres have one.
typedef struct ck_Part {
    signed char beyond[3];
} ck_Part;

// velocity, of a point at the border of two parts: it is on the one that it goes to.
ck_Part ck_collider_part(const ck_Collider *collider, const double *point, const double *velocity);

// True for a plane and the face of a box.
bool ck_collider_is_flat(const ck_Collider *collider, ck_Part part);

// As ck_collider_gap, of the surface of which a part is a piece: a plane, a cylinder or a ball without end.
double ck_collider_part_gap(const ck_Collider *collider, ck_Part part, const double *point, double *normal);

// How far a point is beyond the border of a part along an axis, m: negative inside.
double ck_collider_part_excess(const ck_Collider *collider, int axis, const double *point);

// What of a vector along a part's surface is across what is curved, [3]; 0 where it is flat.
void ck_collider_across(const ck_Collider *collider, ck_Part part, const double *along, double *across);

// What a speed along a part's surface, m/s, asks of acceleration towards it: v²/r across what is curved, m/s².
double ck_collider_turn(const ck_Collider *collider, ck_Part part, const double *along);

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
