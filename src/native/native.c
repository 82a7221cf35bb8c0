#include "native.h"

#include "chain.h"
#include "constraint_kernel.h"
#include "explicit.h"
#include "loops.h"
#include "near_surfaces.h"
#include "path.h"
#include "row_contact.h"
#include "sweep_list.h"
#include "vector.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

ck_Status ck_native_create(ck_Native **out, const ck_Model *model, const ck_Settings *used, ck_Error *error) {
    size_t vectors = 3 * (size_t)model->particle_count;
    ck_Native *native = calloc(1, sizeof *native);
    if (!native) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    *native = (ck_Native){
        .model = model,
        .dt = model->step / used->substeps,
        .last = model->step / used->substeps,
        .used = *used,
        .substeps = used->substeps,
        .iterations = used->iterations,
        .position = malloc(vectors * sizeof(double)),
        .velocity = malloc(vectors * sizeof(double)),
        .start = calloc(vectors, sizeof(double)),
        .other_velocity = calloc(vectors, sizeof(double)),
        .acceleration = calloc(vectors, sizeof(double)),
        .inverse_mass = malloc((size_t)model->particle_count * sizeof(double)),
        .multiplier = calloc((size_t)model->spring_count + 1, sizeof(double)),
    };
    if (!native->position || !native->velocity || !native->start || !native->other_velocity || !native->acceleration ||
        !native->inverse_mass || !native->multiplier) {
        ck_native_destroy(native);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    ck_Status status = ck_contact_create(&native->contact, model, native->dt, error);
    if (!status) status = ck_rigid_contact_create(&native->rigid, model, native->dt, error);
    if (!status) status = ck_waves_create(&native->waves, (int)used->threads, error);
    native->origin = native->contact ? calloc(vectors, sizeof(double)) : native->start;
    if (!native->origin && !status) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (status) {
        ck_native_destroy(native);
        return status;
    }
    memcpy(native->position, model->position, vectors * sizeof(double));
    memcpy(native->velocity, model->velocity, vectors * sizeof(double));
    for (int i = 0; i < model->particle_count; i++) native->inverse_mass[i] = ck_model_inverse_mass(model, i);
    if (model->driven_count) ck_driven_place(model, 0, 1, native->position, native->velocity);
    *out = native;
    return CK_OK;
}

void ck_native_destroy(void *state) {
    ck_Native *native = state;
    if (!native) return;
    if (native->contact) free(native->origin);
    free(native->contact);
    ck_row_contact_destroy(native->beside);
    ck_rigid_contact_destroy(native->rigid);
    ck_waves_destroy(native->waves);
    ck_projection_destroy(native->cloth);
    ck_sweep_list_destroy(native->sweeps);
    ck_explicit_destroy(native->springs);
    ck_chain_destroy(native->chain);
    free(native->compliance);
    free(native->gamma);
    free(native->bending);
    free(native->position);
    free(native->velocity);
    free(native->start);
    free(native->other_velocity);
    free(native->acceleration);
    free(native->inverse_mass);
    free(native->multiplier);
    free(native);
}

const ck_Loops *ck_native_doubles(const ck_Native *native) {
    return ck_loops_for((uint32_t)ck_settings_own(&native->used, CK_NATIVE_VECTORS, 0));
}

const ck_Loops *ck_native_loops(const ck_Native *native) {
    const ck_Loops *loops = ck_native_doubles(native);
    return ck_settings_own(&native->used, CK_NATIVE_SINGLE, 0) > 0 ? ck_loops_single(loops) : loops;
}

ck_Status ck_native_check_precision(const ck_Settings *used, bool is_in_rows, ck_Error *error) {
    if (!(ck_settings_own(used, CK_NATIVE_SINGLE, 0) > 0) || is_in_rows) return CK_OK;
    return ck_fail(error, CK_REFUSED,
                   "single precision is for regular cloths: native-verlet's may bend by springs and touch what moves");
}

void ck_native_read(const void *state, double *position, double *velocity) {
    const ck_Native *native = state;
    memcpy(position, native->position, 3 * sizeof(double) * (size_t)native->model->particle_count);
    memcpy(velocity, native->velocity, 3 * sizeof(double) * (size_t)native->model->particle_count);
}

double ck_native_time(const ck_Native *native) {
    return native->begun + (double)native->done * native->dt;
}

void ck_native_pace(void *state, double duration) {
    ck_Native *native = state;
    ck_native_set_step(native, duration / native->substeps);
}

void ck_native_set_step(ck_Native *native, double dt) {
    native->begun = ck_native_time(native);
    native->done = 0;
    native->dt = dt;
    if (native->contact) native->contact->dt = native->dt;
    if (native->rigid) ck_rigid_contact_pace(native->rigid, native->dt);
}

void ck_native_start_frame(ck_Native *native) {
    if (native->contact) memset(native->contact->impulse, 0, sizeof native->contact->impulse);
    if (native->beside) ck_row_contact_forget_impulse(native->beside);
}

void ck_native_start_substep(ck_Native *native) {
    size_t bytes = 3 * sizeof(double) * (size_t)native->model->particle_count;
    memcpy(native->start, native->position, bytes);
    if (native->contact && native->contact->motion) ck_contact_follow(native->contact, ck_native_time(native));
    if (!native->contact) return;
    memcpy(native->origin, native->start, bytes);
    if (!native->beside) return;
    native->beside->touched.dt = native->dt;
    if (!native->contact->motion) return;
    ck_near_surfaces(ck_row_contact_surfaces(native->beside, false), native->contact);
    ck_near_surfaces_at_end(ck_row_contact_surfaces(native->beside, true), native->contact);
}

void ck_native_drive(ck_Native *native) {
    native->done++;
    if (native->model->driven_count) ck_driven_place(native->model, ck_native_time(native), -1, native->position, NULL);
}

void ck_native_drive_speed(ck_Native *native) {
    if (!native->model->driven_count) return;
    const double time = ck_native_time(native);
    ck_driven_place(native->model, time, -1, native->position, native->velocity);
    ck_driven_place(native->model, time, -1, native->position, native->other_velocity);
}

void ck_native_release(void *state, int particle) {
    ck_Native *native = state;
    native->inverse_mass[particle] = 1 / native->model->mass[particle];
}

void ck_native_contact(const void *state, double *force) {
    const ck_Native *native = state;
    for (int axis = 0; axis < 3; axis++)
        force[axis] = native->contact ? native->contact->impulse[axis] / native->model->step : 0;
}

// Over the impacts on its way, if there are any.
static void meet(ck_Native *native, int particle, const double *next, const double *field) {
    double *x = native->position + 3 * particle, *origin = native->origin + 3 * particle, v[3];
    memcpy(v, next, sizeof v);
    if (!ck_contact_meet(native->contact, native->model->mass[particle], field, x, v)) {
        ck_add_scaled(x, native->dt, next);
        return;
    }
    memcpy(origin, x, 3 * sizeof(double));
    ck_add_scaled(origin, -native->dt, v);
    memcpy(native->other_velocity + 3 * particle, v, sizeof v);
    ck_add_scaled(native->other_velocity + 3 * particle, -native->dt, field);
}

void ck_native_aim(ck_Native *native, int particle, const double *next, const double *field) {
    const double dt = native->dt;
    for (int axis = 0; axis < 3; axis++) {
        const long at = ck_tile_of(particle) + axis * CK_STRIPE;
        native->beside->gain[at] = dt * dt * field[axis];
        native->beside->way[at] = dt * (next[axis] - 0.5 * dt * field[axis]);
    }
}

static void fly(ck_Native *native, int particle, bool may_meet) {
    const double dt = native->dt;
    double way[3], gain[3], next[3], field[3];
    for (int axis = 0; axis < 3; axis++) {
        const long at = ck_tile_of(particle) + axis * CK_STRIPE;
        gain[axis] = native->beside->gain[at];
        way[axis] = native->beside->way[at] + 0.5 * gain[axis];
    }
    if (!may_meet) {
        ck_add_scaled(native->position + 3 * particle, 1, way);
        return;
    }
    for (int axis = 0; axis < 3; axis++) {
        next[axis] = way[axis] / dt;
        field[axis] = gain[axis] / (dt * dt);
    }
    meet(native, particle, next, field);
}

void ck_native_fly(ck_Native *native) {
    ck_RowContact *beside = native->beside;
    const int particles = ck_model_cloth_count(native->model);
    ck_row_contact_take(beside->x, native->position, particles);
    for (int row = 0; row < beside->rows.rows; row++) {
        const unsigned bits = beside->loops->row_meets(beside, row);
        ck_row_contact_begin(beside, row);
        for (int lane = 0; lane < CK_STRIPE && CK_STRIPE * row + lane < particles; lane++)
            if (native->inverse_mass[CK_STRIPE * row + lane] > 0) fly(native, CK_STRIPE * row + lane, bits >> lane & 1);
    }
    ck_row_contact_take(beside->from, native->origin, particles);
}

void ck_native_project(ck_Native *native) {
    ck_RowContact *beside = native->beside;
    if (native->rigid) ck_rigid_contact_project(native->rigid, native);
    if (!beside) return;
    const int particles = ck_model_cloth_count(native->model);
    ck_row_contact_take(beside->x, native->position, particles);
    for (int row = 0; row < beside->rows.rows; row++)
        if (beside->loops->row_press(beside, row)) ck_row_contact_give(beside, row, native->position, particles);
}

void ck_native_meet(ck_Native *native,
                    void (*speeds)(const ck_Native *native, int particle, double *drift, double *now)) {
    ck_RigidContact *rigid = native->rigid;
    if (!rigid) return;
    for (int i = 0; i < native->model->particle_count; i++) {
        memcpy(rigid->drift + 3 * i, native->velocity + 3 * i, 3 * sizeof(double));
        memcpy(rigid->now + 3 * i, native->velocity + 3 * i, 3 * sizeof(double));
        if (native->inverse_mass[i] > 0) speeds(native, i, rigid->drift + 3 * i, rigid->now + 3 * i);
    }
    ck_rigid_contact_meet(rigid, native, ck_native_time(native));
}

void ck_native_turn(const void *state, ck_Turn *turn) {
    ck_rigid_contact_turns(((const ck_Native *)state)->rigid, turn);
}

bool ck_native_is_finite(const ck_Native *native) {
    const uint64_t exponent = 0x7ff0000000000000, one = 0x0010000000000000;
    uint64_t over = 0;
    // of what is no finite number the exponent is all ones: one more reaches the sign
    for (int i = 0; i < 3 * native->model->particle_count; i++) {
        uint64_t bits;
        memcpy(&bits, &native->position[i], sizeof bits);
        over |= (bits & exponent) + one;
    }
    return !(over >> 63);
}
