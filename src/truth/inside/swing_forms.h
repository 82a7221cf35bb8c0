// Closed forms of one mass that swings: the pendulum at any amplitude, in a circle, and between two springs. All but
// the nudge have the signature of ck_TruthForm.at.
#ifndef CK_SWING_FORMS_H
#define CK_SWING_FORMS_H

#include "model.h"

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

#endif
