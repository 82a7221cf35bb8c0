#include "tune.h"
#include "files.h"
#include "names.h"
#include "process.h"
#include "recording.h"
#include "studies.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void show(int evaluation, double best) {
    ck_progress_show("tune: %d settings, least error so far %.3g", evaluation, best);
}

static ck_Status read_varied(ck_TuneOptions *options, const ck_Arguments *arguments, ck_Error *error) {
    const ck_Setting *softness = ck_engine_setting(options->engine, CK_SOFTNESS);
    for (int i = 0; i < arguments->vary_count; i++) {
        const char *name = arguments->varies[i];
        bool is_stiffness = !strcmp(name, "stiffness");
        if (!is_stiffness && (!softness || ck_setting_find(options->engine->settings, name) != softness))
            return ck_fail(error, CK_BAD_INPUT, "--vary %s: of %s it must be stiffness%s%s", name,
                           options->engine->name, softness ? " or " : "", softness ? softness->name : "");
        options->varies_stiffness |= is_stiffness;
        options->varies_softness |= !is_stiffness;
    }
    return CK_OK;
}

// --target METRIC=VALUE: as the metric is measured or, of what is measured in sizes, in metres where m follows.
static ck_Status read_target(ck_TrialGoal *aim, const char *text, const ck_Model *model, ck_Error *error) {
    char name[40], *end;
    int used = 0;
    if (sscanf(text, "%39[a-z_]=%n", name, &used) != 1 || !used || !(aim->metric = ck_metric_find(name)))
        return ck_fail(error, CK_BAD_INPUT,
                       "--target %s: it must read METRIC=VALUE, as in sag=0.12 or sag=0.3m; 'clothcheck list' tells "
                       "the metrics",
                       text);
    aim->value = strtod(text + used, &end);
    bool is_length = !strcmp(name, "sag"), in_metres = !strcmp(end, "m") && is_length;
    if (end == text + used || !isfinite(aim->value) || (*end && !in_metres))
        return ck_fail(error, CK_BAD_INPUT, "--target %s: the value must be a number%s", text,
                       is_length ? ", of sizes, or of metres as in 0.3m" : "");
    if (in_metres) aim->value /= model->size;
    return CK_OK;
}

// --like ENGINE or FILE.
static ck_Status read_like(ck_TuneGoal *goal, ck_Trajectory *path, const char *text, const ck_Model *model,
                           ck_Answer *answer, ck_Error *error) {
    goal->like = ck_engine_find(text);
    if (goal->like) return CK_OK;
    if (access(text, R_OK) && !strpbrk(text, "./")) {
        char known[400];
        return ck_fail(error, CK_BAD_INPUT, "--like %s: there is no such engine, and no such file; engines are %s",
                       text, ck_name_list(known, sizeof known, ck_engine_name, NULL));
    }
    ck_Recording recording;
    char note[200] = "";
    ck_Status status = ck_recording_read(&recording, text, model, 0, error);
    if (!status) status = ck_recording_path(path, &recording, model, note, sizeof note, error);
    if (!status && path->frame_count <= model->frame_count)
        status = ck_fail(error, CK_BAD_INPUT, "%s: holds a coordinate that is no number", text);
    if (!status && *note) ck_answer_line(answer, CK_ANSWER_NOTE, "%s: %s", text, note);
    ck_recording_free(&recording);
    goal->aim.path = path;
    return status;
}

static ck_Status read_goal(ck_TuneGoal *goal, ck_Trajectory *path, const ck_StudyCommand *command, ck_Error *error) {
    const ck_Arguments *arguments = command->arguments;
    const ck_Model *model = &command->comparison->model;
    *goal = (ck_TuneGoal){.error = arguments->error, .stretch = arguments->stretch, .frame = 1e-3 * arguments->frame};
    if (arguments->like && arguments->target)
        return ck_fail(error, CK_BAD_INPUT, "--like and --target: an error has one goal; give one of them");
    if (arguments->target) return read_target(&goal->aim, arguments->target, model, error);
    return arguments->like ? read_like(goal, path, arguments->like, model, command->answer, error) : CK_OK;
}

// Settings as a scene file takes them, in the engine's own names.
static void show_settings(ck_Answer *answer, const ck_TunePoint *point, const ck_Engine *engine) {
    char text[600];
    size_t used = (size_t)snprintf(text, sizeof text, "settings:\n  %s: {", engine->name);
    const char *separator = "";
    for (const ck_Setting *row = engine->settings; row && row->name && used < sizeof text; row++) {
        if (!ck_settings_has(&point->settings, row->slot)) continue;
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s: %.9g", separator, row->name,
                                 ck_settings_get(&point->settings, row->slot));
        separator = ", ";
    }
    if (used < sizeof text) snprintf(text + used, sizeof text - used, "}\n");
    ck_answer_block(answer, "settings", text);
}

static int compare_work(const void *a, const void *b) {
    double x = (*(const ck_TunePoint *const *)a)->work, y = (*(const ck_TunePoint *const *)b)->work;
    return (x > y) - (x < y);
}

// What was tried and is the best for its work.
static ck_Status show_front(ck_Answer *answer, const ck_Tuning *tuning, const ck_Model *model, ck_Error *error) {
    static const ck_AnswerColumn columns[] = {{"substeps", "substeps", 9, "%.0f"},
                                              {"iterations", "iterations", 10, "%.0f"},
                                              {"sweeps_per_s", "sweeps/s", 10, "%.0f"},
                                              {"error", "error", 9, "%.2g"},
                                              {"stretch_max", "stretch", 9, "%.4f"},
                                              {"cpu_ms_per_frame", "ms/frame", 9, "%.3g"},
                                              {"chosen", "", 0, NULL},
                                              {NULL, NULL, 0, NULL}};
    const ck_TunePoint **front = malloc(sizeof(ck_TunePoint *) * (size_t)tuning->point_count);
    int count = 0;
    if (!front) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    for (int i = 0; i < tuning->point_count; i++)
        if (i == tuning->best_index || ck_tuning_is_on_front(tuning, i)) front[count++] = &tuning->points[i];
    qsort(front, (size_t)count, sizeof(ck_TunePoint *), compare_work);
    if (count) ck_answer_table(answer, "front", "The front of what was tried:", columns);
    for (int i = 0; i < count; i++) {
        const ck_TunePoint *point = front[i];
        const double numbers[] = {
            point->settings.substeps, point->settings.iterations, point->work,
            point->trial.error,       point->trial.stretch,       1e3 * ck_tune_frame_cost(point, model)};
        for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) ck_answer_number(answer, numbers[k]);
        ck_answer_text(answer, point == &tuning->points[tuning->best_index] ? "chosen" : "");
    }
    free(front);
    return CK_OK;
}

static void show_notes(ck_Answer *answer, const ck_Tuning *tuning, const ck_TuneOptions *options) {
    if (!tuning->meets) ck_answer_line(answer, CK_ANSWER_NOTE, "the goal is not met");
    if (tuning->is_late)
        ck_answer_line(answer, CK_ANSWER_NOTE,
                       "the search ended after %g s; --timeout gives it longer, and what was tried is not run again",
                       options->timeout);
    if (tuning->is_cheapest)
        ck_answer_line(answer, CK_ANSWER_NOTE,
                       "every cheaper pair of substeps and iterations was tried, and misses the goal");
    if (*tuning->bounds) ck_answer_line(answer, CK_ANSWER_NOTE, "%s", tuning->bounds);
    if (tuning->best.stiffness != 1)
        ck_answer_line(answer, CK_ANSWER_NOTE, "with stiffness, shear and bend of springs times %.6g",
                       tuning->best.stiffness);
    for (int i = 0; i < tuning->validation_count; i++) {
        const ck_Trial *trial = &tuning->validations[i].point.trial;
        ck_answer_line(answer, CK_ANSWER_NOTE, "on %s: error %.3g, stretch %.3g (%s)", tuning->validations[i].scene,
                       trial->error, trial->stretch, ck_run_status_names[trial->status]);
    }
}

static ck_Status show_tuning(const ck_StudyCommand *command, const ck_Tuning *tuning, const ck_TuneOptions *options,
                             ck_Error *error) {
    ck_Answer *answer = command->answer;
    const ck_Model *model = &command->comparison->model;
    const ck_TunePoint *best = &tuning->best;
    ck_Status status = show_front(answer, tuning, model, error);
    ck_answer_line(answer, CK_ANSWER_SAYS,
                   "%s on %s: error %.3g, stretch %.3g, %.3g ms a frame, %.4g sweeps a simulated second; %d settings "
                   "tried",
                   options->engine->name, model->name, best->trial.error, best->trial.stretch,
                   1e3 * ck_tune_frame_cost(best, model), best->work, tuning->point_count);
    show_notes(answer, tuning, options);
    show_settings(answer, best, options->engine);
    char sets[400] = "";
    size_t used = 0;
    for (const ck_Setting *row = options->engine->settings; row && row->name && used < sizeof sets; row++)
        if (ck_settings_has(&best->settings, row->slot))
            used += (size_t)snprintf(sets + used, sizeof sets - used, " --set %s.%s=%.9g", options->engine->name,
                                     row->name, ck_settings_get(&best->settings, row->slot));
    ck_answer_line(answer, CK_ANSWER_FILES, "%s/tune.csv", command->arguments->out);
    ck_answer_line(answer, CK_ANSWER_NEXT, "clothcheck run %s --engine %s%s", command->comparison->path,
                   options->engine->name, sets);
    if (ck_code_knows(options->engine, &command->comparison->model))
        ck_answer_line(answer, CK_ANSWER_NEXT, "clothcheck code %s --engine %s%s", command->comparison->path,
                       options->engine->name, sets);
    return status;
}

static ck_Status run(const ck_StudyCommand *command, ck_Error *error) {
    const ck_Arguments *arguments = command->arguments;
    if (arguments->options.engines != arguments->engines || arguments->options.engine_count != 1)
        return ck_fail(error, CK_BAD_INPUT, "tune needs one --engine NAME");
    ck_TuneOptions options = {
        .engine = arguments->engines[0],
        .validate = arguments->validate,
        .validate_count = arguments->validate_count,
        .directory = arguments->out,
        .question = command->question,
        .given = ck_comparison_settings(arguments->engines[0], &command->comparison->scene, &arguments->options),
        .limits = arguments->options.limits,
        .jobs = arguments->options.jobs,
        .timeout = arguments->timeout > 0 ? arguments->timeout : INFINITY,
        .progress = show};
    ck_Trajectory path = {0};
    ck_Tuning tuning = {0};
    ck_Csv csv = {0};
    char *cache = ck_path_join(arguments->out, "truths");
    options.cache = cache;
    ck_Status status = read_varied(&options, arguments, error);
    if (!status) status = read_goal(&options.goal, &path, command, error);
    if (!status) status = ck_study_command_open(command, &csv, CK_TUNE, error);
    if (!status) status = ck_tune_run(&tuning, command->comparison, &options, &csv, error);
    ck_progress_clear();
    if (!status) status = ck_csv_close(&csv, error);
    if (!status) status = show_tuning(command, &tuning, &options, error);
    ck_csv_discard(&csv);
    ck_tuning_free(&tuning);
    ck_trajectory_free(&path);
    free(cache);
    return status;
}

static int run_command(const ck_Command *command, int argc, char **argv) {
    return ck_study_command(command, CK_TUNE, argc, argv, run);
}

const ck_Command ck_command_tune = {
    .name = "tune",
    .arguments = "SCENE...",
    .about = "the cheapest settings within an error, or the closest to a goal: tune.csv",
    .help = "Searches substeps, iterations and relaxation of one --engine for the cheapest settings within --error or\n"
            "--stretch, for the least error at --max-frame-ms, or without a goal for the least error at all. The error "
            "is\nthe distance to the truth, or to what --like or --target say. Prints the front of what was tried and "
            "the best as lines\nof a scene file, and writes every evaluation to tune.csv. Work is sweeps over all "
            "springs, one more for each substep.",
    .groups = CK_TAKES_FORM | CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_KEEPING | CK_TAKES_GOAL | CK_TAKES_JOBS,
    .out = "out",
    .seconds = 60,
    .shares_out = true,
    .run = run_command,
};
