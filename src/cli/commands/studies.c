// The studies of a scene that run a list of cases.
#include "studies.h"
#include "fit.h"
#include "needs.h"
#include "precision.h"
#include "stability_study.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static ck_Status run_precision(const ck_StudyCommand *command, ck_Error *error) {
    ck_Precision precision;
    ck_Csv csv = {0}, summary = {0};
    ck_JournalRow *rows = NULL;
    ck_Status status = ck_precision_create(&precision, command->comparison, &command->arguments->options, error);
    const ck_Study study = ck_precision_study(&precision);
    // it times its runs: side by side they would slow each other down
    if (!status) status = ck_study_command_run(command, &study, 1, &rows, error);
    if (!status) status = ck_study_command_open(command, &csv, CK_PRECISION, error);
    if (!status) status = ck_study_command_open(command, &summary, CK_PRECISION_SUMMARY, error);
    if (!status) ck_precision_write(&precision, rows, &csv, &summary);
    if (!status) status = ck_csv_close(&csv, error);
    if (!status) status = ck_csv_close(&summary, error);
    if (!status) status = ck_answer_precision(command->arguments, command->comparison->model.name, error);
    if (!status) ck_study_command_done(command, &study, "precision.csv, precision_summary.csv");
    ck_csv_discard(&csv);
    ck_csv_discard(&summary);
    free(rows);
    ck_precision_free(&precision);
    return status;
}

static int precision(const ck_Command *command, int argc, char **argv) {
    return ck_study_command(command, CK_PRECISION, argc, argv, run_precision);
}

const ck_Command ck_command_precision = {
    .name = "precision",
    .arguments = "SCENE...",
    .about = "error against cost over time steps and iterations: precision.csv",
    .help = "Runs every engine over time steps from an eighth to sixteen times as many substeps as its rule takes, and "
            "over\niterations; writes precision.csv with error, cost and the Pareto front, and precision_summary.csv "
            "with orders,\nfloors and the cost to reach 10, 1 and 0.1 %.",
    .groups = CK_TAKES_FORM | CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_KEEPING | CK_TAKES_TIMING | CK_TAKES_PATIENCE |
              CK_TAKES_JOBS | CK_TAKES_SHARD,
    .out = "out",
    .seconds = 900,
    .patience = 3,
    .full_patience = 20,
    .shares_out = true,
    .run = precision,
};

static ck_Status run_stability(const ck_StudyCommand *command, ck_Error *error) {
    ck_StabilityMap map;
    ck_Csv csv = {0};
    ck_JournalRow *rows = NULL;
    ck_Status status = ck_stability_map_create(&map, command->comparison, &command->arguments->options, error);
    const ck_Study study = ck_stability_map_study(&map);
    if (!status) status = ck_study_command_run(command, &study, 0, &rows, error);
    if (!status) status = ck_study_command_open(command, &csv, CK_STABILITY, error);
    if (!status) ck_stability_map_write(&map, rows, &csv);
    if (!status) status = ck_csv_close(&csv, error);
    if (!status)
        status = ck_answer_stability(command->answer, command->arguments->out, command->comparison->model.name, error);
    if (!status) ck_study_command_done(command, &study, "stability.csv");
    ck_csv_discard(&csv);
    free(rows);
    ck_stability_map_free(&map);
    return status;
}

static int stability(const ck_Command *command, int argc, char **argv) {
    return ck_study_command(command, CK_STABILITY, argc, argv, run_stability);
}

const ck_Command ck_command_stability = {
    .name = "stability",
    .arguments = "SCENE...",
    .about = "where methods fail: time step against stiffness: stability.csv",
    .help = "Pushes the scene's rest and steps it: a map over time steps, stiffnesses and iterations, and the critical "
            "step by\nbisection to 1 % beside what theory says; writes stability.csv.",
    .groups = CK_TAKES_FORM | CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_KEEPING | CK_TAKES_JOBS | CK_TAKES_SHARD,
    .out = "out",
    .seconds = 10,
    .shares_out = true,
    .run = stability,
};

// The engine that is asked for, else the first that models all there is.
static const ck_Engine *choose_engine(const ck_StudyCommand *command) {
    const ck_CompareOptions *options = &command->arguments->options;
    for (int i = 0; i < options->engine_count; i++)
        if (!ck_engine_lacks(options->engines[i], &command->comparison->model)) return options->engines[i];
    return options->engines[0];
}

static ck_Status run_needs(const ck_StudyCommand *command, ck_Error *error) {
    const ck_Arguments *arguments = command->arguments;
    ck_Needs needs;
    ck_Csv csv = {0};
    ck_JournalRow *rows = NULL;
    const ck_Engine *engine = choose_engine(command);
    const ck_Settings given = ck_comparison_settings(engine, &command->comparison->scene, &arguments->options);
    ck_Status status =
        ck_needs_create(&needs, command->comparison, engine, isnan(arguments->error) ? 0.01 : arguments->error, &given,
                        &arguments->options.limits, error);
    const ck_Study study = ck_needs_study(&needs);
    if (!status) status = ck_study_command_run(command, &study, 1, &rows, error);
    if (!status) status = ck_study_command_open(command, &csv, CK_NEEDS, error);
    if (!status) ck_needs_write(&needs, rows, &csv);
    if (!status) status = ck_csv_close(&csv, error);
    if (!status) status = ck_answer_needs(command->answer, arguments->out, command->comparison->model.name, error);
    if (!status) ck_study_command_done(command, &study, "needs.csv");
    ck_csv_discard(&csv);
    free(rows);
    ck_needs_free(&needs);
    return status;
}

static int needs(const ck_Command *command, int argc, char **argv) {
    return ck_study_command(command, CK_NEEDS, argc, argv, run_needs);
}

const ck_Command ck_command_needs = {
    .name = "needs",
    .arguments = "SCENE...",
    .about = "what the scene needs to be modelled, and what not: needs.csv",
    .help = "Leaves out one modelled term at a time, and every second particle, and says which of them change any "
            "metric by\nmore than --error (default 0.01), and what each costs; writes needs.csv. The engine is the "
            "first that models all\nthere is, or --engine.",
    .groups = CK_TAKES_FORM | CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_KEEPING | CK_TAKES_JOBS | CK_TAKES_SHARD |
              CK_TAKES_ERROR,
    .out = "out",
    .seconds = 60,
    .shares_out = true,
    .run = needs,
};

// Values as a scene file takes them, and which of them the data hardly tell apart.
static void show_fit(ck_Answer *answer, const ck_Fit *fit, const ck_FitOptions *options,
                     const ck_Comparison *comparison) {
    static const ck_AnswerColumn columns[] = {{"parameter", "parameter", -10, NULL},
                                              {"unit", "unit", -6, NULL},
                                              {"value", "value", 12, "%.5g"},
                                              {"low", "from", 12, "%.5g"},
                                              {"high", "to (95 %)", 12, "%.5g"},
                                              {"start", "started at", 12, "%.5g"},
                                              {NULL, NULL, 0, NULL}};
    ck_answer_table(answer, "fit", NULL, columns);
    for (int i = 0; i < CK_FIT_PARAMETERS; i++) {
        if (!options->varies[i]) continue;
        ck_answer_text(answer, ck_fit_names[i]);
        ck_answer_text(answer, ck_fit_units[i]);
        const double numbers[] = {fit->value[i], fit->low[i], fit->high[i], fit->start[i]};
        for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) ck_answer_number(answer, numbers[k]);
    }
    ck_answer_line(answer, CK_ANSWER_SAYS, "%s: %d numbers, %d runs, %.2g times the uncertainty is left%s",
                   comparison->model.name, fit->number_count, fit->evaluations, fit->misfit,
                   fit->misfit > 2 ? ": the model is not what was measured, or the uncertainty is larger" : "");
    for (int i = 0; i < CK_FIT_PARAMETERS; i++)
        for (int k = 0; k < i; k++)
            if (options->varies[i] && options->varies[k] && fabs(fit->correlation[i][k]) > 0.98)
                ck_answer_line(answer, CK_ANSWER_SAYS,
                               "the data hardly tell %s from %s (correlation %.4f): only together are they known",
                               ck_fit_names[i], ck_fit_names[k], fit->correlation[i][k]);
}

static ck_Status read_fit(ck_FitOptions *options, const ck_StudyCommand *command, ck_Error *error) {
    const ck_Arguments *arguments = command->arguments;
    bool has_engine = arguments->options.engines == arguments->engines;
    if (has_engine && arguments->options.engine_count != 1)
        return ck_fail(error, CK_BAD_INPUT, "fit takes one --engine, or none for the scene's truth");
    *options =
        (ck_FitOptions){.engine = has_engine ? arguments->engines[0] : NULL, .limits = arguments->options.limits};
    if (has_engine)
        options->settings = ck_comparison_settings(options->engine, &command->comparison->scene, &arguments->options);
    for (int i = 0; i < arguments->vary_count; i++) {
        int parameter = 0;
        while (parameter < CK_FIT_PARAMETERS && strcmp(arguments->varies[i], ck_fit_names[parameter])) parameter++;
        if (parameter == CK_FIT_PARAMETERS)
            return ck_fail(error, CK_BAD_INPUT, "--vary %s: it must be stiffness, damping or drag",
                           arguments->varies[i]);
        options->varies[parameter] = true;
    }
    return CK_OK;
}

static ck_Status run_fit(const ck_StudyCommand *command, ck_Error *error) {
    const ck_Arguments *arguments = command->arguments;
    ck_FitOptions options;
    ck_FitData data = {0};
    ck_Fit fit;
    ck_Csv csv = {0};
    ck_Status status = read_fit(&options, command, error);
    if (!status && arguments->points)
        status = ck_recording_read(&data.points, arguments->points, &command->comparison->model, 0, error);
    data.uncertainty = arguments->uncertainty;
    if (!status) status = ck_fit_run(&fit, command->comparison, &data, &options, error);
    if (!status) status = ck_study_command_open(command, &csv, CK_FIT, error);
    if (!status) ck_fit_write(&fit, command->comparison, &options, &csv);
    if (!status) status = ck_csv_close(&csv, error);
    if (!status) {
        show_fit(command->answer, &fit, &options, command->comparison);
        ck_answer_line(command->answer, CK_ANSWER_FILES, "%s/fit.csv", arguments->out);
        ck_answer_line(command->answer, CK_ANSWER_NEXT, "put the values into the scene, then clothcheck compare %s",
                       command->comparison->path);
    }
    ck_csv_discard(&csv);
    ck_recording_free(&data.points);
    return status;
}

static int fit_values(const ck_Command *command, int argc, char **argv) {
    return ck_study_command(command, CK_FIT, argc, argv, run_fit);
}

const ck_Command ck_command_fit = {
    .name = "fit",
    .arguments = "SCENE",
    .about = "stiffness, damping and drag from a measurement: fit.csv",
    .help = "Finds the values of --vary stiffness, damping or drag at which the scene's truth, or one --engine, comes "
            "closest "
            "to\nwhat was measured: --points FILE, and the scene's own key measured. Each comes with the interval that "
            "the\nmeasurement's uncertainty leaves. The scene's values are the start.",
    .groups = CK_TAKES_FORM | CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_KEEPING | CK_TAKES_FIT,
    .out = "out",
    .seconds = 60,
    .run = fit_values,
};
