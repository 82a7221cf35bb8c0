#include "command.h"

#include <stdio.h>

// The engines that have a program, for an error.
static ck_Status check_engine(const ck_Arguments *arguments, ck_Error *error) {
    char known[200] = "";
    size_t used = 0;
    for (int i = 0; i < ck_engine_count() && used < sizeof known; i++)
        if (ck_engine_at(i)->code)
            used +=
                (size_t)snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", ck_engine_at(i)->name);
    if (arguments->options.engines != arguments->engines || arguments->options.engine_count != 1)
        return ck_fail(error, CK_BAD_INPUT, "code needs one --engine NAME, of %s", known);
    if (arguments->engines[0]->code) return CK_OK;
    return ck_fail(error, CK_BAD_INPUT, "%s has no program to paste; these have: %s", arguments->engines[0]->name,
                   known);
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_Comparison comparison = {0};
    ck_Settings used;
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    if (!status && arguments.scene_count != 1)
        status = ck_fail(&error, CK_BAD_INPUT, "code takes one SCENE; %d are given", arguments.scene_count);
    if (!status) status = check_engine(&arguments, &error);
    if (!status) status = ck_comparison_load(&comparison, arguments.scenes[0], &error);
    const ck_Engine *engine = arguments.engines[0];
    if (!status) {
        const ck_Settings wanted = ck_comparison_settings(engine, &comparison.scene, &arguments.options);
        status = ck_run_automatic(engine, &comparison.model, &wanted, &arguments.options.limits, &used, &error);
    }
    if (!status) status = ck_code_write(stdout, engine, &comparison.model, &used, comparison.path, &error);
    ck_comparison_free(&comparison);
    ck_arguments_free(&arguments);
    return status ? ck_command_fail(status, &error) : CK_EXIT_OK;
}

const ck_Command ck_command_code = {
    .name = "code",
    .arguments = "SCENE",
    .about = "a program that does the same with Bullet, ODE or MuJoCo alone, to paste",
    .help =
        "Prints a program of its own, C++ for Bullet and C for ODE and MuJoCo, that runs the scene as --engine does, "
        "with its "
        "settings and,\nas comments, the traps that the bridge is built around. Its first lines say how to build it. "
        "It prints the path as a\nCSV that 'clothcheck score' takes.",
    .groups = CK_TAKES_RUNS,
    .seconds = 60,
    .run = run,
};
