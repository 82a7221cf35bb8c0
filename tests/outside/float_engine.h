// The solver as an engine: what a user would write to have it loaded, or compiled in.
#ifndef FLOAT_ENGINE_H
#define FLOAT_ENGINE_H

#include "engine.h"
#include "float_xpbd.h"

static const char *float_version(void) {
    return "2.1 float";
}

static ck_Status float_create(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                              ck_Ledger *ledger, ck_Error *error) {
    *used = (ck_Settings){.substeps = wanted->substeps ? wanted->substeps : FLOAT_XPBD_SUBSTEPS};
    *state = float_xpbd_new(model, (int)used->substeps);
    if (!*state) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (model->spring_count)
        ck_ledger_add(ledger, (ck_LedgerRow){"structural stiffness", model->springs[0].stiffness, "N/m", "compliance",
                                             1 / model->springs[0].stiffness, "1/k", CK_APPROXIMATE});
    return CK_OK;
}

static ck_StepResult float_step(void *state) {
    float_xpbd_step(state);
    return CK_STEP_OK;
}

static void float_read(const void *state, double *position, double *velocity) {
    float_xpbd_read(state, position, velocity);
}

static void float_release(void *state, int particle) {
    float_xpbd_let_go(state, particle);
}

static const char *float_remark(const void *state) {
    (void)state;
    return "in single precision";
}

static void float_destroy(void *state) {
    float_xpbd_free(state);
}

static const ck_Setting float_settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "40",
     .help = "steps a frame"},
    {0},
};

static const ck_Engine float_engine = {
    .name = "float-xpbd",
    .about = "XPBD in single precision",
    .family = "outside",
    .version = float_version,
    .terms = FLOAT_XPBD_TERMS,
    .is_single = true,
    .settings = float_settings,
    .create = float_create,
    .step = float_step,
    .read = float_read,
    .release = float_release,
    .remark = float_remark,
    .destroy = float_destroy,
};

#endif
