#include "native_projection.h"

ck_Status ck_native_project_rows(ck_Native *native, const ck_ProjectionRule *rule, ck_Error *error) {
    ck_RowSprings springs;
    ck_projection_destroy(native->cloth);
    native->cloth = NULL;
    if (!ck_projection_fits(native->model, &springs)) return CK_OK;
    return ck_projection_create(&native->cloth, native->model, &springs, rule, native->position, native->velocity,
                                native->other_velocity, native->inverse_mass, error);
}

bool ck_native_step_rows(ck_Native *native) {
    if (!native->cloth) return false;
    ck_projection_step(native->cloth, native->substeps, native->waves);
    ck_projection_read(native->cloth, native->position, native->velocity, native->other_velocity);
    return true;
}
