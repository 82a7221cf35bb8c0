// Extended position-based dynamics: compliant constraints, one iteration per small substep.
#include "compliance.h"
#include "hinges.h"
#include "projection.h"
#include "time_scale.h"
#include "vector.h"
#include "wind.h"

#include <stdlib.h>
#include <string.h>

// One Gauss–Seidel sweep: Δλ = (−C − α̃·λ − γ̃·∇C·(x − x_start))/((1 + γ̃)·W + α̃), α̃ = 1/(k·dt²), γ̃ = c/(k·dt).
// A rigid bar has α̃ = γ̃ = 0. Cost: one pass over springs.
// Source: Macklin, Müller, Chentanez 2016, eq. 18 and 26.
static void sweep(ck_Native *native, bool is_turned) {
    const ck_Model *model = native->model;
    for (int k = 0; k < model->spring_count; k++) {
        const int i = is_turned ? model->spring_count - 1 - k : k;
        const ck_Spring *spring = &model->springs[i];
        double weight_a = native->inverse_mass[spring->a], weight_b = native->inverse_mass[spring->b];
        if (weight_a + weight_b == 0) continue;
        double *a = native->position + 3 * spring->a, *b = native->position + 3 * spring->b;
        double d[3], moved[3];
        ck_subtract(d, b, a);
        double length = ck_length(d);
        if (!(length > 0)) continue;
        if (spring->pulls_only && length < spring->rest && !(native->multiplier[i] < 0)) continue;
        double compliance = native->compliance[i], damping = native->gamma[i];
        for (int axis = 0; axis < 3; axis++)
            moved[axis] = d[axis] - (native->start[3 * spring->b + axis] - native->start[3 * spring->a + axis]);
        double residual =
            length - spring->rest + compliance * native->multiplier[i] + damping * ck_dot(moved, d) / length;
        double change = -native->used.relaxation * residual / ((1 + damping) * (weight_a + weight_b) + compliance);
        // a pull may be taken back, but no more
        if (spring->pulls_only) change = fmin(change, -native->multiplier[i]);
        native->multiplier[i] += change;
        ck_add_scaled(a, -weight_a * change / length, d);
        ck_add_scaled(b, weight_b * change / length, d);
    }
}

// The same over hinges: of a flat one the whole vector is the constraint, softened by the pull that it has; else its
// angle is. Cost: one pass over hinges.
static void sweep_hinges(ck_Native *native) {
    const ck_Model *model = native->model;
    const double squared = native->dt * native->dt;
    for (int i = 0; i < model->hinge_count; i++) {
        const ck_Hinge *hinge = &model->hinges[i];
        const ck_HingeState state = ck_hinge_state(hinge, native->position);
        double weight = 0, *multiplier = native->bending + 3 * i, residual[3];
        for (int k = 0; k < 4; k++)
            if (hinge->particles[k] >= 0)
                weight += hinge->weights[k] * hinge->weights[k] * native->inverse_mass[hinge->particles[k]];
        if (!(weight > 0)) continue;
        // one sweep goes the implicit step's share of the way to where the hinge pulls
        const double stiffness = fmax(hinge->stiffness, fabs(state.pull)), compliance = 1 / (stiffness * squared);
        for (int axis = 0; axis < 3; axis++) {
            residual[axis] = state.pull / stiffness * state.vector[axis] + compliance * multiplier[axis];
            const double change = -native->used.relaxation * residual[axis] / (weight + compliance);
            multiplier[axis] += change;
            for (int k = 0; k < 4; k++) {
                const int particle = hinge->particles[k];
                if (particle >= 0)
                    native->position[3 * particle + axis] +=
                        native->inverse_mass[particle] * hinge->weights[k] * change;
            }
        }
    }
}

static void speeds(const ck_Native *native, int particle, double *drift, double *now) {
    double field[3];
    (void)now; // is the velocity
    ck_model_field(native->model, particle, field);
    ck_add_scaled(drift, native->dt, field);
}

// x ← x + v·dt + a·dt²;  sweeps;  v ← (x − x_start)/dt/(1 + γ·dt)
// Drag comes last: before the sweeps it would also ease gravity's push, and a body at rest would hang too high.
static void substep(ck_Native *native) {
    const ck_Model *model = native->model;
    const double dt = native->dt, rate = 1 / (1 + model->drag * dt) / dt;
    ck_native_start_substep(native);
    ck_native_meet(native, speeds);
    memset(native->multiplier, 0, sizeof(double) * (size_t)model->spring_count);
    if (native->bending) memset(native->bending, 0, 3 * sizeof(double) * (size_t)model->hinge_count);
    if (model->wind.face_count) {
        memset(native->acceleration, 0, 3 * sizeof(double) * (size_t)model->particle_count);
        ck_wind_add_force(model, native->position, native->velocity, native->inverse_mass, native->acceleration);
    }
    for (int i = 0; i < model->particle_count; i++) {
        if (native->inverse_mass[i] == 0) continue;
        double field[3];
        ck_model_field(model, i, field);
        // without air these stay 0
        ck_add_scaled(field, 1, native->acceleration + 3 * i);
        if (native->beside && i < ck_model_cloth_count(model)) {
            double next[3];
            memcpy(next, native->velocity + 3 * i, sizeof next);
            ck_add_scaled(next, dt, field);
            ck_native_aim(native, i, next, field);
        } else {
            ck_add_scaled(native->position + 3 * i, dt, native->velocity + 3 * i);
            ck_add_scaled(native->position + 3 * i, dt * dt, field);
        }
    }
    if (native->beside) ck_native_fly(native);
    ck_native_drive(native);
    ck_native_sweep(native, CK_PROJECT_SPRINGS, sweep, native->bending ? sweep_hinges : NULL);
    for (int i = 0; i < 3 * model->particle_count; i++)
        native->velocity[i] = rate * (native->position[i] - native->origin[i]);
    ck_native_drive_speed(native);
}

// Σ w²/m of a hinge, 1/(kg·m²).
static double hinge_weight(const ck_Model *model, int index) {
    const ck_Hinge *hinge = &model->hinges[index];
    double sum = 0;
    for (int k = 0; k < 4; k++)
        if (hinge->particles[k] >= 0)
            sum += hinge->weights[k] * hinge->weights[k] * ck_model_inverse_mass(model, hinge->particles[k]);
    return sum;
}

// Time step: with 1/k_eff = 1/k + w·(dt² + c·dt/k)/iterations, where damping softens too, a spring is at most 0.5 % too
// soft: k·dt² + c·dt ≤ 0.005·iterations/w. Drag is first order: at most 2 % of a speed a substep.
static double time_step_limit(const ck_Model *model, uint32_t iterations) {
    double bending = INFINITY;
    for (int i = 0; i < model->hinge_count; i++)
        bending = fmin(bending, sqrt(0.005 * iterations / (model->hinges[i].stiffness * hinge_weight(model, i))));
    if (model->terms & CK_TERM_RIGID)
        return fmin(bending, fmin(ck_stability_drag_time(model, 0.02), ck_stability_bar_time(model, iterations)));
    double limit = fmin(bending, ck_stability_drag_time(model, 0.02)),
           allowed = 0.005 * iterations / ck_stability_lightness(model);
    for (int i = 0; i < model->spring_count; i++) {
        double k = model->springs[i].stiffness, c = model->springs[i].damping;
        limit = fmin(limit, 2 * allowed / (c + sqrt(c * c + 4 * k * allowed)));
    }
    return limit;
}

static void translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger) {
    *used = (ck_Settings){.substeps = wanted->substeps,
                          .iterations = wanted->iterations             ? wanted->iterations
                                        : model->terms & CK_TERM_RIGID ? ck_stability_sweeps(model)
                                                                       : 1,
                          .relaxation = wanted->relaxation > 0 ? wanted->relaxation : 1,
                          .softness = wanted->softness,
                          .threads = wanted->threads};
    ck_settings_take_own(used, wanted);
    if (!used->substeps) used->substeps = ck_stability_substeps(model, time_step_limit(model, used->iterations));
    ck_own_ledger(ledger, model, used, "v/(1 + drag*dt) after the sweeps", CK_APPROXIMATE);
    ck_compliance_ledger(ledger, model, used, "1/(k*dt^2); 1/k_eff = 1/k + w*(dt^2 + c*dt/k)/iterations");
    ck_ledger_add_wind(ledger, model, "acceleration", "by face, before the sweeps", CK_APPROXIMATE);
    ck_ledger_add_bending(ledger, model, "compliance", "1/(s*dt^2) of each hinge's vector", CK_APPROXIMATE);
    ck_compliance_ledger_damping(ledger, model, used);
}

// α̃ and γ̃ of every spring, by the substep.
static void soften(ck_Native *native) {
    for (int i = 0; i < native->model->spring_count; i++) {
        const ck_Spring *spring = &native->model->springs[i];
        const double compliance = ck_compliance_of(spring, &native->used);
        native->compliance[i] = compliance / (native->dt * native->dt);
        native->gamma[i] = spring->damping * compliance / native->dt;
    }
}

static void pace(void *state, double duration) {
    ck_native_pace(state, duration);
    soften(state);
    ck_native_soften(state, CK_PROJECT_SPRINGS);
}

static ck_Status lay_in_rows(ck_Native *native, ck_Error *error) {
    const double dt = native->dt;
    ck_ProjectionRule rule = {CK_PROJECT_SPRINGS,
                              dt,
                              native->iterations,
                              1,
                              {0},
                              1 / (1 + native->model->drag * dt),
                              native->used.softness,
                              native->used.relaxation};
    ck_model_field(native->model, 0, rule.push);
    for (int axis = 0; axis < 3; axis++) rule.push[axis] *= dt;
    return ck_native_lay_out(native, &rule, error);
}

static ck_Status create(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                        ck_Ledger *ledger, ck_Error *error) {
    ck_RowSprings row_springs;
    translate(model, wanted, used, ledger);
    ck_Native *native;
    ck_Status status = ck_native_check_precision(used, ck_projection_fits(model, &row_springs), error);
    if (!status) status = ck_native_create(&native, model, used, error);
    if (status) return status;
    size_t springs = (size_t)model->spring_count;
    native->compliance = malloc(sizeof(double) * springs + 1);
    native->gamma = malloc(sizeof(double) * springs + 1);
    if (model->hinge_count) native->bending = malloc(3 * sizeof(double) * (size_t)model->hinge_count);
    if (!native->compliance || !native->gamma || (model->hinge_count && !native->bending)) {
        ck_native_destroy(native);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    soften(native);
    return ck_native_hand_out(state, native, lay_in_rows(native, error));
}

static void release(void *state, int particle) {
    ck_native_release(state, particle);
    // without memory for rows the list of springs goes on
    lay_in_rows(state, NULL);
}

static ck_StepResult step(void *state) {
    return ck_native_step_frame(state, substep);
}

static const ck_Setting settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "what one sweep is good to 1 % for",
     .help = "steps a frame"},
    {.name = "iterations",
     .slot = CK_ITERATIONS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "1; of rigid bars 4 where they outnumber freedoms",
     .help = "sweeps over all constraints a substep"},
    {.name = "relaxation",
     .slot = CK_RELAXATION,
     .least = 0.01,
     .most = 2,
     .unit = "1",
     .rule = "1",
     .help = "over-relaxation of a sweep; 1 to 1.5 helps"},
    {.name = "compliance",
     .slot = CK_SOFTNESS,
     .least = 1e-30,
     .most = 1e6,
     .unit = "m/N",
     .rule = "1/k of each spring",
     .help = "compliance of every spring"},
    {.name = "threads",
     .slot = CK_THREADS,
     .is_whole = true,
     .least = 1,
     .most = 64,
     .unit = "1",
     .rule = "1",
     .help = "threads that share a step, on regular cloths, and on meshes where a substep has several sweeps"},
    CK_NATIVE_VECTORS_ROW,
    CK_NATIVE_SINGLE_ROW,
    {0},
};

const ck_Engine ck_native_xpbd = {
    .name = "native-xpbd",
    .about = "compliant position constraints, one iteration per small substep",
    .family = "native",
    .version = ck_own_version,
    .method = CK_METHOD_XPBD,
    .terms = CK_NATIVE_TERMS | CK_TERM_RIGID | CK_TERM_BENDING | CK_TERM_WIND | CK_TERM_PULL_ONLY | CK_TERM_BODIES,
    .settings = settings,
    .order = 1,
    .rest_order = 2,
    .damped_rest_order = 1, // γ̃ sees gravity's push, too
    .create = create,
    .step = step,
    .pace = pace,
    .read = ck_native_read,
    .release = release,
    .contact = ck_native_contact,
    .turn = ck_native_turn,
    .destroy = ck_native_destroy,
};
