// Closed forms of bouncing and sliding. All have the signature of ck_TruthForm.at.
#ifndef CK_CONTACT_FORMS_H
#define CK_CONTACT_FORMS_H

#include "model.h"

// A level body that falls straight onto a plane and bounces until it rests: heights e^(2n)·h0, stop time
// t_1 + 2·v_1·e/(g·(1 − e)).
ck_Status ck_truth_bounce(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error);

// A body on a plane that slides along a straight line, stops, sticks or slips: s'' = g_t ∓ μ·g_n, stop distance
// v²/(2·(μ·g_n − g_t)), sticks for g_t ≤ μ·g_n.
ck_Status ck_truth_slide(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error);

// A particle on a frictionless ball: θ'' = (g/R)·sin θ until cos θ = ⅔·cos θ_0 + v_0²/(3·g·R), then it falls.
ck_Status ck_truth_sphere_slide(const ck_Model *model, double time, double *position, double *velocity,
                                ck_Error *error);

// Puts it so much farther down the ball, along its way.
void ck_truth_nudge_sphere_slide(ck_Model *model, double share);

// A particle that flies straight at a ball, or at a plane along its normal, without any field, and comes back at e
// times its speed.
ck_Status ck_truth_strike(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error);

#endif
