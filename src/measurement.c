#include "measurement.h"

#include "verdict.h"

#include <math.h>
#include <stdio.h>

ck_Status ck_measurement_take(ck_Measurement *measurement, const ck_Model *model, const ck_Reference *reference,
                              const ck_Engine *engine, const ck_Settings *wanted, const ck_Limits *limits, ck_Run *keep,
                              ck_Error *error) {
    ck_Run own = {0}, *run = keep ? keep : &own;
    *measurement = (ck_Measurement){.cpu = NAN, .time_step = NAN};
    for (int i = 0; i < CK_METRIC_CAPACITY; i++) measurement->values[i] = NAN;
    ck_Status status = ck_verdict_run(run, model, reference, engine, wanted, limits, error);
    if (!status && run->trajectory.frame_count == model->frame_count + 1) {
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
