#include "projection.h"

ck_Status ck_native_project_rows(ck_Native *native, const ck_ProjectionRule *rule, ck_Error *error) {
    ck_RowSprings springs;
    ck_projection_destroy(native->cloth);
    native->cloth = NULL;
    if (!ck_projection_fits(native->model, &springs)) return CK_OK;
    return ck_projection_create(&native->cloth, ck_native_loops(native), native->model, &springs, rule,
                                native->position, native->velocity, native->other_velocity, native->inverse_mass,
                                error);
}

ck_Status ck_native_hand_out(void **state, ck_Native *native, ck_Status status) {
    if (status)
        ck_native_destroy(native);
    else
        *state = native;
    return status;
}

ck_StepResult ck_native_step_frame(ck_Native *native, void (*substep)(ck_Native *native)) {
    if (native->cloth) {
        ck_projection_step(native->cloth, native->substeps, native->waves);
        ck_projection_read(native->cloth, native->position, native->velocity, native->other_velocity);
    } else {
        ck_native_start_frame(native);
        for (uint32_t i = 0; i < native->substeps; i++) substep(native);
    }
    return ck_native_is_finite(native) ? CK_STEP_OK : CK_STEP_DIVERGED;
}
