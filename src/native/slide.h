// A particle on one surface that stays: pressed on, held by friction, sliding.
//   x, v, a  [3] m, m/s, m/s²;  normal  of the surface at x, out, unit
#ifndef CK_SLIDE_H
#define CK_SLIDE_H

#include "model.h"

// How hard a surface is pressed on, per mass: what bends the path inwards counts as not pressing. ≤ 0: not at all.
double ck_slide_press(const ck_Collider *collider, const double *normal, const double *x, const double *v,
                      const double *a);

// What a collider that is pressed on leaves of an acceleration a, in-out, m/s²; false where it is not. Friction points
// against the way of half a substep: what has just begun to slide turns into its push much faster than that, and
// against its first direction it would be thrown to and fro. Against the push a slide keeps its direction until it
// stops.
bool ck_slide_hold(const ck_Collider *collider, const double *normal, double dt, const double *x, const double *v,
                   double *a);

// Puts a point onto a surface that it is as good as on.
void ck_slide_place(const ck_Collider *collider, double *x, double *normal);

// How a slide goes on: friction takes all of a speed where it is stronger than what pushes along the surface, and else
// that along its own way, which the push turns.
typedef enum ck_Ending { CK_GOES_ON, CK_STOPS, CK_TURNS } ck_Ending;

// When it stops or turns, s; INFINITY where it goes on. T = v·(q + f·cos θ)/(q² − f²) of a constant push f at an angle
// θ to v, by v' = f·cos θ − q and v·θ' = −f·sin θ: the way turns into the push while friction q slows it down.
//   push  [3] m/s², along the surface;  left  what friction leaves of it
double ck_slide_stop_time(double friction, double dt, const double *v, const double *push, const double *left,
                          ck_Ending *ending);

// When a slide leaves a face of a box, s, beyond which the surface turns away.
double ck_slide_border_time(const ck_Collider *collider, const double *x, const double *v, const double *a);

// Along the surface for a time, s, at whose end it goes on, stops or turns: x, v in-out. On a ball the speed follows
// from the work done, which keeps its energy whatever the step.
//   a, left  m/s²: all of the acceleration, and what the carrier leaves of it
void ck_slide(const ck_Collider *carrier, double *x, double *v, const double *a, const double *left, double time,
              ck_Ending ending);

#endif
