#include "report.h"
#include "command.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Arguments arguments;
    ck_Error error = {0};
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    if (!status && arguments.word_count != 1)
        status = ck_fail(&error, CK_BAD_INPUT, "%s takes one DIR, which a comparison or study wrote into; %d are given",
                         command->name, arguments.word_count);
    if (!status && arguments.has_width && !arguments.is_pdf)
        status = ck_fail(&error, CK_BAD_INPUT, "--width is of charts as PDF, which --format pdf asks for");
    // whoever else reads there may
    if (!status && !access(arguments.words[0], F_OK))
        status = ck_out_folder_claim(&arguments.folder, arguments.words[0], true, &error);
    ck_command_catch_signals();
    if (!status) status = ck_report_write(arguments.words[0], arguments.is_pdf ? arguments.paper_width : 0, &error);
    if (!status) printf("%s/index.html\n", arguments.words[0]);
    ck_arguments_free(&arguments);
    return status ? ck_command_fail(status, &error) : CK_EXIT_OK;
}

const ck_Command ck_command_report = {
    .name = "report",
    .arguments = "DIR",
    .about = "charts and one page of the CSVs in DIR",
    .help =
        "Draws charts of the CSVs that a comparison or study has written into DIR, as DIR/charts/*.svg and *.png "
        "with their\nnumbers beside them, and writes DIR/index.html, a page that needs no network. Runs nothing.\n\n"
        "With --format pdf each chart is there as PDF, too, as wide as a column of a paper.",
    .groups = CK_TAKES_PAPER,
    .run = run,
};
