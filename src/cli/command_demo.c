#include "command.h"
#include "report.h"

#include <stdio.h>

static const char *const scenes[] = {"rope_hanging", "cloth_two_corners", "cloth_on_sphere"};

static void show(const ck_Comparison *comparison) {
    ck_print_summary(comparison);
    ck_print_answer(comparison);
    printf("\n");
    fflush(stdout);
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
    int result = status ? ck_command_fail(status, &error) : ck_command_study(&arguments, show);
    if (result == CK_EXIT_OK) {
        status = ck_report_write(arguments.out, &error);
        if (status)
            result = ck_command_fail(status, &error);
        else
            printf("The page, to be opened in a browser: %s/index.html\nNext: clothcheck compare YOUR_SCENE.yaml\n",
                   arguments.out);
    }
    ck_arguments_free(&arguments);
    return result;
}

const ck_Command ck_command_demo = {
    .name = "demo",
    .arguments = "",
    .about = "three scenes, the page and the answer, in about 20 s",
    .help = "Runs a rope, a hung cloth and a cloth on a ball with the engines that answer in time, says which is the "
            "cheapest\nwithin 1 %, and writes the CSVs and the page into --out.",
    .groups = CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_TIMING | CK_TAKES_PATIENCE | CK_TAKES_JOBS | CK_TAKES_KEEPING,
    .out = "demo",
    .seconds = 60,
    .patience = 1.5,
    .run = run,
};
