// What springs and motion hold: strain, forces and energy.
#ifndef CK_SPRINGS_H
#define CK_SPRINGS_H

#include "model.h"
#include "trajectory.h"

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

// Acceleration of every particle, m/s², 0 where pinned: springs with axial damping, hinges, wind, field, drag.
//   position, velocity  [3*n] in;  acceleration  [3*n] out
// Cost: one pass over springs, hinges, faces in wind and particles each.
void ck_springs_accelerate(const ck_Model *model, const double *position, const double *velocity, double *acceleration);

// The mechanical energy of a body along its path, and the balance of it: what no engine may gain, nor lose beyond the
// scene's own damping.

// In J. elastic is by the scene's k, and 0 for rigid bars; field is counted from the start.
typedef struct ck_Energy {
    double kinetic, elastic, field;
} ck_Energy;

// Cost: one pass over particles and springs.
ck_Energy ck_energy_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame);

double ck_energy_total(const ck_Energy *energy);

// The energy that the body turns over, in J: what it starts with, the largest drop of its potential, or, where it
// starts without speed, field·mass·size. At least that of a millionth of its size per second: below is rounding.
double ck_energy_scale(const ck_Model *model, const ck_Trajectory *trajectory);

// By how much kinetic and field energy exceed at most all the energy there was, / scale; 0 where they never do. A bound
// that holds whatever stiffness an engine really has: energy in springs is never negative. What air, pins and colliders
// that move may give counts as there. Rigid bars that start off
// their length have no energy at the start: then the first tenth of the run counts as the start.
double ck_energy_motion_gain(const ck_Model *model, const ck_Trajectory *trajectory);

// The largest |energy + energy taken by drag and spring damping − energy at the start|, / scale. The damping is
// summed over frames by the trapezoidal rule; its own error, told from sums over every second frame, is taken off. A
// scene that loses energy in other ways (impacts, friction, bars that pull taut) is only charged for what it gains.
double ck_energy_drift(const ck_Model *model, const ck_Trajectory *trajectory);

#ifdef __cplusplus
}
#endif

#endif
