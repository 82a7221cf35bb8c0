// Where a position-based method comes to rest on any network, by the theory of its sweeps.
#ifndef CK_PREDICTION_REST_H
#define CK_PREDICTION_REST_H

#include "engine.h"
#include "model.h"

// The rest position that one Gauss–Seidel sweep a substep leads to, from the true one.
//   truth     [3*n] in, m: the equilibrium
//   position  [3*n] out, m
// False where theory does not reach: other methods, more than one sweep, or a rest that Newton does not find.
bool ck_prediction_rest(const ck_Model *model, ck_Method method, const ck_Settings *used, const double *truth,
                        double *position);

#endif
