#include "tables.h"

#include "files.h"
#include "metric.h"
#include "names.h"
#include "text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

ck_Status ck_tables_open(ck_Tables *tables, const char *directory, ck_Keeping keeping, bool by_engine,
                         const ck_Comparison *comparisons, int count, const ck_CompareOptions *options,
                         ck_Error *error) {
    *tables = (ck_Tables){0};
    int failed = ck_path_make(directory);
    if (failed) return ck_fail(error, CK_IO, "%s: %s", directory, strerror(failed));
    const ck_Kept kept = {directory, comparisons, count, options, by_engine};
    bool keeps = keeping == CK_KEEP_OTHERS;
    ck_Status status = keeping == CK_KEEP_NONE ? CK_OK : ck_kept_check(&kept, &ck_layouts[CK_RUNS], keeps, error);
    for (int i = 0; i < CK_COMPARISON_LAYOUTS && !status; i++) {
        status = ck_csv_open(&tables->csv[i], directory, &ck_layouts[i], error);
        if (!status && keeps && i != CK_MACHINE) status = ck_kept_copy(&kept, &tables->csv[i], &ck_layouts[i], error);
    }
    return status;
}

// The command that repeats one run.
static void write_command(char *out, size_t size, const ck_Comparison *comparison, const ck_Run *run,
                          const ck_CompareOptions *options) {
    const char *engine = run->engine->name;
    const ck_Outside *outside = run->engine->outside;
    const ck_Engine *original = ck_engine_original(run->engine);
    char path[2048];
    ck_text_shell(path, sizeof path, comparison->path);
    size_t used = outside && outside->is_recorded
                      ? (size_t)snprintf(out, size, "clothcheck score %s %s", path, outside->arguments)
                  : outside ? (size_t)snprintf(out, size, "clothcheck run %s %s", path, outside->arguments)
                            : (size_t)snprintf(out, size, "clothcheck run %s --engine %s%s%s", path, engine,
                                               original ? "=" : "", original ? original->name : "");
    if (run->status == CK_RUN_TOO_SLOW)
        used += (size_t)snprintf(out + used, size - used, " --patience %g", options->limits.patience);
    for (int i = 0; i < options->override_count; i++) {
        const ck_Override *override = &options->overrides[i];
        if (override->engine != run->engine) continue;
        for (const ck_Setting *row = override->engine->settings; row && row->name && used < size; row++)
            if (ck_settings_has(&override->settings, row->slot))
                used += (size_t)snprintf(out + used, size - used, " --set %s.%s=%.17g", engine, row->name,
                                         ck_settings_get(&override->settings, row->slot));
    }
}

static void add_run(ck_Csv *csv, const ck_Comparison *comparison, const ck_Run *run, const ck_CompareOptions *options) {
    const ck_Timing *timing = &run->timing;
    char command[4096];
    write_command(command, sizeof command, comparison, run, options);
    double low, high;
    ck_timing_interval(timing, &low, &high);
    double median = ck_timing_median(timing), simulated = timing->frames * run->model->step;
    ck_csv_text(csv, run->model->name);
    ck_csv_text(csv, run->engine->name);
    ck_csv_text(csv, ck_run_status_names[run->status]);
    ck_csv_text(csv, run->reason);
    ck_csv_number(csv, run->used.substeps ? run->model->step / run->used.substeps : NAN);
    ck_csv_count(csv, run->used.substeps);
    ck_csv_count(csv, run->used.iterations);
    ck_csv_number(csv, simulated);
    ck_csv_number(csv, median);
    ck_csv_number(csv, ck_timing_iqr(timing));
    ck_csv_number(csv, low);
    ck_csv_number(csv, high);
    ck_csv_count(csv, (uint64_t)timing->repeat_count);
    ck_csv_number(csv, timing->repeat_count ? timing->worst_step : NAN);
    ck_csv_number(csv, simulated / median);
    ck_csv_count(csv, run->peak_rss_bytes);
    ck_csv_text(csv, ck_engine_version(run->engine));
    ck_csv_text(csv, run->engine->about);
    ck_csv_text(csv, command);
}

static void add_metrics(ck_Csv *csv, const ck_Comparison *comparison, int index) {
    const ck_Run *run = &comparison->runs[index];
    const ck_Reference *prediction = &comparison->predictions[index];
    ck_Model part;
    ck_Reference of_part;
    if (!ck_comparison_scores(comparison, index, &part, &of_part)) return;
    const ck_Model *model = &part;
    const ck_Reference *reference = &of_part;
    for (int i = 0; i < ck_metric_count(); i++) {
        const ck_Metric *metric = ck_metric_at(i);
        double value = ck_metric_value(metric, model, &run->trajectory, reference);
        if (!ck_metric_is_wanted(metric, model) || isnan(value)) continue;
        double truth = ck_metric_truth(metric, model, reference);
        ck_csv_text(csv, model->name);
        ck_csv_text(csv, run->engine->name);
        ck_csv_text(csv, metric->name);
        ck_csv_text(csv, metric->unit);
        ck_csv_number(csv, value);
        ck_csv_number(csv, truth);
        // where a truth was asked for and is not to be had, the kind says why
        ck_csv_text(csv, isnan(truth) && comparison->truth.path_count ? "" : comparison->truth.kind);
        // the paths whose spread it is end at the scene's end
        bool is_whole = ck_run_has_all_frames(&comparison->runs[index]);
        ck_csv_number(csv, is_whole ? ck_truth_uncertainty(&comparison->truth, model, metric) : NAN);
        ck_csv_number(csv, fabs(value - truth));
        // a path of one frame has no whole-run metrics
        bool foretold = prediction->trajectory.frame_count && (metric->at || !prediction->is_static);
        ck_csv_number(csv, foretold ? ck_metric_value(metric, model, &prediction->trajectory, reference) : NAN);
    }
}

// A value that is an error by itself.
static void add_distance(ck_Csv *csv, const ck_Comparison *comparison, int index, const char *metric, double value,
                         const char *to_what) {
    if (isnan(value)) return;
    ck_csv_text(csv, comparison->model.name);
    ck_csv_text(csv, comparison->runs[index].engine->name);
    ck_csv_text(csv, metric);
    ck_csv_text(csv, "1");
    ck_csv_number(csv, value);
    ck_csv_number(csv, 0);
    ck_csv_text(csv, to_what);
    ck_csv_number(csv, NAN);
    ck_csv_number(csv, value);
    ck_csv_number(csv, NAN);
}

// The engine against its own finest run, which tells whether it converges at all, not whether it is right; and which
// rest it came to.
static void add_distances(ck_Csv *csv, const ck_Comparison *comparison, int index) {
    for (int i = 0; i < CK_CONSISTENCY_STEPS; i++)
        add_distance(csv, comparison, index, ck_consistency_names[i], comparison->consistency[index][i],
                     "its own finest run");
    add_distance(csv, comparison, index, "own_rest_rms", comparison->folds[index].own,
                 "the energy minimum that it is next to");
    add_distance(csv, comparison, index, "fold_rms", comparison->folds[index].apart,
                 "from that minimum to the truth's");
}

static void add_deviations(ck_Csv *csv, const ck_Comparison *comparison) {
    const ck_Model *model = &comparison->model;
    for (int i = 0; i < ck_metric_count(); i++) {
        const ck_Metric *metric = ck_metric_at(i);
        for (int one = 0; one < comparison->run_count && ck_metric_is_wanted(metric, model); one++)
            for (int other = one + 1; other < comparison->run_count; other++) {
                if (!ck_run_has_all_frames(&comparison->runs[one]) || !ck_run_has_all_frames(&comparison->runs[other]))
                    continue;
                double deviation =
                    ck_metric_deviation(metric, model, &comparison->runs[one].trajectory,
                                        &comparison->runs[other].trajectory, &comparison->truth.reference);
                ck_trajectory_rest(&comparison->runs[other].trajectory);
                if (isnan(deviation)) continue;
                ck_csv_text(csv, model->name);
                ck_csv_text(csv, metric->name);
                ck_csv_text(csv, comparison->runs[one].engine->name);
                ck_csv_text(csv, comparison->runs[other].engine->name);
                ck_csv_number(csv, deviation);
                ck_csv_text(csv, metric->unit);
            }
    }
}

static void add_ledger(ck_Csv *csv, const ck_Run *run) {
    for (int i = 0; i < run->ledger.count; i++) {
        const ck_LedgerRow *row = &run->ledger.rows[i];
        ck_csv_text(csv, run->model->name);
        ck_csv_text(csv, run->engine->name);
        ck_csv_text(csv, row->quantity);
        ck_csv_number(csv, row->wanted);
        ck_csv_text(csv, row->unit);
        ck_csv_text(csv, row->native_parameter);
        ck_csv_number(csv, row->native_value);
        ck_csv_text(csv, row->formula);
        ck_csv_text(csv, ck_match_names[row->match]);
    }
}

static void add_series_row(ck_Csv *csv, const ck_Model *model, const char *engine, double time, const ck_Metric *metric,
                           double value) {
    if (isnan(value)) return;
    ck_csv_text(csv, model->name);
    ck_csv_text(csv, engine);
    ck_csv_number(csv, time);
    ck_csv_text(csv, metric->name);
    ck_csv_number(csv, value);
}

// Frames as far as the run came: those before a failure tell most about it.
static void add_series(ck_Csv *csv, const ck_Comparison *comparison, const char *engine, const ck_Trajectory *path) {
    const ck_Model *model = &comparison->model;
    const ck_Reference *reference = &comparison->truth.reference;
    for (int i = 0; i < ck_metric_count(); i++) {
        const ck_Metric *metric = ck_metric_at(i);
        for (int frame = 0; frame < path->frame_count && metric->at && ck_metric_is_wanted(metric, model); frame++)
            add_series_row(csv, model, engine, frame * model->step, metric, metric->at(model, path, frame, reference));
    }
}

// A truth at rest is there at the start and at the end, and none of its distances to itself.
static void add_truth_series(ck_Csv *csv, const ck_Comparison *comparison) {
    const ck_Model *model = &comparison->model;
    const ck_Reference *truth = &comparison->truth.reference;
    for (int i = 0; i < ck_metric_count(); i++) {
        const ck_Metric *metric = ck_metric_at(i);
        bool is_its_own = metric->truth == CK_TRUTH_OF_STATE || metric->truth == CK_TRUTH_OF_SERIES;
        if (!is_its_own || !metric->at || !ck_metric_is_wanted(metric, model)) continue;
        for (int frame = 0; frame < truth->trajectory.frame_count; frame++) {
            double value = metric->at(model, &truth->trajectory, frame, truth);
            add_series_row(csv, model, "truth", frame * model->step, metric, value);
            if (truth->is_static) add_series_row(csv, model, "truth", model->duration, metric, value);
        }
    }
}

static void add_comparison(ck_Tables *tables, const ck_Comparison *comparison, const ck_CompareOptions *options,
                           ck_SeriesRows series) {
    for (int i = 0; i < comparison->run_count; i++) {
        add_run(&tables->csv[CK_RUNS], comparison, &comparison->runs[i], options);
        add_ledger(&tables->csv[CK_LEDGER], &comparison->runs[i]);
        if (series != CK_SERIES_ROWS_NONE)
            add_series(&tables->csv[CK_SERIES], comparison, comparison->runs[i].engine->name,
                       &comparison->runs[i].trajectory);
        add_metrics(&tables->csv[CK_METRICS], comparison, i);
        add_distances(&tables->csv[CK_METRICS], comparison, i);
        ck_trajectory_rest(&comparison->runs[i].trajectory);
    }
    if (series == CK_SERIES_ROWS_ALL) add_truth_series(&tables->csv[CK_SERIES], comparison);
    add_deviations(&tables->csv[CK_DEVIATIONS], comparison);
}

void ck_tables_add(ck_Tables *tables, const ck_Comparison *comparison, const ck_CompareOptions *options) {
    add_comparison(tables, comparison, options, CK_SERIES_ROWS_ALL);
}

ck_Status ck_tables_text(char **rows, const ck_Comparison *comparison, const ck_CompareOptions *options,
                         ck_SeriesRows series, ck_Error *error) {
    ck_Tables tables = {0};
    ck_Text texts[CK_COMPARISON_LAYOUTS] = {0};
    bool has_failed = false;
    for (int i = 0; i < CK_COMPARISON_LAYOUTS; i++) {
        rows[i] = NULL;
        if (i == CK_MACHINE || (i == CK_SERIES && series == CK_SERIES_ROWS_NONE)) continue;
        has_failed |= !ck_text_begin(&texts[i]);
        ck_csv_begin(&tables.csv[i], texts[i].file, &ck_layouts[i]);
    }
    if (!has_failed) add_comparison(&tables, comparison, options, series);
    for (int i = 0; i < CK_COMPARISON_LAYOUTS; i++) {
        if (texts[i].file) has_failed |= !ck_text_end(&texts[i]);
        rows[i] = texts[i].bytes;
    }
    return has_failed ? ck_fail(error, CK_NO_MEMORY, "out of memory") : CK_OK;
}

ck_Status ck_tables_close(ck_Tables *tables, ck_Error *error) {
    ck_machine_write(&tables->csv[CK_MACHINE]);
    ck_Status status = CK_OK;
    for (int i = 0; i < CK_COMPARISON_LAYOUTS && !status; i++) status = ck_csv_close(&tables->csv[i], error);
    return status;
}

void ck_tables_discard(ck_Tables *tables) {
    for (int i = 0; i < CK_COMPARISON_LAYOUTS; i++) ck_csv_discard(&tables->csv[i]);
}
