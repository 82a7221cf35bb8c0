// Rigid bars as constraints of the reference: J·a = −J̇·v, so that lengths and their rates stay what they are.
#ifndef CK_BARS_H
#define CK_BARS_H

#include "model.h"
#include "status.h"

// |d|² = L² for each rigid bar, with the matrix J·M⁻¹·Jᵀ sparse and factorised anew at each call. Bars between two pins
// are none.
typedef struct ck_Bars ck_Bars;

// pinned, [n], is read at each call: the caller's, who lets pins go. NULL in bars where the model has no rigid bar.
// Errors: CK_NO_MEMORY.
ck_Status ck_bars_create(ck_Bars **bars, const ck_Model *model, const bool *pinned, ck_Error *error);
// Accepts NULL.
void ck_bars_destroy(ck_Bars *bars);

// Adds what bars pull with to accelerations, m/s², which hold those of everything else and, of pins that move, their
// own. Arrays [3*n]. False where the bars hold one another, so that their forces are not unique.
bool ck_bars_accelerate(ck_Bars *bars, const double *position, const double *velocity, double *acceleration);

// Moves particles, each by its mass, until every bar has its length, to rounding, and takes the speeds along bars.
// False as above, or where it does not get there.
bool ck_bars_project(ck_Bars *bars, double *position, double *velocity);

#endif
