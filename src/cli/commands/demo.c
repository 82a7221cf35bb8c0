#include "command.h"
#include "report.h"

#include <stdio.h>

static const char *const scenes[] = {"rope_hanging", "cloth_two_corners", "cloth_on_ball"};

static void show(ck_Arguments *arguments, const ck_Comparison *comparison) {
    ck_Answer *answer = &arguments->answer;
    ck_answer_summary(arguments, comparison);
    ck_answer_cheapest(arguments, comparison);
    ck_answer_gap(answer);
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes && !status; i++)
        status = ck_arguments_add_scene(&arguments, scenes[i], &error);
    // whether an engine converges is a question for later
    arguments.options.consistency_budget = 0;
    arguments.options.budget = 0.1;
    arguments.options.enough = 0.2;
    if (!status) status = ck_command_compare_scenes(&arguments, show, &error);
    if (!status) status = ck_report_write(arguments.out, 0, &error);
    if (!status) {
        ck_answer_line(&arguments.answer, CK_ANSWER_NOTE, "the page, to be opened in a browser: %s/index.html",
                       arguments.out);
        ck_answer_line(&arguments.answer, CK_ANSWER_NEXT, "clothcheck compare YOUR_SCENE.yaml");
    }
    return ck_command_end(&arguments, status, &error);
}

const ck_Command ck_command_demo = {
    .name = "demo",
    .arguments = "",
    .about = "three scenes, the page and the answer, in half a minute",
    .help = "Runs a rope, a hung cloth and a cloth on a ball with the engines that answer in time, says which is the "
            "cheapest\nwithin 1 %, and writes the CSVs and the page into --out.",
    .groups = CK_TAKES_FORM | CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_TIMING | CK_TAKES_PATIENCE | CK_TAKES_JOBS |
              CK_TAKES_KEEPING,
    .out = "demo",
    .seconds = 60,
    .patience = 1.5,
    .run = run,
};
