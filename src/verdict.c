#include "verdict.h"

#include "engine_list.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

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

// Gained energy by what the engine itself models: bars that do not stretch hold none, whatever k the scene names.
static double gained_energy(const ck_Run *run, const ck_Reference *reference) {
    const ck_Metric *metric = ck_metric_find("energy_drift");
    if (run->engine->method != CK_METHOD_STOERMER_BARS && run->engine->method != CK_METHOD_STOERMER_DIRECT)
        return ck_metric_value(metric, run->model, &run->trajectory, reference);
    ck_Model bars = *run->model;
    bars.springs = malloc(sizeof *bars.springs * (size_t)bars.spring_count + 1);
    if (!bars.springs) return NAN;
    for (int i = 0; i < bars.spring_count; i++) {
        bars.springs[i] = run->model->springs[i];
        bars.springs[i].stiffness = INFINITY;
    }
    double gained = ck_metric_value(metric, &bars, &run->trajectory, reference);
    free(bars.springs);
    return gained;
}

void ck_verdict(ck_Run *run, const ck_Reference *reference) {
    if (run->status != CK_RUN_OK) return;
    if (run->engine == &ck_null_engine) {
        judge(run, CK_RUN_OK, "moves nothing: what the harness costs");
        return;
    }
    double gain = gained_energy(run, reference), strain = measure(run, "stretch_max", reference);
    double settled = measure(run, "settle_time", reference);
    // what the truth itself stretches by is no fault
    double rightful = ck_metric_truth(ck_metric_find("stretch_max"), run->model, reference);
    if (gain > 0.1)
        judge(run, CK_RUN_ENERGY_GAIN, "gained %.3g of the energy there was; more than 0.1 is taken for a blow-up",
              gain);
    else if (strain > 1 && !(strain <= 1.1 * rightful))
        judge(run, CK_RUN_OVERSTRETCHED, "a spring ends at %.3g times its length", strain + 1);
    else if (reference->is_static && isnan(settled))
        judge(run, CK_RUN_UNSETTLED, "still moves at the end, faster than %.3g m/s", ck_metric_still_speed(run->model));
    else if (reference->is_static)
        judge(run, CK_RUN_OK, "settled at t = %.4g s of %g s", settled, run->model->duration);
    double passed = measure(run, "tunnelled", reference);
    if (run->status == CK_RUN_OK && passed > 0)
        judge(run, CK_RUN_OK, "ran to t = %g s, but a share of %.3g of its particles passed through a ball",
              run->model->duration, passed);
}
