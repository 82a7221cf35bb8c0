#include "fit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const ck_fit_names[CK_FIT_PARAMETERS] = {"stiffness", "damping", "drag"};
const char *const ck_fit_units[CK_FIT_PARAMETERS] = {"N/m", "N*s/m", "1/s"};

#define ROUNDS 30
// A relative step that changes a path by far more than its own error, and far less than what bends the answer.
#define DIFFERENCE 1e-3
#define CLOSE 1e-5
// Beyond this the interval of a value holds a tenth and ten times of it: the data say nothing.
#define NOTHING 1.2

typedef struct Problem {
    const ck_Comparison *comparison;
    const ck_FitData *data;
    const ck_FitOptions *options;
    int parameters[CK_FIT_PARAMETERS], count; // those that vary
    double start[CK_FIT_PARAMETERS];
    int numbers; // that are measured
    int evaluations;
} Problem;

static double start_of(const ck_Model *model, int parameter) {
    if (parameter == CK_FIT_DRAG) return model->drag;
    if (!model->spring_count || (model->terms & CK_TERM_RIGID)) return 0;
    return parameter == CK_FIT_STIFFNESS ? model->springs[0].stiffness : model->springs[0].damping;
}

// One measured value of the whole run, where the scene states it; both divided by its uncertainty.
static int add_scalar(const ck_SceneMeasure *measured, const char *metric, double scale, const ck_Model *model,
                      const ck_Trajectory *path, double *left) {
    if (!measured) return 0;
    const ck_Reference none = {.is_static = path->frame_count == 1};
    double value = scale * ck_metric_value(ck_metric_find(metric), model, path, &none);
    *left = (value - measured->value) / measured->uncertainty;
    return 1;
}

static void place_at(const ck_Trajectory *path, double time, int particle, double *at) {
    int last = path->frame_count - 1, frame = (int)fmin(fmax(0, floor(time / path->step + 1e-9)), last);
    double h = path->step, t = frame < last ? time / h - frame : 0;
    int next = frame < last ? frame + 1 : frame;
    for (int axis = 0; axis < 3; axis++) {
        int i = 3 * particle + axis;
        at[axis] = ck_between(ck_trajectory_position(path, frame)[i], ck_trajectory_velocity(path, frame)[i],
                              ck_trajectory_position(path, next)[i], ck_trajectory_velocity(path, next)[i], h, t, NULL);
    }
}

static void compare_path(const Problem *problem, const ck_Model *model, const ck_Trajectory *path, double *left) {
    const ck_FitData *data = problem->data;
    const ck_RecordedPoint *points = data->points.points;
    const ck_SceneMeasured *measured = problem->comparison->scene.file->measured;
    for (int i = 0; i < data->points.point_count; i++, left += 3) {
        place_at(path, points[i].time, points[i].particle, left);
        for (int axis = 0; axis < 3; axis++) left[axis] = (left[axis] - points[i].at[axis]) / data->uncertainty;
    }
    if (!measured) return;
    left += add_scalar(measured->sag, "sag", model->size, model, path, left);
    left += add_scalar(measured->stretch_max, "stretch_max", 1, model, path, left);
    add_scalar(measured->period, "period", 1, model, path, left);
}

static void scale_model(const Problem *problem, const double *logarithms, ck_Model *model, ck_Spring *springs) {
    double factors[CK_FIT_PARAMETERS] = {1, 1, 1};
    for (int i = 0; i < problem->count; i++) factors[problem->parameters[i]] = exp(logarithms[i]);
    for (int i = 0; i < model->spring_count; i++) {
        springs[i] = model->springs[i];
        springs[i].stiffness *= factors[CK_FIT_STIFFNESS];
        springs[i].damping *= factors[CK_FIT_DAMPING];
    }
    model->springs = springs;
    model->drag *= factors[CK_FIT_DRAG];
}

// What is left between the measurement and the model at some values, [numbers].
static ck_Status evaluate(Problem *problem, const double *logarithms, double *left, ck_Error *error) {
    ck_Model model = problem->comparison->model;
    ck_Spring *springs = malloc(sizeof *springs * ((size_t)model.spring_count + 1));
    if (!springs) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    scale_model(problem, logarithms, &model, springs);
    ck_Status status;
    problem->evaluations++;
    if (problem->options->engine) {
        ck_Run run = {0};
        status = ck_run_measure(&run, &model, problem->options->engine, &problem->options->settings,
                                &problem->options->limits, error);
        if (!status && !ck_run_has_all_frames(&run))
            status =
                ck_fail(error, CK_BAD_INPUT, "%s on %s: %s", problem->options->engine->name, model.name, run.reason);
        if (!status) compare_path(problem, &model, &run.trajectory, left);
        ck_run_free(&run);
    } else {
        ck_Truth truth = {0};
        status = ck_truth_create(&truth, &model, NULL, &problem->options->limits, error);
        if (!status && !truth.path_count)
            status = ck_fail(error, CK_BAD_INPUT, "%s: its truth has no path to fit (%s)", model.name, truth.kind);
        if (!status) compare_path(problem, &model, &truth.paths[0], left);
        ck_truth_free(&truth);
    }
    free(springs);
    for (int i = 0; i < problem->numbers && !status; i++)
        if (!isfinite(left[i]))
            status = ck_fail(error, CK_BAD_INPUT, "%s: what is measured has no value here", model.name);
    return status;
}

static double sum_of_squares(const double *left, int count) {
    double sum = 0;
    for (int i = 0; i < count; i++) sum += left[i] * left[i];
    return sum;
}

// Solves a symmetric positive system of at most CK_FIT_PARAMETERS, or inverts it column by column; false where it is
// singular to rounding.
static bool solve(double matrix[][CK_FIT_PARAMETERS], int count, const double *right, double *out) {
    double a[CK_FIT_PARAMETERS][CK_FIT_PARAMETERS + 1];
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < count; k++) a[i][k] = matrix[i][k];
        a[i][count] = right[i];
    }
    for (int i = 0; i < count; i++) {
        if (!(a[i][i] > 1e-14 * matrix[i][i]) || !(matrix[i][i] > 0)) return false;
        for (int row = 0; row < count; row++) {
            double factor = row == i ? 0 : a[row][i] / a[i][i];
            for (int k = i; k <= count; k++) a[row][k] -= factor * a[i][k];
        }
    }
    for (int i = 0; i < count; i++) out[i] = a[i][count] / a[i][i];
    return true;
}

// Jᵀ·J and Jᵀ·r at some values, r known; memory [2*numbers] is scratch.
static ck_Status linearise(Problem *problem, const double *x, const double *left, double normal[][CK_FIT_PARAMETERS],
                           double *right, double *columns, ck_Error *error) {
    int numbers = problem->numbers;
    for (int i = 0; i < problem->count; i++) {
        double moved[CK_FIT_PARAMETERS], *column = columns + (size_t)i * (size_t)numbers;
        memcpy(moved, x, sizeof moved);
        moved[i] += DIFFERENCE;
        ck_Status status = evaluate(problem, moved, column, error);
        if (status) return status;
        for (int k = 0; k < numbers; k++) column[k] = (column[k] - left[k]) / DIFFERENCE;
    }
    for (int i = 0; i < problem->count; i++) {
        const double *one = columns + (size_t)i * (size_t)numbers;
        right[i] = 0;
        for (int k = 0; k < numbers; k++) right[i] -= one[k] * left[k];
        for (int j = 0; j < problem->count; j++) {
            const double *other = columns + (size_t)j * (size_t)numbers;
            normal[i][j] = 0;
            for (int k = 0; k < numbers; k++) normal[i][j] += one[k] * other[k];
        }
    }
    return CK_OK;
}

// Levenberg's damping goes down with each step that helps, and up with each that does not. left and normal are those of
// the last values.
static ck_Status descend(Problem *problem, double *x, double *left, double *trial, double *columns,
                         double normal[][CK_FIT_PARAMETERS], ck_Error *error) {
    double damping = 1e-3, right[CK_FIT_PARAMETERS];
    ck_Status status = evaluate(problem, x, left, error);
    for (int round = 0; round < ROUNDS && !status; round++) {
        status = linearise(problem, x, left, normal, right, columns, error);
        double largest = INFINITY;
        bool helped = false;
        for (int tries = 0; tries < 8 && !status && !helped; tries++) {
            double damped[CK_FIT_PARAMETERS][CK_FIT_PARAMETERS], step[CK_FIT_PARAMETERS], moved[CK_FIT_PARAMETERS];
            memcpy(damped, normal, sizeof damped);
            for (int i = 0; i < problem->count; i++) damped[i][i] *= 1 + damping;
            if (!solve(damped, problem->count, right, step)) return CK_OK;
            largest = 0;
            for (int i = 0; i < problem->count; i++) {
                double limited = fmax(-1, fmin(1, step[i]));
                moved[i] = x[i] + limited;
                largest = fmax(largest, fabs(limited));
            }
            status = evaluate(problem, moved, trial, error);
            helped = !status && sum_of_squares(trial, problem->numbers) < sum_of_squares(left, problem->numbers);
            damping = helped ? damping / 9 : damping * 5;
            if (!helped) continue;
            memcpy(x, moved, sizeof moved);
            memcpy(left, trial, sizeof *left * (size_t)problem->numbers);
        }
        if (!helped || largest < CLOSE) break;
    }
    return status ? status : linearise(problem, x, left, normal, right, columns, error);
}

static ck_Status conclude(ck_Fit *fit, const Problem *problem, const double *x, const double *left,
                          double normal[][CK_FIT_PARAMETERS], ck_Error *error) {
    double covariance[CK_FIT_PARAMETERS][CK_FIT_PARAMETERS];
    int count = problem->count, free_numbers = problem->numbers - count;
    fit->misfit = sqrt(sum_of_squares(left, problem->numbers) / fmax(1, free_numbers));
    for (int i = 0; i < count; i++) {
        double unit[CK_FIT_PARAMETERS] = {0}, column[CK_FIT_PARAMETERS];
        unit[i] = 1;
        if (problem->numbers < count || !solve(normal, count, unit, column))
            return ck_fail(error, CK_REFUSED,
                           "%s: the data cannot tell the values of %d parameters apart; vary fewer, or measure more",
                           problem->comparison->path, count);
        for (int k = 0; k < count; k++) covariance[k][i] = column[k] * fmax(1, fit->misfit * fit->misfit);
    }
    for (int i = 0; i < count; i++) {
        int parameter = problem->parameters[i];
        double spread = 1.96 * sqrt(covariance[i][i]);
        fit->value[parameter] = fit->start[parameter] * exp(x[i]);
        fit->low[parameter] = fit->value[parameter] * exp(-spread);
        fit->high[parameter] = fit->value[parameter] * exp(spread);
        for (int k = 0; k < count; k++)
            fit->correlation[parameter][problem->parameters[k]] =
                covariance[i][k] / sqrt(covariance[i][i] * covariance[k][k]);
        if (spread > 2 * NOTHING)
            return ck_fail(error, CK_REFUSED, "%s: the data say nothing of %s; leave it out, or measure more",
                           problem->comparison->path, ck_fit_names[parameter]);
    }
    return CK_OK;
}

static ck_Status prepare(Problem *problem, ck_Fit *fit, ck_Error *error) {
    const ck_Comparison *comparison = problem->comparison;
    const ck_SceneMeasured *measured = comparison->scene.file->measured;
    problem->numbers = 3 * problem->data->points.point_count;
    if (measured) problem->numbers += !!measured->sag + !!measured->stretch_max + !!measured->period;
    if (!problem->numbers)
        return ck_fail(
            error, CK_BAD_INPUT,
            "%s: nothing is measured; give --points FILE, or measured: {sag: {value: M, uncertainty: M}} in the "
            "scene",
            comparison->path);
    if (!problem->options->engine && !comparison->model.truth)
        return ck_fail(error, CK_BAD_INPUT, "%s: names no truth; give it one, or fit through an --engine",
                       comparison->path);
    for (int i = 0; i < CK_FIT_PARAMETERS; i++) {
        fit->start[i] = fit->value[i] = start_of(&comparison->model, i);
        fit->low[i] = fit->high[i] = NAN;
        if (!problem->options->varies[i]) continue;
        if (!(fit->start[i] > 0))
            return ck_fail(error, CK_BAD_INPUT, "%s: has no %s to start from; give it one", comparison->path,
                           ck_fit_names[i]);
        problem->parameters[problem->count++] = i;
    }
    return problem->count ? CK_OK
                          : ck_fail(error, CK_BAD_INPUT, "fit needs --vary stiffness, --vary damping or --vary drag");
}

ck_Status ck_fit_run(ck_Fit *fit, const ck_Comparison *comparison, const ck_FitData *data, const ck_FitOptions *options,
                     ck_Error *error) {
    *fit = (ck_Fit){0};
    Problem problem = {.comparison = comparison, .data = data, .options = options};
    double x[CK_FIT_PARAMETERS] = {0}, normal[CK_FIT_PARAMETERS][CK_FIT_PARAMETERS] = {0};
    ck_Status status = prepare(&problem, fit, error);
    if (status) return status;
    size_t numbers = (size_t)problem.numbers;
    double *memory = malloc(sizeof *memory * numbers * (2 + CK_FIT_PARAMETERS));
    if (!memory) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    status = descend(&problem, x, memory, memory + numbers, memory + 2 * numbers, normal, error);
    if (!status) status = conclude(fit, &problem, x, memory, normal, error);
    fit->evaluations = problem.evaluations;
    fit->number_count = problem.numbers;
    free(memory);
    return status;
}

void ck_fit_write(const ck_Fit *fit, const ck_Comparison *comparison, const ck_FitOptions *options, ck_Csv *csv) {
    for (int i = 0; i < CK_FIT_PARAMETERS; i++) {
        if (!options->varies[i]) continue;
        ck_csv_text(csv, comparison->model.name);
        ck_csv_text(csv, options->engine ? options->engine->name : "truth");
        ck_csv_text(csv, ck_fit_names[i]);
        ck_csv_text(csv, ck_fit_units[i]);
        ck_csv_number(csv, fit->value[i]);
        ck_csv_number(csv, fit->low[i]);
        ck_csv_number(csv, fit->high[i]);
        ck_csv_number(csv, fit->start[i]);
        ck_csv_number(csv, fit->misfit);
    }
}
