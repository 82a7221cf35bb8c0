#include "precision.h"

#include "rounding.h"
#include "shape.h"
#include "statistics.h"
#include "trial.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_CASES_OF_ENGINE 40
// Substeps up to which an engine is followed, however coarse its own rule is: first order shows late.
#define FINEST 512.0
// Points of a fit of order: the finest ones between these errors, and this many times the truth's uncertainty.
#define COARSEST_FIT 0.02
#define ABOVE_UNCERTAINTY 5
#define MOST_FIT_POINTS 3

enum { DT, SUBSTEPS, ITERATIONS, ERROR, SAG_ERROR, STRETCH_ERROR, CPU, CPU_RANGE };

bool ck_precision_value(int index, char *name, size_t size) {
    static const char *const names[] = {"time_step_s", "substeps",      "iterations", "error",
                                        "sag_error",   "stretch_error", "cpu_s",      "cpu_iqr_s"};
    if (index >= (int)(sizeof names / sizeof *names)) return false;
    snprintf(name, size, "%s", names[index]);
    return true;
}

static void add_case(ck_Precision *precision, const ck_Engine *engine, ck_Settings settings, bool is_ladder) {
    for (int i = 0; i < precision->case_count; i++) {
        const ck_PrecisionCase *other = &precision->cases[i];
        if (other->engine == engine && other->settings.substeps == settings.substeps &&
            other->settings.iterations == settings.iterations)
            return;
    }
    precision->cases[precision->case_count++] = (ck_PrecisionCase){engine, settings, is_ladder};
}

// factor times a count, at least 1.
static uint32_t scaled(uint32_t count, double factor) {
    return (uint32_t)fmax(1, round(count * factor));
}

static void add_engine(ck_Precision *precision, const ck_Engine *engine, const ck_CompareOptions *options) {
    const ck_Model *model = &precision->comparison->model;
    ck_Settings wanted = ck_comparison_settings(engine, &precision->comparison->scene, options), used;
    if (ck_run_automatic(engine, model, &wanted, &options->limits, &used, NULL)) {
        add_case(precision, engine, wanted, false); // its row says why
        return;
    }
    int finest = (int)fmax(4, ceil(log2(FINEST / used.substeps)));
    for (int power = -3; power <= finest; power++) {
        ck_Settings settings = used;
        settings.substeps = scaled(used.substeps, ldexp(1, power));
        add_case(precision, engine, settings, true);
    }
    for (int power = -2; power <= 2 && used.iterations; power++)
        for (int quarter = -1; quarter <= 1; quarter += 2) {
            ck_Settings settings = used;
            settings.substeps = scaled(used.substeps, ldexp(1, power));
            settings.iterations = scaled(used.iterations, quarter < 0 ? 0.25 : 4);
            add_case(precision, engine, settings, false);
        }
}

ck_Status ck_precision_create(ck_Precision *precision, const ck_Comparison *comparison,
                              const ck_CompareOptions *options, ck_Error *error) {
    *precision = (ck_Precision){.comparison = comparison, .limits = options->limits, .repeats = options->repeats};
    const ck_Reference *reference = &comparison->truth.reference;
    if (!reference->trajectory.frame_count || reference->is_invariant)
        return ck_fail(error, CK_BAD_INPUT,
                       "%s: its truth has no positions to measure errors by; name one that has, such as equilibrium or "
                       "trajectory",
                       comparison->path);
    precision->uncertainty =
        ck_truth_uncertainty(&comparison->truth, &comparison->model, ck_metric_find("position_rms"));
    precision->cases = calloc((size_t)options->engine_count * MOST_CASES_OF_ENGINE, sizeof *precision->cases);
    if (!precision->cases) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    for (int i = 0; i < options->engine_count; i++)
        if (options->engines[i]->method != CK_METHOD_STILL) add_engine(precision, options->engines[i], options);
    return CK_OK;
}

void ck_precision_free(ck_Precision *precision) {
    free(precision->cases);
    *precision = (ck_Precision){0};
}

static void describe(const void *context, int index, char *key, size_t size) {
    const ck_PrecisionCase *one = &((const ck_Precision *)context)->cases[index];
    snprintf(key, size, "%s substeps %u iterations %u", one->engine->name, one->settings.substeps,
             one->settings.iterations);
}

static ck_Status run(const void *context, int index, ck_JournalRow *row, ck_Error *error) {
    const ck_Precision *precision = context;
    const ck_PrecisionCase *one = &precision->cases[index];
    ck_Trial trial;
    ck_Status status = ck_trial_run(&trial, &precision->comparison->model, &precision->comparison->truth.reference,
                                    NULL, one->engine, &one->settings, precision->repeats, &precision->limits, error);
    row->status = (int)trial.status;
    snprintf(row->reason, sizeof row->reason, "%s", trial.reason);
    const double values[] = {trial.time_step, trial.used.substeps, trial.used.iterations,
                             trial.error,     trial.sag_error,     trial.stretch_error,
                             trial.cpu,       trial.cpu_range};
    memcpy(row->values, values, sizeof values);
    return status;
}

ck_Study ck_precision_study(const ck_Precision *precision) {
    return (ck_Study){"precision", ck_precision_value, precision->case_count, (void *)precision, describe, run};
}

static bool counts(const ck_JournalRow *row) {
    return row->is_done && row->status == CK_RUN_OK && row->values[ERROR] >= 0 && row->values[CPU] > 0;
}

// Nobody is both cheaper and as right. Errors below the truth's uncertainty are all alike, and so are those within a
// twentieth of each other: at a floor they differ by rounding.
static bool is_on_front(const ck_Precision *precision, const ck_JournalRow *rows, int index) {
    double error = fmax(rows[index].values[ERROR], precision->uncertainty), cpu = rows[index].values[CPU];
    for (int i = 0; i < precision->case_count && counts(&rows[index]); i++) {
        if (!counts(&rows[i])) continue;
        double other = fmax(rows[i].values[ERROR], precision->uncertainty);
        if (other <= 1.05 * error && rows[i].values[CPU] < cpu) return false;
    }
    return counts(&rows[index]);
}

static void add_row(const ck_Precision *precision, const ck_JournalRow *rows, int index, ck_Csv *csv) {
    const double *values = rows[index].values;
    ck_csv_text(csv, precision->comparison->model.name);
    ck_csv_text(csv, precision->cases[index].engine->name);
    ck_csv_number(csv, values[SUBSTEPS]);
    ck_csv_number(csv, values[ITERATIONS]);
    ck_csv_number(csv, values[SUBSTEPS] * fmax(1, values[ITERATIONS]));
    ck_csv_number(csv, values[DT]);
    ck_csv_number(csv, precision->comparison->model.frame_count * precision->comparison->model.step);
    ck_csv_text(csv, ck_run_status_names[rows[index].status]);
    ck_csv_text(csv, rows[index].reason);
    for (int i = ERROR; i <= CPU_RANGE; i++) ck_csv_number(csv, values[i]);
    ck_csv_count(csv, is_on_front(precision, rows, index));
    ck_csv_number(
        csv, ck_rounding_share(&precision->comparison->model, values[DT], precision->cases[index].engine->is_single));
}

static void add_summary(const ck_Precision *precision, ck_Csv *csv, const ck_Engine *engine, const char *quantity,
                        const char *unit, double value, double expected, const char *reason) {
    ck_csv_text(csv, precision->comparison->model.name);
    ck_csv_text(csv, engine->name);
    ck_csv_text(csv, quantity);
    ck_csv_text(csv, unit);
    ck_csv_number(csv, value);
    ck_csv_number(csv, expected);
    ck_csv_text(csv, reason);
}

// The exponent p of error ~ dt^p over the finest points that the truth can tell; NaN with fewer than three.
static double fit_order(const ck_Precision *precision, const ck_JournalRow *rows, const ck_Engine *engine,
                        int *points) {
    double x[MOST_FIT_POINTS], y[MOST_FIT_POINTS];
    *points = 0;
    // an engine's ladder goes from coarse to fine
    for (int i = precision->case_count - 1; i >= 0 && *points < MOST_FIT_POINTS; i--) {
        double error = rows[i].values[ERROR];
        if (precision->cases[i].engine != engine || !precision->cases[i].is_ladder || !counts(&rows[i])) continue;
        if (error > COARSEST_FIT || !(error > ABOVE_UNCERTAINTY * precision->uncertainty)) continue;
        x[*points] = log(rows[i].values[DT]);
        y[(*points)++] = log(error);
    }
    return *points < 3 ? NAN : ck_slope(x, y, *points);
}

// 0: it has none, or is exact.
static int order_of(const ck_Engine *engine, const ck_Model *model, bool is_static) {
    const bool is_damped = (model->terms & CK_TERM_DAMPING) && !(engine->chains_keep_order && ck_shape_is_chain(model));
    if (is_static) return is_damped ? engine->damped_rest_order : engine->rest_order;
    return is_damped && engine->damped_order ? engine->damped_order : engine->order;
}

static void summarise_order(const ck_Precision *precision, const ck_JournalRow *rows, const ck_Engine *engine,
                            ck_Csv *csv) {
    int points;
    char reason[200];
    // the error of a scene at rest is that of the rest: to move wrongly on the way to it costs nothing
    bool is_static = precision->comparison->truth.reference.is_static;
    int theory = order_of(engine, &precision->comparison->model, is_static);
    double order = fit_order(precision, rows, engine, &points), expected = theory > 0 ? theory : NAN;
    if (points < 3)
        snprintf(reason, sizeof reason, "only %d steps have an error between %.3g and %g", points,
                 ABOVE_UNCERTAINTY * precision->uncertainty, COARSEST_FIT);
    else
        snprintf(reason, sizeof reason, "least squares over the %d finest of the steps that the truth can tell",
                 points);
    bool is_exact = is_static && engine->order && !engine->rest_order;
    if (is_exact)
        snprintf(reason, sizeof reason, "at rest it is exact at any step: what is left is the truth's uncertainty");
    add_summary(precision, csv, engine, "order", "1", is_exact ? NAN : order, expected, reason);
}

// The least error of any case of an engine, and the least time to come below each of three.
static void summarise_costs(const ck_Precision *precision, const ck_JournalRow *rows, const ck_Engine *engine,
                            ck_Csv *csv) {
    static const struct {
        const char *quantity;
        double error;
    } goals[] = {{"cost_to_10_percent", 0.1}, {"cost_to_1_percent", 0.01}, {"cost_to_0.1_percent", 0.001}};
    double floor = INFINITY;
    for (int i = 0; i < precision->case_count; i++)
        if (precision->cases[i].engine == engine && counts(&rows[i])) floor = fmin(floor, rows[i].values[ERROR]);
    add_summary(precision, csv, engine, "floor", "1", isfinite(floor) ? floor : NAN, NAN,
                isfinite(floor) ? "least error of all cases" : "no case is ok");
    for (size_t goal = 0; goal < sizeof goals / sizeof *goals; goal++) {
        double cost = INFINITY;
        char reason[120] = "least of all cases within";
        for (int i = 0; i < precision->case_count; i++)
            if (precision->cases[i].engine == engine && counts(&rows[i]) && rows[i].values[ERROR] <= goals[goal].error)
                cost = fmin(cost, rows[i].values[CPU]);
        if (!isfinite(cost) && isfinite(floor)) snprintf(reason, sizeof reason, "never: its floor is %.3g", floor);
        if (!isfinite(floor)) snprintf(reason, sizeof reason, "never: no case is ok");
        add_summary(precision, csv, engine, goals[goal].quantity, "s", isfinite(cost) ? cost : NAN, NAN, reason);
    }
}

// From how many substeps on finer steps make it worse: by half as much again, which the truth can tell.
static void summarise_finest(const ck_Precision *precision, const ck_JournalRow *rows, const ck_Engine *engine,
                             ck_Csv *csv) {
    int best = -1, finest = -1;
    for (int i = 0; i < precision->case_count; i++) {
        if (precision->cases[i].engine != engine || !precision->cases[i].is_ladder || !counts(&rows[i])) continue;
        if (best < 0 || rows[i].values[ERROR] < rows[best].values[ERROR]) best = i;
        finest = i;
    }
    double least = best < 0 ? NAN : fmax(rows[best].values[ERROR], precision->uncertainty);
    if (best < 0 || !(rows[finest].values[ERROR] > 1.5 * least)) return;
    char reason[200];
    double rounding = ck_rounding_share(&precision->comparison->model, rows[finest].values[DT], engine->is_single);
    bool is_rounding = rounding > 0.1 * rows[finest].values[ERROR];
    snprintf(reason, sizeof reason,
             "finer steps make it worse, up to %.2g: %s; the spacing of its numbers is %.1g of what the field moves a "
             "point by in a step there",
             rows[finest].values[ERROR], is_rounding ? "rounding from here on" : "by its method, not by rounding",
             rounding);
    add_summary(precision, csv, engine, is_rounding ? "finest_before_rounding" : "finest_useful_substeps", "1",
                rows[best].values[SUBSTEPS], NAN, reason);
}

void ck_precision_write(const ck_Precision *precision, const ck_JournalRow *rows, ck_Csv *csv, ck_Csv *summary) {
    const ck_Engine *last = NULL;
    for (int i = 0; i < precision->case_count; i++)
        if (rows[i].is_done) add_row(precision, rows, i, csv);
    for (int i = 0; i < precision->case_count; i++) {
        const ck_Engine *engine = precision->cases[i].engine;
        if (engine == last) continue;
        last = engine;
        summarise_order(precision, rows, engine, summary);
        summarise_costs(precision, rows, engine, summary);
        summarise_finest(precision, rows, engine, summary);
    }
}
