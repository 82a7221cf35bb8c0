// Steps that adapt: as long as a tolerance and the body's stability where it is now allow.
#ifndef CK_VERLET_PACE_H
#define CK_VERLET_PACE_H

#include "native.h"

typedef struct ck_VerletPace ck_VerletPace;

// NULL where no tolerance is set. Errors: CK_NO_MEMORY. Free with ck_verlet_pace_destroy, which accepts NULL.
ck_Status ck_verlet_pace_create(ck_VerletPace **pace, const ck_Native *native, ck_Error *error);
void ck_verlet_pace_destroy(ck_VerletPace *pace);

// Where native is at the start of a frame: what it may take at most. Cost: every eighth frame a pass over springs.
// Errors: CK_NO_MEMORY.
ck_Status ck_verlet_pace_look(ck_VerletPace *pace, const ck_Native *native);

// The next substeps, all of dt, s, of what is left of a frame, s: 2 at least, where there is room for them.
uint32_t ck_verlet_pace_next(ck_VerletPace *pace, double left, double *dt);

// Told the accelerations, [count] m/s², before and after the last of them, decides how long the next may be. The local
// error of velocity Verlet is dt³/6 times the rate at which the acceleration changes: dt²/6 times its change.
void ck_verlet_pace_before(ck_VerletPace *pace, const double *acceleration, size_t count);
void ck_verlet_pace_after(ck_VerletPace *pace, double dt, const double *acceleration, size_t count);

// How many substeps it took, of how much.
const char *ck_verlet_pace_tell(ck_VerletPace *pace);

#endif
