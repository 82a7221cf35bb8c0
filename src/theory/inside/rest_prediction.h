// Where a position-based method comes to rest, by the theory of its sweeps: the place that one substep leaves as it is.
#ifndef CK_REST_PREDICTION_H
#define CK_REST_PREDICTION_H

#include "engine.h"
#include "model.h"

// True of methods that come to rest where their sweeps leave them, and not where forces balance.
bool ck_prediction_sweeps(ck_Method method);

// A substep from rest moves each particle by dt²·a and sweeps over the springs so many times; that it ends where it
// began is solved for, from the true rest, with the stiffness of the softened network for Newton's slopes.
//   truth     [3*n] in, m: the equilibrium
//   position  [3*n] out, m
// False where theory does not reach: other methods, or a rest that is not found.
bool ck_prediction_rest(const ck_Model *model, const ck_Engine *engine, const ck_Settings *used, const double *truth,
                        double *position);

#endif
