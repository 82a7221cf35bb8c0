#include "stability_study.h"

#include "equilibrium.h"
#include "hinges.h"
#include "rounding.h"
#include "springs.h"
#include "statistics.h"
#include "time_scale.h"
#include "vector.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A probe: steps from rest with a push, read so many times. Odd, as a mode at its limit changes sign in each step, and
// velocity Verlet's then has no speed: only its positions tell.
#define FRAMES 40
#define STEPS 51
// The push of every free coordinate, in spacings: far above rounding, far below what bends a spring.
#define PUSH 1e-6
// A bisection ends when its bounds are this close, and gives up beyond this step.
#define CLOSE 1.01
#define LONGEST (1.0 / 4)

static const double stiffnesses[CK_STABILITY_RESTS] = {0.1, 1, 10};
static const double shares[] = {0.25, 0.5, 0.9, 1.1, 2, 4, 8, 16};
#define SHARES ((int)(sizeof shares / sizeof *shares))

// What becomes of a probe.
typedef enum Class {
    OK,
    UNSETTLED,
    OVERSTRETCHED,
    ENERGY_GAIN,
    DIVERGED,
    ABORTED,
    FROZEN,
    CLAMPED,
    UNSUPPORTED,
    REFUSED
} Class;
static const char *const class_names[] = {"ok",      "unsettled", "overstretched", "energy_gain", "diverged",
                                          "aborted", "frozen",    "clamped",       "unsupported", "refused"};

enum { CLASS, DT, STRAIN_EXCESS, SPEED, PREDICTED, STABLE, UNSTABLE };

bool ck_stability_value(int index, char *name, size_t size) {
    static const char *const names[] = {
        "class", "time_step_s", "strain_excess", "speed_m_s", "predicted_step_s", "stable_step_s", "unstable_step_s"};
    if (index >= (int)(sizeof names / sizeof *names)) return false;
    snprintf(name, size, "%s", names[index]);
    return true;
}

// Adds w·(pull·I + turn·v·vᵀ)·Σ w·d of a hinge of vector v.
static void turn_hinge(const ck_Hinge *hinge, const double *position, const double *d, double *force) {
    const ck_HingeState state = ck_hinge_state(hinge, position);
    double moved[3] = {0, 0, 0};
    for (int k = 0; k < 4; k++)
        if (hinge->particles[k] >= 0) ck_add_scaled(moved, hinge->weights[k], d + 3 * hinge->particles[k]);
    const double turned = state.turn * ck_dot(state.vector, moved);
    for (int k = 0; k < 4; k++) {
        if (hinge->particles[k] < 0) continue;
        ck_add_scaled(force + 3 * hinge->particles[k], hinge->weights[k] * state.pull, moved);
        ck_add_scaled(force + 3 * hinge->particles[k], hinge->weights[k] * turned, state.vector);
    }
}

// force = K·d, N, of small displacements d about a rest: k·[n·nᵀ + (1 − L/l)·(1 − n·nᵀ)] of each spring, or without the
// first term what tension does across springs; and of hinges, which every engine that is judged by this steps
// explicitly.
static void apply_stiffness(const ck_Model *model, const double *position, const double *d, bool is_across,
                            double *force) {
    memset(force, 0, 3 * sizeof *force * (size_t)model->particle_count);
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        double n[3], moved[3];
        ck_subtract(n, position + 3 * spring->b, position + 3 * spring->a);
        ck_subtract(moved, d + 3 * spring->b, d + 3 * spring->a);
        double length = ck_length(n), across = 1 - spring->rest / length;
        if (spring->pulls_only && across < 0) continue;
        double along = ck_dot(moved, n) / (length * length) * ((is_across ? 0 : 1) - across);
        for (int axis = 0; axis < 3; axis++) {
            double pull = spring->stiffness * (across * moved[axis] + along * n[axis]);
            force[3 * spring->a + axis] -= pull;
            force[3 * spring->b + axis] += pull;
        }
    }
    for (int i = 0; i < model->hinge_count; i++) turn_hinge(&model->hinges[i], position, d, force);
}

// What springs take of the motion d, per mass: dᵀ·C·d/(dᵀ·M·d), where C is c·n·nᵀ of each spring.
static double damping_of_motion(const ck_Model *model, const double *position, const double *d) {
    double power = 0, mass = 0;
    for (int i = 0; i < 3 * model->particle_count; i++) mass += model->mass[i / 3] * d[i] * d[i];
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        double n[3], moved[3];
        ck_subtract(n, position + 3 * spring->b, position + 3 * spring->a);
        ck_subtract(moved, d + 3 * spring->b, d + 3 * spring->a);
        double along = ck_dot(moved, n) / ck_length(n);
        power += spring->damping * along * along;
    }
    return power / mass;
}

// The largest ω² by power iteration on M⁻¹·K, a Rayleigh quotient, good to far below 0.1 % after so many rounds. Its
// motion is left in memory.
static double find_largest(const ck_Model *model, const double *position, bool is_across, double *memory) {
    size_t count = 3 * (size_t)model->particle_count;
    double *d = memory, *force = memory + count, quotient = 0;
    ck_Random random = ck_random_seed(1);
    for (size_t i = 0; i < count; i++) d[i] = model->pinned[i / 3] ? 0 : ck_random_unit(&random) - 0.5;
    for (int round = 0; round < 2000; round++) {
        double mass = 0, stiffness = 0, length = 0;
        apply_stiffness(model, position, d, is_across, force);
        for (size_t i = 0; i < count; i++) {
            mass += model->mass[i / 3] * d[i] * d[i];
            stiffness += d[i] * force[i];
            d[i] = model->pinned[i / 3] ? 0 : force[i] / model->mass[i / 3];
            length += d[i] * d[i];
        }
        quotient = stiffness / mass;
        for (size_t i = 0; i < count && length > 0; i++) d[i] /= sqrt(length);
    }
    return quotient;
}

static void measure_rest(ck_StabilityRest *rest, const ck_Model *model, double *memory) {
    double across = find_largest(model, rest->position, true, memory);
    rest->across = (ck_Vibration){sqrt(fmax(0, across)), 0};
    rest->fastest.frequency = sqrt(find_largest(model, rest->position, false, memory));
    rest->fastest.damping = damping_of_motion(model, rest->position, memory);
    rest->strain = ck_springs_largest_strain(model, rest->position);
}

static ck_Status find_rest(ck_StabilityRest *rest, const ck_StabilityMap *map, double stiffness, ck_Error *error) {
    const ck_Comparison *comparison = map->comparison;
    const ck_Model *base = &comparison->model;
    size_t count = 3 * (size_t)base->particle_count;
    *rest = (ck_StabilityRest){.stiffness = stiffness, .position = malloc(count * sizeof(double))};
    ck_Spring *springs = malloc(sizeof *springs * (size_t)base->spring_count);
    double *memory = calloc(3 * count, sizeof *memory);
    ck_Status status = rest->position && springs && memory ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) {
        ck_Model model = *base;
        ck_model_scale_stiffness(&model, springs, stiffness);
        ck_Equilibrium equilibrium = {0};
        status = ck_equilibrium_solve(&equilibrium, &model,
                                      ck_trajectory_position(&comparison->truth.reference.trajectory, 0), error);
        if (!status) {
            memcpy(rest->position, equilibrium.position, count * sizeof(double));
            measure_rest(rest, &model, memory + count);
        }
        ck_equilibrium_free(&equilibrium);
    }
    free(springs);
    free(memory);
    return status;
}

// True where the method has iterations to set; false, too, where the engine does not take the scene.
static bool iterates(const ck_Engine *engine, const ck_Model *model, const ck_Limits *limits) {
    ck_Settings used, wanted = {.substeps = 1};
    return !ck_run_automatic(engine, model, &wanted, limits, &used, NULL) && used.iterations > 0;
}

static void add_engine(ck_StabilityMap *map, const ck_Engine *engine) {
    bool has_iterations = iterates(engine, &map->comparison->model, &map->options->limits);
    for (int i = 0; i < CK_STABILITY_RESTS; i++)
        for (int share = 0; share < SHARES; share++)
            for (uint32_t iterations = 0; iterations <= 10; iterations += 10)
                if (iterations == 0 || has_iterations)
                    map->cases[map->case_count++] =
                        (ck_StabilityCase){engine, false, false, stiffnesses[i], shares[share], iterations};
    // without damping a method whose own rest is elsewhere swings about it for ever, which is no blow-up
    bool has_limit = !isnan(ck_stability_limit(engine->method, (ck_Vibration){1, 0}, (ck_Vibration){1, 0}));
    for (int undamped = 0; undamped <= has_limit; undamped++)
        map->cases[map->case_count++] = (ck_StabilityCase){engine, true, undamped, 1, NAN, 0};
}

ck_Status ck_stability_map_create(ck_StabilityMap *map, const ck_Comparison *comparison,
                                  const ck_CompareOptions *options, ck_Error *error) {
    *map = (ck_StabilityMap){.comparison = comparison, .options = options};
    const ck_Reference *reference = &comparison->truth.reference;
    const unsigned foreign = CK_TERM_RIGID | CK_TERM_COLLIDERS | CK_TERM_RELEASE | CK_TERM_MOVES;
    if (!reference->is_static || !reference->trajectory.frame_count || (comparison->model.terms & foreign))
        return ck_fail(error, CK_BAD_INPUT,
                       "%s: stability is mapped about a rest: the scene needs springs, a truth at rest such as "
                       "equilibrium, and neither rigid bars, colliders nor releases",
                       comparison->path);
    ck_Status status = CK_OK;
    for (int i = 0; i < CK_STABILITY_RESTS && !status; i++)
        status = find_rest(&map->rests[i], map, stiffnesses[i], error);
    map->cases =
        calloc((size_t)options->engine_count * (CK_STABILITY_RESTS * 2 * (size_t)SHARES + 2), sizeof *map->cases);
    if (!map->cases && !status) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status && options->engine_count == 1 && options->engines[0]->method == CK_METHOD_STILL)
        status = ck_fail(error, CK_BAD_INPUT, "%s moves nothing; give another --engine", options->engines[0]->name);
    for (int i = 0; i < options->engine_count && !status; i++)
        if (options->engines[i]->method != CK_METHOD_STILL) add_engine(map, options->engines[i]);
    return status;
}

void ck_stability_map_free(ck_StabilityMap *map) {
    for (int i = 0; i < CK_STABILITY_RESTS; i++) free(map->rests[i].position);
    free(map->cases);
    *map = (ck_StabilityMap){0};
}

static void describe(const void *context, int index, char *key, size_t size) {
    const ck_StabilityCase *one = &((const ck_StabilityMap *)context)->cases[index];
    if (one->is_critical)
        snprintf(key, size, "%s critical %s", one->engine->name, one->is_undamped ? "undamped" : "damped");
    else
        snprintf(key, size, "%s stiffness %g share %g iterations %u", one->engine->name, one->stiffness, one->share,
                 one->iterations);
}

static const ck_StabilityRest *rest_of(const ck_StabilityMap *map, const ck_StabilityCase *one) {
    int i = 0;
    while (map->rests[i].stiffness != one->stiffness) i++;
    return &map->rests[i];
}

static double rms_speed(const ck_Trajectory *trajectory, int frame) {
    double sum = 0;
    for (int i = 0; i < trajectory->particle_count; i++) {
        const double *v = ck_trajectory_velocity(trajectory, frame) + 3 * i;
        sum += ck_dot(v, v);
    }
    return sqrt(sum / trajectory->particle_count);
}

static double largest_speed(const ck_Trajectory *trajectory, int frame) {
    double largest = 0;
    for (int i = 0; i < trajectory->particle_count; i++)
        largest = fmax(largest, ck_length(ck_trajectory_velocity(trajectory, frame) + 3 * i));
    return largest;
}

// Root mean square of the way since the frame before, m.
static double rms_way(const ck_Trajectory *trajectory, int frame) {
    const double *now = ck_trajectory_position(trajectory, frame),
                 *before = ck_trajectory_position(trajectory, frame - 1);
    double sum = 0;
    for (int i = 0; i < 3 * trajectory->particle_count; i++) sum += (now[i] - before[i]) * (now[i] - before[i]);
    return sqrt(sum / trajectory->particle_count);
}

// The largest over a quarter of the frames, from the first to the last of four.
static double in_quarter(double (*measure)(const ck_Trajectory *, int), const ck_Trajectory *path, int quarter) {
    double largest = 0;
    for (int frame = (quarter - 1) * FRAMES / 4 + 1; frame <= quarter * FRAMES / 4; frame++)
        largest = fmax(largest, measure(path, frame));
    return largest;
}

// A blow-up that stays finite: it is as fast as a body that fell a hundredth of its size, or moves by a thousandth of
// it from frame to frame, in the last quarter at least a tenth of the second's: what is clamped comes and goes. One
// whose fastest particle has kept its speed to 1 % over the last frames is held by a clamp of the engine's. What came
// to rest is ok, however soft: its strain beyond the rest's says by how much.
static Class judge(const ck_Run *run, double rest_strain, double size, double gravity, double *strain, double *speed) {
    const ck_Trajectory *path = &run->trajectory;
    const ck_Model *model = run->model;
    *strain = ck_springs_largest_strain(model, ck_trajectory_position(path, FRAMES));
    *speed = in_quarter(rms_speed, path, 4);
    double way = in_quarter(rms_way, path, 4);
    bool is_fast = *speed > 0.1 * sqrt(2 * gravity * size) || way > 1e-3 * size;
    bool keeps_on = *speed > 0.1 * in_quarter(rms_speed, path, 2) || way > 0.1 * in_quarter(rms_way, path, 2);
    double now = largest_speed(path, FRAMES), before = largest_speed(path, FRAMES - 5);
    if (is_fast && keeps_on && fabs(now - before) < 0.01 * now) return CLAMPED;
    if (is_fast && keeps_on) return ENERGY_GAIN;
    if (*speed == 0 && !memcmp(ck_trajectory_position(path, FRAMES), ck_trajectory_position(path, 0),
                               3 * sizeof(double) * (size_t)model->particle_count))
        return FROZEN;
    if (*strain > 1 + rest_strain && *speed > ck_metric_still_speed(model)) return OVERSTRETCHED;
    if (keeps_on && *speed > ck_metric_still_speed(model) && (model->terms & (CK_TERM_DRAG | CK_TERM_DAMPING)))
        return UNSETTLED;
    return OK;
}

static Class class_of(const ck_Run *run) {
    switch (run->status) {
    case CK_RUN_DIVERGED: return DIVERGED;
    case CK_RUN_UNSUPPORTED: return UNSUPPORTED;
    case CK_RUN_REFUSED: return REFUSED;
    default: return ABORTED;
    }
}

typedef struct Probe {
    Class class;
    double strain, speed; // NaN where it did not get to its end
    char reason[256];
} Probe;

// The model of a probe: at rest but for the push, one step a substep.
static void set_up(ck_Model *model, const ck_StabilityRest *rest, bool is_undamped, double dt, double *position) {
    ck_Random random = ck_random_seed(7);
    model->position = position;
    for (int i = 0; i < 3 * model->particle_count; i++) {
        double push = PUSH * model->spacing * (2 * ck_random_unit(&random) - 1);
        position[i] = rest->position[i] + (model->pinned[i / 3] ? 0 : push);
    }
    model->terms &= ~(unsigned)CK_TERM_VELOCITY;
    model->step = STEPS * dt;
    model->frame_count = FRAMES;
    model->duration = FRAMES * model->step;
    if (!is_undamped) return;
    model->drag = 0;
    model->terms &= ~(unsigned)(CK_TERM_DRAG | CK_TERM_DAMPING);
    for (int i = 0; i < model->spring_count; i++) model->springs[i].damping = 0;
}

static ck_Status probe(Probe *out, const ck_StabilityMap *map, const ck_StabilityCase *one, double dt,
                       ck_Error *error) {
    const ck_Model *base = &map->comparison->model;
    const ck_StabilityRest *rest = rest_of(map, one);
    size_t count = 3 * (size_t)base->particle_count;
    ck_Spring *springs = malloc(sizeof *springs * (size_t)base->spring_count);
    double *memory = calloc(2 * count, sizeof *memory);
    ck_Run run = {0};
    ck_Status status = springs && memory ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    *out = (Probe){.class = ABORTED, .strain = NAN, .speed = NAN};
    if (!status) {
        ck_Model model = *base;
        ck_model_scale_stiffness(&model, springs, one->stiffness);
        model.velocity = memory;
        set_up(&model, rest, one->is_undamped, dt, memory + count);
        ck_Settings wanted = ck_comparison_settings(one->engine, &map->comparison->scene, map->options);
        wanted.substeps = STEPS;
        if (one->iterations) wanted.iterations = one->iterations;
        double field[3];
        ck_model_mean_field(&model, field);
        status = ck_run_measure(&run, &model, one->engine, &wanted, &map->options->limits, error);
        if (!status && run.trajectory.frame_count == FRAMES + 1)
            out->class = judge(&run, rest->strain, base->size, ck_length(field), &out->strain, &out->speed);
        else if (!status)
            out->class = class_of(&run);
        snprintf(out->reason, sizeof out->reason, "%.255s", run.reason);
        ck_run_free(&run);
    }
    free(springs);
    free(memory);
    return status;
}

static bool has_no_result(Class class) {
    return class == ABORTED || class == UNSUPPORTED || class == REFUSED;
}

static bool is_blow_up(Class class) {
    return class == DIVERGED || class == ENERGY_GAIN || class == CLAMPED;
}

static double predict(const ck_StabilityMap *map, const ck_StabilityCase *one) {
    const ck_StabilityRest *rest = rest_of(map, one);
    ck_Vibration fastest = rest->fastest, across = rest->across;
    fastest.damping = one->is_undamped ? 0 : fastest.damping + map->comparison->model.drag;
    across.damping = one->is_undamped ? 0 : map->comparison->model.drag;
    return ck_stability_limit(one->engine->method, fastest, across);
}

// Doubles or halves from the explicit limit to a pair of steps, one stable and one not, and halves their ratio.
static ck_Status bisect(const ck_StabilityMap *map, const ck_StabilityCase *one, ck_JournalRow *row, ck_Error *error) {
    double stable = NAN, unstable = NAN, dt = 2 / rest_of(map, one)->fastest.frequency;
    Probe now = {.class = OK};
    ck_Status status = CK_OK;
    while (!status && !(unstable / stable < CLOSE) && dt < LONGEST && dt > 1e-7) {
        status = probe(&now, map, one, dt, error);
        if (has_no_result(now.class)) break;
        if (is_blow_up(now.class))
            unstable = dt;
        else
            stable = dt;
        dt = isnan(unstable) ? 2 * stable : isnan(stable) ? 0.5 * unstable : sqrt(stable * unstable);
    }
    row->values[CLASS] = isnan(unstable) || has_no_result(now.class) ? now.class : OK;
    row->values[STABLE] = stable;
    row->values[UNSTABLE] = unstable;
    if (has_no_result(now.class))
        snprintf(row->reason, sizeof row->reason, "%s", now.reason);
    else if (isnan(unstable))
        snprintf(row->reason, sizeof row->reason, "no blow-up up to %.3g s", stable);
    else
        snprintf(row->reason, sizeof row->reason, "stable at %.6g s, not at %.6g s", stable, unstable);
    return status;
}

static ck_Status run(const void *context, int index, ck_JournalRow *row, ck_Error *error) {
    const ck_StabilityMap *map = context;
    const ck_StabilityCase *one = &map->cases[index];
    const ck_StabilityRest *rest = rest_of(map, one);
    row->values[PREDICTED] = predict(map, one);
    if (one->is_critical) return bisect(map, one, row, error);
    double dt = one->share * 2 / rest->fastest.frequency;
    Probe now;
    ck_Status status = probe(&now, map, one, dt, error);
    row->values[CLASS] = now.class;
    row->values[DT] = dt;
    row->values[STRAIN_EXCESS] = now.strain - rest->strain;
    row->values[SPEED] = now.speed;
    snprintf(row->reason, sizeof row->reason, "%s", now.reason);
    return status;
}

void ck_stability_map_write(const ck_StabilityMap *map, const ck_JournalRow *rows, ck_Csv *csv) {
    for (int i = 0; i < map->case_count; i++) {
        const ck_StabilityCase *one = &map->cases[i];
        const double *values = rows[i].values;
        if (!rows[i].is_done) continue;
        double critical = values[STABLE] > 0 && values[UNSTABLE] > 0 ? sqrt(values[STABLE] * values[UNSTABLE]) : NAN;
        ck_csv_text(csv, map->comparison->model.name);
        ck_csv_text(csv, one->engine->name);
        ck_csv_text(csv, one->is_critical ? "critical" : "map");
        ck_csv_text(csv, one->is_undamped ? "none" : "scene");
        ck_csv_number(csv, one->stiffness);
        ck_csv_count(csv, one->iterations);
        ck_csv_number(csv, values[DT]);
        ck_csv_text(csv, class_names[(int)values[CLASS]]);
        ck_csv_text(csv, rows[i].reason);
        ck_csv_number(csv, values[STRAIN_EXCESS]);
        ck_csv_number(csv, values[SPEED]);
        ck_csv_number(csv, critical);
        ck_csv_number(csv, values[PREDICTED]);
        ck_csv_number(csv, critical / values[PREDICTED]);
        ck_csv_number(csv, ck_rounding_step(&map->comparison->model, one->engine->is_single));
    }
}

ck_Study ck_stability_map_study(const ck_StabilityMap *map) {
    return (ck_Study){"stability", ck_stability_value, map->case_count, (void *)map, describe, run};
}
