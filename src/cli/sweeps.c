#include "sweeps.h"

#include "csv_reader.h"
#include "files.h"
#include "store.h"

#include <ftw.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// What is run at a point that is not compare: the program's own command.
static int run_words(int count, char **words) {
    static const ck_Command *const commands[] = {&ck_command_precision, &ck_command_stability, &ck_command_tune,
                                                 &ck_command_needs,     &ck_command_refine,    &ck_command_conform};
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (!strcmp(commands[i]->name, words[0])) return commands[i]->run(commands[i], count, words);
    return CK_EXIT_USAGE;
}

static int remove_entry(const char *path, const struct stat *about, int type, struct FTW *place) {
    (void)about, (void)type, (void)place;
    return remove(path);
}

// What a folder holds already: cases of this study or of another one stay, results of other commands would be lost.
static ck_Status check_folder(const ck_Sweeps *sweeps, ck_Error *error) {
    const char *out = sweeps->arguments->out;
    char *folder = ck_sweep_folder(out), *runs = ck_path_join(out, ck_layouts[CK_RUNS].file);
    ck_Status status = folder && runs ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Board board = {.file = -1};
    if (!status && sweeps->arguments->forces && !access(folder, F_OK)) {
        status = ck_board_open(&board, folder, sweeps->sweep.study, error);
        if (!status && !ck_board_is_free(&board))
            status = ck_fail(error, CK_BAD_INPUT, "%s: this study is running there; wait, or give another --out", out);
        ck_board_close(&board);
        if (!status) nftw(folder, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
    } else if (!status && access(folder, F_OK) && !access(runs, F_OK) && !sweeps->arguments->forces)
        status = ck_fail(error, CK_BAD_INPUT,
                         "%s: holds results that are of no study, which would be lost; --force replaces them, another "
                         "--out leaves them",
                         runs);
    free(folder);
    free(runs);
    return status;
}

// How many cases ended how.
static ck_Status answer_cases(ck_Sweeps *sweeps, ck_Error *error) {
    ck_Answer *answer = &sweeps->arguments->answer;
    ck_CsvTable table = {0};
    int counts[CK_RUN_STATUS_COUNT] = {0};
    double cost = 0;
    ck_Status status = ck_csv_table_read(&table, sweeps->arguments->out, &ck_layouts[CK_STUDY], error);
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
        ck_answer_line(answer, CK_ANSWER_SAYS, "%s: %d cases at %d point%s, %.3g s of work: %s", sweeps->file.name,
                       table.row_count, sweeps->sweep.point_count, sweeps->sweep.point_count == 1 ? "" : "s", cost,
                       text);
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

static ck_Status answer_chart(ck_Sweeps *sweeps, const ck_StudyChart *chart, ck_Error *error) {
    ck_Answer *answer = &sweeps->arguments->answer;
    const ck_CompareOptions *options = &sweeps->arguments->options;
    ck_AnswerColumn columns[MOST_COLUMNS + 2] = {{"scene", "", -56, NULL}};
    const int engines = options->engine_count < MOST_COLUMNS ? options->engine_count : MOST_COLUMNS;
    ck_CsvTable table = {0};
    char title[200], name[300], word[CK_SWEEP_WORD];
    for (int i = 0; i < engines; i++)
        columns[1 + i] = (ck_AnswerColumn){options->engines[i]->name, options->engines[i]->name, 15, "%.3g"};
    snprintf(title, sizeof title, "%s%s:", chart->metric, strcmp(chart->of, "error") ? "" : ", distance to the truth");
    ck_Status status = ck_csv_table_read(&table, sweeps->arguments->out, &ck_layouts[CK_METRICS], error);
    if (!status) ck_answer_table(answer, "chart", title, columns);
    for (int i = 0; i < sweeps->sweep.point_count && !status; i++) {
        ck_Scene scene;
        ck_sweep_word(&sweeps->sweep, i, word);
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

static ck_Status answer(ck_Sweeps *sweeps, ck_Error *error) {
    ck_Arguments *arguments = sweeps->arguments;
    ck_Status status = CK_OK;
    if (sweeps->file.run == CK_STUDY_COMPARE && sweeps->sweep.point_count <= MOST_ROWS)
        for (int i = 0; i < sweeps->file.chart_count && !status; i++)
            status = answer_chart(sweeps, &sweeps->file.charts[i], error);
    if (!status) status = answer_cases(sweeps, error);
    if (!status && sweeps->file.run == CK_STUDY_COMPARE && sweeps->sweep.point_count <= MOST_ROWS)
        status = ck_answer_findings(arguments, NULL, error);
    ck_answer_line(&arguments->answer, CK_ANSWER_FILES, "%s", arguments->out);
    ck_answer_line(&arguments->answer, CK_ANSWER_NEXT, "clothcheck report %s", arguments->out);
    return status;
}

// The results are written by one process; the others then find them written.
static ck_Status write_results(ck_Sweeps *sweeps, ck_Error *error) {
    char *folder = ck_sweep_folder(sweeps->arguments->out);
    ck_Board board = {.file = -1};
    ck_Status status = folder ? ck_board_open(&board, folder, sweeps->sweep.study, error)
                              : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status && !ck_board_lock_results(&board, sweeps->sweep.case_count))
        status = ck_fail(error, CK_IO, "%s: cannot be locked", board.path);
    if (!status) status = ck_sweep_write(&sweeps->sweep, error);
    ck_board_close(&board);
    free(folder);
    return status ? status : answer(sweeps, error);
}

static void say_rest(ck_Sweeps *sweeps, const ck_SweepProgress *progress) {
    ck_Arguments *arguments = sweeps->arguments;
    ck_answer_line(&arguments->answer, CK_ANSWER_SAYS, "%s: %d of %d cases are done", sweeps->file.name, progress->done,
                   progress->all);
    if (arguments->shards > 1)
        ck_answer_line(&arguments->answer, CK_ANSWER_NEXT, "clothcheck merge OUT %s ...", arguments->out);
    else
        ck_answer_line(&arguments->answer, CK_ANSWER_NEXT, "%s", sweeps->again);
}

ck_Status ck_sweeps_open(ck_Sweeps *sweeps, ck_Error *error) {
    ck_Arguments *arguments = sweeps->arguments;
    const int jobs = arguments->options.jobs, cores = (int)sysconf(_SC_NPROCESSORS_ONLN);
    // what is timed is not run side by side
    const bool is_timed = sweeps->file.run == CK_STUDY_PRECISION || sweeps->file.run == CK_STUDY_NEEDS;
    sweeps->options = (ck_SweepOptions){.file = &sweeps->file,
                                        .paths = sweeps->paths,
                                        .compare = &arguments->options,
                                        .directory = arguments->out,
                                        .command = run_words,
                                        .jobs = jobs                    ? jobs
                                                : is_timed || cores < 1 ? 1
                                                                        : cores,
                                        .shard = arguments->shard,
                                        .shards = arguments->shards,
                                        .case_limit = arguments->case_limit,
                                        .timeout = arguments->study_timeout,
                                        .is_part = arguments->is_part,
                                        .is_by_point = sweeps->is_by_point};
    ck_Status status = ck_sweep_create(&sweeps->sweep, &sweeps->options, error);
    return status || arguments->is_dry ? status : check_folder(sweeps, error);
}

ck_Status ck_sweeps_end(ck_Sweeps *sweeps, const ck_SweepProgress *progress, ck_Error *error) {
    const ck_Arguments *arguments = sweeps->arguments;
    if (!arguments->is_part && arguments->shards <= 1 && progress->done == progress->all)
        return write_results(sweeps, error);
    say_rest(sweeps, progress);
    return CK_OK;
}

ck_Status ck_sweeps_write(ck_Sweeps *sweeps, ck_Error *error) {
    return write_results(sweeps, error);
}

void ck_sweeps_free(ck_Sweeps *sweeps) {
    ck_sweep_free(&sweeps->sweep);
    ck_study_file_free(&sweeps->file);
}

// The words of a command line that say what is asked, without engines, which are asked for by name.
static ck_Status take_options(ck_StudyFile *file, const char *question, ck_Error *error) {
    char *words = strdup(question), *rest = words;
    if (!words) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    file->options = calloc(strlen(question) + 1, sizeof *file->options);
    strsep(&rest, "\t"); // the command
    for (char *word; file->options && (word = strsep(&rest, "\t"));) {
        if (!strcmp(word, "--engine")) {
            strsep(&rest, "\t");
            continue;
        }
        char *copy = strdup(word);
        if (copy) file->options[file->option_count++] = copy;
    }
    free(words);
    return file->options ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
}

static ck_Status take_scenes(ck_Sweeps *sweeps, ck_StudyRun run, ck_Error *error) {
    ck_Arguments *arguments = sweeps->arguments;
    ck_StudyFile *file = &sweeps->file;
    file->run = run;
    file->name = strdup(ck_study_runs[run]);
    file->document.path = strdup(ck_study_runs[run]);
    file->scenes = calloc((size_t)arguments->scene_count, sizeof *file->scenes);
    if (!file->name || !file->document.path || !file->scenes) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    size_t used = (size_t)snprintf(sweeps->again, sizeof sweeps->again, "clothcheck %s", file->name);
    for (int i = 0; i < arguments->scene_count; i++) {
        file->scenes[i] = strdup(arguments->scenes[i]);
        if (!file->scenes[i]) return ck_fail(error, CK_NO_MEMORY, "out of memory");
        file->scene_count++;
        if (used < sizeof sweeps->again)
            used += (size_t)snprintf(sweeps->again + used, sizeof sweeps->again - used, " %s", arguments->scenes[i]);
    }
    if (used < sizeof sweeps->again)
        snprintf(sweeps->again + used, sizeof sweeps->again - used, " --out %s", arguments->out);
    sweeps->paths = arguments->scenes;
    return take_options(file, arguments->question, error);
}

int ck_sweeps_of_scenes(ck_Arguments *arguments, ck_StudyRun run) {
    ck_Sweeps *sweeps = calloc(1, sizeof *sweeps);
    ck_Error error = {0};
    ck_SweepProgress progress;
    ck_Status status = sweeps ? CK_OK : ck_fail(&error, CK_NO_MEMORY, "out of memory");
    if (!status) {
        sweeps->arguments = arguments;
        sweeps->is_by_point = true;
        status = take_scenes(sweeps, run, &error);
    }
    ck_command_catch_signals();
    if (!status) status = ck_sweeps_open(sweeps, &error);
    if (!status && arguments->runs_nothing)
        status = ck_sweeps_write(sweeps, &error);
    else if (!status) {
        status = ck_sweep_run(&sweeps->sweep, &progress, &error);
        if (!status) status = ck_sweeps_end(sweeps, &progress, &error);
    }
    if (sweeps) ck_sweeps_free(sweeps);
    free(sweeps);
    return ck_command_end(arguments, status, &error);
}
