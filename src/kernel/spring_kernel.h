// Damped springs on a regular cloth: forces and integration of a whole velocity Verlet substep in one pass over rows.
#ifndef CK_SPRING_KERNEL_H
#define CK_SPRING_KERNEL_H

#include "loops.h"
#include "rows.h"
#include "status.h"
#include "waves.h"

typedef struct ck_ExplicitCloth ck_ExplicitCloth;

// Position, velocity and acceleration, [3*n], are taken over as they stand; inverse_mass [n] is 0 where pinned.
// Memory: 13 doubles a particle. Errors: CK_NO_MEMORY. Free with ck_explicit_destroy.
ck_Status ck_explicit_create(ck_ExplicitCloth **cloth, const ck_Loops *loops, const ck_Model *model,
                             const ck_RowSprings *springs, double dt, const double *position, const double *velocity,
                             const double *acceleration, const double *inverse_mass, ck_Error *error);
void ck_explicit_destroy(ck_ExplicitCloth *cloth);

// As many substeps of dt: x ← x + v·dt + a·dt²/2;  v* = v + a·dt;  a' = a(x, v*);  v ← v + (a + a')·dt/2.
//   waves  the threads that share the work; NULL: this one alone
// Cost: one pass over rows a substep, without allocation. The same bits however many threads there are; on which
// processors, loops.h says.
void ck_explicit_step(ck_ExplicitCloth *cloth, uint32_t substeps, ck_Waves *waves);

// A substep in two halves, for who moves some particles otherwise in between: x and v*, and half of v; then a' and the
// other half. Together they are ck_explicit_step with one substep.
void ck_explicit_drift(ck_ExplicitCloth *cloth);
void ck_explicit_kick(ck_ExplicitCloth *cloth);

// Before a drift: the free particles that may come to touch a surface within the substep, [n] at most, by how far each
// can get. Returns how many. Cost: a third of a pass, and some ns for each of them.
int ck_explicit_find_near(const ck_ExplicitCloth *cloth, const ck_NearSurface *surfaces, int count, int *particles);

// One particle's state, [3] each; and what is made of it: its velocity, and before a kick place and predicted velocity,
// which may be NULL.
void ck_explicit_take(const ck_ExplicitCloth *cloth, int particle, double *position, double *velocity,
                      double *acceleration);
void ck_explicit_put(const ck_ExplicitCloth *cloth, int particle, const double *velocity, const double *position,
                     const double *predicted);

// [3*n] m, m/s, at the same time.
void ck_explicit_read(const ck_ExplicitCloth *cloth, double *position, double *velocity);

#endif
