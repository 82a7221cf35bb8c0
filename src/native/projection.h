// Where a native position-based solver's cloth runs in rows: native then holds its state at the end of a frame.
#ifndef CK_PROJECTION_H
#define CK_PROJECTION_H

#include "constraint_kernel.h"
#include "native.h"

// Lays native's state out in rows where the kernel takes its model; anew where it was before. Errors: CK_NO_MEMORY;
// native then goes on with its list of springs.
ck_Status ck_native_project_rows(ck_Native *native, const ck_ProjectionRule *rule, ck_Error *error);

// What is left of an engine's create once native is laid out, or not for that status: hands it out or frees it.
ck_Status ck_native_hand_out(void **state, ck_Native *native, ck_Status status);

// A frame in rows, or where there are none by so many substeps over the list of springs.
ck_StepResult ck_native_step_frame(ck_Native *native, void (*substep)(ck_Native *native));

#endif
