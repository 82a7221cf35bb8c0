#include "film.h"
#include "asked_engines.h"
#include "command.h"
#include "files.h"
#include "tables.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Where the replay goes, and what became of it: the command has one at a time.
static struct {
    ck_PartFolder folder;
    double seconds;
    char scene[200];
    ck_Status status;
    ck_Error error;
} made;

// Every frame of the runs, for a film.
static void keep_replay(ck_Arguments *arguments, const ck_Comparison *comparison) {
    const ck_Model *model = &comparison->model;
    ck_answer_summary(arguments, comparison);
    made.seconds = model->duration;
    snprintf(made.scene, sizeof made.scene, "%s", model->name);
    made.status = ck_replay_write(comparison, made.folder.path, false, model->frame_count + 1, &made.error);
}

static void show_progress(int drawn, int count) {
    ck_progress_show("frame %d of %d", drawn, count);
}

// The best known of each family, where none is asked for.
static ck_Status choose_engines(ck_Arguments *arguments, ck_Error *error) {
    static const char *const usual[] = {"native-verlet", "native-xpbd", "bullet-pbd", "ode-quick"};
    ck_Status status = CK_OK;
    if (arguments->options.engines == arguments->engines) return CK_OK;
    for (size_t i = 0; i < sizeof usual / sizeof *usual && !status; i++)
        status = ck_arguments_add_engines(arguments, usual[i], error);
    return status;
}

// Work is done where the film will be.
static ck_Status work_beside(const char *out, ck_Error *error) {
    const char *slash = strrchr(out, '/');
    char *folder = slash ? strndup(out, (size_t)(slash - out) + 1) : strdup(".");
    ck_Status status = folder ? ck_part_folder_open(&made.folder, folder, "film", error)
                              : ck_fail(error, CK_NO_MEMORY, "out of memory");
    free(folder);
    return status;
}

static ck_Status film_scene(ck_Arguments *arguments, const char *out, ck_Error *error) {
    ck_Status status = ck_command_compare_scenes(arguments, keep_replay, error);
    if (status) return status;
    if (made.status) return ck_fail(error, made.status, "%s", made.error.message);
    const ck_Film film = {.replays = made.folder.path,
                          .scene = made.scene,
                          .seconds = made.seconds,
                          .color = arguments->color ? arguments->color : "strain",
                          .width = arguments->film_width,
                          .height = arguments->film_height,
                          .fps = arguments->film_fps};
    status = ck_film_write(&film, made.folder.path, out, show_progress, error);
    ck_progress_clear();
    return status;
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    ck_Arguments arguments;
    char out[4096];
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    if (!status && arguments.scene_count != 1)
        status = ck_fail(&error, CK_BAD_INPUT, "film takes one SCENE; %d are given; 'clothcheck list' tells them",
                         arguments.scene_count);
    if (!status) {
        const char *slash = strrchr(arguments.scenes[0], '/'), *name = slash ? slash + 1 : arguments.scenes[0];
        if (arguments.film)
            snprintf(out, sizeof out, "%s", arguments.film);
        else
            snprintf(out, sizeof out, "%.*s.mp4", (int)strcspn(name, ".@"), name);
        status = ck_film_check(out, &error);
    }
    if (!status) status = choose_engines(&arguments, &error);
    arguments.options.consistency_budget = 0;
    arguments.options.repeats = 0;
    if (!status) status = work_beside(out, &error);
    if (!status) status = film_scene(&arguments, out, &error);
    ck_part_folder_close(&made.folder);
    if (!status) ck_answer_line(&arguments.answer, CK_ANSWER_NOTE, "=> %s", out);
    if (!status) ck_answer_line(&arguments.answer, CK_ANSWER_NEXT, "clothcheck view %s", arguments.scenes[0]);
    return ck_command_end(&arguments, status, &error);
}

const ck_Command ck_command_film = {
    .name = "film",
    .arguments = "SCENE",
    .about = "a video of the scene, engines side by side",
    .help =
        "Runs a scene and makes a video of it: engines side by side, with their names, the scene's sentence and the "
        "time,\nevery frame of the runs. Needs Debian's packages chromium and ffmpeg. Without --engine: "
        "native-verlet, native-xpbd,\nbullet-pbd and ode-quick.",
    .groups = CK_TAKES_RUNS | CK_TAKES_FILM,
    .seconds = 900,
    .run = run,
};
