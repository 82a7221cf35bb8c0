#include "conform.h"

#include "files.h"
#include "moved_model.h"
#include "vector.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *const ck_conform_verdicts[] = {"pass", "fail", "none"};

// An engine under question, and what has been found.
typedef struct Asked {
    const ck_Conform *conform;
    const ck_Engine *engine;
    double epsilon; // half a unit in the last place of 1
    ck_ConformResult *result;
    ck_Error *error;
} Asked;

static double epsilon_of(const ck_Engine *engine) {
    return engine->is_single ? 0x1p-24 : 0x1p-53;
}

// Sums in which double precision rounds, some 1e4 substeps of ten each; and what solvers by conjugate gradient leave of
// a speed, which stop at eps of its square. In single precision the rounding of coordinates is more than either.
#define ROUNDING 1e-11
#define SOLVED 1e-8

static ck_Status tell(const Asked *asked, double value, double tolerance, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
static ck_Status tell(const Asked *asked, double value, double tolerance, const char *format, ...) {
    ck_ConformResult *result = asked->result;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(result->reason, sizeof result->reason, format, arguments);
    va_end(arguments);
    result->value = value;
    result->tolerance = tolerance;
    result->verdict = value <= tolerance ? CK_CONFORM_PASS : CK_CONFORM_FAIL;
    return CK_OK;
}

// Nothing to ask: no verdict.
static ck_Status skip(const Asked *asked, const char *why) {
    ck_ConformResult *result = asked->result;
    *result = (ck_ConformResult){.value = NAN, .tolerance = NAN, .verdict = CK_CONFORM_NONE};
    snprintf(result->reason, sizeof result->reason, "%.250s", why);
    return CK_OK;
}

// Runs a model. *has_run is false, with the result told, where the engine does not get to its end.
static ck_Status run(const Asked *asked, ck_Run *run, const ck_Model *model, const ck_Settings *wanted, bool *has_run) {
    ck_Status status = ck_run_measure(run, model, asked->engine, wanted, &asked->conform->limits, asked->error);
    *has_run = !status && ck_run_has_all_frames(run);
    if (status || *has_run) return status;
    if (run->status == CK_RUN_UNSUPPORTED || run->status == CK_RUN_REFUSED) return skip(asked, run->reason);
    return tell(asked, NAN, NAN, "%s: %.200s", ck_run_status_names[run->status], run->reason);
}

static double value_of(const char *metric, const ck_Run *run) {
    const ck_Reference none = {0};
    return ck_metric_value(ck_metric_find(metric), run->model, &run->trajectory, &none);
}

// The largest change of what is measured of a rest.
static double change_between(const ck_Run *one, const ck_Run *other) {
    static const char *const metrics[] = {"sag", "stretch_max", "stretch_rms"};
    double largest = 0;
    for (size_t i = 0; i < sizeof metrics / sizeof *metrics; i++)
        largest = fmax(largest, fabs(value_of(metrics[i], one) - value_of(metrics[i], other)));
    return largest;
}

static double substep_of(const ck_Run *run) {
    return run->model->step / (run->used.substeps ? run->used.substeps : 100);
}

// What is left of a rest by rounding of coordinates of an extent, m: a speed read off two positions is off by it a
// substep, and drag ends what comes of that. / size, ten times.
static double rest_rounding(const Asked *asked, const ck_Run *run, double extent) {
    return 10 * asked->epsilon * extent * (1 + 1 / (substep_of(run) * run->model->drag)) / run->model->size;
}

// By how much rounding of coordinates changes momentum: a speed is off by it a substep, and what it is off walks at
// random. / the largest speed, ten times.
static double momentum_rounding(const Asked *asked, const ck_Run *run) {
    const ck_Trajectory *path = &run->trajectory;
    double extent = 0, speed = 0, substeps = run->model->duration / substep_of(run);
    for (int frame = 0; frame < path->frame_count; frame++)
        for (int i = 0; i < 3 * path->particle_count; i++) {
            extent = fmax(extent, fabs(ck_trajectory_position(path, frame)[i]));
            speed = fmax(speed, fabs(ck_trajectory_velocity(path, frame)[i]));
        }
    return 10 * asked->epsilon * extent / (substep_of(run) * speed) * sqrt(substeps);
}

// What only double precision comes down to.
static double in_double(const Asked *asked, double value) {
    return asked->engine->is_single ? 0 : value;
}

// Two runs of the net, of which the second is moved.
static ck_Status run_moved(const Asked *asked, ck_Move move, double by, ck_Run *before, ck_Run *after, ck_Model *moved,
                           bool *has_run) {
    const ck_Model *model = &asked->conform->net.model;
    ck_Status status = ck_moved_model_create(moved, model, move, by, asked->error);
    if (!status) status = run(asked, before, model, &(ck_Settings){0}, has_run);
    if (!status && *has_run)
        status = run(asked, after, moved, &(ck_Settings){.substeps = before->used.substeps}, has_run);
    return status;
}

static ck_Status ask_moved(const Asked *asked, ck_Move move, double by) {
    ck_Run before = {0}, after = {0};
    ck_Model moved = {0};
    bool has_run = false;
    ck_Status status = run_moved(asked, move, by, &before, &after, &moved, &has_run);
    if (has_run && move == CK_MOVE_SHIFT) {
        status =
            tell(asked, change_between(&before, &after), rest_rounding(asked, &before, fmax(by, before.model->size)),
                 "rounding of coordinates of %g m, over substeps of %.2g s", by, substep_of(&before));
    } else if (has_run) {
        status = tell(asked, change_between(&before, &after),
                      in_double(asked, ROUNDING) + rest_rounding(asked, &before, before.model->size),
                      "rounding, over substeps of %.2g s: nothing else may know", substep_of(&before));
    }
    ck_run_free(&before);
    ck_run_free(&after);
    ck_moved_model_free(&moved);
    return status;
}

static ck_Status ask_shift(const Asked *asked, double by) {
    return ask_moved(asked, CK_MOVE_SHIFT, by);
}

static ck_Status ask_rotation(const Asked *asked, double by) {
    return ask_moved(asked, CK_MOVE_ROTATE, by);
}

static ck_Status ask_mirror(const Asked *asked, double by) {
    return ask_moved(asked, CK_MOVE_MIRROR, by);
}

static ck_Status ask_scale(const Asked *asked, double by) {
    return ask_moved(asked, CK_MOVE_GROW, by);
}

// How much the order of springs changes a rest at a number of substeps; 0: the engine's own.
static ck_Status shuffle_at(const Asked *asked, uint32_t substeps, double *change, double *rounding, uint32_t *used,
                            bool *has_run) {
    const ck_Model *model = &asked->conform->net.model;
    ck_Run before = {0}, after = {0};
    ck_Model moved = {0};
    ck_Status status = ck_moved_model_create(&moved, model, CK_MOVE_SHUFFLE, 0, asked->error);
    if (!status) status = run(asked, &before, model, &(ck_Settings){.substeps = substeps}, has_run);
    if (!status && *has_run)
        status = run(asked, &after, &moved, &(ck_Settings){.substeps = before.used.substeps}, has_run);
    if (!status && *has_run) {
        *change = change_between(&before, &after);
        *rounding = in_double(asked, SOLVED) + rest_rounding(asked, &before, model->size);
        *used = before.used.substeps;
    }
    ck_run_free(&before);
    ck_run_free(&after);
    ck_moved_model_free(&moved);
    return status;
}

// A sweep's softening depends on which neighbour came before, so that the order matters by as much: it goes as the step
// does.
static ck_Status ask_shuffle(const Asked *asked, double by) {
    (void)by;
    double coarse, fine, rounding;
    uint32_t substeps;
    bool has_run = false;
    ck_Status status = shuffle_at(asked, 0, &coarse, &rounding, &substeps, &has_run);
    if (status || !has_run) return status;
    if (coarse <= rounding) return tell(asked, coarse, rounding, "rounding");
    if (!ck_engine_setting(asked->engine, CK_SUBSTEPS))
        return tell(asked, coarse, rounding, "rounding; it has no substeps to halve");
    status = shuffle_at(asked, 2 * substeps, &fine, &rounding, &substeps, &has_run);
    if (status || !has_run) return status;
    return tell(asked, fine, fmax(rounding, 0.7 * coarse),
                "%.2e with twice the step: a sweep's softening knows the order, and goes with the step", coarse);
}

// A metric that must be 0 to rounding or, where a method only keeps it to its order, fall as the step does.
static ck_Status ask_vanishing(const Asked *asked, const ck_Model *model, const char *metric) {
    ck_Run coarse = {0}, fine = {0};
    bool has_run;
    ck_Status status = run(asked, &coarse, model, &(ck_Settings){0}, &has_run);
    double value = has_run ? value_of(metric, &coarse) : NAN,
           rounding = has_run ? in_double(asked, SOLVED) + momentum_rounding(asked, &coarse) : NAN;
    if (has_run && value <= rounding)
        status = tell(asked, value, rounding, "rounding");
    else if (has_run && !ck_engine_setting(asked->engine, CK_SUBSTEPS))
        status = tell(asked, value, rounding, "rounding; it has no substeps to halve");
    else if (has_run) {
        has_run = false;
        if (!status) status = run(asked, &fine, model, &(ck_Settings){.substeps = 2 * coarse.used.substeps}, &has_run);
        if (has_run)
            status = tell(asked, value_of(metric, &fine), 0.7 * value,
                          "%.2e at %u substeps: with half the step it must be less, as the method's error is", value,
                          coarse.used.substeps);
    }
    ck_run_free(&coarse);
    ck_run_free(&fine);
    return status;
}

static ck_Status ask_momentum(const Asked *asked, double by) {
    (void)by;
    return ask_vanishing(asked, &asked->conform->drift.model, "momentum_drift");
}

static ck_Status ask_angular(const Asked *asked, double by) {
    (void)by;
    return ask_vanishing(asked, &asked->conform->drift.model, "angular_momentum_drift");
}

static ck_Status ask_energy(const Asked *asked, double by) {
    (void)by;
    return ask_vanishing(asked, &asked->conform->turn.model, "energy_drift");
}

static void find_centre(const ck_Run *run, int frame, double *centre) {
    const ck_Model *model = run->model;
    double total = 0;
    memset(centre, 0, 3 * sizeof *centre);
    for (int i = 0; i < model->particle_count; i++) {
        ck_add_scaled(centre, model->mass[i], ck_trajectory_position(&run->trajectory, frame) + 3 * i);
        total += model->mass[i];
    }
    for (int axis = 0; axis < 3; axis++) centre[axis] /= total;
}

// Forces within the body move no centre, damped or not.
static ck_Status ask_damped_fall(const Asked *asked, double by) {
    (void)by;
    const ck_Model *model = &asked->conform->fall.model;
    ck_Model undamped = {0};
    ck_Run damped_run = {0}, undamped_run = {0};
    bool has_run = false;
    ck_Status status = ck_moved_model_create(&undamped, model, CK_MOVE_SHIFT, 0, asked->error);
    for (int i = 0; i < model->spring_count && !status; i++) undamped.springs[i].damping = 0;
    undamped.terms &= ~(unsigned)CK_TERM_DAMPING;
    if (!status) status = run(asked, &damped_run, model, &(ck_Settings){0}, &has_run);
    if (!status && has_run)
        status = run(asked, &undamped_run, &undamped, &(ck_Settings){.substeps = damped_run.used.substeps}, &has_run);
    if (has_run && !status) {
        double one[3], other[3];
        find_centre(&damped_run, model->frame_count, one);
        find_centre(&undamped_run, model->frame_count, other);
        double way = ck_length(model->gravity) * model->duration * model->duration / 2;
        status =
            tell(asked, ck_distance(one, other) / way, in_double(asked, SOLVED) + momentum_rounding(asked, &damped_run),
                 "rounding, of the way that it falls: damping along springs slows no fall");
    }
    ck_run_free(&damped_run);
    ck_run_free(&undamped_run);
    ck_moved_model_free(&undamped);
    return status;
}

// From three runs, without any truth: log2 of the ratio of their differences.
static ck_Status ask_order(const Asked *asked, double by) {
    (void)by;
    const ck_Metric *distance = ck_metric_find("position_rms");
    ck_Run runs[3] = {{0}, {0}, {0}};
    bool has_run = true;
    ck_Status status = CK_OK;
    if (!ck_engine_setting(asked->engine, CK_SUBSTEPS)) return skip(asked, "it has no setting substeps");
    for (int level = 0; level < 3 && !status && has_run; level++)
        status =
            run(asked, &runs[level], &asked->conform->turn.model, &(ck_Settings){.substeps = 40u << level}, &has_run);
    if (has_run && !status) {
        const ck_Model *model = runs[0].model;
        double coarse = distance->between(model, &runs[0].trajectory, &runs[1].trajectory),
               fine = distance->between(model, &runs[1].trajectory, &runs[2].trajectory), order = log2(coarse / fine);
        if (fine < momentum_rounding(asked, &runs[2]))
            status = skip(asked, "its steps differ by rounding only");
        else if (asked->engine->order)
            status = tell(asked, fabs(order - asked->engine->order), 0.15,
                          "measured %.3f, its method's is %d; the next term of the error allows 0.15", order,
                          asked->engine->order);
        else
            status =
                tell(asked, 1 - order, 0.2, "measured %.3f, at least first order; the next term allows 0.2", order);
    }
    for (int level = 0; level < 3; level++) ck_run_free(&runs[level]);
    return status;
}

static double count_differences(const ck_Run *one, const ck_Run *other) {
    const ck_Trajectory *a = &one->trajectory, *b = &other->trajectory;
    double count = 0;
    for (size_t i = 0; i < 6 * (size_t)a->particle_count * (size_t)a->frame_count; i++)
        count += a->data[i] != b->data[i];
    return count;
}

static ck_Status ask_twice(const Asked *asked, const ck_Settings *first, const ck_Settings *second, const char *why) {
    ck_Run one = {0}, other = {0};
    bool has_run;
    ck_Status status = run(asked, &one, &asked->conform->net.model, first, &has_run);
    if (!status && has_run) status = run(asked, &other, &asked->conform->net.model, second, &has_run);
    if (!status && has_run) status = tell(asked, count_differences(&one, &other), 0, "%s", why);
    ck_run_free(&one);
    ck_run_free(&other);
    return status;
}

static ck_Status ask_repeat(const Asked *asked, double by) {
    (void)by;
    return ask_twice(asked, &(ck_Settings){0}, &(ck_Settings){0}, "the same bits in every number of two runs");
}

static ck_Status ask_threads(const Asked *asked, double by) {
    (void)by;
    if (!ck_engine_setting(asked->engine, CK_THREADS)) return skip(asked, "it has no setting threads");
    return ask_twice(asked, &(ck_Settings){.threads = 1}, &(ck_Settings){.threads = 2},
                     "the same bits with one thread and with two");
}

// Adding a property is one row.
static const struct {
    const char *name, *unit;
    ck_Status (*ask)(const Asked *asked, double by);
    double by;
} properties[] = {
    {"translation 1 m", "1", ask_shift, 1},
    {"translation 10 m", "1", ask_shift, 10},
    {"translation 100 m", "1", ask_shift, 100},
    {"translation 1 km", "1", ask_shift, 1000},
    {"rotation", "1", ask_rotation, 0},
    {"mirror", "1", ask_mirror, 0},
    {"scale", "1", ask_scale, 10},
    {"order of springs", "1", ask_shuffle, 0},
    {"momentum", "1", ask_momentum, 0},
    {"angular momentum", "1", ask_angular, 0},
    {"damped fall", "1", ask_damped_fall, 0},
    {"order", "1", ask_order, 0},
    {"energy", "1", ask_energy, 0},
    {"two runs", "numbers", ask_repeat, 0},
    {"threads", "numbers", ask_threads, 0},
};
#define PROPERTIES ((int)(sizeof properties / sizeof *properties))

int ck_conform_property_count(void) {
    return PROPERTIES;
}

const char *ck_conform_property(int index) {
    return properties[index].name;
}

const char *ck_conform_unit(int index) {
    return properties[index].unit;
}

ck_Status ck_conform_open(ck_Conform *conform, const ck_Limits *limits, ck_Error *error) {
    static const char *const names[] = {"net", "drift", "fall", "turn"};
    *conform = (ck_Conform){.limits = *limits};
    ck_Comparison *const scenes[] = {&conform->net, &conform->drift, &conform->fall, &conform->turn};
    char data[4096];
    if (!ck_path_data(data, sizeof data))
        return ck_fail(error, CK_BAD_INPUT, "scenes/conform is not beside the program");
    ck_Status status = CK_OK;
    for (int i = 0; i < 4 && !status; i++) {
        snprintf(conform->paths[i], sizeof conform->paths[i], "%s/scenes/conform/%s.yaml", data, names[i]);
        status = ck_comparison_load(scenes[i], conform->paths[i], error);
    }
    return status;
}

void ck_conform_close(ck_Conform *conform) {
    ck_comparison_free(&conform->net);
    ck_comparison_free(&conform->drift);
    ck_comparison_free(&conform->fall);
    ck_comparison_free(&conform->turn);
}

ck_Status ck_conform_ask(ck_ConformResult *result, const ck_Conform *conform, const ck_Engine *engine, int property,
                         ck_Error *error) {
    *result = (ck_ConformResult){.value = NAN, .tolerance = NAN};
    const Asked asked = {conform, engine, epsilon_of(engine), result, error};
    return properties[property].ask(&asked, properties[property].by);
}

void ck_conform_add(const ck_ConformResult *result, const ck_Engine *engine, int property, ck_Csv *csv) {
    char command[600];
    if (engine->outside)
        snprintf(command, sizeof command, "clothcheck conform '%s' %s", properties[property].name,
                 engine->outside->arguments);
    else
        snprintf(command, sizeof command, "clothcheck conform '%s' --engine %s", properties[property].name,
                 engine->name);
    ck_csv_text(csv, engine->name);
    ck_csv_text(csv, properties[property].name);
    ck_csv_text(csv, properties[property].unit);
    ck_csv_number(csv, result->value);
    ck_csv_number(csv, result->tolerance);
    ck_csv_text(csv, ck_conform_verdicts[result->verdict]);
    ck_csv_text(csv, result->reason);
    ck_csv_text(csv, command);
}
