#include "needs.h"
#include "studies.h"

#include <math.h>
#include <stdlib.h>

// The engine that is asked for, else the first that models all there is.
static const ck_Engine *choose_engine(const ck_StudyCommand *command) {
    const ck_CompareOptions *options = &command->arguments->options;
    for (int i = 0; i < options->engine_count; i++)
        if (!ck_engine_lacks(options->engines[i], &command->comparison->model)) return options->engines[i];
    return options->engines[0];
}

static ck_Status run(const ck_StudyCommand *command, ck_Error *error) {
    const ck_Arguments *arguments = command->arguments;
    ck_Needs needs;
    ck_Csv csv = {0};
    ck_JournalRow *rows = NULL;
    const ck_Engine *engine = choose_engine(command);
    const ck_Settings given = ck_comparison_settings(engine, &command->comparison->scene, &arguments->options);
    ck_Status status =
        ck_needs_create(&needs, command->comparison, engine, isnan(arguments->error) ? 0.01 : arguments->error, &given,
                        &arguments->options.limits, error);
    const ck_Study study = ck_needs_study(&needs);
    if (!status) status = ck_study_command_run(command, &study, 1, &rows, error);
    if (!status) status = ck_study_command_open(command, &csv, CK_NEEDS, error);
    if (!status) ck_needs_write(&needs, rows, &csv);
    if (!status) status = ck_csv_close(&csv, error);
    if (!status) ck_study_command_done(command, &study, "needs.csv");
    ck_csv_discard(&csv);
    free(rows);
    ck_needs_free(&needs);
    return status;
}

static int run_command(const ck_Command *command, int argc, char **argv) {
    return ck_study_command(command, CK_NEEDS, argc, argv, run);
}

const ck_Command ck_command_needs = {
    .name = "needs",
    .arguments = "SCENE",
    .about = "what the scene needs to be modelled, and what not: needs.csv",
    .help = "Leaves out one modelled term at a time, and every second particle, and says which of them change any "
            "metric by\nmore than --error (default 0.01), and what each costs; writes needs.csv. The engine is the "
            "first that models all\nthere is, or --engine.",
    .groups = CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_KEEPING | CK_TAKES_JOBS | CK_TAKES_SHARD | CK_TAKES_ERROR,
    .out = "out",
    .seconds = 60,
    .run = run_command,
};
