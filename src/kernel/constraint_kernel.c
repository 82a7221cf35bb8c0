#include "constraint_kernel.h"

#include "constraint_kind.h"
#include "row_contact.h"

#include <stdlib.h>
#include <string.h>

bool ck_projection_fits(const ck_Model *model, ck_RowSprings *springs) {
    return !(model->terms & CK_TERM_MOVING_COLLIDERS) && ck_rows_fit(model, springs) && springs->rest[CK_BEND] == 0;
}

static const ck_ProjectionHead *head_of(const ck_ProjectedCloth *cloth) {
    return (const ck_ProjectionHead *)cloth;
}

void ck_projection_destroy(ck_ProjectedCloth *cloth) {
    if (!cloth) return;
    ck_row_contact_destroy(head_of(cloth)->contact);
    free(head_of(cloth)->seen);
    head_of(cloth)->kind->destroy(cloth);
}

ck_Status ck_projection_create(ck_ProjectedCloth **cloth, const ck_ProjectionSetup *setup, ck_Error *error) {
    static const ck_ProjectionKind *const kinds[2][2] = {{&ck_projection_rows, &ck_projection_rows_single},
                                                         {&ck_projection_lines, &ck_projection_lines_single}};
    const ck_ProjectionKind *kind = kinds[setup->rule->projection == CK_PROJECT_LINES][setup->loops->is_single];
    ck_Status status = kind->create(cloth, setup, error);
    if (status || !setup->beside) return status;
    status = kind->touch(*cloth, setup, error);
    if (!status) return CK_OK;
    ck_projection_destroy(*cloth);
    *cloth = NULL;
    return status;
}

static bool meet(void *state, int place, const double *field, double *x, double *v, double *impulse) {
    const ck_ProjectionHead *head = head_of(state);
    return head->follower.meet(head->follower.state, head->kind->particle_at(state, place), field, x, v, impulse);
}

static void press(void *state, int place, const double *from, double *depth, double *held, double *x, double *impulse) {
    const ck_ProjectionHead *head = head_of(state);
    head->follower.press(head->follower.state, head->kind->particle_at(state, place), from, depth, held, x, impulse);
}

ck_Follower ck_projection_follower(ck_ProjectedCloth *cloth, const ck_Follower *follower) {
    ((ck_ProjectionHead *)cloth)->follower = *follower;
    return (ck_Follower){cloth, meet, press};
}

void ck_projection_step(ck_ProjectedCloth *cloth, uint32_t substeps, ck_Waves *waves) {
    if (head_of(cloth)->contact) ck_row_contact_forget_impulse(head_of(cloth)->contact);
    head_of(cloth)->kind->step(cloth, substeps, waves);
}

void ck_projection_read(const ck_ProjectedCloth *cloth, double *position, double *velocity, double *before) {
    head_of(cloth)->kind->read(cloth, position, velocity, before);
}

void ck_projection_impulse(const ck_ProjectedCloth *cloth, double *impulse) {
    memset(impulse, 0, 3 * sizeof *impulse);
    if (head_of(cloth)->contact) ck_row_contact_impulse(head_of(cloth)->contact, impulse);
}
