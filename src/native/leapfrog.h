// What the native solvers of rigid bars and of lines share: Störmer–Verlet with a constraint solver in its middle.
//
// velocity holds the leapfrog velocity half a substep behind the positions, other_velocity the one a substep before
// that.
#ifndef CK_LEAPFROG_H
#define CK_LEAPFROG_H

#include "native.h"
#include "sweep_order.h"

// As ck_native_create, with velocities half a substep back. Errors: CK_NO_MEMORY.
ck_Status ck_leapfrog_create(ck_Native **native, const ck_Model *model, const ck_Settings *used, ck_Error *error);

// v ← (v·(1 − γ·dt/2) + a·dt)/(1 + γ·dt/2);  x' = x + v·dt;  solve;  v ← (x' − x)/dt
//   solve  makes bars of positions their length again; false where it does not get there
// Returns what solve does.
bool ck_leapfrog_substep(ck_Native *native, bool (*solve)(ck_Native *native));

// The kernel that takes whole steps so, where there is one for the model; see ck_native_lay_out.
ck_Status ck_leapfrog_lay_out(ck_Native *native, ck_Projection projection, ck_Error *error);

// Position and velocity at the same time, as ck_Engine.read.
void ck_leapfrog_read(const void *state, double *position, double *velocity);

// Lets a pinned particle go, with the speed it has.
void ck_leapfrog_release(void *state, int particle);

// Adds all rows: what bars do not model, stiffness and damping, is impossible unless the scene's bars are rigid.
void ck_leapfrog_ledger(ck_Ledger *ledger, const ck_Model *model, const ck_Settings *used);

#endif
