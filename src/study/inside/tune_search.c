#include "tune_search.h"

#include "process.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A setting that misses a bound counts as this much more work for each power of e.
#define PENALTY 20
// Where the least error is looked for: a hundredth of it is not worth e times the work.
#define WORTH 0.01

enum { ERROR, SAG_ERROR, STRETCH_ERROR, CPU, TIME_STEP, STRETCH };

static bool value_name(int index, char *name, size_t size) {
    static const char *const names[] = {"error", "sag_error", "stretch_error", "cpu_s", "time_step_s", "stretch"};
    if (index >= (int)(sizeof names / sizeof *names)) return false;
    snprintf(name, size, "%s", names[index]);
    return true;
}

static void take_kept(void *context, const char *key, const ck_JournalRow *row) {
    ck_TuneSearch *search = context;
    if (search->kept_count == CK_TUNE_MOST_POINTS) return;
    snprintf(search->kept_keys[search->kept_count], sizeof search->kept_keys[0], "%s", key);
    search->kept[search->kept_count++] = *row;
}

ck_Status ck_tune_search_open(ck_TuneSearch *search, ck_Error *error) {
    return ck_journal_open(&search->journal, search->options->directory, "tune.journal", search->options->question,
                           value_name, take_kept, search, error);
}

static void write_key(char *key, size_t size, const ck_Engine *engine, const ck_TunePoint *point) {
    size_t used = (size_t)snprintf(key, size, "stiffness %.17g", point->stiffness);
    for (const ck_Setting *row = engine->settings; row && row->name && used < size; row++)
        used += (size_t)snprintf(key + used, size - used, " %s %.17g", row->name,
                                 ck_settings_get(&point->settings, row->slot));
}

static bool take_from_journal(const ck_TuneSearch *search, const char *key, ck_TunePoint *point) {
    for (int i = 0; i < search->kept_count; i++) {
        if (strcmp(search->kept_keys[i], key)) continue;
        const ck_JournalRow *row = &search->kept[i];
        const double *values = row->values;
        point->trial = (ck_Trial){.status = row->status,
                                  .error = values[ERROR],
                                  .stretch = values[STRETCH],
                                  .sag_error = values[SAG_ERROR],
                                  .stretch_error = values[STRETCH_ERROR],
                                  .cpu = values[CPU],
                                  .time_step = values[TIME_STEP]};
        snprintf(point->trial.reason, sizeof point->trial.reason, "%s", row->reason);
        return true;
    }
    return false;
}

static ck_Status keep_in_journal(ck_TuneSearch *search, const char *key, const ck_Trial *trial) {
    ck_JournalRow row = {.status = (int)trial->status};
    for (int i = 0; i < CK_JOURNAL_VALUES; i++) row.values[i] = NAN;
    const double values[] = {trial->error, trial->sag_error, trial->stretch_error,
                             trial->cpu,   trial->time_step, trial->stretch};
    memcpy(row.values, values, sizeof values);
    snprintf(row.reason, sizeof row.reason, "%s", trial->reason);
    return ck_journal_add(&search->journal, key, &row, search->error);
}

// Errors are measured on the scene as it is, whatever stiffness the engine was given. At rest and on the way they are
// told apart: a truth at rest knows nothing of the way.
ck_Status ck_tune_run_on(ck_TunePoint *point, const ck_Comparison *comparison, const ck_TrialGoal *aim,
                         const ck_TuneOptions *options, ck_Error *error) {
    ck_Model model = comparison->model;
    const ck_Reference *truth = &comparison->truth.reference;
    ck_Spring *springs = malloc(sizeof *springs * (size_t)model.spring_count + 1);
    if (!springs) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_model_scale_stiffness(&model, springs, point->stiffness);
    ck_Status status =
        ck_trial_run(&point->trial, &model, truth, aim, options->engine, &point->settings, 0, &options->limits, error);
    free(springs);
    return status;
}

static void split_errors(ck_TunePoint *point, const ck_TuneSearch *search) {
    bool is_path = search->aim.path || !search->comparison->truth.reference.is_static;
    point->static_error = is_path && !search->aim.metric ? point->trial.sag_error : point->trial.error;
    point->dynamic_error = is_path && !search->aim.metric ? point->trial.error : NAN;
}

double ck_tune_frame_cost(const ck_TunePoint *point, const ck_Model *model) {
    return point->trial.cpu / (model->frame_count * model->step) / 60;
}

bool ck_tune_has_bound(const ck_TuneGoal *goal) {
    return !isnan(goal->error) || !isnan(goal->stretch);
}

// By how many times the worst of its bounds is missed; at most 1: it meets them. NaN: it has none, or no such value.
static double miss_of(const ck_TuneSearch *search, const ck_TunePoint *point, bool with_cost) {
    const ck_TuneGoal *goal = &search->options->goal;
    const double values[] = {point->trial.error, point->trial.stretch,
                             ck_tune_frame_cost(point, &search->comparison->model)},
                 bounds[] = {goal->error, goal->stretch, with_cost ? goal->frame : NAN};
    double worst = 0;
    for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++) {
        if (isnan(bounds[i])) continue;
        if (isnan(values[i])) return INFINITY;
        worst = fmax(worst, values[i] / bounds[i]);
    }
    return worst;
}

bool ck_tune_meets(const ck_TuneSearch *search, const ck_TunePoint *point) {
    return point->trial.status == CK_RUN_OK && miss_of(search, point, true) <= 1;
}

// The logarithm of the work, or of the error: what is searched for.
static double value_of(const ck_TuneSearch *search, const ck_TunePoint *point) {
    const ck_TuneGoal *goal = &search->options->goal;
    double miss = miss_of(search, point, true), missed = fmin(0.5 * CK_TUNE_FAILED, PENALTY * fmax(0, log(miss)));
    if (point->trial.status != CK_RUN_OK || isinf(miss)) return CK_TUNE_FAILED;
    // capped, so that whatever runs is better than what does not; of two that cost the same, the closer one
    if (ck_tune_has_bound(goal)) return log(point->work) + 1e-6 * fmin(1, miss_of(search, point, false)) + missed;
    if (!(point->trial.error >= 0)) return CK_TUNE_FAILED;
    return log(fmax(point->trial.error, fmax(1e-16, search->uncertainty))) + WORTH * log(point->work) + missed;
}

void ck_tune_add_row(ck_Csv *csv, const ck_Model *model, const ck_TuneOptions *options, const char *role,
                     const ck_TunePoint *point, bool meets, const char *bounds) {
    const char *const names[] = {"substeps", "iterations", "relaxation", "compliance", "klst"};
    const ck_TuneGoal *goal = &options->goal;
    ck_csv_text(csv, model->name);
    ck_csv_text(csv, options->engine->name);
    ck_csv_text(csv, role);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const ck_Setting *row = ck_setting_find(options->engine->settings, names[i]);
        ck_csv_number(csv, row ? ck_settings_get(&point->settings, row->slot) : 0);
    }
    ck_csv_number(csv, point->stiffness);
    ck_csv_text(csv, ck_run_status_names[point->trial.status]);
    ck_csv_text(csv, point->trial.reason);
    const double errors[] = {point->trial.error, point->static_error, point->dynamic_error, goal->error,
                             point->trial.stretch};
    for (size_t i = 0; i < sizeof errors / sizeof *errors; i++) ck_csv_number(csv, errors[i]);
    ck_csv_text(csv, !ck_tune_has_bound(goal) && isnan(goal->frame) ? "" : meets ? "yes" : "no");
    ck_csv_number(csv, point->work);
    ck_csv_number(csv, point->trial.cpu);
    ck_csv_text(csv, bounds);
}

// One of a batch that has to be run.
typedef struct Work {
    ck_TuneSearch *search;
    ck_TuneOptions options;
    ck_TunePoint *points;
    int *todo; // numbers in points
} Work;

static ck_Status run_one(void *context, int index, ck_Error *error) {
    const Work *work = context;
    const ck_TuneSearch *search = work->search;
    return ck_tune_run_on(&work->points[work->todo[index]], search->comparison, &search->aim, &work->options, error);
}

// Runs those that are not known; what the end of the search cut short, of that nothing is known.
static void run_batch(ck_TuneSearch *search, ck_TunePoint *points, int *todo, int count) {
    Work work = {search, *search->options, points, todo};
    const ck_TuneGoal *goal = &search->options->goal;
    // no run outlasts the search
    work.options.limits.seconds = fmin(work.options.limits.seconds, fmax(1, search->deadline - ck_wall()));
    // side by side they would slow each other down where time is what is asked for
    search->status = ck_parallel(count, ck_parallel_with_children(isnan(goal->frame) ? search->options->jobs : 1),
                                 run_one, &work, search->error);
    bool is_cut = work.options.limits.seconds < search->options->limits.seconds;
    for (int i = 0; i < count; i++) search->is_late |= is_cut && points[todo[i]].trial.status == CK_RUN_TIMED_OUT;
}

static int find_key(const ck_TuneSearch *search, const char *key) {
    for (int i = 0; i < search->point_count; i++)
        if (!strcmp(search->keys[i], key)) return i;
    return -1;
}

static int take_point(ck_TuneSearch *search, ck_TunePoint *point, const char *key) {
    split_errors(point, search);
    int index = search->point_count++;
    memcpy(search->keys[index], key, sizeof search->keys[index]);
    search->points[index] = *point;
    search->values[index] = value_of(search, point);
    if (search->values[index] < search->values[search->best]) search->best = index;
    ck_tune_add_row(search->csv, &search->comparison->model, search->options, "evaluation", point,
                    ck_tune_meets(search, point), "");
    if (search->options->progress)
        search->options->progress(search->point_count, search->points[search->best].trial.error);
    return index;
}

void ck_tune_try(ck_TuneSearch *search, const ck_TunePoint *points, int count, int *indices) {
    char keys[CK_TUNE_MOST_BATCH][256];
    ck_TunePoint tried[CK_TUNE_MOST_BATCH];
    int todo[CK_TUNE_MOST_BATCH], todo_count = 0;
    bool was_kept[CK_TUNE_MOST_BATCH] = {false};
    search->is_late |= ck_wall() > search->deadline;
    for (int i = 0; i < count; i++) {
        tried[i] = points[i];
        write_key(keys[i], sizeof keys[i], search->options->engine, &tried[i]);
        indices[i] = find_key(search, keys[i]);
        was_kept[i] = indices[i] < 0 && take_from_journal(search, keys[i], &tried[i]);
        if (indices[i] < 0 && !was_kept[i]) todo[todo_count++] = i;
    }
    bool has_room = search->point_count + count <= CK_TUNE_MOST_POINTS;
    if (search->status || search->is_late || !has_room) return;
    if (todo_count) run_batch(search, tried, todo, todo_count);
    for (int i = 0; i < count && !search->status; i++) {
        if (indices[i] >= 0) continue;
        if (!was_kept[i] && search->is_late && tried[i].trial.status == CK_RUN_TIMED_OUT) continue;
        if (!was_kept[i]) search->status = keep_in_journal(search, keys[i], &tried[i].trial);
        int known = find_key(search, keys[i]);
        if (!search->status) indices[i] = known >= 0 ? known : take_point(search, &tried[i], keys[i]);
    }
}
