#include "command.h"

#include <stdio.h>
#include <string.h>

static void show(const ck_Comparison *comparison) {
    ck_print_summary(comparison);
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

int ck_command_run(int argc, char **argv) {
    for (int i = 1; i < argc; i++)
        if (!strcmp(argv[i], "--help")) {
            printf("clothcheck run SCENE [options]\n\nRuns one scene and prints a summary and what each engine made of "
                   "the scene.\n\n");
            ck_arguments_help(CK_TAKES_TIMING);
            return CK_EXIT_OK;
        }
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_Status status = ck_arguments_read(&arguments, argc, argv, CK_TAKES_TIMING, &error);
    if (!status) status = ck_arguments_all_scenes(&arguments, &error);
    if (!status && arguments.scene_count != 1)
        status =
            ck_fail(&error, CK_BAD_INPUT, "run takes one SCENE, not %d; compare takes several", arguments.scene_count);
    int result = status ? ck_command_fail(status, &error) : ck_command_study(&arguments, show);
    ck_arguments_free(&arguments);
    return result;
}
