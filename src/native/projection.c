#include "projection.h"

#include "follower.h"
#include "near_surfaces.h"
#include "row_contact.h"
#include "sweep_list.h"

#include <stdlib.h>

static ck_SweepRule rule_of(const ck_Native *native, ck_Projection projection) {
    return (ck_SweepRule){projection,           native->iterations, native->used.relaxation,
                          native->inverse_mass, native->compliance, native->gamma};
}

static ck_Status create_beside(ck_Native *native, ck_Error *error) {
    const int count = native->model->collider_count;
    ck_NearSurface *surfaces = malloc(sizeof *surfaces * (size_t)count + 1);
    if (!surfaces) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_near_surfaces(surfaces, native->contact);
    const ck_Touched touched = {surfaces, count, native->dt, native->contact->slack};
    const ck_Follower follower = ck_native_follower(native);
    const ck_Status status = ck_row_contact_create(&native->beside, ck_native_doubles(native), &touched, &follower,
                                                   ck_model_cloth_count(native->model), error);
    free(surfaces);
    return status;
}

// Contact beside the list of springs, whose surfaces and masses serve rows, too.
ck_Status ck_native_lay_beside(ck_Native *native, ck_Error *error) {
    const ck_Model *model = native->model;
    if (!native->contact) return CK_OK;
    const ck_Status status = native->beside ? CK_OK : create_beside(native, error);
    for (int i = 0; i < ck_model_cloth_count(model) && !status; i++)
        native->beside->mass[i] = native->inverse_mass[i] > 0 ? model->mass[i] : 0;
    return status;
}

static ck_Status lay_in_rows(ck_Native *native, const ck_ProjectionRule *rule, const ck_RowSprings *springs,
                             ck_Error *error) {
    ck_ProjectedCloth *last = native->cloth;
    const ck_ProjectionSetup setup = {.loops = ck_native_loops(native),
                                      .model = native->model,
                                      .springs = springs,
                                      .rule = rule,
                                      .position = native->position,
                                      .velocity = native->velocity,
                                      .before = native->other_velocity,
                                      .inverse_mass = native->inverse_mass,
                                      .beside = native->beside,
                                      .last = last};
    native->cloth = NULL;
    const ck_Status status = ck_projection_create(&native->cloth, &setup, error);
    ck_projection_destroy(last);
    return status;
}

ck_Status ck_native_lay_out(ck_Native *native, const ck_ProjectionRule *rule, ck_Error *error) {
    ck_RowSprings springs;
    const ck_SweepRule sweeps = rule_of(native, rule->projection);
    ck_Status status = ck_native_lay_beside(native, error);
    if (!status && ck_projection_fits(native->model, &springs)) return lay_in_rows(native, rule, &springs, error);
    ck_projection_destroy(native->cloth);
    native->cloth = NULL;
    if (status) return status;
    if (!native->sweeps)
        return ck_sweep_list_create(&native->sweeps, ck_native_loops(native), native->model, &sweeps, error);
    ck_sweep_list_set(native->sweeps, native->model, &sweeps);
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
    for (uint32_t i = 0, count; i < native->iterations; i += count) {
        const bool is_turned = ck_sweep_is_turned(projection, i, native->iterations);
        for (count = 1; sweeps && is_alone && i + count < native->iterations; count++)
            if (ck_sweep_is_turned(projection, i + count, native->iterations) != is_turned) break;
        const bool is_last = i + count == native->iterations;
        if (sweeps)
            ck_sweep_list_sweep(sweeps, count, is_turned, native->waves);
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
        if (native->contact) ck_projection_impulse(native->cloth, native->contact->impulse);
    } else {
        ck_native_start_frame(native);
        for (uint32_t i = 0; i < native->substeps; i++) substep(native);
        if (native->beside) ck_row_contact_impulse(native->beside, native->contact->impulse);
    }
    return ck_native_is_finite(native) ? CK_STEP_OK : CK_STEP_DIVERGED;
}
