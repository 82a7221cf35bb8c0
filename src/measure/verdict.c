#include "runner.h"

#include "engine.h"
#include "springs.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

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

// Beyond this share of the energy there was, motion is a blow-up: no method's own error of a stable step comes near it.
#define BLOW_UP 0.1
// A scene settles to a thousandth of its speed, ck_metric_still_speed: so many times drag's time of 2/drag.
#define SETTLING_TIMES 6.9

double ck_settling_time(const ck_Model *model) {
    return model->drag > 0 ? SETTLING_TIMES * 2 / model->drag : INFINITY;
}

// Why a scene may not come to rest in its duration, whoever steps it; empty where that is not known. Along springs c
// damps, too, but not the swinging across them.
static const char *reason_to_move(const ck_Model *model, char *text, size_t size) {
    double needed = ck_settling_time(model);
    text[0] = 0;
    if (!(model->terms & (CK_TERM_DRAG | CK_TERM_DAMPING)) && !model->collider_count)
        snprintf(text, size, ": the scene has neither drag nor spring damping, and cannot settle");
    else if (model->drag > 0 && needed > model->duration && !model->collider_count)
        snprintf(text, size, ": drag of %g/s takes some %.3g s to settle, and the scene has %g s", model->drag, needed,
                 model->duration);
    return text;
}

// A rest with another stretch than the truth's is a result, which its error grades: it is only said how far off it is.
static void judge_settled(ck_Run *run, const ck_Reference *reference, double settled) {
    double strain = measure(run, "stretch_rms", reference);
    double rightful = ck_metric_truth(ck_metric_find("stretch_rms"), run->model, reference);
    if (strain - rightful > 0.01)
        judge(run, CK_RUN_OK, "settled at t = %.4g s of %g s, too soft: rms strain %.3g where %.3g is right", settled,
              run->model->duration, strain, rightful);
    else
        judge(run, CK_RUN_OK, "settled at t = %.4g s of %g s", settled, run->model->duration);
}

// True where springs are longer than the scene's k allows: they would hold more energy than there was. Of bars any
// stretch is; whatever a right solver does, it is not.
static bool is_overstretched(const ck_Run *run) {
    const ck_Model *model = run->model;
    int last = run->trajectory.frame_count - 1;
    double strain = ck_springs_largest_strain(model, ck_trajectory_position(&run->trajectory, last));
    ck_Energy start = ck_energy_at(model, &run->trajectory, 0), end = ck_energy_at(model, &run->trajectory, last);
    double gained = ck_energy_total(&end) - ck_energy_total(&start);
    bool is_beyond = (model->terms & CK_TERM_RIGID) || gained > BLOW_UP * ck_energy_scale(model, &run->trajectory);
    return strain > 1 && is_beyond;
}

static void note_contact(ck_Run *run, const ck_Reference *reference) {
    double passed = measure(run, "tunnelled", reference);
    if (run->status == CK_RUN_OK && passed > 0)
        judge(run, CK_RUN_OK, "ran to t = %g s, but a share of %.3g of its particles passed through a ball",
              run->model->duration, passed);
}

static void note_remark(ck_Run *run) {
    size_t used = strlen(run->reason);
    if (run->remark[0]) snprintf(run->reason + used, sizeof run->reason - used, "; %s", run->remark);
}

void ck_verdict(ck_Run *run, const ck_Reference *reference) {
    if (run->status != CK_RUN_OK) return;
    if (run->engine->method == CK_METHOD_STILL) {
        judge(run, CK_RUN_OK, "moves nothing: what the harness costs");
        return;
    }
    char why[160];
    double gain = ck_energy_motion_gain(run->model, &run->trajectory);
    double settled = measure(run, "settle_time", reference);
    bool is_at_rest = !isnan(settled);
    if (gain > BLOW_UP)
        judge(run, CK_RUN_ENERGY_GAIN,
              "its motion gained %.3g of all the energy there was; more than %g is taken for a blow-up", gain, BLOW_UP);
    else if (!is_at_rest && is_overstretched(run))
        judge(run, CK_RUN_OVERSTRETCHED, "moves on, with a spring of %.3g times its length",
              measure(run, "stretch_max", reference) + 1);
    else if (reference->is_static && !is_at_rest)
        judge(run, CK_RUN_UNSETTLED, "still moves at the end, faster than %.3g m/s%s",
              ck_metric_still_speed(run->model), reason_to_move(run->model, why, sizeof why));
    else if (reference->is_static)
        judge_settled(run, reference, settled);
    note_contact(run, reference);
    note_remark(run);
}

// Halvings of a step that an engine's own rule chose.
#define HALVINGS 3

static bool blew_up(const ck_Run *run) {
    return run->status == CK_RUN_ENERGY_GAIN || run->status == CK_RUN_DIVERGED || run->status == CK_RUN_OVERSTRETCHED;
}

ck_Status ck_verdict_run(ck_Run *run, const ck_Model *model, const ck_Reference *reference, const ck_Engine *engine,
                         const ck_Settings *wanted, const ck_Limits *limits, ck_Error *error) {
    ck_Settings settings = *wanted;
    ck_Status status = ck_run_measure(run, model, engine, &settings, limits, error);
    if (!status) ck_verdict(run, reference);
    // an origin's step is one of its quirks
    bool has_rule = !wanted->substeps && engine->method != CK_METHOD_SEED && ck_engine_setting(engine, CK_SUBSTEPS);
    uint32_t chosen = run->used.substeps;
    for (int i = 0; i < HALVINGS && has_rule && chosen && !status && blew_up(run); i++) {
        settings.substeps = 2 * run->used.substeps;
        ck_run_free(run);
        status = ck_run_measure(run, model, engine, &settings, limits, error);
        if (!status) ck_verdict(run, reference);
        char verdict[sizeof run->reason];
        memcpy(verdict, run->reason, sizeof verdict);
        snprintf(run->reason, sizeof run->reason, "%.500s; its own rule chose %u substeps, which blow up: it took %u",
                 verdict, chosen, settings.substeps);
    }
    return status;
}
