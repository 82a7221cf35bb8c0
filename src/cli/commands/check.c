#include "check.h"
#include "command.h"
#include "files.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// What a run in a check may take, s of CPU: the whole is to run often. In a baseline of their own, users decide.
#define SECONDS 1.5
#define MOST_PRINTED 20

typedef struct Work {
    ck_Arguments arguments;
    ck_Baseline baseline;
    ck_Comparison *comparisons;
    int comparison_count;
    ck_Check check;
    ck_JournalRow *rows;
} Work;

static double most_seconds(const Work *work) {
    return strcmp(work->arguments.baseline, CK_BASELINE_PATH) ? INFINITY : SECONDS;
}

static bool has_row(const ck_Baseline *baseline, const char *scene, const char *engine) {
    for (int i = 0; i < baseline->count; i++)
        if (!strcmp(baseline->rows[i].scene, scene) && (!engine || !strcmp(baseline->rows[i].engine, engine)))
            return true;
    return false;
}

static ck_Status load_scenes(Work *work, ck_Error *error) {
    const ck_Arguments *arguments = &work->arguments;
    char *cache = ck_path_join(arguments->out, "truths");
    work->comparisons = calloc((size_t)arguments->scene_count, sizeof *work->comparisons);
    ck_Status status = cache && work->comparisons ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    for (int i = 0; i < arguments->scene_count && !status; i++) {
        ck_Comparison *comparison = &work->comparisons[work->comparison_count];
        status = ck_comparison_load(comparison, arguments->scenes[i], error);
        // the baseline says which scenes are quick enough
        if (!status && !arguments->is_update && !has_row(&work->baseline, comparison->model.name, NULL))
            ck_comparison_free(comparison);
        else
            work->comparison_count++;
    }
    for (int i = 0; i < work->comparison_count && !status; i++)
        status = ck_truth_create(&work->comparisons[i].truth, &work->comparisons[i].model, cache,
                                 &arguments->options.limits, error);
    free(cache);
    return status;
}

static ck_Status list_cases(Work *work, ck_Error *error) {
    const ck_CompareOptions *options = &work->arguments.options;
    ck_Check *check = &work->check;
    check->options = options;
    check->is_update = work->arguments.is_update;
    check->tolerances = work->arguments.tolerances;
    check->tolerance_count = work->arguments.tolerance_count;
    check->cases = calloc((size_t)(work->comparison_count * options->engine_count) + 1, sizeof *check->cases);
    if (!check->cases) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    for (int i = 0; i < work->comparison_count; i++)
        for (int k = 0; k < options->engine_count; k++) {
            const char *scene = work->comparisons[i].model.name;
            if (check->is_update || has_row(&work->baseline, scene, options->engines[k]->name))
                check->cases[check->case_count++] = (ck_CheckCase){&work->comparisons[i], options->engines[k]};
        }
    if (!check->case_count)
        return ck_fail(error, CK_BAD_INPUT, "the baseline has nothing of these scenes and engines; --update adds it");
    work->rows = calloc((size_t)check->case_count, sizeof *work->rows);
    return work->rows ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
}

static ck_Status run_cases(Work *work, ck_Error *error) {
    const ck_Study study = ck_check_study(&work->check);
    int jobs = work->arguments.options.jobs ? work->arguments.options.jobs : (int)sysconf(_SC_NPROCESSORS_ONLN);
    // a check is of the code as it is now: nothing is taken from an older one
    const ck_StudyOptions options = {work->arguments.out, "check", jobs > 0 ? jobs : 1, 0, 0, false};
    ck_study_forget(&study, &options);
    ck_Status status = ck_study_run(&study, &options, work->rows, error);
    ck_study_forget(&study, &options);
    return status;
}

static const ck_AnswerColumn columns[] = {
    {"scene", "scene", -20, NULL},   {"engine", "engine", -16, NULL},  {"metric", "metric", -16, NULL},
    {"value", "is", 16, "%.9g"},     {"was", "was", 16, "%.9g"},       {"band", "within", 8, "%.2g"},
    {"status", "status", -13, NULL}, {"status_was", "was", -13, NULL}, {NULL, NULL, 0, NULL}};

static void show_deviation(ck_Answer *answer, const ck_Deviation *deviation) {
    const ck_BaselineRow *was = deviation->row;
    ck_answer_text(answer, was->scene);
    ck_answer_text(answer, was->engine);
    ck_answer_text(answer, *was->metric ? was->metric : "status");
    ck_answer_number(answer, deviation->value);
    ck_answer_number(answer, was->value);
    ck_answer_number(answer, deviation->allowed);
    ck_answer_text(answer, deviation->status);
    ck_answer_text(answer, was->status);
}

static int compare_excess(const void *a, const void *b) {
    double x = ((const ck_Deviation *)a)->excess, y = ((const ck_Deviation *)b)->excess;
    return (x < y) - (x > y);
}

// Shows the worst of all deviations; returns how many there are, negative without memory.
static int show_worst(Work *work, int most) {
    ck_Deviation *all = calloc((size_t)work->baseline.count + 1, sizeof *all);
    int count = 0;
    if (!all) return -1;
    for (int i = 0; i < work->check.case_count; i++)
        count += ck_check_compare(&work->check, i, &work->rows[i], &work->baseline, all + count);
    qsort(all, (size_t)count, sizeof *all, compare_excess);
    ck_Answer *answer = &work->arguments.answer;
    ck_answer_table(answer, "deviations", NULL, columns);
    for (int i = 0; i < count && i < most; i++) show_deviation(answer, &all[i]);
    if (count > most) ck_answer_line(answer, CK_ANSWER_NOTE, "and %d more", count - most);
    free(all);
    return count;
}

static bool is_of(const ck_BaselineRow *row, const ck_CheckCase *one) {
    return !strcmp(one->comparison->model.name, row->scene) && !strcmp(one->engine->name, row->engine);
}

// The case that a row of the baseline is of; negative: none was measured now.
static int find_case(const ck_Check *check, const ck_BaselineRow *row) {
    for (int i = 0; i < check->case_count; i++)
        if (is_of(row, &check->cases[i])) return i;
    return -1;
}

// Adds a case as it is now; false where it took too long. A busy machine drops no run that was quick enough before:
// that stays as it was.
static bool add_case(const Work *work, int index, bool is_known, ck_Csv *csv) {
    const ck_CheckCase *one = &work->check.cases[index];
    if (ck_check_add(one, &work->rows[index], (is_known ? 2 : 1) * most_seconds(work), csv)) return true;
    for (int i = 0; i < work->baseline.count; i++)
        if (is_of(&work->baseline.rows[i], one)) ck_baseline_add(&work->baseline.rows[i], csv);
    return false;
}

// In the order there was, so that what did not move is no change; what is new comes last.
static void add_all(Work *work, ck_Csv *csv) {
    const ck_Check *check = &work->check;
    const ck_BaselineRow *rows = work->baseline.rows;
    int added = 0, kept = 0;
    for (int i = 0; i < work->baseline.count; i++) {
        const int index = find_case(check, &rows[i]);
        bool is_first = true;
        for (int k = 0; k < i && is_first && index >= 0; k++) is_first = !is_of(&rows[k], &check->cases[index]);
        if (index < 0)
            ck_baseline_add(&rows[i], csv);
        else if (is_first && add_case(work, index, true, csv))
            added++;
        else if (is_first)
            kept++;
    }
    for (int i = 0; i < check->case_count; i++)
        if (!has_row(&work->baseline, check->cases[i].comparison->model.name, check->cases[i].engine->name))
            added += add_case(work, i, false, csv);
    ck_Answer *answer = &work->arguments.answer;
    ck_answer_line(answer, CK_ANSWER_SAYS, "%s: %d runs", work->arguments.baseline, added);
    if (check->case_count > added + kept)
        ck_answer_line(answer, CK_ANSWER_NOTE, "%d take more than %g s and are left out",
                       check->case_count - added - kept, most_seconds(work));
    if (kept)
        ck_answer_line(answer, CK_ANSWER_NOTE, "%d take more than %g s or time out, and stay as they were", kept,
                       2 * most_seconds(work));
}

static ck_Status update(Work *work, ck_Error *error) {
    ck_Csv csv = {0};
    char *path = strdup(work->arguments.baseline), *slash = path ? strrchr(path, '/') : NULL;
    if (!path) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Layout layout = ck_layouts[CK_BASELINE];
    layout.file = slash ? slash + 1 : path;
    if (slash) *slash = 0;
    ck_Status status = ck_csv_open(&csv, slash ? path : ".", &layout, error);
    if (!status && work->baseline.count) show_worst(work, 1000);
    if (!status) add_all(work, &csv);
    if (!status) status = ck_csv_close(&csv, error);
    ck_csv_discard(&csv);
    free(path);
    return status;
}

// Rows of an engine that is not here are not checked, and that is said.
static void note_absent(Work *work) {
    const ck_Baseline *baseline = &work->baseline;
    for (int i = 0; i < baseline->count; i++) {
        const char *engine = baseline->rows[i].engine;
        bool is_told = ck_engine_find(engine);
        for (int k = 0; k < i && !is_told; k++) is_told = !strcmp(baseline->rows[k].engine, engine);
        if (!is_told)
            ck_answer_line(&work->arguments.answer, CK_ANSWER_NOTE,
                           "%s is not here and was not checked: give --engine '%s=...'", engine, engine);
    }
}

static ck_Status check(Work *work, int *deviations, ck_Error *error) {
    ck_Arguments *arguments = &work->arguments;
    int failed = ck_path_make(arguments->out);
    ck_Status status = failed ? ck_fail(error, CK_IO, "%s: %s", arguments->out, strerror(failed)) : CK_OK;
    if (!status) status = ck_arguments_all_scenes(arguments, error);
    ck_Status found = status ? status : ck_baseline_read(&work->baseline, arguments->baseline, error);
    if (!status && !arguments->is_update) status = found;
    ck_command_catch_signals();
    if (!status) status = load_scenes(work, error);
    if (!status) status = list_cases(work, error);
    if (!status) status = run_cases(work, error);
    if (!status && arguments->history) status = ck_check_remember(arguments->history, &work->check, work->rows, error);
    if (!status && arguments->history)
        ck_answer_line(&arguments->answer, CK_ANSWER_NEXT, "clothcheck report %s", arguments->history);
    if (!status && arguments->is_update) return update(work, error);
    if (!status) status = ck_check_write_junit(arguments->out, &work->check, work->rows, &work->baseline, error);
    if (!status && (*deviations = show_worst(work, MOST_PRINTED)) < 0)
        status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) note_absent(work);
    if (!status)
        ck_answer_line(&arguments->answer, CK_ANSWER_SAYS, "%d runs, %d deviations", work->check.case_count,
                       *deviations);
    if (!status) ck_answer_line(&arguments->answer, CK_ANSWER_FILES, "%s/check.xml (JUnit)", arguments->out);
    return status;
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    Work work = {0};
    int deviations = 0;
    ck_Status status = ck_arguments_read(&work.arguments, command, argc, argv, &error);
    if (!status) status = check(&work, &deviations, &error);
    for (int i = 0; i < work.comparison_count; i++) ck_comparison_free(&work.comparisons[i]);
    free(work.comparisons);
    free(work.check.cases);
    free(work.rows);
    ck_baseline_free(&work.baseline);
    int ended = ck_command_end(&work.arguments, status, &error);
    return !ended && deviations ? CK_EXIT_FAILED : ended;
}

const ck_Command ck_command_check = {
    .name = "check",
    .arguments = "[SCENE...]",
    .about = "regression: what was measured before, within bands; exit status 1",
    .help =
        "Measures what --baseline holds again and prints what is beyond its band, the worst first;\nwrites check.xml "
        "(JUnit). Exit "
        "status 1 where there is any. A band is ten times what nudges of the start by\n1e-12 of the size change at "
        "most, 1e-6 of an engine in single precision: what rounding may come to on another machine.\nWith --baseline "
        "and --engine 'mine=./adapter' it guards a solver in a repository of its own; --update begins it.",
    .groups = CK_TAKES_FORM | CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_JOBS | CK_TAKES_UPDATE,
    .out = "out",
    .seconds = 900,
    .run = run,
};
