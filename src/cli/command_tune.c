#include "files.h"
#include "process.h"
#include "studies.h"
#include "tune.h"

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

static ck_Status run(const ck_StudyCommand *command, ck_Error *error) {
    const ck_Arguments *arguments = command->arguments;
    if (arguments->options.engines != arguments->engines || arguments->options.engine_count != 1)
        return ck_fail(error, CK_BAD_INPUT, "tune needs one --engine NAME");
    ck_TuneOptions options = {
        .engine = arguments->engines[0],
        .tolerance = arguments->error,
        .like = arguments->like,
        .validate = arguments->validate,
        .validate_count = arguments->validate_count,
        .directory = arguments->out,
        .question = command->question,
        .given = ck_comparison_settings(arguments->engines[0], &command->comparison->scene, &arguments->options),
        .limits = arguments->options.limits,
        .timeout = arguments->timeout > 0 ? arguments->timeout : INFINITY,
        .progress = show};
    ck_Status vary = read_varied(&options, arguments, error);
    if (vary) return vary;
    char *cache = ck_path_join(arguments->out, "truths");
    options.cache = cache;
    ck_Tuning tuning;
    ck_Csv csv = {0};
    ck_Status status = ck_study_command_open(command, &csv, CK_TUNE, error);
    if (!status) status = ck_tune_run(&tuning, command->comparison, &options, &csv, error);
    ck_progress_clear();
    if (!status) status = ck_csv_close(&csv, error);
    if (!status) {
        ck_tune_print(&tuning, &options, &command->comparison->model);
        printf("CSV: %s/tune.csv\nNext: clothcheck run %s --engine %s", arguments->out, command->comparison->path,
               options.engine->name);
        for (const ck_Setting *row = options.engine->settings; row && row->name; row++)
            if (ck_settings_has(&tuning.best.settings, row->slot))
                printf(" --set %s.%s=%.9g", options.engine->name, row->name,
                       ck_settings_get(&tuning.best.settings, row->slot));
        printf("\n");
    }
    ck_csv_discard(&csv);
    free(cache);
    return status;
}

static int run_command(const ck_Command *command, int argc, char **argv) {
    return ck_study_command(command, CK_TUNE, argc, argv, run);
}

const ck_Command ck_command_tune = {
    .name = "tune",
    .arguments = "SCENE",
    .about = "the cheapest settings within an error, or the closest to a goal: tune.csv",
    .help = "Searches substeps, iterations and relaxation for the cheapest settings within --error, or without it for "
            "those that\ncome closest to the truth, or to --like ENGINE; prints them as lines of a scene file, and "
            "writes every evaluation to\ntune.csv. Needs one --engine. Work is sweeps over all springs, one more for "
            "each substep.",
    .groups = CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_KEEPING | CK_TAKES_GOAL,
    .out = "out",
    .seconds = 60,
    .run = run_command,
};
