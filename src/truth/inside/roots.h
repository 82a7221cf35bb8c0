// The computed truths behind the truth table. Those that solve have the signature of ck_TruthForm.solve.
#ifndef CK_ROOTS_H
#define CK_ROOTS_H

#include "truth.h"

// What each needs of a model. Errors: CK_BAD_INPUT.
ck_Status ck_truth_equilibrium_check(const ck_Model *model, ck_Error *error);
ck_Status ck_truth_trajectory_check(const ck_Model *model, ck_Error *error);
ck_Status ck_truth_converged_check(const ck_Model *model, ck_Error *error);
ck_Status ck_truth_rest_check(const ck_Model *model, ck_Error *error);

// The equilibrium that the release leads to, and those of nudged starts.
ck_Status ck_truth_solve_equilibrium(ck_Truth *truth, const ck_Model *model, ck_Error *error);

// What is not known where the release's own motion is not followed; NULL: it is.
const char *ck_truth_equilibrium_leaves_open(const ck_Model *model);

// The reference path, and the one at twice its step.
ck_Status ck_truth_solve_trajectory(ck_Truth *truth, const ck_Model *model, ck_Error *error);

// How many springs and particles that evaluates at least.
double ck_truth_trajectory_work(const ck_Model *model);

#endif
