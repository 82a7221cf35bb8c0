#include "command.h"
#include "finding.h"

#include <stdio.h>
#include <string.h>

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_Findings findings = {0};
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    const char *directory = arguments.word_count ? arguments.words[0] : "out";
    if (!status && arguments.word_count > 1)
        status = ck_fail(&error, CK_BAD_INPUT, "findings takes one DIR; %d are given", arguments.word_count);
    if (!status) status = ck_findings_read(&findings, directory, &error);
    if (!status) {
        static const ck_AnswerColumn columns[] = {{"kind", "kind", -10, NULL},
                                                  {"finding", "finding", -60, NULL},
                                                  {"command", "", 0, NULL},
                                                  {NULL, NULL, 0, NULL}};
        ck_Answer *answer = &arguments.answer;
        ck_answer_table(answer, "findings", NULL, columns);
        for (int i = 0; i < findings.count; i++) {
            ck_answer_text(answer, findings.items[i].kind);
            ck_answer_text(answer, findings.items[i].text);
            ck_answer_text(answer, findings.items[i].command);
        }
        ck_answer_line(answer, CK_ANSWER_SAYS, "%s: %d findings", directory, findings.count);
        ck_answer_line(answer, CK_ANSWER_NEXT, "clothcheck report %s", directory);
    }
    ck_findings_free(&findings);
    return ck_command_end(&arguments, status, &error);
}

const ck_Command ck_command_findings = {
    .name = "findings",
    .arguments = "[DIR]",
    .about = "the results of a directory that a person should know, in sentences",
    .help =
        "Reads the CSVs of compare and precision in DIR (default: out) and says where engines break down, what "
        "they cannot\nmodel where that shows, settings that are no use, and what single precision and stock set-ups "
        "cost; each with the\ncommand that shows it. Nothing is said of differences within an uncertainty.",
    .groups = CK_TAKES_FORM,
    .run = run,
};
