#include "command.h"
#include "report.h"

#include <stdio.h>
#include <string.h>

int ck_command_report(int argc, char **argv) {
    bool asks_help = argc > 1 && !strcmp(argv[1], "--help");
    if (argc != 2 || asks_help || argv[1][0] == '-') {
        fprintf(asks_help ? stdout : stderr,
                "clothcheck report DIR\n\nDraws charts of the CSVs that a comparison or study has written into DIR, as "
                "DIR/charts/*.svg and *.png with their\nnumbers beside them, and writes DIR/index.html, a page that "
                "needs no network. Runs nothing.\n");
        return asks_help ? CK_EXIT_OK : CK_EXIT_USAGE;
    }
    ck_Error error = {0};
    ck_command_catch_signals();
    ck_Status status = ck_report_write(argv[1], &error);
    if (status) return ck_command_fail(status, &error);
    printf("%s/index.html\n", argv[1]);
    return CK_EXIT_OK;
}
