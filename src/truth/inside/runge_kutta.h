// Ground truths that are computed, not written down: independent of every engine.
#ifndef CK_RUNGE_KUTTA_H
#define CK_RUNGE_KUTTA_H

#include "model.h"
#include "status.h"
#include "trajectory.h"

// The path from the model's start by a Runge–Kutta method, substeps to a frame: of the eighth order; in contact, where
// forces have kinks, which no order survives, and where dampers keep steps short, of the fourth. Rigid bars are
// constraints on accelerations, and put right after each step; a step ends where a moved pin's speed jumps.
//   nudge  m, added to the start of every free coordinate with a sign of its own, by seed; 0: none
// Writes all frames; stops early, with fewer frames, where numbers leave the finite.
// Errors: CK_NO_MEMORY. Free trajectory in any case. See tableau.h.
ck_Status ck_reference_integrate(ck_Trajectory *trajectory, const ck_Model *model, int substeps, double nudge,
                                 uint64_t seed, ck_Error *error);

// The same by the fourth order, which the fewest forces keep stable: where a body comes to in the end.
ck_Status ck_reference_follow(ck_Trajectory *trajectory, const ck_Model *model, int substeps, ck_Error *error);

// The nudge, in sizes, whose growth says how long a path can be trusted.
#define CK_REFERENCE_NUDGE 1e-9

// How many springs and particles a first path of a model evaluates: some 5 ns each.
double ck_reference_work(const ck_Model *model);

// A path that halving its step no longer moves, and how far it can be trusted.
typedef struct ck_ReferencePath {
    ck_Trajectory fine, coarse; // at the step that was accepted, and at twice that
    int substeps;               // of fine
    int horizon;                // the last frame before a 1e-9 nudge of the start has grown by 1e4
    double agreement;           // largest distance of fine and coarse up to the horizon, / size
} ck_ReferencePath;

// Halves the step until two paths agree to 1e-9 of the size up to the horizon, to 1e-6 where forces have kinks, and to
// 1e-5 in contact.
// Errors: CK_NO_MEMORY; CK_REFUSED where the model has bars in contact, or bars that do not start at their lengths,
// where a particle comes between two colliders, or no affordable step agrees.
// Free with ck_reference_path_free in any case.
ck_Status ck_reference_path_create(ck_ReferencePath *path, const ck_Model *model, ck_Error *error);
void ck_reference_path_free(ck_ReferencePath *path);

#endif
