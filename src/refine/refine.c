#include "refine.h"

#include "start.h"
#include "trial.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const int ck_refine_shares[CK_REFINE_LEVELS] = {1, 2, 4};

// Values that differ by less than that, as a share, are as good as one, whatever the order of what is left.
#define SETTLED 5e-3
// And below that there is no order to be told: engines come to rest within some 1e-6.
#define RESTS 1e-5

bool ck_refine_value(int index, char *name, size_t size) {
    if (index >= ck_metric_count()) return false;
    snprintf(name, size, "%s", ck_metric_at(index)->name);
    return true;
}

ck_Status ck_refine_create(ck_Refine *refine, const ck_Comparison *comparison, const ck_CompareOptions *options,
                           const char *cache, ck_Error *error) {
    *refine = (ck_Refine){.comparison = comparison, .options = options, .cache = cache};
    const ck_SceneFile *file = comparison->scene.file;
    const ck_TruthForm *form = comparison->truth.form;
    const char *refusal = ck_scene_resize_refusal(file, ck_refine_shares[CK_REFINE_LEVELS - 1]);
    if (refusal) return ck_fail(error, CK_BAD_INPUT, "%s: cannot be refined: %s", comparison->path, refusal);
    refine->engines = calloc((size_t)options->engine_count + 1, sizeof *refine->engines);
    if (!refine->engines) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (form && (form->solve || form->at)) refine->engine_count++; // the truth comes first
    for (int i = 0; i < options->engine_count; i++)
        if (options->engines[i]->method != CK_METHOD_STILL)
            refine->engines[refine->engine_count++] = options->engines[i];
    ck_Status status = CK_OK;
    for (int level = 0; level < CK_REFINE_LEVELS && !status; level++) {
        ck_SceneResized *resized = &refine->scenes[level];
        ck_scene_resize(resized, file, ck_refine_shares[level]);
        const ck_Scene scene = {.file = &resized->file, .document = comparison->scene.document};
        refine->model_count++;
        status = ck_start_build(&refine->models[level], &scene, error);
    }
    return status;
}

void ck_refine_free(ck_Refine *refine) {
    for (int i = 0; i < refine->model_count; i++) ck_model_free(&refine->models[i]);
    free(refine->engines);
    *refine = (ck_Refine){0};
}

static const char *name_of(const ck_Engine *engine) {
    return engine ? engine->name : "truth";
}

static void describe(const void *context, int index, char *key, size_t size) {
    const ck_Refine *refine = context;
    snprintf(key, size, "%s at %d times", name_of(refine->engines[index / CK_REFINE_LEVELS]),
             ck_refine_shares[index % CK_REFINE_LEVELS]);
}

// What the scene's truth says at a level.
static ck_Status solve(const ck_Refine *refine, const ck_Model *model, ck_JournalRow *row, ck_Error *error) {
    ck_Truth truth;
    ck_Status status = ck_truth_create(&truth, model, refine->cache, &refine->options->limits, error);
    row->status = truth.path_count ? CK_RUN_OK : CK_RUN_REFUSED;
    snprintf(row->reason, sizeof row->reason, "%s", truth.kind);
    for (int k = 0; k < ck_metric_count() && !status; k++)
        row->values[k] = truth.path_count ? ck_metric_truth(ck_metric_at(k), model, &truth.reference) : NAN;
    ck_truth_free(&truth);
    return status;
}

static ck_Status run(const void *context, int index, ck_JournalRow *row, ck_Error *error) {
    const ck_Refine *refine = context;
    const ck_Engine *engine = refine->engines[index / CK_REFINE_LEVELS];
    const ck_Model *model = &refine->models[index % CK_REFINE_LEVELS];
    if (!engine) return solve(refine, model, row, error);
    const ck_Settings wanted = ck_comparison_settings(engine, &refine->comparison->scene, refine->options);
    const ck_Reference none = {.is_static = refine->comparison->truth.reference.is_static};
    ck_Measurement measurement;
    ck_Status status =
        ck_measurement_take(&measurement, model, &none, engine, &wanted, &refine->options->limits, NULL, error);
    row->status = (int)measurement.status;
    snprintf(row->reason, sizeof row->reason, "%s", measurement.reason);
    for (int k = 0; k < ck_metric_count(); k++) row->values[k] = measurement.values[k];
    return status;
}

ck_Study ck_refine_study(const ck_Refine *refine) {
    return (ck_Study){"refine",       ck_refine_value, refine->engine_count * CK_REFINE_LEVELS,
                      (void *)refine, describe,        run};
}

ck_Refinement ck_refine_judge(const double *values) {
    const double first = values[1] - values[0], second = values[2] - values[1], scale = fabs(values[2]);
    if (!(isfinite(first) && isfinite(second))) return (ck_Refinement){NAN, NAN, "unknown"};
    const double ratio = first / second;
    const bool is_settled = fabs(first) <= SETTLED * scale && fabs(second) <= SETTLED * scale;
    // differences that do not shrink by a quarter at least, or change their sign, have no order to be extrapolated by
    if (ratio > 4.0 / 3 && fabs(first) > RESTS * scale)
        return (ck_Refinement){log2(ratio), values[2] + second / (ratio - 1), "converges"};
    if (is_settled) return (ck_Refinement){NAN, values[2], "settled"};
    return (ck_Refinement){NAN, NAN, fabs(second) < 0.5 * fabs(first) ? "converges" : "does not converge"};
}

static bool is_known(const ck_Refine *refine, const ck_JournalRow *rows, int engine, int metric) {
    bool has_any = false;
    for (int level = 0; level < CK_REFINE_LEVELS; level++) {
        const ck_JournalRow *row = &rows[engine * CK_REFINE_LEVELS + level];
        has_any |= row->is_done && !isnan(row->values[metric]);
    }
    // a distance to a truth is no quantity of the sheet
    return has_any && strcmp(ck_metric_at(metric)->name, "position_rms") &&
           ck_metric_is_wanted(ck_metric_at(metric), &refine->comparison->model);
}

static void add_name(const ck_Refine *refine, ck_Csv *csv, int engine, const ck_Metric *metric) {
    ck_csv_text(csv, refine->comparison->model.name);
    ck_csv_text(csv, name_of(refine->engines[engine]));
    ck_csv_text(csv, metric->name);
    ck_csv_text(csv, metric->unit);
}

static void add_metric(const ck_Refine *refine, const ck_JournalRow *rows, int engine, int index, ck_Csv *csv,
                       ck_Csv *summary) {
    const ck_Metric *metric = ck_metric_at(index);
    double values[CK_REFINE_LEVELS];
    const char *reason = "";
    for (int level = 0; level < CK_REFINE_LEVELS; level++) {
        const ck_JournalRow *row = &rows[engine * CK_REFINE_LEVELS + level];
        const bool counts = row->is_done && row->status == CK_RUN_OK;
        values[level] = counts ? row->values[index] : NAN;
        if (row->is_done && !counts) reason = row->reason;
        if (!row->is_done) continue;
        add_name(refine, csv, engine, metric);
        ck_csv_count(csv, (size_t)refine->models[level].particle_count);
        ck_csv_number(csv, refine->models[level].spacing);
        ck_csv_number(csv, row->values[index]);
        ck_csv_text(csv, ck_run_status_names[row->status]);
        ck_csv_text(csv, row->reason);
    }
    const ck_Refinement judged = ck_refine_judge(values);
    add_name(refine, summary, engine, metric);
    for (int level = 0; level < CK_REFINE_LEVELS; level++) ck_csv_number(summary, values[level]);
    ck_csv_number(summary, judged.order);
    ck_csv_number(summary, judged.limit);
    ck_csv_text(summary, judged.verdict);
    ck_csv_text(summary, reason);
}

void ck_refine_write(const ck_Refine *refine, const ck_JournalRow *rows, ck_Csv *csv, ck_Csv *summary) {
    for (int engine = 0; engine < refine->engine_count; engine++)
        for (int k = 0; k < ck_metric_count(); k++)
            if (is_known(refine, rows, engine, k)) add_metric(refine, rows, engine, k, csv, summary);
}
