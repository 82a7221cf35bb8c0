#include "command.h"
#include "report.h"

#include <stdio.h>
#include <string.h>

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    if (argc != 2 || argv[1][0] == '-') {
        ck_fail(&error, CK_BAD_INPUT, "%s takes one DIR, which a comparison or study wrote into; %d are given",
                command->name, argc - 1);
        return ck_command_fail(CK_BAD_INPUT, &error);
    }
    ck_command_catch_signals();
    ck_Status status = ck_report_write(argv[1], &error);
    if (status) return ck_command_fail(status, &error);
    printf("%s/index.html\n", argv[1]);
    return CK_EXIT_OK;
}

const ck_Command ck_command_report = {
    .name = "report",
    .arguments = "DIR",
    .about = "charts and one page of the CSVs in DIR",
    .help = "Draws charts of the CSVs that a comparison or study has written into DIR, as DIR/charts/*.svg and *.png "
            "with their\nnumbers beside them, and writes DIR/index.html, a page that needs no network. Runs nothing.",
    .run = run,
};
