#include "export.h"
#include "command.h"

#include <stdio.h>
#include <string.h>

static ck_Status export_as(const char *format, const ck_Arguments *arguments, const ck_Model *model, ck_Error *error) {
    bool is_csv = !strcmp(format, "csv");
    if (is_csv && arguments->out) return ck_export_csv(arguments->out, model, error);
    if (is_csv) return ck_fail(error, CK_BAD_INPUT, "--format csv writes several files; give --out DIR");
    if (arguments->out)
        return ck_fail(error, CK_BAD_INPUT, "--format %s goes to standard output; leave --out out", format);
    if (!strcmp(format, "json")) return ck_export_json(stdout, model, error);
    if (!strcmp(format, "obj")) return ck_export_obj(stdout, model, error);
    return ck_fail(error, CK_BAD_INPUT, "--format %s: it must be json, csv or obj", format);
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_Comparison comparison = {0};
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    if (!status && arguments.scene_count != 1)
        status = ck_fail(&error, CK_BAD_INPUT, "export takes one SCENE; %d are given", arguments.scene_count);
    if (!status) status = ck_comparison_load(&comparison, arguments.scenes[0], &error);
    if (!status)
        status = export_as(arguments.format ? arguments.format : "json", &arguments, &comparison.model, &error);
    ck_comparison_free(&comparison);
    ck_arguments_free(&arguments);
    return status ? ck_command_fail(status, &error) : CK_EXIT_OK;
}

const ck_Command ck_command_export = {
    .name = "export",
    .arguments = "SCENE",
    .about = "the compiled scene in SI units: JSON that loads again, CSV tables, or a mesh",
    .help =
        "Writes particles, springs, pins, colliders and what acts on them. JSON is a scene file itself, of a network "
        "whose\nsprings have values of their own: scenes/README.md has its keys, and it loads into the same numbers. "
        "csv writes\nparticles.csv, springs.csv, colliders.csv and scene.csv into --out; obj is a Wavefront mesh.",
    .groups = CK_TAKES_OUT | CK_TAKES_FORMAT,
    .run = run,
};
