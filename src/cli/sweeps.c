#include "sweeps.h"

#include "csv_reader.h"
#include "files.h"
#include "store.h"

#include <fcntl.h>
#include <glob.h>
#include <limits.h>
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

// True where no process has a case of any study in a folder.
static bool is_idle(const char *folder) {
    glob_t found;
    char pattern[PATH_MAX];
    bool is = true;
    snprintf(pattern, sizeof pattern, "%s/board-*", folder);
    if (glob(pattern, 0, NULL, &found)) found.gl_pathc = 0;
    for (size_t i = 0; i < found.gl_pathc && is; i++) {
        const ck_Board board = {.file = open(found.gl_pathv[i], O_RDWR | O_CLOEXEC)};
        is = board.file < 0 || ck_board_is_free(&board);
        if (board.file >= 0) close(board.file);
    }
    if (found.gl_pathc) globfree(&found);
    return is;
}

// The first CSV of a report that is there.
static const char *find_results(const char *out) {
    for (int i = 0; i < CK_REPORT_LAYOUTS; i++) {
        char *path = ck_path_join(out, ck_layouts[i].file);
        const bool is_there = path && i != CK_MACHINE && !access(path, F_OK);
        free(path);
        if (is_there) return ck_layouts[i].file;
    }
    return NULL;
}

// What a folder holds already: cases of this study or of another one stay, results of other commands would be lost.
static ck_Status check_folder(const ck_Sweeps *sweeps, ck_Error *error) {
    const ck_Arguments *arguments = sweeps->arguments;
    const char *out = arguments->out, *results = find_results(out);
    char *folder = ck_sweep_folder(out);
    if (!folder) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    const bool has_cases = !access(folder, F_OK);
    ck_Status status = CK_OK;
    if (arguments->forces && arguments->runs_nothing)
        status =
            ck_fail(error, CK_BAD_INPUT, "--kept writes what is there, and --force removes it: give one of the two");
    else if (arguments->forces && has_cases && !is_idle(folder))
        status = ck_fail(error, CK_BAD_INPUT, "%s: a study is running there; wait, or give another --out", out);
    else if (arguments->forces && has_cases)
        ck_path_remove(folder);
    else if (results && !has_cases && !arguments->forces)
        status = ck_fail(error, CK_BAD_INPUT,
                         "%s/%s: holds results that are of no study, which would be lost; --force replaces them, "
                         "another --out leaves them",
                         out, results);
    free(folder);
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
    static ck_AnswerColumn columns[MOST_COLUMNS + 2]; // which must outlive the answer
    const int engines = options->engine_count < MOST_COLUMNS ? options->engine_count : MOST_COLUMNS;
    ck_CsvTable table = {0};
    char title[200], name[CK_SWEEP_NAME];
    columns[0] = (ck_AnswerColumn){"scene", "", -56, NULL};
    for (int i = 0; i < engines; i++)
        columns[1 + i] = (ck_AnswerColumn){options->engines[i]->name, options->engines[i]->name, 15, "%.3g"};
    snprintf(title, sizeof title, "%s%s:", chart->metric, strcmp(chart->of, "error") ? "" : ", distance to the truth");
    ck_Status status = ck_csv_table_read(&table, sweeps->arguments->out, &ck_layouts[CK_METRICS], error);
    if (!status) ck_answer_table(answer, "chart", title, columns);
    for (int i = 0; i < sweeps->sweep.point_count && !status; i++) {
        ck_sweep_name(&sweeps->sweep, i, name);
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
            if (ck_metric_find(sweeps->file.charts[i].metric))
                status = answer_chart(sweeps, &sweeps->file.charts[i], error);
    if (!status) status = answer_cases(sweeps, error);
    if (!status && sweeps->file.run == CK_STUDY_COMPARE && sweeps->sweep.point_count <= MOST_ROWS)
        status = ck_answer_findings(arguments, NULL, error);
    ck_answer_line(&arguments->answer, CK_ANSWER_FILES, "%s", arguments->out);
    ck_answer_line(&arguments->answer, CK_ANSWER_NEXT, "clothcheck report %s", arguments->out);
    return status;
}

// One process after the other, where several have shared the cases: each writes the same.
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

// Limits that are given reach every run, whatever command it is of.
static void take_limits(ck_Sweeps *sweeps) {
    const ck_Arguments *arguments = sweeps->arguments;
    const ck_Limits *limits = &arguments->options.limits;
    const bool has_time = limits->seconds != arguments->command->seconds,
               has_memory = limits->memory_bytes != ck_limits_default().memory_bytes;
    int count = 0;
    snprintf(sweeps->limits[0], sizeof sweeps->limits[0], "%.17g", limits->seconds);
    snprintf(sweeps->limits[1], sizeof sweeps->limits[1], "%.17g", (double)limits->memory_bytes / 1048576);
    if (has_time) sweeps->words[count++] = "--time-limit", sweeps->words[count++] = sweeps->limits[0];
    if (has_memory) sweeps->words[count++] = "--memory-limit", sweeps->words[count++] = sweeps->limits[1];
    sweeps->options.words = sweeps->words;
    // what was asked on the command line of several scenes is among the options already
    sweeps->options.word_count = sweeps->is_by_point ? 0 : count;
}

ck_Status ck_sweeps_open(ck_Sweeps *sweeps, ck_Error *error) {
    ck_Arguments *arguments = sweeps->arguments;
    if (!*arguments->out) return ck_fail(error, CK_BAD_INPUT, "--out has no name; give a folder");
    const int jobs = arguments->options.jobs, cores = (int)sysconf(_SC_NPROCESSORS_ONLN);
    // what is timed is not run side by side
    const bool is_timed = sweeps->file.run == CK_STUDY_PRECISION || sweeps->file.run == CK_STUDY_NEEDS;
    const int workers = is_timed || cores < 1 ? 1 : cores;
    sweeps->options = (ck_SweepOptions){.file = &sweeps->file,
                                        .paths = sweeps->paths,
                                        .compare = &arguments->options,
                                        .directory = arguments->out,
                                        .command = run_words,
                                        .jobs = jobs ? jobs : workers,
                                        .shard = arguments->shard,
                                        .shards = arguments->shards,
                                        .case_limit = arguments->case_limit,
                                        .timeout = arguments->study_timeout,
                                        .is_part = arguments->is_part,
                                        .is_by_point = sweeps->is_by_point};
    take_limits(sweeps);
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

static void add_option(ck_StudyFile *file, const char *word) {
    char *copy = strdup(word);
    if (copy) file->options[file->option_count++] = copy;
}

// The words of a command line that say what is asked, without engines, which are asked for by name.
static ck_Status take_options(ck_StudyFile *file, const char *question, ck_Error *error) {
    char *words = strdup(question), *rest = words;
    if (!words) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    file->options = calloc(strlen(question) + 3, sizeof *file->options);
    strsep(&rest, "\t"); // the command
    for (char *word; file->options && (word = strsep(&rest, "\t"));) {
        if (!strcmp(word, "--engine")) {
            strsep(&rest, "\t");
            continue;
        }
        add_option(file, word);
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
    snprintf(sweeps->again, sizeof sweeps->again, "the same command, which goes on there");
    for (int i = 0; i < arguments->scene_count; i++) {
        file->scenes[i] = strdup(arguments->scenes[i]);
        if (!file->scenes[i]) return ck_fail(error, CK_NO_MEMORY, "out of memory");
        file->scene_count++;
    }
    sweeps->paths = arguments->scenes;
    ck_Status status = take_options(file, arguments->question, error);
    // of the ways to an answer the one that changes it
    char timeout[40];
    snprintf(timeout, sizeof timeout, "%.17g", arguments->timeout);
    if (!status && run == CK_STUDY_TUNE) {
        add_option(file, "--timeout");
        add_option(file, timeout);
    }
    return status;
}

static ck_Status check_several(const ck_Arguments *arguments, ck_StudyRun run, ck_Error *error) {
    if (arguments->appends)
        return ck_fail(error, CK_BAD_INPUT, "--append is for one scene; give several an --out of their own");
    if (run == CK_STUDY_TUNE &&
        (arguments->options.engines != arguments->engines || arguments->options.engine_count != 1))
        return ck_fail(error, CK_BAD_INPUT, "tune needs one --engine NAME");
    return CK_OK;
}

int ck_sweeps_of_scenes(ck_Arguments *arguments, ck_StudyRun run) {
    ck_Sweeps *sweeps = calloc(1, sizeof *sweeps);
    ck_Error error = {0};
    ck_SweepProgress progress;
    ck_Status status = sweeps ? check_several(arguments, run, &error) : ck_fail(&error, CK_NO_MEMORY, "out of memory");
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
