// Many scenes and many values of their keys, from one file.
#include "asked_engines.h"
#include "change.h"
#include "command.h"
#include "csv_reader.h"
#include "files.h"
#include "names.h"
#include "process.h"
#include "slurm.h"
#include "store.h"
#include "sweep.h"

#include <errno.h>
#include <ftw.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct Study {
    ck_Arguments arguments;
    ck_StudyFile file;
    char **paths; // of its scenes
    char *out;    // where --out does not say: out/NAME
    ck_SweepOptions options;
    ck_Sweep sweep;
} Study;

// What is run at a point that is not compare: the program's own command.
static int run_words(int count, char **words) {
    static const ck_Command *const commands[] = {&ck_command_precision, &ck_command_stability, &ck_command_tune,
                                                 &ck_command_needs,     &ck_command_refine,    &ck_command_conform};
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (!strcmp(commands[i]->name, words[0])) return commands[i]->run(commands[i], count, words);
    return CK_EXIT_USAGE;
}

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
    study->paths = calloc((size_t)study->file.scene_count + 1, sizeof *study->paths);
    if (!study->paths) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Status status = CK_OK;
    for (int i = 0; i < study->file.scene_count && !status; i++)
        status = find_scene(&study->paths[i], &study->file, study->file.scenes[i], error);
    return status;
}

static ck_Status find_engines(Study *study, ck_Error *error) {
    ck_Arguments *arguments = &study->arguments;
    ck_Status status = CK_OK;
    for (int i = 0; i < study->file.engine_count && arguments->options.engines != arguments->engines && !status; i++)
        for (; i < study->file.engine_count && !status; i++)
            status = ck_arguments_add_engines(arguments, study->file.engines[i], error);
    return status;
}

static ck_Status check_charts(const ck_StudyFile *file, ck_Error *error) {
    for (int i = 0; i < file->chart_count; i++)
        if (!ck_metric_find(file->charts[i].metric))
            return ck_document_fail(&file->document, ck_document_find(&file->document, "charts"), error,
                                    "there is no metric %s; 'clothcheck list' tells them", file->charts[i].metric);
    return CK_OK;
}

static ck_Status open_study(Study *study, ck_Error *error) {
    ck_Arguments *arguments = &study->arguments;
    if (arguments->word_count != 1)
        return ck_fail(error, CK_BAD_INPUT, "study takes one FILE; %d are given", arguments->word_count);
    ck_Status status = ck_study_file_load(&study->file, arguments->words[0], error);
    if (!status) status = check_charts(&study->file, error);
    if (!status) status = find_scenes(study, error);
    if (!status) status = find_engines(study, error);
    if (status) return status;
    if (arguments->out == arguments->command->out) {
        study->out = ck_path_join(arguments->command->out, study->file.name);
        if (!study->out) return ck_fail(error, CK_NO_MEMORY, "out of memory");
        arguments->out = study->out;
    }
    arguments->options.repeats = study->file.repeats;
    const int jobs = arguments->options.jobs, cores = (int)sysconf(_SC_NPROCESSORS_ONLN);
    study->options = (ck_SweepOptions){.file = &study->file,
                                       .paths = study->paths,
                                       .compare = &arguments->options,
                                       .directory = arguments->out,
                                       .command = run_words,
                                       .jobs = jobs        ? jobs
                                               : cores > 0 ? cores
                                                           : 1,
                                       .shard = arguments->shard,
                                       .shards = arguments->shards,
                                       .case_limit = arguments->case_limit,
                                       .timeout = arguments->study_timeout,
                                       .is_part = arguments->is_part};
    return ck_sweep_create(&study->sweep, &study->options, error);
}

static int remove_entry(const char *path, const struct stat *about, int type, struct FTW *place) {
    (void)about, (void)type, (void)place;
    return remove(path);
}

// What a folder holds already: cases of this study or of another one stay, results of other commands would be lost.
static ck_Status check_folder(const Study *study, ck_Error *error) {
    const char *out = study->arguments.out;
    char *folder = ck_sweep_folder(out), *runs = ck_path_join(out, ck_layouts[CK_RUNS].file);
    ck_Status status = folder && runs ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Board board = {.file = -1};
    if (!status && study->arguments.forces && !access(folder, F_OK)) {
        status = ck_board_open(&board, folder, study->sweep.study, error);
        if (!status && !ck_board_is_free(&board))
            status = ck_fail(error, CK_BAD_INPUT, "%s: this study is running there; wait, or give another --out", out);
        ck_board_close(&board);
        if (!status) nftw(folder, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
    } else if (!status && access(folder, F_OK) && !access(runs, F_OK) && !study->arguments.forces)
        status = ck_fail(error, CK_BAD_INPUT,
                         "%s: holds results that are of no study, which would be lost; --force replaces them, another "
                         "--out leaves them",
                         runs);
    free(folder);
    free(runs);
    return status;
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
    if (arguments->partition)
        used += (size_t)snprintf(end + used, sizeof end - used, " --partition %s", arguments->partition);
    if (arguments->slurm_time) snprintf(end + used, sizeof end - used, " --slurm-time %s", arguments->slurm_time);
    const ck_SlurmOptions options = {.name = study->file.name,
                                     .folder = folder,
                                     .partition = arguments->partition,
                                     .time = arguments->slurm_time,
                                     .array = arguments->array,
                                     .limit = arguments->array_limit,
                                     .cores = arguments->cores,
                                     .part = part,
                                     .end = end};
    ck_Status status = folder ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
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
                           study->file.name, study->sweep.case_count, arguments->array, jobs[0], jobs[1]);
            ck_answer_line(&arguments->answer, CK_ANSWER_NEXT, "squeue --job %ld,%ld", jobs[0], jobs[1]);
        }
    }
    free(folder);
    return status;
}

// How far the array before came, so that one that gets nowhere is not submitted for ever.
static ck_Status submit_again(Study *study, int done, ck_Error *error) {
    char *folder = ck_sweep_folder(study->arguments.out), *path = folder ? ck_path_join(folder, "slurm_done") : NULL;
    char *text = NULL;
    size_t size;
    const int before = path && !ck_file_read(&text, &size, path, NULL) ? atoi(text) : -1;
    ck_WholeFile whole = {0};
    ck_Status status = CK_OK;
    if (done <= before)
        status = ck_fail(error, CK_IO,
                         "%s: %d of %d cases are missing, and the last array did none of them; see %s/slurm-*.log",
                         study->file.name, study->sweep.case_count - done, study->sweep.case_count, folder);
    if (!status) status = ck_whole_file_open(&whole, folder, "slurm_done", error);
    if (!status) fprintf(whole.file, "%d\n", done);
    if (!status) status = ck_whole_file_close(&whole, error);
    ck_whole_file_discard(&whole);
    if (!status) status = use_slurm(study, error);
    free(text);
    free(path);
    free(folder);
    return status;
}

// How many cases ended how.
static ck_Status answer_cases(Study *study, ck_Error *error) {
    ck_Answer *answer = &study->arguments.answer;
    ck_CsvTable table = {0};
    int counts[CK_RUN_STATUS_COUNT] = {0};
    double cost = 0;
    ck_Status status = ck_csv_table_read(&table, study->arguments.out, &ck_layouts[CK_STUDY], error);
    for (int i = 0; i < table.row_count && !status; i++) {
        for (int k = 0; k < CK_RUN_STATUS_COUNT; k++)
            counts[k] += !strcmp(ck_csv_text_of(&table, i, "status"), ck_run_status_names[k]);
        cost += ck_csv_number_of(&table, i, "cost_s");
    }
    char text[300] = "";
    for (int k = 0; k < CK_RUN_STATUS_COUNT; k++)
        if (counts[k])
            snprintf(text + strlen(text), sizeof text - strlen(text), "%s%d %s", *text ? ", " : "", counts[k],
                     ck_run_status_names[k]);
    if (!status)
        ck_answer_line(answer, CK_ANSWER_SAYS, "%s: %d cases at %d point%s, %.3g s of work: %s", study->file.name,
                       table.row_count, study->sweep.point_count, study->sweep.point_count == 1 ? "" : "s", cost, text);
    ck_csv_table_free(&table);
    return status;
}

// The most points of which a table is printed, and engines of its columns.
#define MOST_ROWS 40
#define MOST_COLUMNS 8

// The number of an engine's metric at a point, by the names of both.
static double find_value(const ck_CsvTable *table, const ck_StudyChart *chart, const char *scene, const char *engine) {
    for (int i = 0; i < table->row_count; i++)
        if (!strcmp(ck_csv_text_of(table, i, "engine"), engine) && !strcmp(ck_csv_text_of(table, i, "scene"), scene) &&
            !strcmp(ck_csv_text_of(table, i, "metric"), chart->metric))
            return ck_csv_number_of(table, i, chart->of);
    return NAN;
}

static ck_Status answer_chart(Study *study, const ck_StudyChart *chart, ck_Error *error) {
    ck_Answer *answer = &study->arguments.answer;
    const ck_CompareOptions *options = &study->arguments.options;
    ck_AnswerColumn columns[MOST_COLUMNS + 2] = {{"scene", "", -56, NULL}};
    const int engines = options->engine_count < MOST_COLUMNS ? options->engine_count : MOST_COLUMNS;
    ck_CsvTable table = {0};
    char title[200], name[300], word[CK_SWEEP_WORD];
    for (int i = 0; i < engines; i++)
        columns[1 + i] = (ck_AnswerColumn){options->engines[i]->name, options->engines[i]->name, 15, "%.3g"};
    snprintf(title, sizeof title, "%s%s:", chart->metric, strcmp(chart->of, "error") ? "" : ", distance to the truth");
    ck_Status status = ck_csv_table_read(&table, study->arguments.out, &ck_layouts[CK_METRICS], error);
    if (!status) ck_answer_table(answer, "chart", title, columns);
    for (int i = 0; i < study->sweep.point_count && !status; i++) {
        ck_Scene scene;
        ck_sweep_word(&study->sweep, i, word);
        ck_Status loaded = ck_scene_load(&scene, word, NULL);
        snprintf(name, sizeof name, "%.290s", loaded ? word : scene.file->name);
        ck_scene_free(&scene);
        ck_answer_text(answer, name);
        for (int k = 0; k < engines; k++)
            ck_answer_number(answer, find_value(&table, chart, name, options->engines[k]->name));
    }
    ck_answer_gap(answer);
    ck_csv_table_free(&table);
    return status;
}

static ck_Status answer(Study *study, ck_Error *error) {
    ck_Arguments *arguments = &study->arguments;
    ck_Status status = CK_OK;
    if (study->file.run == CK_STUDY_COMPARE && study->sweep.point_count <= MOST_ROWS)
        for (int i = 0; i < study->file.chart_count && !status; i++)
            status = answer_chart(study, &study->file.charts[i], error);
    if (!status) status = answer_cases(study, error);
    if (!status && study->file.run == CK_STUDY_COMPARE && study->sweep.point_count <= MOST_ROWS)
        status = ck_answer_findings(arguments, NULL, error);
    ck_answer_line(&arguments->answer, CK_ANSWER_FILES, "%s", arguments->out);
    ck_answer_line(&arguments->answer, CK_ANSWER_NEXT, "clothcheck report %s", arguments->out);
    return status;
}

// The results are written by one process; the others then find them written.
static ck_Status write_results(Study *study, ck_Error *error) {
    char *folder = ck_sweep_folder(study->arguments.out);
    ck_Board board = {.file = -1};
    ck_Status status = folder ? ck_board_open(&board, folder, study->sweep.study, error)
                              : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status && !ck_board_lock_results(&board, study->sweep.case_count))
        status = ck_fail(error, CK_IO, "%s: cannot be locked", board.path);
    if (!status) status = ck_sweep_write(&study->sweep, error);
    ck_board_close(&board);
    free(folder);
    return status ? status : answer(study, error);
}

static void say_rest(Study *study, const ck_SweepProgress *progress) {
    ck_Arguments *arguments = &study->arguments;
    ck_answer_line(&arguments->answer, CK_ANSWER_SAYS, "%s: %d of %d cases are done", study->file.name, progress->done,
                   progress->all);
    if (arguments->shards > 1)
        ck_answer_line(&arguments->answer, CK_ANSWER_NEXT, "clothcheck merge OUT %s ...", arguments->out);
    else
        ck_answer_line(&arguments->answer, CK_ANSWER_NEXT, "clothcheck study %s --out %s", arguments->words[0],
                       arguments->out);
}

static ck_Status run_study(Study *study, ck_Error *error) {
    ck_Arguments *arguments = &study->arguments;
    ck_SweepProgress progress;
    if (arguments->uses_slurm) return use_slurm(study, error);
    if (arguments->is_dry) {
        ck_answer_line(&arguments->answer, CK_ANSWER_SAYS, "%s: %d points, %d engines, %d cases, %d of them truths",
                       study->file.name, study->sweep.point_count, arguments->options.engine_count,
                       study->sweep.case_count, study->sweep.truth_count);
        return CK_OK;
    }
    if (arguments->runs_nothing) return write_results(study, error);
    // the last job of an array only looks what is there
    if (arguments->finishes) study->options.jobs = 0;
    ck_Status status = ck_sweep_run(&study->sweep, &progress, error);
    if (status) return status;
    if (arguments->finishes && progress.done < progress.all) return submit_again(study, progress.done, error);
    if (arguments->is_part || arguments->shards > 1 || progress.done < progress.all) {
        say_rest(study, &progress);
        return CK_OK;
    }
    return write_results(study, error);
}

static int run(const ck_Command *command, int argc, char **argv) {
    Study *study = calloc(1, sizeof *study);
    ck_Error error = {0};
    if (!study) return ck_command_fail(ck_fail(&error, CK_NO_MEMORY, "out of memory"), &error);
    ck_Status status = ck_arguments_read(&study->arguments, command, argc, argv, &error);
    ck_command_catch_signals();
    if (!status) status = open_study(study, &error);
    if (!status && !study->arguments.is_dry) status = check_folder(study, &error);
    if (!status) status = run_study(study, &error);
    ck_sweep_free(&study->sweep);
    for (int i = 0; study->paths && i < study->file.scene_count; i++) free(study->paths[i]);
    free(study->paths);
    ck_study_file_free(&study->file);
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
    .run = run,
};
