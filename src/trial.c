#include "trial.h"

#include "verdict.h"

#include <math.h>
#include <stdio.h>

static double error_of(const char *metric, const ck_Run *run, const ck_Reference *reference) {
    const ck_Metric *of = ck_metric_find(metric);
    return fabs(ck_metric_value(of, run->model, &run->trajectory, reference) -
                ck_metric_truth(of, run->model, reference));
}

static void measure(ck_Trial *trial, const ck_Run *run, const ck_Reference *reference, const ck_Trajectory *against) {
    const ck_Metric *position = ck_metric_find("position_rms");
    trial->error = against ? ck_metric_deviation(position, run->model, &run->trajectory, against, reference)
                           : ck_metric_value(position, run->model, &run->trajectory, reference);
    trial->sag_error = error_of("sag", run, reference);
    trial->stretch_error = error_of("stretch_max", run, reference);
}

ck_Status ck_trial_run(ck_Trial *trial, const ck_Model *model, const ck_Truth *truth, const ck_Trajectory *against,
                       const ck_Engine *engine, const ck_Settings *wanted, int repeats, const ck_Limits *limits,
                       ck_Error *error) {
    *trial = (ck_Trial){.error = NAN, .sag_error = NAN, .stretch_error = NAN, .cpu = NAN, .cpu_range = NAN};
    ck_Run run = {0};
    ck_Status status = ck_verdict_run(&run, model, &truth->reference, engine, wanted, limits, error);
    bool has_path = !status && run.trajectory.frame_count == model->frame_count + 1;
    if (has_path) {
        measure(trial, &run, &truth->reference, against);
        trial->cpu = run.measured_cpu;
        for (int i = 0; i < repeats && !status; i++) status = ck_run_time(&run, INFINITY, limits, error);
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
