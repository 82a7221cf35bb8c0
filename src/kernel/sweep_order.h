// The order in which a Gauss-Seidel sweep over a cloth's rows comes to its springs.
#ifndef CK_SWEEP_ORDER_H
#define CK_SWEEP_ORDER_H

#include "model.h"
#include "status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum ck_Projection {
    CK_PROJECT_BARS, // Δx along the direction at the start of the substep, to first order (SHAKE)
    CK_PROJECT_SPRINGS, // Δλ = (−C − α̃·λ − γ̃·∇C·(x − x_start))/((1 + γ̃)·W + α̃) along the direction now (XPBD)
    CK_PROJECT_LINES // the same Δλ of all springs of a line together
} ck_Projection;

// The springs of a model in the order in which a native sweep, of so many a substep, corrects them, [spring_count]:
// that of constraint_kernel.h where it takes the model, else the model's, but for those in colours. Lines, which only
// such models have, stand one behind the other, each from its first spring on. Errors: CK_NO_MEMORY.
ck_Status ck_sweep_order(const ck_Model *model, ck_Projection projection, uint32_t sweeps, int *order);

// True where that order goes by colours, of which none has two springs that share a particle, 256 springs at a time:
// compliant springs, many of them, and more than one and a half a particle. As good on a mesh, while along a rope
// nothing would come far, and a sheet of bars shook with it (`ball_on_trampoline`).
bool ck_sweep_has_colours(const ck_Model *model, ck_Projection projection);

// True where a substep's sweep goes through that order backwards: of several over bars, the second half. Sweeps and
// their transposes in turn act as the gradient of something; those in one order only push in circles, too, and a sheet
// whose bars are more than its freedoms takes energy out of that, and shakes for ever. Compliant springs lose what they
// shake by, and what is torn far needs six times as many sweeps both ways.
static inline bool ck_sweep_is_turned(ck_Projection projection, uint32_t sweep, uint32_t sweeps) {
    return projection == CK_PROJECT_BARS && sweep >= sweeps - sweeps / 2;
}

#ifdef __cplusplus
}
#endif

#endif
