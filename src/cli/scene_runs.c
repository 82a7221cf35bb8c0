#include "command.h"
#include "files.h"
#include "process.h"
#include "tables.h"
#include "unfinished.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int ck_command_fail(ck_Status status, const ck_Error *error) {
    fprintf(stderr, "clothcheck: %s\n", error->message);
    return status == CK_BAD_INPUT ? CK_EXIT_USAGE : CK_EXIT_FAILED;
}

static void interrupt(int signal_number) {
    (void)signal_number;
    ck_child_interrupted = 1;
}

int ck_command_end(ck_Arguments *arguments, ck_Status status, ck_Error *error) {
    if (!status) status = ck_answer_close(&arguments->answer, error);
    ck_arguments_free(arguments);
    return status ? ck_command_fail(status, error) : CK_EXIT_OK;
}

void ck_command_catch_signals(void) {
    // a wait for another end, as of a pipe in place of a file, is not taken up again
    const struct sigaction action = {.sa_handler = interrupt};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
}

// How far a comparison of several scenes has come, for its line on the terminal.
static struct {
    int scene, scenes;
    double start; // of ck_wall
} far;

static void show_progress(const char *scene, const char *engine, const char *doing) {
    char left[60] = "";
    if (far.scene)
        snprintf(left, sizeof left, "; about %.0f s more",
                 (ck_wall() - far.start) / far.scene * (far.scenes - far.scene));
    if (far.scenes > 1)
        ck_progress_show("scene %d of %d%s: %s %s on %s", far.scene + 1, far.scenes, left, doing, engine, scene);
    else
        ck_progress_show("%s %s on %s", doing, engine, scene);
}

// Two scenes of one name would be one in the CSVs.
static ck_Status check_names(const ck_Comparison *comparisons, int count, ck_Error *error) {
    for (int i = 0; i < count; i++)
        for (int j = 0; j < i; j++)
            if (!strcmp(comparisons[i].model.name, comparisons[j].model.name))
                return ck_fail(error, CK_BAD_INPUT, "%s and %s are both named %s; give one of them another name",
                               comparisons[j].path, comparisons[i].path, comparisons[i].model.name);
    return CK_OK;
}

// One scene to its tables, replay and answer: run, or as an interrupted comparison has left it.
static ck_Status run_one(ck_Comparison *comparison, ck_Arguments *arguments, const ck_CompareOptions *options,
                         ck_Tables *tables, const ck_Unfinished *unfinished, ck_Show *show, ck_Error *error) {
    if (ck_unfinished_take(unfinished, comparison, tables)) {
        ck_answer_line(&arguments->answer, CK_ANSWER_NOTE, "%s: as it was finished before the interruption",
                       comparison->model.name);
        return CK_OK;
    }
    ck_Status status = ck_comparison_run(comparison, options, error);
    ck_progress_clear();
    if (!status && unfinished->directory) status = ck_unfinished_keep(unfinished, comparison, options, error);
    if (!status && arguments->out) ck_tables_add(tables, comparison, options);
    if (!status && arguments->out && !unfinished->directory)
        status = ck_replay_write(comparison, arguments->out, arguments->appends && arguments->by_engine,
                                 CK_REPLAY_FRAMES, error);
    if (!status) show(arguments, comparison);
    return status;
}

static ck_Status run_all(ck_Comparison *comparisons, ck_Arguments *arguments, ck_Tables *tables,
                         const ck_Unfinished *unfinished, ck_Show *show, ck_Error *error) {
    ck_CompareOptions options = arguments->options;
    ck_command_catch_signals();
    options.progress = show_progress;
    char *cache = arguments->out ? ck_path_join(arguments->out, "truths") : NULL;
    options.cache = cache;
    ck_Status status = CK_OK;
    far.start = ck_wall();
    far.scenes = arguments->scene_count;
    for (int i = 0; i < arguments->scene_count && !status; i++) {
        far.scene = i;
        status = run_one(&comparisons[i], arguments, &options, tables, unfinished, show, error);
        ck_comparison_free_runs(&comparisons[i]);
        const ck_Error why = *error;
        if (status && unfinished->directory && i)
            status = ck_fail(error, status, "%s; %s/unfinished has %d finished scenes: the same command goes on there",
                             why.message, arguments->out, i);
    }
    free(cache);
    return status;
}

// All that the results of a comparison depend on: the command line, the scenes' texts and this program.
static char *question_of(const ck_Arguments *arguments, const ck_Comparison *comparisons, int count) {
    uint64_t scenes = CK_HASH_START;
    char *question;
    for (int i = 0; i < count; i++)
        // and what its files hold, which are in the model
        scenes = ck_hash(scenes, comparisons[i].scene.document.text, comparisons[i].scene.document.length) ^
                 ck_model_hash(&comparisons[i].model);
    for (int i = 0; i < arguments->options.engine_count; i++) {
        const char *version = ck_engine_version(arguments->options.engines[i]);
        scenes = ck_hash(scenes, version, strlen(version));
    }
    return asprintf(&question, "%s\t(%d scenes %016llx, %s)\n", arguments->question, count, (unsigned long long)scenes,
                    ck_machine_build()) < 0
               ? NULL
               : question;
}

// Of several scenes, what is finished is kept until all are.
static ck_Status open_unfinished(ck_Unfinished *unfinished, ck_Arguments *arguments, const ck_Comparison *comparisons,
                                 int count, ck_Error *error) {
    if (!arguments->out || arguments->by_engine || count < 2) return CK_OK;
    int dropped;
    char *question = question_of(arguments, comparisons, count);
    ck_Status status = question ? ck_unfinished_open(unfinished, arguments->out, question, &dropped, error)
                                : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status && dropped)
        ck_answer_line(&arguments->answer, CK_ANSWER_NOTE,
                       "%d finished scenes of an interrupted comparison that was asked otherwise are dropped", dropped);
    free(question);
    return status;
}

ck_Status ck_command_compare_scenes(ck_Arguments *arguments, ck_Show *show, ck_Error *error) {
    ck_Tables tables = {0};
    ck_Unfinished unfinished = {0};
    int count = 0;
    ck_Comparison *comparisons = calloc((size_t)arguments->scene_count, sizeof *comparisons);
    ck_Status status = comparisons ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    for (; count < arguments->scene_count && !status; count++)
        status = ck_comparison_load(&comparisons[count], arguments->scenes[count], error);
    if (!status) status = check_names(comparisons, count, error);
    ck_Keeping keeping = arguments->forces ? CK_KEEP_NONE : arguments->appends ? CK_KEEP_OTHERS : CK_KEEP_OR_FAIL;
    if (!status) status = open_unfinished(&unfinished, arguments, comparisons, count, error);
    // one that was killed while it gave its files their names goes on, whatever has them by now
    if (unfinished.kept == count && keeping == CK_KEEP_OR_FAIL) keeping = CK_KEEP_NONE;
    if (!status && arguments->out)
        status = ck_tables_open(&tables, arguments->out, keeping, arguments->by_engine, comparisons, count,
                                &arguments->options, error);
    if (!status) status = run_all(comparisons, arguments, &tables, &unfinished, show, error);
    if (!status && arguments->out) status = ck_tables_close(&tables, error);
    if (!status) status = ck_unfinished_finish(&unfinished, error);
    ck_tables_discard(&tables);
    ck_unfinished_close(&unfinished);
    for (int i = 0; i < count; i++) ck_comparison_free(&comparisons[i]);
    free(comparisons);
    return status;
}
