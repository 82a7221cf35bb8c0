// A model in units of its own size and mass, for engines that have lengths and masses of their own: tolerances,
// margins, grids. So they see every body as one of a metre or two and particles of a kilogram or two, whatever units
// its author thinks in.
#ifndef CK_SCALED_MODEL_H
#define CK_SCALED_MODEL_H

#include "ledger.h"
#include "model.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ck_ScaledModel {
    ck_Model model;      // its body, springs and colliders are its own; what is not changed is the other's
    double length, mass; // of a unit, in m and kg: powers of two, so that nothing is rounded
} ck_ScaledModel;

// Errors: CK_NO_MEMORY. Free with ck_scaled_model_free in any case; the other model must outlive it.
ck_Status ck_scaled_model_create(ck_ScaledModel *scaled, const ck_Model *model);

// Adds what the units are to a ledger.
void ck_scaled_model_ledger(ck_Ledger *ledger, const ck_Model *model);

// Accepts a zeroed one.
void ck_scaled_model_free(ck_ScaledModel *scaled);

#ifdef __cplusplus
}
#endif

#endif
