#include "command.h"
#include "outside.h"

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    if (!status && arguments.word_count != 1)
        status = ck_fail(&error, CK_BAD_INPUT, "new-engine takes one NAME; %d are given", arguments.word_count);
    const char *name = status ? "" : arguments.words[0];
    if (!status) status = ck_outside_new_engine(name, &error);
    if (!status) {
        ck_answer_line(&arguments.answer, CK_ANSWER_SAYS, "%s/ holds an engine that runs: %s.c, CMakeLists.txt, check",
                       name, name);
        ck_answer_line(&arguments.answer, CK_ANSWER_NEXT, "%s/check --update", name);
    }
    return ck_command_end(&arguments, status, &error);
}

const ck_Command ck_command_new_engine = {
    .name = "new-engine",
    .arguments = "NAME",
    .about = "a directory to begin an engine of one's own with, as a shared library",
    .help =
        "Writes NAME/ with an engine that builds and runs, its CMakeLists.txt, and check, which a CI runs: it builds, "
        "asks for\nconformance, and holds the results against a baseline of its own.",
    .run = run,
};
