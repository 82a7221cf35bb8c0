#include "command.h"
#include "outside.h"
#include "path.h"
#include "vector.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Farther than that, in sizes, a pin is not where the scene has it: recordings are in single precision, or rounded.
#define PIN_SLACK 1e-4

// The pin that is farthest from where the scene has it.
typedef struct Stray {
    int particle;
    double off, time; // m, s
} Stray;

static void look_at(Stray *stray, const ck_Run *run, int frame, int particle, const double *place) {
    const double off = ck_distance(place, ck_trajectory_position(&run->trajectory, frame) + 3 * particle);
    if (off > stray->off) *stray = (Stray){particle, off, frame * run->model->step};
}

// A recording whose pins are elsewhere is of another scene. Those that are let go count as long as they are moved.
static void show_pins(ck_Answer *answer, const ck_Run *run) {
    const ck_Model *model = run->model;
    bool *moves = calloc((size_t)model->particle_count, sizeof *moves);
    Stray stray = {0};
    for (int i = 0; i < model->driven_count && moves; i++) moves[model->driven[i].particle] = true;
    for (int frame = 0; frame < run->trajectory.frame_count && moves; frame++) {
        for (int i = 0; i < model->driven_count; i++) {
            double place[3];
            if (!ck_driven_holds(model, &model->driven[i], frame * model->step)) continue;
            ck_driven_at(&model->driven[i], frame * model->step, place);
            look_at(&stray, run, frame, model->driven[i].particle, place);
        }
        for (int i = 0; i < model->particle_count; i++)
            if (ck_model_is_held(model, i) && !moves[i]) look_at(&stray, run, frame, i, model->position + 3 * i);
    }
    free(moves);
    if (stray.off > PIN_SLACK * model->size)
        ck_answer_line(answer, CK_ANSWER_NOTE,
                       "%s: particle %d, a pin, is %.3g m from where the scene has it at t = %.3g s: that is another "
                       "scene, and its errors are of that, too",
                       run->engine->name, stray.particle, stray.off, stray.time);
}

static void show(ck_Arguments *arguments, const ck_Comparison *comparison) {
    ck_Answer *answer = &arguments->answer;
    ck_answer_summary(arguments, comparison);
    for (int i = 0; i < comparison->run_count; i++)
        if (comparison->runs[i].engine->outside && comparison->runs[i].remark[0])
            ck_answer_line(answer, CK_ANSWER_NOTE, "%s: %s", comparison->runs[i].engine->name,
                           comparison->runs[i].remark);
    for (int i = 0; i < comparison->run_count; i++)
        if (comparison->runs[i].engine->outside) show_pins(answer, &comparison->runs[i]);
    ck_answer_cheapest(arguments, comparison);
}

// Puts the recording before the engines that were asked for, which are none where none was.
static ck_Status add_recording(ck_Arguments *arguments, ck_Error *error) {
    ck_Engine *engine = NULL;
    ck_Comparison comparison;
    ck_CompareOptions *options = &arguments->options;
    ck_Status status = ck_comparison_load(&comparison, arguments->scenes[0], error);
    if (!status)
        status = ck_outside_recording(&engine, arguments->name ? arguments->name : "recorded", arguments->path,
                                      arguments->interval, 1e-3 * arguments->frame_cost, &comparison.model, error);
    ck_comparison_free(&comparison);
    if (!status) status = ck_engines_add(engine, error);
    if (status) {
        ck_outside_free(engine);
        return status;
    }
    bool has_others = options->engines == arguments->engines;
    int others = has_others ? options->engine_count : 0;
    if (others + 1 > CK_COMPARISON_MAX_ENGINES)
        return ck_fail(error, CK_BAD_INPUT, "at most %d engines beside a recording", CK_COMPARISON_MAX_ENGINES - 1);
    memmove(arguments->engines + 1, arguments->engines, (size_t)others * sizeof *arguments->engines);
    arguments->engines[0] = engine;
    options->engines = arguments->engines;
    options->engine_count = others + 1;
    return CK_OK;
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    if (!status && (arguments.scene_count != 1 || !arguments.path))
        status = ck_fail(&error, CK_BAD_INPUT, "score takes one SCENE and --path FILE; %d scenes%s are given",
                         arguments.scene_count, arguments.path ? "" : " and no file");
    if (!status) status = add_recording(&arguments, &error);
    arguments.by_engine = true;
    if (!arguments.out) arguments.options.consistency_budget = 0;
    if (!status) status = ck_command_compare_scenes(&arguments, show, &error);
    if (!status && arguments.out) {
        ck_answer_line(&arguments.answer, CK_ANSWER_FILES, "%s", arguments.out);
        ck_answer_line(&arguments.answer, CK_ANSWER_NEXT, "clothcheck report %s", arguments.out);
    } else if (!status) {
        ck_answer_line(&arguments.answer, CK_ANSWER_NEXT,
                       "the same with --engine native-verlet --out out, and clothcheck report out");
    }
    return ck_command_end(&arguments, status, &error);
}

const ck_Command ck_command_score = {
    .name = "score",
    .arguments = "SCENE",
    .about = "judges positions that another program recorded",
    .help =
        "Measures a recording as if it were an engine's run: status, all metrics, errors to the truth, and the "
        "distances to each\n--engine that runs beside it. With --out it writes the CSVs and the replay; --append adds "
        "it to a comparison that is\nthere. A recording may have fewer or more frames than the scene.",
    .groups = CK_TAKES_FORM | CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_TIMING | CK_TAKES_PATIENCE | CK_TAKES_JOBS |
              CK_TAKES_KEEPING | CK_TAKES_RECORDING,
    .seconds = 900,
    .patience = 10,
    .run = run,
};
