// Störmer–Verlet with rigid bars, solved directly: a chain's constraints are a tridiagonal system, and any mass ratio
// is as good as another.
#include "engine.h"
#include "leapfrog.h"
#include "shape.h"
#include "time_scale.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

// Newton rounds a substep at most; some four are usual.
#define ROUNDS 20
// The largest |l² − L²|/2L² that is left: rounding.
#define TOLERANCE 1e-14

// d_i: bar i at the start of the substep, r_i: now. One Newton round on (r_i² − L_i²)/2 = 0 for the multipliers λ of
//   −w_i·(r_i·d_{i−1})·λ_{i−1} + (w_i + w_{i+1})·(r_i·d_i)·λ_i − w_{i+1}·(r_i·d_{i+1})·λ_{i+1} = −(r_i² − L_i²)/2
// by elimination; then x_{i+1} += w_{i+1}·λ_i·d_i, x_i −= w_i·λ_i·d_i. Returns the largest residual before it.
// Cost: three passes over bars. Source: Ryckaert, Ciccotti, Berendsen 1977, with the matrix kept whole.
static double newton_round(ck_Native *native) {
    const ck_Model *model = native->model;
    const double *weight = native->inverse_mass;
    double *lambda = native->multiplier, *upper = native->acceleration, largest = 0;
    double before[3] = {0}, old[3], ahead[3], now[3];
    for (int i = 0; i < model->spring_count; i++) {
        const double rest = model->springs[i].rest;
        ck_subtract(now, native->position + 3 * i + 3, native->position + 3 * i);
        ck_subtract(old, native->start + 3 * i + 3, native->start + 3 * i);
        memset(ahead, 0, sizeof ahead);
        if (i + 1 < model->spring_count) ck_subtract(ahead, native->start + 3 * i + 6, native->start + 3 * i + 3);
        double error = 0.5 * (ck_dot(now, now) - rest * rest);
        double lower = i ? -weight[i] * ck_dot(now, before) : 0;
        double pivot = (weight[i] + weight[i + 1]) * ck_dot(now, old) - (i ? lower * upper[i - 1] : 0);
        bool held = weight[i] + weight[i + 1] == 0;
        upper[i] = held ? 0 : -weight[i + 1] * ck_dot(now, ahead) / pivot;
        lambda[i] = held ? 0 : (-error - (i ? lower * lambda[i - 1] : 0)) / pivot;
        if (!held) largest = fmax(largest, fabs(error) / (rest * rest));
        memcpy(before, old, sizeof before);
    }
    for (int i = model->spring_count - 2; i >= 0; i--) lambda[i] -= upper[i] * lambda[i + 1];
    for (int i = 0; i < model->spring_count; i++) {
        ck_subtract(old, native->start + 3 * i + 3, native->start + 3 * i);
        ck_add_scaled(native->position + 3 * i + 3, weight[i + 1] * lambda[i], old);
        ck_add_scaled(native->position + 3 * i, -weight[i] * lambda[i], old);
    }
    return largest;
}

// The last round's residual is that before its correction, whose own error is its square.
static bool solve(ck_Native *native) {
    double residual = INFINITY;
    for (uint32_t i = 0; i < native->iterations && !(residual <= TOLERANCE); i++) {
        double now = newton_round(native);
        // rounding is reached where it no longer falls
        if (now >= 0.5 * residual && now < 1e-12) return true;
        residual = now;
    }
    return residual < 1e-6;
}

// Time step: at most 1/240 s, half of what waves across the rope allow, and a quarter of drag's time.
static void translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger) {
    double limit =
        fmin(fmin(1.0 / 240, 0.5 * ck_stability_transverse_time(model)), ck_stability_drag_time(model, 0.25));
    *used = (ck_Settings){.substeps = wanted->substeps ? wanted->substeps : ck_stability_substeps(model, limit),
                          .iterations = wanted->iterations ? wanted->iterations : ROUNDS};
    ck_leapfrog_ledger(ledger, model, used);
}

// Bars that reach straight from pin to pin leave nothing to solve: the system is singular.
static bool is_taut(const ck_Model *model) {
    double length = 0;
    int pin = -1;
    for (int i = 0; i < model->particle_count; i++) {
        if (i) length += model->springs[i - 1].rest;
        if (!model->pinned[i]) continue;
        bool spans = pin >= 0 && i > pin + 1;
        if (spans && length <= ck_distance(model->position + 3 * pin, model->position + 3 * i) * (1 + 1e-9))
            return true;
        pin = i;
        length = 0;
    }
    return false;
}

static ck_Status create(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                        ck_Ledger *ledger, ck_Error *error) {
    translate(model, wanted, used, ledger);
    if (!ck_shape_is_chain(model))
        return ck_fail(error, CK_REFUSED, "only a rope without bend springs, or a chain of bars, is tridiagonal");
    if (is_taut(model))
        return ck_fail(error, CK_REFUSED,
                       "bars that reach straight from pin to pin cannot move: no solution but to stay");
    return ck_leapfrog_create((ck_Native **)state, model, used, error);
}

static ck_StepResult step(void *state) {
    ck_Native *native = state;
    for (uint32_t i = 0; i < native->substeps; i++)
        if (!ck_leapfrog_substep(native, solve)) return CK_STEP_DIVERGED;
    return ck_native_is_finite(native) ? CK_STEP_OK : CK_STEP_DIVERGED;
}

static const ck_Setting settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "a share of the fastest bar under the whole load",
     .help = "steps a frame"},
    {.name = "iterations",
     .slot = CK_ITERATIONS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "as many as converge",
     .help = "Newton rounds a substep at most"},
    {0},
};

const ck_Engine ck_native_rope = {
    .name = "native-rope",
    .about = "rigid bars of a rope, Stoermer-Verlet with a direct tridiagonal solve",
    .family = "native",
    .version = ck_own_version,
    .method = CK_METHOD_STOERMER_DIRECT,
    .terms = (CK_NATIVE_TERMS | CK_TERM_RIGID) & ~(unsigned)(CK_TERM_COLLIDERS | CK_TERM_MOVING_COLLIDERS),
    .settings = settings,
    .order = 0,
    .create = create,
    .step = step,
    .pace = ck_native_pace,
    .read = ck_leapfrog_read,
    .release = ck_leapfrog_release,
    .destroy = ck_native_destroy,
};
