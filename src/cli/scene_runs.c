#include "command.h"
#include "files.h"
#include "process.h"
#include "tables.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int ck_command_fail(ck_Status status, const ck_Error *error) {
    fprintf(stderr, "clothcheck: %s\n", error->message);
    return status == CK_BAD_INPUT ? CK_EXIT_USAGE : CK_EXIT_FAILED;
}

static void interrupt(int signal_number) {
    (void)signal_number;
    ck_child_interrupted = 1;
}

void ck_command_catch_signals(void) {
    signal(SIGINT, interrupt);
    signal(SIGTERM, interrupt);
}

// How far a comparison of several scenes has come, for its line on the terminal.
static struct {
    int scene, scenes;
    double start; // of ck_wall
} far;

static void show_progress(const char *scene, const char *engine, const char *doing) {
    char left[60] = "";
    if (far.scene)
        snprintf(left, sizeof left, "; about %.0f s more",
                 (ck_wall() - far.start) / far.scene * (far.scenes - far.scene));
    if (far.scenes > 1)
        ck_progress_show("scene %d of %d%s: %s %s on %s", far.scene + 1, far.scenes, left, doing, engine, scene);
    else
        ck_progress_show("%s %s on %s", doing, engine, scene);
}

// Two scenes of one name would be one in the CSVs.
static ck_Status check_names(const ck_Comparison *comparisons, int count, ck_Error *error) {
    for (int i = 0; i < count; i++)
        for (int j = 0; j < i; j++)
            if (!strcmp(comparisons[i].model.name, comparisons[j].model.name))
                return ck_fail(error, CK_BAD_INPUT, "%s and %s are both named %s; give one of them another name",
                               comparisons[j].path, comparisons[i].path, comparisons[i].model.name);
    return CK_OK;
}

static ck_Status run_all(ck_Comparison *comparisons, const ck_Arguments *arguments, ck_Tables *tables,
                         void (*show)(const ck_Comparison *), ck_Error *error) {
    ck_CompareOptions options = arguments->options;
    ck_command_catch_signals();
    options.progress = show_progress;
    char *cache = arguments->out ? ck_path_join(arguments->out, "truths") : NULL;
    options.cache = cache;
    ck_Status status = CK_OK;
    far.start = ck_wall();
    far.scenes = arguments->scene_count;
    for (int i = 0; i < arguments->scene_count && !status; i++) {
        far.scene = i;
        status = ck_comparison_run(&comparisons[i], &options, error);
        ck_progress_clear();
        if (!status && arguments->out) ck_tables_add(tables, &comparisons[i], &options);
        if (!status && arguments->out) status = ck_replay_write(&comparisons[i], arguments->out, error);
        if (!status) show(&comparisons[i]);
        ck_comparison_free_runs(&comparisons[i]);
    }
    free(cache);
    return status;
}

int ck_command_study(const ck_Arguments *arguments, void (*show)(const ck_Comparison *comparison)) {
    ck_Error error = {0};
    ck_Tables tables = {0};
    int count = 0;
    ck_Comparison *comparisons = calloc((size_t)arguments->scene_count, sizeof *comparisons);
    ck_Status status = comparisons ? CK_OK : ck_fail(&error, CK_NO_MEMORY, "out of memory");
    for (; count < arguments->scene_count && !status; count++)
        status = ck_comparison_load(&comparisons[count], arguments->scenes[count], &error);
    if (!status) status = check_names(comparisons, count, &error);
    ck_Keeping keeping = arguments->forces ? CK_KEEP_NONE : arguments->appends ? CK_KEEP_OTHERS : CK_KEEP_OR_FAIL;
    if (!status && arguments->out)
        status = ck_tables_open(&tables, arguments->out, keeping, comparisons, count, &arguments->options, &error);
    if (!status) status = run_all(comparisons, arguments, &tables, show, &error);
    if (!status && arguments->out) status = ck_tables_close(&tables, &error);
    ck_tables_discard(&tables);
    for (int i = 0; i < count; i++) ck_comparison_free(&comparisons[i]);
    free(comparisons);
    return status ? ck_command_fail(status, &error) : CK_EXIT_OK;
}

// a number in three digits, or a dash where there is none
static void print_number(const char *format, int width, double number) {
    char text[32] = "-";
    if (!isnan(number)) snprintf(text, sizeof text, fabs(number) < 1e6 ? format : "%.3g", number);
    printf(" %*s", width, text);
}

static double value_of(const char *metric, const ck_Run *run, const ck_Model *model, const ck_Reference *reference) {
    return ck_metric_value(ck_metric_find(metric), model, &run->trajectory, reference);
}

static void print_engine(const ck_Comparison *comparison, int index) {
    const ck_Run *run = &comparison->runs[index];
    double sag = NAN, sag_error = NAN, distance = NAN, stretch = NAN;
    ck_Model model;
    ck_Reference reference;
    if (ck_comparison_scores(comparison, index, &model, &reference)) {
        sag = value_of("sag", run, &model, &reference);
        sag_error = fabs(sag - ck_metric_truth(ck_metric_find("sag"), &model, &reference));
        distance = value_of("position_rms", run, &model, &reference);
        stretch = value_of("stretch_max", run, &model, &reference);
    }
    double cost = 1e3 * ck_timing_median(&run->timing) / (run->timing.frames * run->model->step);
    printf("%-18s %-16s %-13s", run->model->name, run->engine->name, ck_run_status_names[run->status]);
    print_number("%.6f", 10, sag);
    print_number("%.1e", 9, sag_error);
    print_number("%.1e", 9, distance);
    print_number("%.4f", 8, stretch);
    print_number("%.3g", 9, cost);
    print_number("%.3g", 9, cost / 60);
    printf("\n");
}

// How well the truth is known, or why there is none.
static void print_truth(const ck_Comparison *comparison) {
    const ck_Truth *truth = &comparison->truth;
    if (!truth->form) return;
    double known = ck_truth_uncertainty(truth, &comparison->model, ck_metric_find("position_rms"));
    if (truth->path_count && !isnan(known))
        printf("  truth: %s, known to %.1e of the size\n", truth->kind, known);
    else if (!truth->path_count && !truth->reference.is_invariant)
        printf("  truth: %s\n", truth->kind);
}

void ck_print_summary(const ck_Comparison *comparison) {
    printf("%-18s %-16s %-13s %10s %9s %9s %8s %9s %9s\n", "scene", "engine", "status", "sag", "error", "rms error",
           "stretch", "ms CPU/s", "ms/frame");
    for (int i = 0; i < comparison->run_count; i++) print_engine(comparison, i);
    print_truth(comparison);
    for (int i = 0; i < comparison->run_count; i++) {
        const ck_Run *run = &comparison->runs[i];
        if (run->status != CK_RUN_OK && run->status != CK_RUN_UNSUPPORTED)
            printf("  %s %s: %.140s\n", run->engine->name, ck_run_status_names[run->status], run->reason);
    }
    fflush(stdout);
}
