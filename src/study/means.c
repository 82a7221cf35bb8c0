#include "means.h"

#include <math.h>
#include <string.h>

// m, of each spring
#define REST 1.0
// How far a spring is stretched, over its length, at rest and by one step of gravity more, which position-based engines
// see: little, as some engines' springs are straight only there.
#define STRAIN 2e-3
// Frames of the first look, and at most.
#define FRAMES 400
#define MOST_FRAMES 40000
#define TRIES 6

// Particles that hang from a pin, one below the other.
typedef struct Chain {
    ck_Model model;
    double position[3 * (CK_MEANS_LINKS + 1)], velocity[3 * (CK_MEANS_LINKS + 1)], mass[CK_MEANS_LINKS + 1];
    bool pinned[CK_MEANS_LINKS + 1], released[CK_MEANS_LINKS + 1];
    ck_Spring springs[CK_MEANS_LINKS];
} Chain;

static void make_chain(Chain *chain, int links, const ck_MeansQuestion *question, double gravity, double step,
                       int frames) {
    *chain = (Chain){.pinned = {true}};
    for (int i = 0; i <= links; i++) {
        chain->position[3 * i + 1] = -REST * i;
        chain->mass[i] = question->mass;
        if (i)
            chain->springs[i - 1] = (ck_Spring){
                .a = i - 1, .b = i, .rest = REST, .stiffness = question->stiffness, .damping = question->damping};
    }
    chain->model = (ck_Model){.name = "means",
                              .body = CK_NETWORK,
                              .particle_count = links + 1,
                              .position = chain->position,
                              .velocity = chain->velocity,
                              .mass = chain->mass,
                              .pinned = chain->pinned,
                              .released = chain->released,
                              .pin_count = 1,
                              .springs = chain->springs,
                              .spring_count = links,
                              .gravity = {0, -gravity, 0},
                              .terms = CK_TERM_SPRINGS | CK_TERM_GRAVITY,
                              .size = REST * links,
                              .spacing = REST,
                              .step = step,
                              .duration = step * frames,
                              .frame_count = frames};
    if (question->damping > 0) chain->model.terms |= CK_TERM_DAMPING;
}

static ck_Status run_chain(ck_Run *run, const Chain *chain, const ck_MeansQuestion *question,
                           const ck_Settings *settings, ck_Error *error) {
    ck_Status status = ck_run_measure(run, &chain->model, question->engine, settings, &question->limits, error);
    if (!status && run->status != CK_RUN_OK)
        status = ck_fail(error, CK_REFUSED, "%s: %s", question->engine->name, run->reason);
    return status;
}

// m, how far the last particle hangs below where it began.
static double drop(const ck_Run *run, int frame) {
    const int last = run->trajectory.particle_count - 1;
    return -REST * last - ck_trajectory_position(&run->trajectory, frame)[3 * last + 1];
}

// y'' = a·y' + b·y + d over a lag of frames.
typedef struct Recurrence {
    double a, b, d;
    double residual; // over the largest y, of the worst frame
} Recurrence;

static double residual_of(const Recurrence *of, const ck_Run *run, int lag, int from) {
    double worst = 0, largest = 1e-300;
    for (int i = from + 2 * lag; i < run->trajectory.frame_count; i++) {
        double y = drop(run, i);
        worst = fmax(worst, fabs(y - of->a * drop(run, i - lag) - of->b * drop(run, i - 2 * lag) - of->d));
        largest = fmax(largest, fabs(y));
    }
    return worst / largest;
}

// Solves the three normal equations by Gauss, of all frames from one on; false where they do not tell a from b.
static bool fit_from(Recurrence *fit, const ck_Run *run, int lag, int from) {
    double sums[3][4] = {{0}};
    const double scale = fabs(drop(run, run->trajectory.frame_count - 1)) + 1e-300;
    for (int i = from + 2 * lag; i < run->trajectory.frame_count; i++) {
        const double row[4] = {drop(run, i - lag) / scale, drop(run, i - 2 * lag) / scale, 1, drop(run, i) / scale};
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 4; c++) sums[r][c] += row[r] * row[c];
    }
    const double largest = sums[0][0] + sums[1][1] + sums[2][2];
    for (int pivot = 0; pivot < 3; pivot++) {
        if (!(fabs(sums[pivot][pivot]) > 1e-15 * largest)) return false;
        for (int r = 0; r < 3; r++) {
            double share = r == pivot ? 0 : sums[r][pivot] / sums[pivot][pivot];
            for (int c = pivot; c < 4; c++) sums[r][c] -= share * sums[pivot][c];
        }
    }
    *fit = (Recurrence){sums[0][3] / sums[0][0], sums[1][3] / sums[1][1], sums[2][3] / sums[2][2] * scale, 0};
    fit->residual = residual_of(fit, run, lag, from);
    return isfinite(fit->residual);
}

// The first frames may hold a root more, of a method that keeps more than positions and velocities: without them the
// rest fits far better.
static bool fit_recurrence(Recurrence *fit, const ck_Run *run, int lag) {
    enum { EARLY = 4 };
    Recurrence later;
    if (!fit_from(fit, run, lag, 0)) return false;
    if (fit_from(&later, run, lag, EARLY) && later.residual < 0.03 * fit->residual) *fit = later;
    return true;
}

// What a run of one mass says: its law, and the drop at rest.
static void read_law(ck_SpringLaw *law, double *rest, const ck_Run *run, int lag, double mass, double gravity) {
    Recurrence fit;
    *law = (ck_SpringLaw){NAN, NAN, NAN};
    *rest = drop(run, run->trajectory.frame_count - 1);
    if (fit_recurrence(&fit, run, lag)) {
        ck_spring_law_of_recurrence(law, fit.a, fit.b, mass, lag * run->model->step);
        *rest = fit.d / (1 - fit.a - fit.b);
    }
    law->at_rest = *rest > 1e-12 * REST ? mass * gravity / *rest : INFINITY;
}

// Hangs one mass on a spring, by a gravity that stretches it as far as it should, and steps it for some of its periods.
static ck_Status measure_one(ck_Means *means, const ck_MeansQuestion *question, const ck_Settings *settings,
                             ck_Error *error) {
    double guess = isfinite(question->stiffness) ? question->stiffness : 1000;
    double gravity = STRAIN * REST * guess / question->mass;
    int lag = 1, frames = FRAMES;
    for (int i = 0; i < TRIES; i++) {
        Chain chain;
        ck_Run run = {0};
        double rest = NAN;
        make_chain(&chain, 1, question, gravity, means->dt, frames);
        ck_Status status = run_chain(&run, &chain, question, settings, error);
        if (!status) read_law(&means->measured, &rest, &run, lag, question->mass, gravity);
        ck_run_free(&run);
        if (status) return status;
        if (!(rest > 1e-12 * REST)) return CK_OK; // it gives way to nothing
        const double factor = STRAIN * REST / (rest + gravity * means->dt * means->dt);
        const int radian =
            (int)fmin(MOST_FRAMES / 40.0, fmax(1, 1 / (means->dt * sqrt(means->measured.at_rest / question->mass))));
        if (fabs(log(factor)) < 0.1 && lag == radian) break;
        gravity *= factor;
        lag = radian;
        frames = (int)fmax(FRAMES, 40.0 * lag);
    }
    return CK_OK;
}

// Lets a chain hang until its slowest motion, which is critically damped, is over.
static ck_Status measure_chain(ck_Means *means, const ck_MeansQuestion *question, const ck_Settings *settings,
                               ck_Error *error) {
    const int n = CK_MEANS_LINKS;
    const double known = isfinite(means->measured.at_rest) ? means->measured.at_rest : means->measured.moving,
                 stiffness = isfinite(known) ? known : 1000,
                 slowest = acos(-1) / (2 * n + 1) * sqrt(stiffness / question->mass);
    const double load = n * (question->mass / stiffness + means->dt * means->dt); // m of stretch by 1 m/s² of gravity
    double gravity = STRAIN * REST / load;
    const double steps = fmax(FRAMES, 40 / (slowest * means->dt));
    const int apart = (int)ceil(steps / FRAMES);
    ck_Settings coarse = *settings;
    coarse.substeps = (uint32_t)apart;
    Chain chain;
    ck_Run run = {0};
    make_chain(&chain, n, question, gravity, apart * means->dt, FRAMES);
    chain.model.drag = fmin(2 * slowest, 0.2 / means->dt);
    chain.model.terms |= CK_TERM_DRAG;
    ck_Status status = run_chain(&run, &chain, question, &coarse, error);
    if (!status) {
        double total = drop(&run, run.trajectory.frame_count - 1);
        means->chain = total > 1e-12 * REST ? question->mass * gravity * n * (n + 1) / (2 * total) : INFINITY;
    }
    ck_run_free(&run);
    return status;
}

ck_Status ck_means_measure(ck_Means *means, const ck_MeansQuestion *question, ck_Error *error) {
    Chain chain;
    ck_Run run = {0};
    *means = (ck_Means){.measured = {NAN, NAN, NAN}, .theory = {NAN, NAN, NAN}, .chain = NAN};
    // its own rule chooses what is not set, of a frame; then every substep is a frame, to be looked at
    make_chain(&chain, 1, question, 9.81, question->frame, 1);
    ck_Status status = run_chain(&run, &chain, question, &question->settings, error);
    means->used = run.used;
    const ck_LedgerRow *exact = NULL;
    for (int i = 0; i < run.ledger.count; i++)
        if (!strcmp(run.ledger.rows[i].quantity, ck_stiffness_names[CK_STRUCTURAL]) &&
            run.ledger.rows[i].match == CK_EXACT)
            exact = &run.ledger.rows[i];
    means->dt = question->frame / fmax(1, means->used.substeps);
    if (!status)
        ck_spring_law_predict(&means->theory, question->engine, &means->used, question->mass, question->stiffness,
                              question->damping, means->dt);
    if (exact && isnan(means->theory.at_rest)) means->theory.at_rest = exact->wanted;
    ck_run_free(&run);
    ck_Settings settings = question->settings;
    settings.substeps = 1;
    settings.iterations = means->used.iterations;
    if (!status) status = measure_one(means, question, &settings, error);
    if (!status) status = measure_chain(means, question, &settings, error);
    return status;
}

ck_Status ck_means_alike(ck_Ledger *ledger, const ck_Engine *engine, const ck_MeansQuestion *question, double stiffness,
                         double damping, ck_Error *error) {
    const ck_MeansQuestion other = {.engine = engine,
                                    .mass = question->mass,
                                    .frame = question->frame,
                                    .stiffness = stiffness,
                                    .damping = damping,
                                    .limits = question->limits};
    Chain chain;
    ck_Run run = {0};
    make_chain(&chain, 1, &other, 9.81, question->frame, 1);
    ck_Status status = run_chain(&run, &chain, &other, &other.settings, error);
    *ledger = run.ledger;
    ck_run_free(&run);
    return status;
}
