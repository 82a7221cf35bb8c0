// Pins and colliders that move along a path of their own.
#ifndef CK_PATH_H
#define CK_PATH_H

#include "model.h"

#ifdef __cplusplus
extern "C" {
#endif

// At a time, s, how far a path has moved from its start, m, and its velocity and acceleration, m/s and m/s²; each [3].
//   side  −1 or 1: where the velocity jumps, it is that before or after
// Between points it is a cubic of the velocity that the neighbours of each point make, and 0 at both ends: Catmull and
// Rom 1974, for uneven times.
void ck_path_at(const ck_Path *path, double time, int side, double *moved, double *velocity, double *acceleration);

// The next time after this one, s, at which a path's velocity or acceleration jumps; INFINITY: it never does again.
double ck_path_next_jump(const ck_Path *path, double time);

// The longest step, s, that follows all paths: a twentieth of a sine's period, where the chord from one step to the
// next leaves out (2π/20)²/8 = 1.2 % of its amplitude, and as much of points. INFINITY: nothing turns.
double ck_path_longest_step(const ck_Model *model);

// Gives a path with a goal the velocity that takes it there from a place where it is at 0 or, where it begins later,
// then.
void ck_path_aim(ck_Path *path, const double *place);

// True where the velocity of any pin that moves jumps at that time.
bool ck_driven_jump(const ck_Model *model, double time);

// True for a pin that is moved at that time: one that has been let go is not. At the moment itself it still is, unless
// the model holds it no more.
bool ck_driven_holds(const ck_Model *model, const ck_Driven *driven, double time);

// Where it is at a time, m.
void ck_driven_at(const ck_Driven *driven, double time, double *position);

// What moves a pin at that time; NULL: nothing. Cost: one pass over the pins that move.
const ck_Driven *ck_driven_find(const ck_Model *model, int particle, double time);

// Puts every pin that is moved at that time where it belongs: its position, m, and where not NULL its velocity, m/s;
// arrays [3*n]. Cost: one pass over the pins that move.
void ck_driven_place(const ck_Model *model, double time, int side, double *position, double *velocity);

// Writes the accelerations of these pins, m/s², into [3*n].
void ck_driven_accelerate(const ck_Model *model, double time, int side, double *acceleration);

// True where something outside does work: moving air, pins or colliders.
bool ck_model_is_worked_on(const ck_Model *model);

// True where a pin or a collider still moves at the end.
bool ck_model_ends_moving(const ck_Model *model);

#ifdef __cplusplus
}
#endif

#endif
