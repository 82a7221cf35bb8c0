// Moves nothing: what the harness itself costs.
#include "engine.h"

#include <string.h>

static const char *version(void) {
    return CK_VERSION " double";
}

static ck_Status create(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                        ck_Ledger *ledger, ck_Error *error) {
    (void)wanted, (void)ledger, (void)error;
    *used = (ck_Settings){.substeps = 1};
    *state = (void *)model;
    return CK_OK;
}

static ck_StepResult step(void *state) {
    (void)state;
    return CK_STEP_OK;
}

static void read_state(const void *state, double *position, double *velocity) {
    const ck_Model *model = state;
    memcpy(position, model->position, 3 * sizeof(double) * (size_t)model->particle_count);
    memcpy(velocity, model->velocity, 3 * sizeof(double) * (size_t)model->particle_count);
}

static void turn(const void *state, ck_Turn *turn) {
    const ck_Model *model = state;
    for (int i = 0; i < model->rigid_count; i++) turn[i] = ck_rigid_start(&model->rigid[i]);
}

static void destroy(void *state) {
    (void)state;
}

const ck_Engine ck_still = {
    .name = "still",
    .about = "moves nothing: what the harness itself costs",
    .family = "native",
    .version = version,
    .method = CK_METHOD_STILL,
    .terms = ~0u,
    .create = create,
    .step = step,
    .read = read_state,
    .turn = turn,
    .destroy = destroy,
};
