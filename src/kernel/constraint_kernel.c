#include "constraint_kernel.h"

#include "constraint_loop.h"
#include "row_contact.h"

#include <string.h>

bool ck_projection_fits(const ck_Model *model, ck_RowSprings *springs) {
    return !(model->terms & CK_TERM_MOVING_COLLIDERS) && ck_rows_fit(model, springs) && springs->rest[CK_BEND] == 0;
}

// The first member of each kind's structure.
static const ck_ProjectionKind *kind_of(const ck_ProjectedCloth *cloth) {
    return *(const ck_ProjectionKind *const *)cloth;
}

static bool is_double(const ck_ProjectedCloth *cloth) {
    return kind_of(cloth) == &ck_projection_rows;
}

void ck_projection_destroy(ck_ProjectedCloth *cloth) {
    if (!cloth) return;
    if (is_double(cloth)) ck_row_contact_destroy(cloth->contact);
    kind_of(cloth)->destroy(cloth);
}

// Only in double precision. What moves starts as without contact.
static ck_Status touch(ck_ProjectedCloth *cloth, const ck_ProjectionSetup *setup, ck_Error *error) {
    ck_Status status = ck_row_contact_of_rows(&cloth->contact, setup->beside, &cloth->rows, error);
    if (status) return status;
    cloth->contact->x = cloth->x;
    memcpy(cloth->contact->from, cloth->start, 3 * sizeof *cloth->start * cloth->rows.size);
    cloth->from = cloth->contact->from;
    return CK_OK;
}

ck_Status ck_projection_create(ck_ProjectedCloth **cloth, const ck_ProjectionSetup *setup, ck_Error *error) {
    const ck_ProjectionKind *kind = setup->rule->projection == CK_PROJECT_LINES ? &ck_projection_lines
                                    : setup->loops->is_single                   ? &ck_projection_rows_single
                                                                                : &ck_projection_rows;
    ck_Status status = kind->create(cloth, setup, error);
    if (status || !setup->beside || !is_double(*cloth)) return status;
    status = touch(*cloth, setup, error);
    if (!status) return CK_OK;
    ck_projection_destroy(*cloth);
    *cloth = NULL;
    return status;
}

void ck_projection_step(ck_ProjectedCloth *cloth, uint32_t substeps, ck_Waves *waves) {
    if (is_double(cloth) && cloth->contact) ck_row_contact_forget_impulse(cloth->contact);
    kind_of(cloth)->step(cloth, substeps, waves);
}

void ck_projection_read(const ck_ProjectedCloth *cloth, double *position, double *velocity, double *before) {
    kind_of(cloth)->read(cloth, position, velocity, before);
}

void ck_projection_impulse(const ck_ProjectedCloth *cloth, double *impulse) {
    memset(impulse, 0, 3 * sizeof *impulse);
    if (is_double(cloth) && cloth->contact) ck_row_contact_impulse(cloth->contact, impulse);
}
