// What the native engines share: the state of the particles, and the ledger's common rows.
#ifndef CK_NATIVE_H
#define CK_NATIVE_H

#include "engine.h"

typedef struct ck_Native {
    const ck_Model *model;
    double dt; // s, one substep
    uint32_t substeps, iterations;
    double *position, *velocity; // [3*n]
    double *start;               // [3*n] positions at the start of the substep
    double *other_velocity;      // [3*n] predicted (Verlet), or of one substep earlier (bars)
    double *acceleration;        // [3*n]
    double *inverse_mass;        // [n]
    double *multiplier;          // [springs] of the constraints, kg·m (force·dt²)
} ck_Native;

// Terms that every native engine models.
#define CK_NATIVE_TERMS                                                                                                \
    (CK_TERM_SPRINGS | CK_TERM_DAMPING | CK_TERM_GRAVITY | CK_TERM_FORCE | CK_TERM_DRAG | CK_TERM_VELOCITY)

const char *ck_native_version(void);

// Allocates and sets the start state. Errors: CK_NO_MEMORY.
ck_Status ck_native_create(ck_Native **native, const ck_Model *model, const ck_Settings *used, ck_Error *error);
void ck_native_destroy(void *state);

// Copies position and velocity out, for engines whose velocity stands at the time of their positions.
void ck_native_read(const void *state, double *position, double *velocity);

// Adds the rows that the native engines meet exactly: mass, gravity, force, time step; and drag.
void ck_native_ledger(ck_Ledger *ledger, const ck_Model *model, const ck_Settings *used, const char *drag_formula,
                      ck_Match drag_match);

// Adds a row for each kind of spring there is, whose stiffness the engine takes as it is or not at all.
void ck_native_ledger_springs(ck_Ledger *ledger, const ck_Model *model, const char *parameter, const char *formula,
                              ck_Match match);

// False where any coordinate has left the finite numbers.
bool ck_native_is_finite(const ck_Native *native);

#endif
