#include "leapfrog.h"

#include "constraint_kernel.h"
#include "projection.h"
#include "vector.h"

#include <string.h>

// s: from the middle of the last substep to that of this one.
static double between(const ck_Native *native) {
    return 0.5 * (native->last + native->dt);
}

static void speeds(const ck_Native *native, int particle, double *drift, double *now) {
    const double dt = between(native), half = 0.5 * native->model->drag * dt, *v = native->velocity + 3 * particle;
    double field[3];
    ck_model_field(native->model, particle, field);
    for (int axis = 0; axis < 3; axis++) drift[axis] = ((1 - half) * v[axis] + dt * field[axis]) / (1 + half);
    for (int axis = 0; axis < 3; axis++) now[axis] = 0.5 * (v[axis] + drift[axis]);
}

bool ck_leapfrog_substep(ck_Native *native, bool (*solve)(ck_Native *native)) {
    const ck_Model *model = native->model;
    const double dt = native->dt, apart = between(native), keep = 1 - 0.5 * model->drag * apart,
                 slow = 1 / (1 + 0.5 * model->drag * apart), rate = 1 / dt;
    ck_native_start_substep(native);
    ck_native_meet(native, speeds);
    memcpy(native->other_velocity, native->velocity, 3 * sizeof(double) * (size_t)model->particle_count);
    for (int i = 0; i < model->particle_count; i++) {
        if (native->inverse_mass[i] == 0) continue;
        double field[3];
        const double *v = native->velocity + 3 * i;
        ck_model_field(model, i, field);
        if (native->beside && i < ck_model_cloth_count(model)) {
            double next[3], change[3];
            for (int axis = 0; axis < 3; axis++) {
                next[axis] = slow * (keep * v[axis] + apart * field[axis]);
                change[axis] = (next[axis] - v[axis]) / apart;
            }
            ck_native_aim(native, i, next, change);
        } else {
            for (int axis = 0; axis < 3; axis++)
                native->position[3 * i + axis] += dt * slow * (keep * v[axis] + apart * field[axis]);
        }
    }
    if (native->beside) ck_native_fly(native);
    ck_native_drive(native);
    bool solved = solve(native);
    for (int i = 0; i < 3 * model->particle_count; i++)
        native->velocity[i] = rate * (native->position[i] - native->origin[i]);
    ck_native_drive_speed(native);
    native->last = dt;
    return solved;
}

// Half a step back, v₋½ = v₀ − a·dt/2: else the whole path would be off by a·t·dt/2.
static void start_leapfrog(ck_Native *native, int particle) {
    double field[3], *velocity = native->velocity + 3 * particle, *before = native->other_velocity + 3 * particle;
    ck_model_field(native->model, particle, field);
    ck_add_scaled(field, -native->model->drag, velocity);
    if (native->contact && particle < ck_model_cloth_count(native->model))
        ck_contact_filter(native->contact, native->position + 3 * particle, velocity, field, field);
    memcpy(before, velocity, 3 * sizeof(double));
    ck_add_scaled(velocity, -0.5 * native->dt, field);
    ck_add_scaled(before, -1.5 * native->dt, field);
}

void ck_leapfrog_release(void *state, int particle) {
    ck_native_release(state, particle);
    start_leapfrog(state, particle);
}

ck_Status ck_leapfrog_create(ck_Native **native, const ck_Model *model, const ck_Settings *used, ck_Error *error) {
    ck_Status status = ck_native_create(native, model, used, error);
    for (int i = 0; i < model->particle_count && !status; i++)
        if ((*native)->inverse_mass[i] > 0) start_leapfrog(*native, i);
    return status;
}

ck_Status ck_leapfrog_lay_out(ck_Native *native, ck_Projection projection, ck_Error *error) {
    const double half = 0.5 * native->model->drag * native->dt;
    ck_ProjectionRule rule = {.projection = projection,
                              .dt = native->dt,
                              .iterations = native->iterations,
                              .carry = (1 - half) / (1 + half),
                              .keep = 1,
                              .compliance = native->used.softness,
                              .relaxation = native->used.relaxation};
    ck_model_field(native->model, 0, rule.push);
    for (int axis = 0; axis < 3; axis++) rule.push[axis] *= native->dt / (1 + half);
    return ck_native_lay_out(native, &rule, error);
}

// v(t) = v₋½ + a·dt/2, with the last substep's whole acceleration (v₋½ − v₋₁½)/dt
void ck_leapfrog_read(const void *state, double *position, double *velocity) {
    const ck_Native *native = state;
    memcpy(position, native->position, 3 * sizeof(double) * (size_t)native->model->particle_count);
    for (int i = 0; i < 3 * native->model->particle_count; i++)
        velocity[i] = native->velocity[i] + 0.5 * (native->velocity[i] - native->other_velocity[i]);
}

void ck_leapfrog_ledger(ck_Ledger *ledger, const ck_Model *model, const ck_Settings *used) {
    ck_own_ledger(ledger, model, used, "v*(1 - drag*dt/2)/(1 + drag*dt/2)", CK_EXACT);
    bool rigid = model->terms & CK_TERM_RIGID;
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++) {
        const ck_Spring *spring = ck_model_spring_of_kind(model, kind);
        if (spring)
            ck_ledger_add(ledger,
                          (ck_LedgerRow){ck_stiffness_names[kind], spring->stiffness, "N/m", "bar length", spring->rest,
                                         rigid ? "bar of fixed length" : "a bar does not stretch: k is not modelled",
                                         rigid ? CK_EXACT : CK_IMPOSSIBLE});
    }
    if (model->terms & CK_TERM_DAMPING)
        ck_ledger_add(ledger, (ck_LedgerRow){"spring damping", model->springs[0].damping, "N*s/m", "none", 0,
                                             "a bar does not stretch: c is not modelled", CK_IMPOSSIBLE});
}
