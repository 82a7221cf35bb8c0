// Where a native position-based solver runs in vectors: a regular cloth in rows, whose state native then holds at the
// end of a frame; any other body's sweeps over its list of springs.
#ifndef CK_PROJECTION_H
#define CK_PROJECTION_H

#include "constraint_kernel.h"
#include "native.h"

// Lays native's state out in rows where the kernel takes its model, else its springs in packs; anew where it was
// before. Errors: CK_NO_MEMORY; native then goes on with its list of springs one by one.
ck_Status ck_native_lay_out(ck_Native *native, const ck_ProjectionRule *rule, ck_Error *error);

// Of what is touched, what the particles that are free may: a part of that, for who has no sweeps. Nothing without
// colliders. Errors: CK_NO_MEMORY.
ck_Status ck_native_lay_beside(ck_Native *native, ck_Error *error);

// The packs take other compliances.
void ck_native_soften(ck_Native *native, ck_Projection projection);

// What is left of an engine's create once native is laid out, or not for that status: hands it out or frees it.
ck_Status ck_native_hand_out(void **state, ck_Native *native, ck_Status status);

// A frame in rows, or where there are none by so many substeps over the list of springs.
ck_StepResult ck_native_step_frame(ck_Native *native, void (*substep)(ck_Native *native));

// A substep's sweeps over the list of springs, each followed by what else holds particles: in packs, or where there are
// none by sweep, one by one.
//   between  NULL, or what comes after each sweep over springs
void ck_native_sweep(ck_Native *native, ck_Projection projection, void (*sweep)(ck_Native *native, bool is_turned),
                     void (*between)(ck_Native *native));

#endif
