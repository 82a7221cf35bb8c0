#include "comparison.h"

#include "names.h"
#include "runner.h"
#include "start.h"
#include "statistics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const ck_Engine *all_engines[CK_COMPARISON_MAX_ENGINES];

ck_CompareOptions ck_compare_options_default(void) {
    for (int i = 0; i < ck_engine_count(); i++) all_engines[i] = ck_engine_at(i);
    return (ck_CompareOptions){
        .engines = all_engines,
        .engine_count = ck_engine_count(),
        .repeats = CK_REPEAT_UNTIL_KNOWN,
        .budget = 0.5,
        .enough = CK_TIMING_ENOUGH,
        .consistency_budget = 0.3,
        .seed = 1,
        .limits = ck_limits_default(),
    };
}

static const char *metric_name(const void *table, int index) {
    (void)table;
    return index < ck_metric_count() ? ck_metric_at(index)->name : NULL;
}

static ck_Status check_measure(const ck_Comparison *comparison, ck_Error *error) {
    for (int i = 0; i < comparison->model.measure_count; i++) {
        if (ck_metric_find(comparison->model.measure[i])) continue;
        char path[32], known[400], hint[80];
        const char *name = comparison->model.measure[i];
        snprintf(path, sizeof path, "measure[%d]", i);
        return ck_scene_fail(&comparison->scene, path, error, "there is no metric %s%s; known are %s", name,
                             ck_name_hint(hint, sizeof hint, name, metric_name, NULL),
                             ck_name_list(known, sizeof known, metric_name, NULL));
    }
    return CK_OK;
}

ck_Status ck_comparison_load(ck_Comparison *comparison, const char *path, ck_Error *error) {
    *comparison = (ck_Comparison){.path = path};
    ck_Status status = ck_scene_load(&comparison->scene, path, error);
    if (!status) status = ck_engines_check(&comparison->scene, error);
    if (!status) status = ck_start_build(&comparison->model, &comparison->scene, error);
    if (!status) status = check_measure(comparison, error);
    if (status) return status;
    ck_Error why = {0};
    status = ck_truth_check(&comparison->model, &why);
    if (status == CK_BAD_INPUT) return ck_scene_fail(&comparison->scene, "truth", error, "%s", why.message);
    return status ? ck_fail(error, status, "%s", why.message) : CK_OK;
}

ck_Settings ck_comparison_settings(const ck_Engine *engine, const ck_Scene *scene, const ck_CompareOptions *options) {
    ck_Settings settings = ck_engine_scene_settings(engine, scene);
    for (int i = 0; i < options->override_count; i++) {
        const ck_Override *override = &options->overrides[i];
        if (override->engine == engine) ck_settings_override(&settings, &override->settings);
    }
    return settings;
}

static void report(const ck_CompareOptions *options, const ck_Comparison *comparison, int run, const char *doing) {
    if (options->progress) options->progress(comparison->model.name, options->engines[run]->name, doing);
}

// Finds which rest a run came to, and adds it to the run's reason where it is another than the truth's.
static ck_Status tell_fold(ck_Comparison *comparison, int index, const ck_Limits *limits, ck_Error *error) {
    ck_Run *run = &comparison->runs[index];
    ck_Fold *fold = &comparison->folds[index];
    ck_Status status = ck_fold_find(fold, run, &comparison->truth, limits, error);
    if (status || !ck_fold_is_another(fold, &comparison->truth, &comparison->model)) return status;
    size_t used = strlen(run->reason);
    snprintf(
        run->reason + used, sizeof run->reason - used,
        "; in another fold than the truth's, whose bottom is %.2g from it and %.1e J above: from its own it is %.2g",
        fold->apart, fold->energy, fold->own);
    return CK_OK;
}

typedef struct Work {
    ck_Comparison *comparison;
    const ck_CompareOptions *options;
} Work;

// The measured pass of an engine, and all that is told of it alone.
static ck_Status measure_one(void *context, int index, ck_Error *error) {
    const Work *work = context;
    const ck_CompareOptions *options = work->options;
    // the costly ones stand last in the table: begun first, they do not end last
    int i = options->engine_count - 1 - index;
    ck_Comparison *comparison = work->comparison;
    ck_Run *run = &comparison->runs[i];
    ck_Settings wanted = ck_comparison_settings(options->engines[i], &comparison->scene, options);
    report(options, comparison, i, "measuring");
    ck_Status status = ck_verdict_run(run, &comparison->model, &comparison->truth.reference, options->engines[i],
                                      &wanted, &options->limits, error);
    if (status || !ck_run_has_all_frames(run)) return status;
    status = ck_prediction_create(&comparison->predictions[i], &comparison->model, run->engine, &run->used,
                                  &comparison->truth, &options->limits, error);
    if (!status) status = tell_fold(comparison, i, &options->limits, error);
    report(options, comparison, i, "restarting");
    if (!status && options->consistency_budget > 0)
        status = ck_consistency_measure(comparison->consistency[i], run, options->consistency_budget, &options->limits,
                                        error);
    ck_trajectory_rest(&run->trajectory);
    return status;
}

// Side by side: what is timed is timed later, and alone.
static ck_Status measure_all(ck_Comparison *comparison, const ck_CompareOptions *options, ck_Error *error) {
    for (int i = 0; i < options->engine_count; i++) {
        for (int step = 0; step < CK_CONSISTENCY_STEPS; step++) comparison->consistency[i][step] = NAN;
        comparison->folds[i] = (ck_Fold){NAN, NAN, NAN};
    }
    comparison->run_count = options->engine_count;
    return ck_parallel(options->engine_count, ck_parallel_with_children(options->jobs), measure_one,
                       &(Work){comparison, options}, error);
}

// Repeats in rounds, each in an order of its own: a slow spell of the machine hits all engines alike.
static ck_Status time_all(ck_Comparison *comparison, const ck_CompareOptions *options, ck_Error *error) {
    ck_Random random = ck_random_seed(options->seed);
    int order[CK_COMPARISON_MAX_ENGINES];
    for (int i = 0; i < options->engine_count; i++) order[i] = i;
    bool until_known = options->repeats == CK_REPEAT_UNTIL_KNOWN;
    int rounds = until_known ? CK_MAX_REPEATS : options->repeats;
    for (int round = 0; round < rounds; round++) {
        for (int i = options->engine_count - 1; i > 0; i--) {
            int other = (int)(ck_random_next(&random) % (uint64_t)(i + 1)), kept = order[i];
            order[i] = order[other];
            order[other] = kept;
        }
        for (int i = 0; i < options->engine_count; i++) {
            ck_Run *run = &comparison->runs[order[i]];
            if (!ck_run_has_all_frames(run) || (until_known && ck_timing_is_known(&run->timing, options->enough)))
                continue;
            report(options, comparison, order[i], "timing");
            ck_Status status = ck_run_time(run, options->budget, &options->limits, error);
            if (status) return status;
        }
    }
    return CK_OK;
}

ck_Status ck_comparison_run(ck_Comparison *comparison, const ck_CompareOptions *options, ck_Error *error) {
    comparison->runs = calloc((size_t)options->engine_count + 1, sizeof *comparison->runs);
    comparison->predictions = calloc((size_t)options->engine_count + 1, sizeof *comparison->predictions);
    comparison->consistency = calloc((size_t)options->engine_count + 1, sizeof *comparison->consistency);
    comparison->folds = calloc((size_t)options->engine_count + 1, sizeof *comparison->folds);
    if (!comparison->runs || !comparison->predictions || !comparison->consistency || !comparison->folds)
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (options->progress) options->progress(comparison->model.name, "truth", "finding");
    ck_Status status = comparison->truth.form ? CK_OK
                                              : ck_truth_create(&comparison->truth, &comparison->model, options->cache,
                                                                &options->limits, error);
    if (!status) status = measure_all(comparison, options, error);
    if (!status) status = time_all(comparison, options, error);
    return status;
}

bool ck_comparison_scores(const ck_Comparison *comparison, int index, ck_Model *model, ck_Reference *reference) {
    const ck_Run *run = &comparison->runs[index];
    *model = comparison->model;
    *reference = comparison->truth.reference;
    if (ck_run_has_all_frames(run)) return true;
    int frames = run->trajectory.frame_count;
    if (run->status != CK_RUN_TOO_SLOW || frames < 2 || reference->is_static) return false;
    model->frame_count = frames - 1;
    model->duration = model->frame_count * model->step;
    if (reference->trajectory.frame_count > frames) reference->trajectory.frame_count = frames;
    if (reference->horizon >= frames) reference->horizon = frames - 1;
    return true;
}

void ck_comparison_free_runs(ck_Comparison *comparison) {
    for (int i = 0; i < comparison->run_count; i++) {
        ck_run_free(&comparison->runs[i]);
        ck_trajectory_free(&comparison->predictions[i].trajectory);
    }
    free(comparison->runs);
    free(comparison->predictions);
    free(comparison->consistency);
    free(comparison->folds);
    comparison->consistency = NULL;
    comparison->folds = NULL;
    comparison->runs = NULL;
    comparison->predictions = NULL;
    comparison->run_count = 0;
    ck_truth_free(&comparison->truth);
}

void ck_comparison_free(ck_Comparison *comparison) {
    ck_comparison_free_runs(comparison);
    ck_model_free(&comparison->model);
    ck_scene_free(&comparison->scene);
    *comparison = (ck_Comparison){0};
}
