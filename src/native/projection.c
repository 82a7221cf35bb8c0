#include "projection.h"

#include "sweep_list.h"

static ck_SweepRule rule_of(const ck_Native *native, ck_Projection projection) {
    return (ck_SweepRule){projection,           native->iterations, native->used.relaxation,
                          native->inverse_mass, native->compliance, native->gamma};
}

ck_Status ck_native_lay_out(ck_Native *native, const ck_ProjectionRule *rule, ck_Error *error) {
    ck_RowSprings springs;
    const ck_SweepRule sweeps = rule_of(native, rule->projection);
    ck_projection_destroy(native->cloth);
    native->cloth = NULL;
    if (ck_projection_fits(native->model, &springs)) {
        const ck_ProjectionSetup setup = {
            ck_native_loops(native), native->model,       &springs, rule, native->position, native->velocity,
            native->other_velocity,  native->inverse_mass};
        return ck_projection_create(&native->cloth, &setup, error);
    }
    if (native->sweeps)
        ck_sweep_list_set(native->sweeps, native->model, &sweeps);
    else
        return ck_sweep_list_create(&native->sweeps, ck_native_loops(native), native->model, &sweeps, error);
    return CK_OK;
}

void ck_native_soften(ck_Native *native, ck_Projection projection) {
    const ck_SweepRule sweeps = rule_of(native, projection);
    if (native->sweeps) ck_sweep_list_set(native->sweeps, native->model, &sweeps);
}

void ck_native_sweep(ck_Native *native, ck_Projection projection, void (*sweep)(ck_Native *native, bool is_turned),
                     void (*between)(ck_Native *native)) {
    ck_SweepList *sweeps = native->sweeps;
    const bool is_alone = !between && !native->contact && !native->rigid;
    if (sweeps) ck_sweep_list_begin(sweeps, native->position, native->start);
    for (uint32_t i = 0; i < native->iterations; i++) {
        const bool is_turned = ck_sweep_is_turned(projection, i, native->iterations),
                   is_last = i + 1 == native->iterations;
        if (sweeps)
            ck_sweep_list_sweep(sweeps, is_turned);
        else
            sweep(native, is_turned);
        if (sweeps && (is_last || !is_alone)) ck_sweep_list_read(sweeps, native->position);
        if (between) between(native);
        ck_native_project(native);
        if (sweeps && !is_last && !is_alone) ck_sweep_list_take(sweeps, native->position);
    }
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
