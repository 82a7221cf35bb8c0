// Störmer–Verlet with rigid bars, relaxed Gauss–Seidel and mass-weighted.
//
// velocity holds the leapfrog velocity half a substep behind the positions, other_velocity the one a substep before
// that.
#include "engine_list.h"
#include "native.h"
#include "stability.h"
#include "vector.h"

#include <string.h>

// One Gauss–Seidel sweep over the bars: moves both ends along the bar's direction at the start of the substep until it
// has its length again, to first order. The old direction conserves energy; the new one would dissipate it.
// Cost: one pass over bars. Source: Ryckaert, Ciccotti, Berendsen 1977 (SHAKE).
static void sweep(ck_Native *native) {
    const ck_Model *model = native->model;
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *bar = &model->springs[i];
        double weight_a = native->inverse_mass[bar->a], weight_b = native->inverse_mass[bar->b];
        if (weight_a + weight_b == 0) continue;
        double *a = native->position + 3 * bar->a, *b = native->position + 3 * bar->b;
        double now[3], old[3];
        ck_subtract(now, b, a);
        ck_subtract(old, native->start + 3 * bar->b, native->start + 3 * bar->a);
        double along = ck_dot(now, old), length_squared = ck_dot(now, now);
        // a bar that turned by more than 60° in one substep is projected along itself instead
        if (4 * along * along < length_squared * ck_dot(old, old) || along <= 0) {
            memcpy(old, now, sizeof old);
            along = length_squared;
        }
        if (!(along > 0)) continue;
        double scale = 0.5 * (length_squared - bar->rest * bar->rest) / (along * (weight_a + weight_b));
        ck_add_scaled(a, weight_a * scale, old);
        ck_add_scaled(b, -weight_b * scale, old);
    }
}

// v ← (v·(1 − γ·dt/2) + a·dt)/(1 + γ·dt/2);  x' = x + v·dt;  sweeps;  v ← (x' − x)/dt
static void substep(ck_Native *native) {
    const ck_Model *model = native->model;
    const double dt = native->dt, keep = 1 - 0.5 * model->drag * dt, slow = 1 / (1 + 0.5 * model->drag * dt);
    const size_t bytes = 3 * sizeof(double) * (size_t)model->particle_count;
    ck_native_start_substep(native);
    memcpy(native->other_velocity, native->velocity, bytes);
    for (int i = 0; i < model->particle_count; i++) {
        if (native->inverse_mass[i] == 0) continue;
        double field[3];
        ck_model_field(model, i, field);
        const double *v = native->velocity + 3 * i;
        if (native->contact) {
            double next[3], change[3];
            for (int axis = 0; axis < 3; axis++) {
                next[axis] = slow * (keep * v[axis] + dt * field[axis]);
                change[axis] = (next[axis] - v[axis]) / dt;
            }
            ck_native_move(native, i, next, change);
        } else {
            for (int axis = 0; axis < 3; axis++)
                native->position[3 * i + axis] += dt * slow * (keep * v[axis] + dt * field[axis]);
        }
    }
    for (uint32_t i = 0; i < native->iterations; i++) {
        sweep(native);
        ck_native_project(native);
    }
    for (int i = 0; i < 3 * model->particle_count; i++)
        native->velocity[i] = (native->position[i] - native->origin[i]) / dt;
}

static void translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger) {
    *used = (ck_Settings){.substeps = wanted->substeps,
                          .iterations = wanted->iterations ? wanted->iterations : ck_stability_sweeps(model)};
    if (!used->substeps)
        used->substeps = ck_stability_substeps(
            model, fmin(ck_stability_drag_time(model, 0.25), ck_stability_bar_time(model, used->iterations)));
    ck_native_ledger(ledger, model, used, "v*(1 - drag*dt/2)/(1 + drag*dt/2)", CK_EXACT);
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

// Half a step back, v₋½ = v₀ − a·dt/2: else the whole path would be off by a·t·dt/2.
static void start_leapfrog(ck_Native *native, int particle) {
    double field[3], *velocity = native->velocity + 3 * particle, *before = native->other_velocity + 3 * particle;
    ck_model_field(native->model, particle, field);
    ck_add_scaled(field, -native->model->drag, velocity);
    if (native->contact) ck_contact_filter(native->contact, native->position + 3 * particle, velocity, field, field);
    memcpy(before, velocity, 3 * sizeof(double));
    ck_add_scaled(velocity, -0.5 * native->dt, field);
    ck_add_scaled(before, -1.5 * native->dt, field);
}

static void release(void *state, int particle) {
    ck_native_release(state, particle);
    start_leapfrog(state, particle);
}

static ck_Status create(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                        ck_Ledger *ledger, ck_Error *error) {
    translate(model, wanted, used, ledger);
    ck_Status status = ck_native_create((ck_Native **)state, model, used, error);
    const ck_Native *native = *state;
    for (int i = 0; i < model->particle_count && !status; i++)
        if (native->inverse_mass[i] > 0) start_leapfrog(*state, i);
    return status;
}

static ck_StepResult step(void *state) {
    ck_Native *native = state;
    ck_native_start_frame(native);
    for (uint32_t i = 0; i < native->substeps; i++) substep(native);
    return ck_native_is_finite(native) ? CK_STEP_OK : CK_STEP_DIVERGED;
}

// v(t) = v₋½ + a·dt/2, with the last substep's whole acceleration (v₋½ − v₋₁½)/dt
static void read_state(const void *state, double *position, double *velocity) {
    const ck_Native *native = state;
    memcpy(position, native->position, 3 * sizeof(double) * (size_t)native->model->particle_count);
    for (int i = 0; i < 3 * native->model->particle_count; i++)
        velocity[i] = native->velocity[i] + 0.5 * (native->velocity[i] - native->other_velocity[i]);
}

const ck_Engine ck_native_bars = {
    .name = "native-bars",
    .about = "rigid bars, Stoermer-Verlet with Gauss-Seidel relaxation",
    .family = "native",
    .version = ck_native_version,
    .method = CK_METHOD_STOERMER_BARS,
    .terms = CK_NATIVE_TERMS | CK_TERM_RIGID,
    .order = 0,
    .create = create,
    .step = step,
    .read = read_state,
    .release = release,
    .contact = ck_native_contact,
    .destroy = ck_native_destroy,
};
