// What the springs of a model do at given positions and speeds: strain, energy, damping.
#ifndef CK_SPRINGS_H
#define CK_SPRINGS_H

#include "model.h"

#ifdef __cplusplus
extern "C" {
#endif

// length/rest − 1.
//   position  [3*n] m
double ck_spring_strain(const ck_Spring *spring, const double *position);

// The largest strain, and the root mean square of all; NaN without springs.
double ck_springs_largest_strain(const ck_Model *model, const double *position);
double ck_springs_rms_strain(const ck_Model *model, const double *position);

// ½·k·(l − L)² of all, in J; rigid bars hold none.
double ck_springs_energy(const ck_Model *model, const double *position);

// c·(v·n)² of all, in W: what spring damping takes.
//   position, velocity  [3*n] m and m/s
double ck_springs_damping_power(const ck_Model *model, const double *position, const double *velocity);

// True where every spring starts at its rest length, to 1e-12 of it.
bool ck_springs_start_at_rest(const ck_Model *model);

// Acceleration of every particle, m/s², 0 where pinned: springs with axial damping, field, drag.
//   position, velocity  [3*n] in;  acceleration  [3*n] out
// Cost: one pass over springs, one over particles.
void ck_springs_accelerate(const ck_Model *model, const double *position, const double *velocity, double *acceleration);

#ifdef __cplusplus
}
#endif

#endif
