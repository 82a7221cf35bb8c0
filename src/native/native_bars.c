// Störmer–Verlet with rigid bars, relaxed Gauss–Seidel and mass-weighted.
#include "constraint_kernel.h"
#include "engine.h"
#include "leapfrog.h"
#include "projection.h"
#include "time_scale.h"
#include "vector.h"

#include <math.h>
#include <string.h>

// One Gauss–Seidel sweep over the bars: moves both ends along the bar's direction at the start of the substep until it
// has its length again, to first order. The old direction conserves energy; the new one would dissipate it.
// d·d_start is taken to be L²: rows of vectors are spared a division by it. A long bar is projected along itself, which
// keeps it finite at any step; so is one that turned by more than 66° in one substep, which rows ask only once a bar
// was long. Cost: one pass over bars. Source: Ryckaert, Ciccotti, Berendsen 1977 (SHAKE).
static void sweep(ck_Native *native, bool is_turned) {
    const ck_Model *model = native->model;
    for (int k = 0; k < model->spring_count; k++) {
        const ck_Spring *bar = &model->springs[is_turned ? model->spring_count - 1 - k : k];
        double weight_a = native->inverse_mass[bar->a], weight_b = native->inverse_mass[bar->b];
        if (weight_a + weight_b == 0) continue;
        double *a = native->position + 3 * bar->a, *b = native->position + 3 * bar->b;
        double now[3], old[3];
        ck_subtract(now, b, a);
        ck_subtract(old, native->start + 3 * bar->b, native->start + 3 * bar->a);
        double square = bar->rest * bar->rest, squared = ck_dot(now, now);
        const bool is_long = squared > CK_LONG_BAR * square;
        if (is_long || ck_dot(now, old) < CK_TURNED_BAR * square) memcpy(old, now, sizeof old);
        double scale =
            0.5 * native->used.relaxation * (squared - square) / (is_long ? squared : square) / (weight_a + weight_b);
        ck_add_scaled(a, weight_a * scale, old);
        ck_add_scaled(b, -weight_b * scale, old);
    }
}

static bool relax(ck_Native *native) {
    ck_native_sweep(native, CK_PROJECT_BARS, sweep, NULL);
    return true;
}

static void substep(ck_Native *native) {
    ck_leapfrog_substep(native, relax);
}

static void translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger) {
    *used = (ck_Settings){.substeps = wanted->substeps,
                          .iterations = wanted->iterations ? wanted->iterations : ck_stability_sweeps(model),
                          .relaxation = wanted->relaxation > 0 ? wanted->relaxation : 1,
                          .threads = wanted->threads};
    ck_settings_take_own(used, wanted);
    if (!used->substeps)
        used->substeps = ck_stability_substeps(
            model, fmin(ck_stability_drag_time(model, 0.25), ck_stability_bar_time(model, used->iterations)));
    ck_leapfrog_ledger(ledger, model, used);
}

static ck_Status create(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                        ck_Ledger *ledger, ck_Error *error) {
    translate(model, wanted, used, ledger);
    ck_Native *native;
    ck_RowSprings springs;
    ck_Status status = ck_native_check_precision(used, ck_projection_fits(model, &springs), error);
    if (!status) status = ck_leapfrog_create(&native, model, used, error);
    if (status) return status;
    return ck_native_hand_out(state, native, ck_leapfrog_lay_out(native, CK_PROJECT_BARS, error));
}

static void release(void *state, int particle) {
    ck_leapfrog_release(state, particle);
    // without memory for rows the list of springs goes on
    ck_leapfrog_lay_out(state, CK_PROJECT_BARS, NULL);
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
     .rule = "what the sweeps can follow",
     .help = "steps a frame"},
    {.name = "iterations",
     .slot = CK_ITERATIONS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "1; 4 where bars outnumber freedoms",
     .help = "sweeps over all constraints a substep"},
    {.name = "relaxation",
     .slot = CK_RELAXATION,
     .least = 0.01,
     .most = 2,
     .unit = "1",
     .rule = "1",
     .help = "over-relaxation of a sweep; 1 to 1.5 helps"},
    {.name = "threads",
     .slot = CK_THREADS,
     .is_whole = true,
     .least = 1,
     .most = 64,
     .unit = "1",
     .rule = "1",
     .help = "threads that share a step where a substep has several sweeps: two on regular cloths, more on meshes"},
    CK_NATIVE_VECTORS_ROW,
    CK_NATIVE_SINGLE_ROW,
    {0},
};

const ck_Engine ck_native_bars = {
    .name = "native-bars",
    .about = "rigid bars, Stoermer-Verlet with Gauss-Seidel relaxation",
    .family = "native",
    .version = ck_own_version,
    .method = CK_METHOD_STOERMER_BARS,
    .terms = CK_NATIVE_TERMS | CK_TERM_RIGID | CK_TERM_BODIES,
    .settings = settings,
    .order = 0,
    .create = create,
    .step = step,
    .pace = ck_native_pace,
    .read = ck_leapfrog_read,
    .release = release,
    .contact = ck_native_contact,
    .turn = ck_native_turn,
    .destroy = ck_native_destroy,
};
