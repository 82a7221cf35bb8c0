#include "command.h"
#include "seed_cloth.h"
#include "seed_tecido.h"

#include <glob.h>
#include <stdio.h>
#include <string.h>

static void list_scenes(void) {
    glob_t found;
    printf("\nScenes in scenes/:\n");
    if (glob("scenes/*.yaml", 0, NULL, &found)) return;
    for (size_t i = 0; i < found.gl_pathc; i++) {
        ck_Comparison comparison;
        ck_Error error = {0};
        if (ck_comparison_load(&comparison, found.gl_pathv[i], &error))
            printf("  %s\n", error.message);
        else
            printf("  %-18s %s\n", comparison.model.name,
                   comparison.scene.file->about ? comparison.scene.file->about : "");
        ck_comparison_free(&comparison);
    }
    globfree(&found);
}

static void list_quirks(const char *engine, const char *const *names, int count) {
    printf("\nQuirks of %s, to add up in --set %s.mended=N:\n", engine, engine);
    for (int i = 0; i < count; i++) printf("  %-16d %s\n", 1 << i, names[i]);
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Arguments arguments;
    ck_Error error = {0};
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    ck_arguments_free(&arguments);
    if (status) return ck_command_fail(status, &error);
    printf("Engines:\n");
    for (int i = 0; i < ck_engine_count(); i++)
        printf("  %-16s %s (%s %s)\n", ck_engine_at(i)->name, ck_engine_at(i)->about, ck_engine_at(i)->family,
               ck_engine_at(i)->version());
    list_quirks("seed-tecido", ck_tecido_quirk_names, CK_TECIDO_QUIRK_COUNT);
    list_quirks("seed-cloth", ck_cloth_quirk_names, CK_CLOTH_QUIRK_COUNT);
    printf("\nMetrics:\n");
    for (int i = 0; i < ck_metric_count(); i++) printf("  %-16s %s\n", ck_metric_at(i)->name, ck_metric_at(i)->title);
    printf("\nTruths:\n");
    for (int i = 0; i < ck_truth_count(); i++)
        printf("  %-16s %s\n", ck_truth_form_at(i)->name, ck_truth_form_at(i)->source);
    list_scenes();
    return CK_EXIT_OK;
}

const ck_Command ck_command_list = {
    .name = "list",
    .arguments = "",
    .about = "engines, scenes, metrics and truths",
    .help = "Tells the engines, metrics, truths and the scenes in scenes/.",
    .run = run,
};
