#include "command.h"

#include <stdio.h>
#include <string.h>

static void show(const ck_Comparison *comparison) {
    ck_print_summary(comparison);
    ck_print_answer(comparison);
    for (int i = 0; i < comparison->run_count; i++) {
        const ck_Run *run = &comparison->runs[i];
        printf("\n%s: %s; %u substeps", run->engine->name, run->reason, run->used.substeps);
        if (run->used.iterations) printf(", %u iterations", run->used.iterations);
        printf("\n");
        for (int row = 0; row < run->ledger.count; row++) {
            const ck_LedgerRow *entry = &run->ledger.rows[row];
            printf("  %-21s %10.4g %-6s as %s = %.6g (%s): %s\n", entry->quantity, entry->wanted, entry->unit,
                   entry->native_parameter, entry->native_value, entry->formula, ck_match_names[entry->match]);
        }
    }
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    if (!status && arguments.scene_count != 1)
        status = ck_fail(&error, CK_BAD_INPUT,
                         arguments.scene_count ? "run takes one SCENE; %d are given; compare takes several"
                                               : "run takes one SCENE; none is given; 'clothcheck list' tells them",
                         arguments.scene_count);
    // it is only written to CSVs
    if (!arguments.out) arguments.options.consistency_budget = 0;
    int result = status ? ck_command_fail(status, &error) : ck_command_study(&arguments, show);
    if (result == CK_EXIT_OK)
        printf("\nNext: clothcheck compare %s --out out, then clothcheck report out\n", arguments.scenes[0]);
    ck_arguments_free(&arguments);
    return result;
}

const ck_Command ck_command_run = {
    .name = "run",
    .arguments = "SCENE",
    .about = "one scene, chosen engines: summary and ledger; CSVs with --out",
    .help = "Runs one scene and prints a summary and what each engine made of the scene.",
    .groups = CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_TIMING | CK_TAKES_PATIENCE | CK_TAKES_JOBS | CK_TAKES_KEEPING,
    .seconds = 900,
    .patience = 10,
    .run = run,
};
