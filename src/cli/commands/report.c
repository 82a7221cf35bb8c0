#include "report.h"
#include "command.h"

#include <stdio.h>
#include <string.h>

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Arguments arguments;
    ck_Error error = {0};
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    if (!status && arguments.word_count != 1)
        status = ck_fail(&error, CK_BAD_INPUT, "%s takes one DIR, which a comparison or study wrote into; %d are given",
                         command->name, arguments.word_count);
    ck_command_catch_signals();
    if (!status) status = ck_report_write(arguments.words[0], &error);
    if (!status) printf("%s/index.html\n", arguments.words[0]);
    ck_arguments_free(&arguments);
    return status ? ck_command_fail(status, &error) : CK_EXIT_OK;
}

const ck_Command ck_command_report = {
    .name = "report",
    .arguments = "DIR",
    .about = "charts and one page of the CSVs in DIR",
    .help = "Draws charts of the CSVs that a comparison or study has written into DIR, as DIR/charts/*.svg and *.png "
            "with their\nnumbers beside them, and writes DIR/index.html, a page that needs no network. Runs nothing.",
    .run = run,
};
