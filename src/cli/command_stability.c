#include "stability_study.h"
#include "studies.h"

#include <stdlib.h>

static ck_Status run(const ck_StudyCommand *command, ck_Error *error) {
    ck_StabilityMap map;
    ck_Csv csv = {0};
    ck_JournalRow *rows = NULL;
    ck_Status status = ck_stability_map_create(&map, command->comparison, &command->arguments->options, error);
    const ck_Study study = ck_stability_map_study(&map);
    if (!status) status = ck_study_command_run(command, &study, 0, &rows, error);
    if (!status) status = ck_study_command_open(command, &csv, CK_STABILITY, error);
    if (!status) ck_stability_map_write(&map, rows, &csv);
    if (!status) status = ck_csv_close(&csv, error);
    if (!status) ck_study_command_done(command, &study, "stability.csv");
    ck_csv_discard(&csv);
    free(rows);
    ck_stability_map_free(&map);
    return status;
}

static int run_command(const ck_Command *command, int argc, char **argv) {
    return ck_study_command(command, CK_STABILITY, argc, argv, run);
}

const ck_Command ck_command_stability = {
    .name = "stability",
    .arguments = "SCENE",
    .about = "where methods fail: time step against stiffness: stability.csv",
    .help = "Pushes the scene's rest and steps it: a map over time steps, stiffnesses and iterations, and the critical "
            "step by\nbisection to 1 % beside what theory says; writes stability.csv.",
    .groups = CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_KEEPING | CK_TAKES_JOBS | CK_TAKES_SHARD,
    .out = "out",
    .seconds = 10,
    .run = run_command,
};
