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
    CK_PROJECT_SPRINGS // Δλ = (−C − α̃·λ − γ̃·∇C·(x − x_start))/((1 + γ̃)·W + α̃) along the direction now (XPBD)
} ck_Projection;

// The springs of a model in the order in which a native sweep corrects them, [spring_count]: kernel_projection's where
// it takes the model, else the model's. Errors: CK_NO_MEMORY.
ck_Status ck_sweep_order(const ck_Model *model, ck_Projection projection, int *order);

#ifdef __cplusplus
}
#endif

#endif
