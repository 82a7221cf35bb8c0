#include "constraint_kernel.h"

#include "constraint_kind.h"

bool ck_projection_fits(const ck_Model *model, ck_RowSprings *springs) {
    return !model->collider_count && ck_rows_fit(model, springs) && springs->rest[CK_BEND] == 0;
}

ck_Status ck_projection_create(ck_ProjectedCloth **cloth, const ck_ProjectionSetup *setup, ck_Error *error) {
    const ck_ProjectionKind *kind = setup->loops->is_single ? &ck_projection_rows_single : &ck_projection_rows;
    return kind->create(cloth, setup, error);
}

// The first member of either's structure.
static const ck_ProjectionKind *kind_of(const ck_ProjectedCloth *cloth) {
    return *(const ck_ProjectionKind *const *)cloth;
}

void ck_projection_destroy(ck_ProjectedCloth *cloth) {
    if (cloth) kind_of(cloth)->destroy(cloth);
}

void ck_projection_step(ck_ProjectedCloth *cloth, uint32_t substeps, ck_Waves *waves) {
    kind_of(cloth)->step(cloth, substeps, waves);
}

void ck_projection_read(const ck_ProjectedCloth *cloth, double *position, double *velocity, double *before) {
    kind_of(cloth)->read(cloth, position, velocity, before);
}
