#include "trial.h"

#include "runner.h"

#include <math.h>
#include <stdio.h>

static double error_of(const char *metric, const ck_Run *run, const ck_Reference *reference) {
    const ck_Metric *of = ck_metric_find(metric);
    return fabs(ck_metric_value(of, run->model, &run->trajectory, reference) -
                ck_metric_truth(of, run->model, reference));
}

static double distance_of(const ck_TrialGoal *goal, const ck_Run *run, const ck_Reference *truth) {
    const ck_Metric *position = ck_metric_find("position_rms");
    if (goal->metric) return fabs(ck_metric_value(goal->metric, run->model, &run->trajectory, truth) - goal->value);
    return goal->path ? ck_metric_deviation(position, run->model, &run->trajectory, goal->path, truth)
                      : ck_metric_value(position, run->model, &run->trajectory, truth);
}

static void measure(ck_Trial *trial, const ck_Run *run, const ck_Reference *truth, const ck_TrialGoal *goal) {
    trial->error = distance_of(goal ? goal : &(ck_TrialGoal){0}, run, truth);
    trial->stretch = ck_metric_value(ck_metric_find("stretch_max"), run->model, &run->trajectory, truth);
    trial->sag_error = error_of("sag", run, truth);
    trial->stretch_error = error_of("stretch_max", run, truth);
}

ck_Status ck_trial_run(ck_Trial *trial, const ck_Model *model, const ck_Reference *truth, const ck_TrialGoal *goal,
                       const ck_Engine *engine, const ck_Settings *wanted, int repeats, const ck_Limits *limits,
                       ck_Error *error) {
    *trial =
        (ck_Trial){.error = NAN, .stretch = NAN, .sag_error = NAN, .stretch_error = NAN, .cpu = NAN, .cpu_range = NAN};
    ck_Run run = {0};
    ck_Status status = ck_verdict_run(&run, model, truth, engine, wanted, limits, error);
    bool has_path = !status && ck_run_has_all_frames(&run);
    if (has_path) {
        measure(trial, &run, truth, goal);
        trial->cpu = run.measured_cpu;
        int most = repeats < 0 ? CK_MAX_REPEATS : repeats;
        for (int i = 0; i < most && !status && (repeats > 0 || !ck_timing_is_known(&run.timing, CK_TIMING_ENOUGH)); i++)
            status = ck_run_time(&run, INFINITY, limits, error);
    }
    if (run.timing.repeat_count) {
        trial->cpu = ck_timing_median(&run.timing);
        trial->cpu_range = ck_timing_iqr(&run.timing);
    }
    trial->status = run.status;
    trial->used = run.used;
    trial->time_step = run.used.substeps ? model->step / run.used.substeps : NAN;
    snprintf(trial->reason, sizeof trial->reason, "%.255s", run.reason);
    ck_run_free(&run);
    return status;
}

ck_Status ck_measurement_take(ck_Measurement *measurement, const ck_Model *model, const ck_Reference *reference,
                              const ck_Engine *engine, const ck_Settings *wanted, const ck_Limits *limits, ck_Run *keep,
                              ck_Error *error) {
    ck_Run own = {0}, *run = keep ? keep : &own;
    *measurement = (ck_Measurement){.cpu = NAN, .time_step = NAN};
    for (int i = 0; i < CK_METRIC_CAPACITY; i++) measurement->values[i] = NAN;
    ck_Status status = ck_verdict_run(run, model, reference, engine, wanted, limits, error);
    if (!status && ck_run_has_all_frames(run)) {
        for (int i = 0; i < ck_metric_count(); i++)
            if (ck_metric_is_wanted(ck_metric_at(i), model))
                measurement->values[i] = ck_metric_value(ck_metric_at(i), model, &run->trajectory, reference);
        measurement->cpu = run->measured_cpu;
        measurement->time_step = model->step / run->used.substeps;
    }
    measurement->status = run->status;
    snprintf(measurement->reason, sizeof measurement->reason, "%.255s", run->reason);
    ck_run_free(&own);
    return status;
}
