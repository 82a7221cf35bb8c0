// Closed forms of motion: small vibrations as sums of modes, falling with drag.
// All but the *_off have the signature of ck_TruthForm.at.
#ifndef CK_MOTION_FORMS_H
#define CK_MOTION_FORMS_H

#include "model.h"

// The start of a path: the model's positions, at rest. Arrays [3*n].
void ck_truth_start_from(const ck_Model *model, double *position, double *velocity);

// A rope pinned at its first particle, thrown along itself; no field. Drag and spring damping as they are. Exact.
ck_Status ck_truth_longitudinal_modes(const ck_Model *model, double time, double *position, double *velocity,
                                      ck_Error *error);

// The same with a single free particle.
ck_Status ck_truth_oscillator(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error);

// A prestretched rope pinned at both ends, thrown sideways; no field. Linear in the amplitude.
ck_Status ck_truth_taut_string(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error);
double ck_truth_taut_string_off(const ck_Model *model);

// A straight rope that is let go stretched, as a slinky held by its top: its centre falls freely, its bottom stays
// until the wave from the top arrives, after √(M/K), K of the whole. Exact until coils meet, which is an error. Source:
// Cross and Wheatland 2012, arXiv 1208.4629.
ck_Status ck_truth_slinky(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error);

// A stiff rope hanging from its first particle, thrown sideways. Linear in the amplitude, for bars that do not stretch.
ck_Status ck_truth_hanging_chain(const ck_Model *model, double time, double *position, double *velocity,
                                 ck_Error *error);
double ck_truth_hanging_chain_off(const ck_Model *model);

// A flat sheet across the field, let go at rest in still air: masses by the area around each particle.
ck_Status ck_truth_air_fall(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error);

// Any body without pins and colliders whose springs start at rest, falling with drag.
ck_Status ck_truth_terminal_speed(const ck_Model *model, double time, double *position, double *velocity,
                                  ck_Error *error);

#endif
