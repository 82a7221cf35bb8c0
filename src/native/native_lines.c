// Compliant springs of regular cloths, of which whole rows, diagonals and columns are solved at once, and of chains,
// which are one line: a line is a tridiagonal system. A pull at one end of it is felt at the other in one sweep, where
// Gauss-Seidel takes one for each spring between.
#include "chain.h"
#include "compliance.h"
#include "constraint_kernel.h"
#include "leapfrog.h"
#include "projection.h"
#include "time_scale.h"
#include "vector.h"

#include <math.h>

// N, of the springs from pin to pin along lines of so many particles, so far apart in their numbers; what noise pulls
// between others is gone at once.
static double pinned_tension(const ck_Model *model, int first, int apart, int count) {
    const ck_Spring *spring = ck_model_spring_of_kind(model, CK_STRUCTURAL);
    double tension = 0;
    int before = -1;
    for (int i = 0; i < count; i++) {
        const int particle = first + i * apart;
        if (!model->pinned[particle]) continue;
        if (before >= 0) {
            const double way =
                ck_distance(model->position + 3 * (first + before * apart), model->position + 3 * particle);
            tension = fmax(tension, spring->stiffness * (way / (i - before) - spring->rest));
        }
        before = i;
    }
    return tension;
}

// N, of a line: its share of the whole load, or what pins stretch it by.
static double tension_of(const ck_Model *model) {
    const int columns = model->columns, rows = model->particle_count / columns;
    double tension = ck_stability_swing_load(model) / (rows < columns ? rows : columns);
    for (int row = 0; row < rows; row++) tension = fmax(tension, pinned_tension(model, row * columns, 1, columns));
    for (int column = 0; column < columns; column++)
        tension = fmax(tension, pinned_tension(model, column, columns, rows));
    return tension;
}

// Time step: 0.16 of √(m·d/T), what waves across a line under a tension T allow, as it pulls along where its springs
// lie before they move; at most 1/240 s, half of that where there are colliders, whose pushes are of first order; and a
// quarter of drag's time. Half as long again keeps sheets of 20×20 and of 64×64 that are let go within 1 % of their
// path for half a second, whether their springs have 1e3 or 1e6 N/m (`clothcheck bench`), but `cloth_64` with its soft
// corners flips there. Of a chain, which does not, 0.2: a rope of 41 nodes over a pulley is then within 0.2 % of its
// path.
static double time_step_limit(const ck_Model *model, double share, double tension) {
    const double across = tension > 0 ? sqrt(model->spacing / (ck_stability_lightness(model) * tension)) : INFINITY;
    return fmin(fmin(model->collider_count ? 1.0 / 480 : 1.0 / 240, share * across),
                ck_stability_drag_time(model, 0.25));
}

static void translate(const ck_Model *model, double limit, const ck_Settings *wanted, ck_Settings *used,
                      ck_Ledger *ledger) {
    *used = (ck_Settings){.substeps = wanted->substeps,
                          .iterations = wanted->iterations ? wanted->iterations : 1,
                          .softness = wanted->softness};
    ck_settings_take_own(used, wanted);
    if (!used->substeps) used->substeps = ck_stability_substeps(model, limit);
    ck_own_ledger(ledger, model, used, "v*(1 - drag*dt/2)/(1 + drag*dt/2)", CK_EXACT);
    ck_compliance_ledger(ledger, model, used, "1/(k*dt^2)");
    ck_compliance_ledger_damping(ledger, model, used);
}

static ck_Status lay_out(ck_Native *native, ck_Error *error) {
    if (!native->chain) return ck_leapfrog_lay_out(native, CK_PROJECT_LINES, error);
    ck_chain_soften(native->chain, native);
    return ck_native_lay_beside(native, error);
}

static ck_Status create(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                        ck_Ledger *ledger, ck_Error *error) {
    ck_RowSprings springs;
    ck_Native *native;
    ck_Chain *chain = NULL;
    const bool is_cloth = ck_projection_fits(model, &springs);
    ck_Status status = ck_native_check_precision(wanted, is_cloth, error);
    if (!status && !is_cloth) status = ck_chain_create(&chain, model, error);
    if (status) return status;
    const double limit = is_cloth ? time_step_limit(model, 0.16, tension_of(model))
                                  : time_step_limit(model, 0.2, ck_chain_tension(chain, model));
    translate(model, limit, wanted, used, ledger);
    status = ck_leapfrog_create(&native, model, used, error);
    if (status) {
        ck_chain_destroy(chain);
        return status;
    }
    native->chain = chain;
    return ck_native_hand_out(state, native, lay_out(native, error));
}

// Without memory for lines the next step fails.
static void release(void *state, int particle) {
    ck_leapfrog_release(state, particle);
    lay_out(state, NULL);
}

static bool solve(ck_Native *native) {
    ck_chain_solve(native->chain, native);
    return true;
}

static void substep(ck_Native *native) {
    ck_leapfrog_substep(native, solve);
}

static ck_StepResult step(void *state) {
    ck_Native *native = state;
    return native->cloth || native->chain ? ck_native_step_frame(native, substep) : CK_STEP_DIVERGED;
}

static const ck_Setting settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "a share of the time of waves across the springs",
     .help = "steps a frame"},
    {.name = "iterations",
     .slot = CK_ITERATIONS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "1",
     .help = "sweeps over all lines a substep"},
    {.name = "compliance",
     .slot = CK_SOFTNESS,
     .least = 1e-30,
     .most = 1e6,
     .unit = "m/N",
     .rule = "1/k of each spring",
     .help = "compliance of every spring",
     .leaves_theory = true},
    CK_NATIVE_VECTORS_ROW,
    CK_NATIVE_SINGLE_ROW,
    {0},
};

const ck_Engine ck_native_lines = {
    .name = "native-lines",
    .about = "compliant springs, solved at once along chains, and a cloth's rows, columns and diagonals",
    .family = "native",
    .version = ck_own_version,
    .method = CK_METHOD_STOERMER_LINES,
    .terms = CK_TERM_SPRINGS | CK_TERM_DAMPING | CK_TERM_GRAVITY | CK_TERM_FORCE | CK_TERM_DRAG | CK_TERM_VELOCITY |
             CK_TERM_COLLIDERS | CK_TERM_RELEASE | CK_TERM_MOVES | CK_TERM_MOVING_COLLIDERS | CK_TERM_BODIES,
    .settings = settings,
    .order = 2,
    .damped_order = 1, // a line sees rates that the other kinds' lines have yet to change
    .rest_order = 2,
    .damped_rest_order = 1, // as of native-xpbd
    .chains_keep_order = true,
    .create = create,
    .step = step,
    .read = ck_leapfrog_read,
    .release = release,
    .contact = ck_native_contact,
    .turn = ck_native_turn,
    .destroy = ck_native_destroy,
};
