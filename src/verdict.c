#include "verdict.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

static double measure(const ck_Run *run, const char *metric, const ck_Reference *reference) {
    return ck_metric_value(ck_metric_find(metric), run->model, &run->trajectory, reference);
}

static void judge(ck_Run *run, ck_RunStatus status, const char *format, ...) __attribute__((format(printf, 3, 4)));

static void judge(ck_Run *run, ck_RunStatus status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(run->reason, sizeof run->reason, format, arguments);
    va_end(arguments);
    run->status = status;
}

void ck_verdict(ck_Run *run, const ck_Reference *reference) {
    if (run->status != CK_RUN_OK) return;
    double gain = measure(run, "energy_drift", reference), strain = measure(run, "stretch_max", reference);
    double settled = measure(run, "settle_time", reference);
    if (gain > 0.1)
        judge(run, CK_RUN_ENERGY_GAIN, "gained %.3g of the energy there was; more than 0.1 is taken for a blow-up",
              gain);
    else if (strain > 1)
        judge(run, CK_RUN_OVERSTRETCHED, "a spring ends at %.3g times its length", strain + 1);
    else if (reference->is_static && isnan(settled))
        judge(run, CK_RUN_UNSETTLED, "still moves at the end, faster than %.3g m/s", ck_metric_still_speed(run->model));
    else if (reference->is_static)
        judge(run, CK_RUN_OK, "settled at t = %.4g s of %g s", settled, run->model->duration);
}
