// Closed forms of motion: small vibrations as sums of modes, the pendulum at any amplitude, falling with drag.
// All but the *_off have the signature of ck_TruthForm.at.
#ifndef CK_MOTION_FORMS_H
#define CK_MOTION_FORMS_H

#include "model.h"

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

// A rigid bar from a pin, let go at rest at any angle.
ck_Status ck_truth_pendulum(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error);
// Turns the bar by so much towards its rest.
void ck_truth_nudge_pendulum(ck_Model *model, double share);

// A mass on one spring or bar that circles below its pin: cos θ = g/(ω²·l), l = L/(1 − m·ω²/k). Exact.
ck_Status ck_truth_conical_pendulum(const ck_Model *model, double time, double *position, double *velocity,
                                    ck_Error *error);

// A mass between two springs without tension, plucked sideways: m·y'' = −k·y³/L², of period 7.4163·L·√(m/k)/A. Of
// amplitudes A that are small beside L.
ck_Status ck_truth_plucked_mass(const ck_Model *model, double time, double *position, double *velocity,
                                ck_Error *error);

// A flat sheet across the field, let go at rest in still air: masses by the area around each particle.
ck_Status ck_truth_air_fall(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error);

// Any body without pins and colliders whose springs start at rest, falling with drag.
ck_Status ck_truth_terminal_speed(const ck_Model *model, double time, double *position, double *velocity,
                                  ck_Error *error);

#endif
