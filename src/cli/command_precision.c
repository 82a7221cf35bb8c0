#include "precision.h"
#include "studies.h"

#include <stdlib.h>

static ck_Status run(const ck_StudyCommand *command, ck_Error *error) {
    ck_Precision precision;
    ck_Csv csv = {0}, summary = {0};
    ck_JournalRow *rows = NULL;
    ck_Status status = ck_precision_create(&precision, command->comparison, &command->arguments->options, error);
    const ck_Study study = ck_precision_study(&precision);
    // it times its runs: side by side they would slow each other down
    if (!status) status = ck_study_command_run(command, &study, 1, &rows, error);
    if (!status) status = ck_study_command_open(command, &csv, CK_PRECISION, error);
    if (!status) status = ck_study_command_open(command, &summary, CK_PRECISION_SUMMARY, error);
    if (!status) ck_precision_write(&precision, rows, &csv, &summary);
    if (!status) status = ck_csv_close(&csv, error);
    if (!status) status = ck_csv_close(&summary, error);
    if (!status) ck_study_command_done(command, &study, "precision.csv, precision_summary.csv");
    ck_csv_discard(&csv);
    ck_csv_discard(&summary);
    free(rows);
    ck_precision_free(&precision);
    return status;
}

static int run_command(const ck_Command *command, int argc, char **argv) {
    return ck_study_command(command, CK_PRECISION, argc, argv, run);
}

const ck_Command ck_command_precision = {
    .name = "precision",
    .arguments = "SCENE",
    .about = "error against cost over time steps and iterations: precision.csv",
    .help = "Runs every engine over time steps from an eighth to sixteen times as many substeps as its rule takes, and "
            "over\niterations; writes precision.csv with error, cost and the Pareto front, and precision_summary.csv "
            "with orders,\nfloors and the cost to reach 10, 1 and 0.1 %.",
    .groups = CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_KEEPING | CK_TAKES_TIMING | CK_TAKES_JOBS | CK_TAKES_SHARD,
    .out = "out",
    .seconds = 20,
    .run = run_command,
};
