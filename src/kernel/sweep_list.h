// Gauss–Seidel sweeps over any springs, in vectors: in packs that share no particle, and such that of two springs which
// share one the first in ck_sweep_order still comes first. So a sweep is that in this order, but for rounding, and so
// is its reverse.
#ifndef CK_SWEEP_LIST_H
#define CK_SWEEP_LIST_H

#include "loops.h"
#include "model.h"
#include "status.h"
#include "sweep_order.h"
#include "waves.h"

typedef struct ck_SweepList ck_SweepList;

// What sweeps correct by: rigid bars, or compliant springs (XPBD); see constraint_kernel.h.
//   inverse_mass       [n] 1/kg, 0 where pinned
//   compliance, gamma  [springs] α̃ = 1/(k·dt²), 1/kg, and γ̃ = c/(k·dt); of bars not read
typedef struct ck_SweepRule {
    ck_Projection projection;
    uint32_t iterations;
    double relaxation;
    const double *inverse_mass, *compliance, *gamma;
} ck_SweepRule;

// *list is NULL where packs would be less than a quarter full, as along a rope: it is swept one by one as fast. Never
// where the order has colours.
// Memory: 8 doubles a particle, 5 to 9 a spring. Errors: CK_NO_MEMORY. Free with ck_sweep_list_destroy, which accepts
// NULL.
ck_Status ck_sweep_list_create(ck_SweepList **list, const ck_Loops *loops, const ck_Model *model,
                               const ck_SweepRule *rule, ck_Error *error);
void ck_sweep_list_destroy(ck_SweepList *list);

// Takes other values of the same model's springs and particles.
void ck_sweep_list_set(ck_SweepList *list, const ck_Model *model, const ck_SweepRule *rule);

// A substep: where particles are, and were at its start, [3*n] m; no multipliers yet. Then any number of sweeps, which
// threads share where there are several, with the same bits: each goes on where the one before is far enough. That
// takes springs in an order in which those that share a particle stand near, as a mesh or a network has them; a
// cloth's, kind by kind, are far apart.
void ck_sweep_list_begin(ck_SweepList *list, const double *position, const double *start);
void ck_sweep_list_sweep(const ck_SweepList *list, uint32_t count, bool are_turned, ck_Waves *waves);

// Where they are now, [3*n] m, out; and where something else has put them, in.
void ck_sweep_list_read(const ck_SweepList *list, double *position);
void ck_sweep_list_take(ck_SweepList *list, const double *position);

#endif
