// A rope that slides over a ball.
#ifndef CK_CAPSTAN_PATH_H
#define CK_CAPSTAN_PATH_H

#include "truth.h"

// What the truth needs of a model. Errors: CK_BAD_INPUT.
ck_Status ck_truth_capstan_check(const ck_Model *model, ck_Error *error);

// A chain over the upper half of a ball, hanging down on both sides, that slides towards its last particle: its nodes,
// springs and friction along the one arc that it lies on, by small steps, and the same by steps of twice that. The
// horizon is where a nudge sideways has grown by 1e4: a rope under tension is not held on a smooth ball.
// Signature of ck_TruthForm.solve.
ck_Status ck_truth_solve_capstan(ck_Truth *truth, const ck_Model *model, ck_Error *error);

// As what hangs swings along with the last node that touches, it goes up to R·δ²/8 to and fro, δ a spring's angle, of
// which 0.3 in the mean square, and lags behind.
double ck_truth_capstan_off(const ck_Model *model);

#endif
