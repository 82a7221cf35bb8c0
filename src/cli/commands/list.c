#include "asked_engines.h"
#include "command.h"
#include "names.h"
#include "outside.h"
#include "seed.h"

#include <stdio.h>
#include <string.h>

static void list_scenes(void) {
    ck_Arguments all = {0};
    ck_Error none = {0};
    if (ck_arguments_all_scenes(&all, &none)) return;
    printf("\nScenes in %.*s:\n", (int)(strrchr(all.scenes[0], '/') - all.scenes[0]), all.scenes[0]);
    for (int i = 0; i < all.scene_count; i++) {
        ck_Comparison comparison;
        ck_Error error = {0};
        if (ck_comparison_load(&comparison, all.scenes[i], &error))
            printf("  %s\n", error.message);
        else
            printf("  %-18s %s\n", comparison.model.name,
                   comparison.scene.file->about ? comparison.scene.file->about : "");
        ck_comparison_free(&comparison);
    }
    ck_arguments_free(&all);
}

static void list_quirks(const char *engine, const char *const *names, int count) {
    printf("\nQuirks of %s, to add up in --set %s.mended=N:\n", engine, engine);
    for (int i = 0; i < count; i++) printf("  %-16d %s\n", 1 << i, names[i]);
}

static bool list_adapter(void *context, const char *name, const char *path) {
    ck_Engine *engine;
    ck_Error error = {0};
    if (ck_adapter_open(&engine, name, path, &error))
        printf("  %-21s %s\n", name, error.message);
    else
        printf("  %-21s %s (%s)\n", name, engine->about, ck_engine_version(engine));
    ck_outside_free(engine);
    *(bool *)context = *(bool *)context || !strcmp(name, "jolt");
    return true;
}

static void list_engines(void) {
    bool has_jolt = false;
    printf("Engines ('clothcheck list ENGINE' tells its settings):\n");
    for (int i = 0; i < ck_engine_count(); i++)
        printf("  %-21s %s (%s %s)\n", ck_engine_at(i)->name, ck_engine_at(i)->about, ck_engine_at(i)->family,
               ck_engine_version(ck_engine_at(i)));
    printf("\nEngines in processes of their own, which run where --engine names them:\n");
    ck_adapters_visit("*", list_adapter, &has_jolt);
    if (!has_jolt) printf("  %-21s not here: bridge/fetch jolt brings it with npm\n", "jolt");
    if (!ck_engine_find("mujoco"))
        printf("  %-21s not here: this program was built without MuJoCo (Debian's libmujoco-dev)\n", "mujoco");
}

static void list_all(void) {
    list_engines();
    list_quirks("seed-tecido", ck_tecido_quirk_names, CK_TECIDO_QUIRK_COUNT);
    list_quirks("seed-cloth", ck_cloth_quirk_names, CK_CLOTH_QUIRK_COUNT);
    printf("\nMetrics:\n");
    for (int i = 0; i < ck_metric_count(); i++) printf("  %-16s %s\n", ck_metric_at(i)->name, ck_metric_at(i)->title);
    printf("\nTruths:\n");
    for (int i = 0; i < ck_truth_count(); i++)
        printf("  %-19s %s\n", ck_truth_form_at(i)->name, ck_truth_form_at(i)->source);
    list_scenes();
}

static void list_engine(const ck_Engine *engine) {
    printf("%s: %s (%s %s)\n\nIt models ", engine->name, engine->about, engine->family, ck_engine_version(engine));
    const char *separator = "";
    for (int bit = 0; bit < CK_TERM_COUNT; bit++)
        if (engine->terms & (1u << bit)) {
            printf("%s%s", separator, ck_term_names[bit]);
            separator = ", ";
        }
    printf(".\n\nSettings, as in --set %s.NAME=N or in a scene under settings:\n", engine->name);
    for (const ck_Setting *row = engine->settings; row && row->name; row++) {
        printf("  %-12s %s; %s%g to %g", row->name, row->help, row->is_whole ? "whole, " : "", row->least, row->most);
        printf("%s%s (default: %s)%s%s\n", strcmp(row->unit, "1") ? " " : "", strcmp(row->unit, "1") ? row->unit : "",
               row->rule, row->also ? "; also called " : "", row->also ? row->also : "");
    }
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Arguments arguments;
    ck_Error error = {0};
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    if (!status && !arguments.word_count) list_all();
    for (int i = 0; i < arguments.word_count && !status; i++) {
        arguments.options.engine_count = 0;
        status = ck_arguments_add_engines(&arguments, arguments.words[i], &error);
        for (int k = 0; k < arguments.options.engine_count && !status; k++) {
            if (i || k) printf("\n");
            list_engine(arguments.options.engines[k]);
        }
    }
    ck_arguments_free(&arguments);
    return status ? ck_command_fail(status, &error) : CK_EXIT_OK;
}

const ck_Command ck_command_list = {
    .name = "list",
    .arguments = "[ENGINE...]",
    .about = "engines and their settings, scenes, metrics and truths",
    .help = "Tells the engines, metrics, truths and scenes there are; of an ENGINE what it models and its settings.",
    .run = run,
};
