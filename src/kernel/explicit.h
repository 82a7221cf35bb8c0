// Damped springs stepped by velocity Verlet, forces and integration of a whole substep in one pass: over the rows of a
// regular cloth, or over the list of springs of any other body.
#ifndef CK_EXPLICIT_H
#define CK_EXPLICIT_H

#include "loops.h"
#include "rows.h"
#include "status.h"
#include "waves.h"

typedef struct ck_Explicit ck_Explicit;

// Where a body is at the start of a substep.
//   position, velocity  [3*n] m, m/s
//   inverse_mass        [n] 1/kg, 0 where pinned
typedef struct ck_ExplicitSetup {
    const ck_Loops *loops;
    const ck_Model *model;
    double dt; // s, of every substep
    const double *position, *velocity, *inverse_mass;
} ck_ExplicitSetup;

// In rows where the model is a regular cloth, else as a list, whatever springs it has. What air, hinges, driven pins
// and rigid bodies do is left out: see ck_explicit_pull. Memory: rows 13 doubles a particle; lists 28, and 1 to 9 a
// spring. Errors: CK_NO_MEMORY; CK_REFUSED for a list beyond CK_MOST_LISTED. Free with ck_explicit_destroy.
ck_Status ck_explicit_create(ck_Explicit **body, const ck_ExplicitSetup *setup, ck_Error *error);
ck_Status ck_explicit_create_list(ck_Explicit **body, const ck_ExplicitSetup *setup, ck_Error *error);
// Goes on from another state, or with other pins, of the same model.
void ck_explicit_place(ck_Explicit *body, const ck_ExplicitSetup *setup);
// Other steps from here on, of the same body where it is: only dt is read, and what goes with it.
void ck_explicit_pace(ck_Explicit *body, const ck_ExplicitSetup *setup);
// Accepts NULL.
void ck_explicit_destroy(ck_Explicit *body);

// As many substeps of dt: x ← x + v·dt + a·dt²/2;  v* = v + a·dt;  a' = a(x, v*);  v ← v + (a + a')·dt/2.
//   waves  the threads that share the work; NULL: this one alone
// Cost: one pass a substep, without allocation. The same bits however many threads there are; on which processors,
// loops.h says.
void ck_explicit_step(ck_Explicit *body, uint32_t substeps, ck_Waves *waves);

// A substep in two halves, for who moves some particles otherwise in between: x and v*, and half of v; then a' and the
// other half. Together they are ck_explicit_step with one substep.
//
// Free particles that may come to touch a surface within the substep, by how far each can get, are loose, [n] at most:
// their state at its start is there. They stay so until they leave; what is new stands behind them, and is alone. After
// a kick their accelerations are there. Cost: half a pass; and some ns for each that is new.
void ck_explicit_drift(ck_Explicit *body, const ck_NearSurface *surfaces, int count, ck_Loose *loose);
void ck_explicit_kick(ck_Explicit *body, ck_Loose *loose);
// A kick and the drift of the next substep, so that the second finds in the cache what the first has left there. What
// has been loose has not had the other half of v; what is new has.
void ck_explicit_turn(ck_Explicit *body, const ck_NearSurface *surfaces, int count, ck_Loose *loose);

// What is made of them: before a kick place and predicted velocity, after the last one their velocity.
void ck_explicit_put(const ck_Explicit *body, const ck_Loose *loose, bool is_kicked);

// After they are put before a kick: those that no surface was in reach of, alone below 0, are loose no longer.
void ck_explicit_leave(ck_Explicit *body, ck_Loose *loose);

// The accelerations at the end of the last call, as the layout has them, with 0 for what is not free; [count] m/s².
const double *ck_explicit_acceleration(const ck_Explicit *body, size_t *count);

// [3*n] m, m/s, at the same time.
void ck_explicit_read(const ck_Explicit *body, double *position, double *velocity);

// Of a list alone, for who steps a body otherwise: the acceleration by springs, field and drag where the particles are
// somewhere else; 0 where pinned. All are [3*n].
void ck_explicit_pull(ck_Explicit *list, const double *position, const double *velocity, double *acceleration);

#endif
