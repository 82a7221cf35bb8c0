// Many scenes and many values of their keys, from one file.
#include "asked_engines.h"
#include "change.h"
#include "command.h"
#include "files.h"
#include "names.h"
#include "process.h"
#include "slurm.h"
#include "sweeps.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct Study {
    ck_Arguments arguments;
    ck_Sweeps sweeps;
    char **paths; // of its scenes
    char *out;    // where --out does not say: out/NAME
} Study;

// A bare name as everywhere, or a path beside the study's file.
static ck_Status find_scene(char **path, const ck_StudyFile *file, const char *scene, ck_Error *error) {
    const char *end = strrchr(file->document.file, '/');
    char *beside = NULL;
    const size_t length = (size_t)ck_change_file_length(scene);
    const bool is_bare = !memchr(scene, '/', length) && !memchr(scene, '.', length);
    if (is_bare || *scene == '/' || !end) return ck_scene_path(path, scene, error);
    if (asprintf(&beside, "%.*s/%s", (int)(end - file->document.file), file->document.file, scene) < 0)
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Status status = ck_scene_path(path, beside, error);
    free(beside);
    return status;
}

static ck_Status find_scenes(Study *study, ck_Error *error) {
    study->paths = calloc((size_t)study->sweeps.file.scene_count + 1, sizeof *study->paths);
    if (!study->paths) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Status status = CK_OK;
    for (int i = 0; i < study->sweeps.file.scene_count && !status; i++)
        status = find_scene(&study->paths[i], &study->sweeps.file, study->sweeps.file.scenes[i], error);
    return status;
}

// Those of the file, where the command line names none.
static ck_Status find_engines(Study *study, ck_Error *error) {
    ck_Arguments *arguments = &study->arguments;
    const ck_StudyFile *file = &study->sweeps.file;
    ck_Status status = CK_OK;
    if (arguments->options.engines == arguments->engines) return CK_OK;
    for (int i = 0; i < file->engine_count && !status; i++)
        status = ck_arguments_add_engines(arguments, file->engines[i], error);
    return status;
}

// What a chart may be of: metrics and quantities by their names, numbers by their columns.
static bool is_charted(const ck_StudyFile *file, const char *metric) {
    static const ck_LayoutName layouts[CK_STUDY_RUNS] = {
        [CK_STUDY_COMPARE] = CK_RUNS, [CK_STUDY_TUNE] = CK_TUNE, [CK_STUDY_STABILITY] = CK_STABILITY};
    if (file->run == CK_STUDY_PRECISION)
        return !strncmp(metric, "cost_to_", 8) || !strcmp(metric, "order") || !strcmp(metric, "floor");
    if ((file->run == CK_STUDY_COMPARE || file->run == CK_STUDY_REFINE) && ck_metric_find(metric)) return true;
    if (file->run == CK_STUDY_COMPARE && !strcmp(metric, "cost")) return true;
    const bool has_layout = file->run == CK_STUDY_COMPARE || layouts[file->run];
    const ck_Layout *layout = &ck_layouts[layouts[file->run]];
    for (int i = 0; has_layout && i < ck_layout_column_count(layout); i++)
        if (layout->columns[i].kind == CK_COLUMN_NUMBER && !strcmp(layout->columns[i].name, metric)) return true;
    return false;
}

static ck_Status check_charts(const ck_StudyFile *file, ck_Error *error) {
    for (int i = 0; i < file->chart_count; i++)
        if (!is_charted(file, file->charts[i].metric))
            return ck_document_fail(&file->document, ck_document_find(&file->document, "charts"), error,
                                    "there is no chart of %s for %s; reports/studies/README.md tells what there is",
                                    file->charts[i].metric, ck_study_runs[file->run]);
    return CK_OK;
}

static ck_Status open_study(Study *study, ck_Error *error) {
    ck_Arguments *arguments = &study->arguments;
    if (arguments->word_count != 1)
        return ck_fail(error, CK_BAD_INPUT, "study takes one FILE; %d are given", arguments->word_count);
    ck_Status status = ck_study_file_load(&study->sweeps.file, arguments->words[0], error);
    if (!status) status = check_charts(&study->sweeps.file, error);
    if (!status) status = find_scenes(study, error);
    if (!status) status = find_engines(study, error);
    if (status) return status;
    if (arguments->out == arguments->command->out) {
        study->out = ck_path_join(arguments->command->out, study->sweeps.file.name);
        if (!study->out) return ck_fail(error, CK_NO_MEMORY, "out of memory");
        arguments->out = study->out;
    }
    arguments->options.repeats = study->sweeps.file.repeats < 0 ? 1 : study->sweeps.file.repeats;
    snprintf(study->sweeps.again, sizeof study->sweeps.again, "clothcheck study %s --out %s", arguments->words[0],
             arguments->out);
    study->sweeps.arguments = arguments;
    study->sweeps.paths = study->paths;
    return ck_sweeps_open(&study->sweeps, error);
}

// The words of this command for another process.
static size_t write_words(char *line, size_t size, const Study *study) {
    const ck_Arguments *arguments = &study->arguments;
    size_t used = (size_t)snprintf(line, size, "study ");
    used += ck_text_shell(line + used, size - used, arguments->words[0]);
    used += (size_t)snprintf(line + used, size - used, " --out ");
    used += ck_text_shell(line + used, size - used, arguments->out);
    used += (size_t)snprintf(line + used, size - used, " --time-limit %g --memory-limit %zu --case-limit %g",
                             arguments->options.limits.seconds, arguments->options.limits.memory_bytes >> 20,
                             arguments->case_limit);
    for (int i = 0;
         arguments->options.engines == arguments->engines && i < arguments->options.engine_count && used < size; i++) {
        const ck_Engine *engine = arguments->engines[i];
        used += (size_t)snprintf(line + used, size - used, " %s%s", engine->outside ? "" : "-e ",
                                 engine->outside ? engine->outside->arguments : engine->name);
    }
    return used < size ? used : size - 1;
}

// Adds an option and its word, quoted; nothing without one. Returns how long the line is.
static size_t add_word(char *line, size_t size, size_t used, const char *option, const char *word) {
    if (!word || used >= size) return used;
    used += (size_t)snprintf(line + used, size - used, " %s ", option);
    return used < size ? used + ck_text_shell(line + used, size - used, word) : size - 1;
}

// The scripts, and their jobs.
static ck_Status use_slurm(Study *study, ck_Error *error) {
    ck_Arguments *arguments = &study->arguments;
    char part[8192], end[8192], *folder = ck_sweep_folder(arguments->out);
    size_t used = write_words(part, sizeof part, study);
    snprintf(part + used, sizeof part - used, " --part --jobs %d", arguments->cores);
    used = write_words(end, sizeof end, study);
    used += (size_t)snprintf(end + used, sizeof end - used, " --finish --array %d --cores %d", arguments->array,
                             arguments->cores);
    if (arguments->array_limit)
        used += (size_t)snprintf(end + used, sizeof end - used, " --array-limit %d", arguments->array_limit);
    used = add_word(end, sizeof end, used, "--partition", arguments->partition);
    add_word(end, sizeof end, used, "--slurm-time", arguments->slurm_time);
    const ck_SlurmOptions options = {.name = study->sweeps.file.name,
                                     .folder = folder,
                                     .partition = arguments->partition,
                                     .time = arguments->slurm_time,
                                     .array = arguments->array,
                                     .limit = arguments->array_limit,
                                     .cores = arguments->cores,
                                     .part = part,
                                     .end = end};
    ck_Status status = folder ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    // a line that was cut would be another command
    if (!status && (strlen(part) + 1 == sizeof part || strlen(end) + 1 == sizeof end))
        status = ck_fail(error, CK_BAD_INPUT, "the command line of a part is longer than %zu characters", sizeof part);
    for (int i = 0; i < 2 && arguments->is_dry && !status; i++) {
        char *text = ck_slurm_script(&options, i);
        if (text) ck_answer_block(&arguments->answer, i ? "results_script" : "part_script", text);
        free(text);
    }
    if (!status && !arguments->is_dry) {
        long jobs[2];
        status = ck_slurm_submit(&options, jobs, error);
        if (!status) {
            ck_answer_line(&arguments->answer, CK_ANSWER_SAYS,
                           "%s: %d cases in an array of %d parts, job %ld; job %ld writes the results when they have "
                           "ended",
                           study->sweeps.file.name, study->sweeps.sweep.case_count, arguments->array, jobs[0], jobs[1]);
            ck_answer_line(&arguments->answer, CK_ANSWER_NEXT, "squeue --job %ld,%ld", jobs[0], jobs[1]);
        }
    }
    free(folder);
    return status;
}

// Of each study.
#define SLURM_DONE "slurm_done-%016llx"

// One that is submitted by hand begins anew.
static void forget_array(const Study *study) {
    char *path;
    if (asprintf(&path, "%s/study/" SLURM_DONE, study->arguments.out, (unsigned long long)study->sweeps.sweep.study) <
        0)
        return;
    unlink(path);
    free(path);
}

// How far the array before came, so that one that gets nowhere is not submitted for ever.
static ck_Status submit_again(Study *study, int done, ck_Error *error) {
    char *folder = ck_sweep_folder(study->arguments.out), name[60];
    snprintf(name, sizeof name, SLURM_DONE, (unsigned long long)study->sweeps.sweep.study);
    char *path = folder ? ck_path_join(folder, name) : NULL;
    char *text = NULL;
    size_t size;
    const int before = path && !ck_file_read(&text, &size, path, NULL) ? atoi(text) : -1;
    ck_WholeFile whole = {0};
    ck_Status status = CK_OK;
    if (done <= before)
        status = ck_fail(
            error, CK_IO, "%s: %d of %d cases are missing, and the last array did none of them; see %s/slurm-*.log",
            study->sweeps.file.name, study->sweeps.sweep.case_count - done, study->sweeps.sweep.case_count, folder);
    if (!status) status = ck_whole_file_open(&whole, folder, name, error);
    if (!status) fprintf(whole.file, "%d\n", done);
    if (!status) status = ck_whole_file_close(&whole, error);
    ck_whole_file_discard(&whole);
    if (!status) status = use_slurm(study, error);
    free(text);
    free(path);
    free(folder);
    return status;
}

static ck_Status run_study(Study *study, ck_Error *error) {
    ck_Arguments *arguments = &study->arguments;
    ck_SweepProgress progress;
    if (arguments->uses_slurm && !arguments->is_dry) forget_array(study);
    if (arguments->uses_slurm) return use_slurm(study, error);
    if (arguments->is_dry) {
        ck_answer_line(&arguments->answer, CK_ANSWER_SAYS, "%s: %d points, %d engines, %d cases, %d of them truths",
                       study->sweeps.file.name, study->sweeps.sweep.point_count, arguments->options.engine_count,
                       study->sweeps.sweep.case_count, study->sweeps.sweep.truth_count);
        return CK_OK;
    }
    if (arguments->runs_nothing) return ck_sweeps_write(&study->sweeps, error);
    // the last job of an array only looks what is there
    if (arguments->finishes) study->sweeps.options.jobs = 0;
    ck_Status status = ck_sweep_run(&study->sweeps.sweep, &progress, error);
    if (status) return status;
    if (arguments->finishes && progress.done < progress.all) return submit_again(study, progress.done, error);
    return ck_sweeps_end(&study->sweeps, &progress, error);
}

static int run(const ck_Command *command, int argc, char **argv) {
    Study *study = calloc(1, sizeof *study);
    ck_Error error = {0};
    if (!study) return ck_command_fail(ck_fail(&error, CK_NO_MEMORY, "out of memory"), &error);
    ck_Status status = ck_arguments_read(&study->arguments, command, argc, argv, &error);
    ck_command_catch_signals();
    if (!status) status = open_study(study, &error);
    if (!status) status = run_study(study, &error);
    for (int i = 0; study->paths && i < study->sweeps.file.scene_count; i++) free(study->paths[i]);
    free(study->paths);
    ck_sweeps_free(&study->sweeps);
    char *out = study->out;
    const int ended = ck_command_end(&study->arguments, status, &error);
    free(out);
    free(study);
    return ended;
}

const ck_Command ck_command_study = {
    .name = "study",
    .arguments = "FILE",
    .about = "many scenes and values of their keys, from one file; on a cluster, too",
    .help = "Runs what a study's file says (reports/studies/README.md): scenes, values of their keys, engines, and "
            "compare, "
            "precision,\nstability, tune, needs, refine or conform at each point. Cases are kept in OUT/study: a study "
            "that was killed, or\ngiven more values, runs what is missing, and several processes on one OUT share the "
            "work. The CSVs are those of the\ncommand, with a column for each key.",
    .groups = CK_TAKES_FORM | CK_TAKES_OUT | CK_TAKES_JOBS | CK_TAKES_SHARD | CK_TAKES_STUDY,
    .out = "out",
    .seconds = 300,
    .shares_out = true,
    .run = run,
};
