// What a command's result comes to, in a few lines on the terminal.
#include "command.h"
#include "csv_reader.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// An engine that answers: its error and its cost, ms a simulated second.
typedef struct Answer {
    const ck_Engine *engine;
    double error, cost;
} Answer;

static int compare_costs(const void *a, const void *b) {
    double x = ((const Answer *)a)->cost, y = ((const Answer *)b)->cost;
    return (x > y) - (x < y);
}

// The engines that came to their end and are within 1 %, the cheapest first.
static int find_answers(const ck_Comparison *comparison, Answer *answers) {
    const ck_Metric *position = ck_metric_find("position_rms");
    int count = 0;
    for (int i = 0; i < comparison->run_count; i++) {
        const ck_Run *run = &comparison->runs[i];
        if (run->status != CK_RUN_OK || run->engine->method == CK_METHOD_STILL || !ck_run_has_all_frames(run)) continue;
        double simulated = run->timing.frames * run->model->step,
               error = ck_metric_value(position, run->model, &run->trajectory, &comparison->truth.reference);
        if (error <= 0.01 && run->timing.repeat_count)
            answers[count++] = (Answer){run->engine, error, 1e3 * ck_timing_median(&run->timing) / simulated};
    }
    qsort(answers, (size_t)count, sizeof *answers, compare_costs);
    return count;
}

void ck_print_answer(const ck_Comparison *comparison) {
    const char *name = comparison->model.name;
    Answer answers[CK_COMPARISON_MAX_ENGINES];
    if (!comparison->truth.reference.trajectory.frame_count) {
        printf("=> %s: no truth knows its positions; look at what the engines agree on: the page shows it\n", name);
        return;
    }
    int count = find_answers(comparison, answers);
    int timed = 0;
    for (int i = 0; i < comparison->run_count; i++) timed += comparison->runs[i].timing.repeat_count > 0;
    if (!timed) return;
    if (!count) {
        printf("=> %s: no engine that was timed is within 1 %% of the truth; 'clothcheck precision' refines them\n",
               name);
        return;
    }
    printf("=> %s: the cheapest within 1 %% of the truth is %s: %.2g %% off, %.3g ms a simulated second", name,
           answers[0].engine->name, 100 * answers[0].error, answers[0].cost);
    if (count > 1)
        printf("; next %s: %.2g %%, %.2g times as long", answers[1].engine->name, 100 * answers[1].error,
               answers[1].cost / answers[0].cost);
    printf("\n");
}

static double number(const ck_CsvTable *table, int row, const char *column) {
    return ck_csv_table_number(table, row, ck_layout_column(table->layout, column));
}

static const char *text(const ck_CsvTable *table, int row, const char *column) {
    return ck_csv_table_text(table, row, ck_layout_column(table->layout, column));
}

static bool is_of(const ck_CsvTable *table, int row, const char *scene, const char *engine) {
    return !strcmp(text(table, row, "scene"), scene) && !strcmp(text(table, row, "engine"), engine);
}

// True for the first row of an engine on a scene.
static bool is_new(const ck_CsvTable *table, int row, const char *scene) {
    if (strcmp(text(table, row, "scene"), scene)) return false;
    for (int i = 0; i < row; i++)
        if (is_of(table, i, scene, text(table, row, "engine"))) return false;
    return true;
}

// The cheapest setting of an engine within an error: seconds, substeps and iterations.
static void print_cost(const ck_CsvTable *table, const char *scene, const char *engine, double error) {
    int best = -1;
    for (int i = 0; i < table->row_count; i++)
        if (is_of(table, i, scene, engine) && !strcmp(text(table, i, "status"), "ok") &&
            number(table, i, "error") <= error &&
            (best < 0 || number(table, i, "cpu_s") < number(table, best, "cpu_s")))
            best = i;
    char cost[60] = "never";
    if (best >= 0)
        snprintf(cost, sizeof cost, "%.3g s (%s x %s)", number(table, best, "cpu_s"), text(table, best, "substeps"),
                 text(table, best, "iterations"));
    printf("  %-22s", cost);
}

ck_Status ck_print_precision(const char *directory, const char *scene, ck_Error *error) {
    ck_CsvTable table = {0};
    ck_Status status = ck_csv_table_read(&table, directory, &ck_layouts[CK_PRECISION], error);
    if (!status)
        printf("CPU seconds for the whole of %s, at so many substeps x iterations a frame\n%-16s %9s  %-22s  %-22s  "
               "%-22s\n",
               scene, "engine", "least", "to 10 %", "to 1 %", "to 0.1 %");
    for (int i = 0; i < table.row_count && !status; i++) {
        const char *engine = text(&table, i, "engine");
        double least = INFINITY;
        if (!is_new(&table, i, scene)) continue;
        for (int k = i; k < table.row_count; k++)
            if (is_of(&table, k, scene, engine) && !strcmp(text(&table, k, "status"), "ok"))
                least = fmin(least, number(&table, k, "error"));
        printf(isfinite(least) ? "%-16s %9.1e" : "%-16s         -", engine, least);
        print_cost(&table, scene, engine, 0.1);
        print_cost(&table, scene, engine, 0.01);
        print_cost(&table, scene, engine, 0.001);
        printf("\n");
    }
    ck_csv_table_free(&table);
    return status;
}

ck_Status ck_print_stability(const char *directory, const char *scene, ck_Error *error) {
    ck_CsvTable table = {0};
    ck_Status status = ck_csv_table_read(&table, directory, &ck_layouts[CK_STABILITY], error);
    if (!status)
        printf("The longest stable step about the rest of %s\n%-16s %-10s %11s %11s %7s\n", scene, "engine", "damping",
               "measured, s", "theory, s", "ratio");
    for (int i = 0; i < table.row_count && !status; i++) {
        double critical = number(&table, i, "critical_step_s"), theory = number(&table, i, "predicted_step_s");
        if (strcmp(text(&table, i, "scene"), scene) || strcmp(text(&table, i, "case"), "critical")) continue;
        printf("%-16s %-10s", text(&table, i, "engine"), text(&table, i, "damping"));
        if (isnan(critical)) {
            printf(" %s: %.80s\n", text(&table, i, "status"), text(&table, i, "reason"));
            continue;
        }
        printf(" %11.5g", critical);
        if (!isnan(theory)) printf(" %11.5g %7.3f", theory, critical / theory);
        printf("\n");
    }
    ck_csv_table_free(&table);
    return status;
}

ck_Status ck_print_bench(const char *directory, ck_Error *error) {
    ck_CsvTable table = {0};
    ck_Status status = ck_csv_table_read(&table, directory, &ck_layouts[CK_BENCH], error);
    if (!status) printf("%-8s %9s  %-16s %-28s %s\n", "body", "particles", "engine", "set-up", "ns a spring");
    for (int i = 0; i < table.row_count && !status; i++) {
        double value = number(&table, i, "value");
        if (strcmp(text(&table, i, "metric"), "update_time") || isnan(value)) continue;
        printf("%-8s %9.0f  %-16s %-28s %.3g\n", text(&table, i, "body"), number(&table, i, "particles"),
               text(&table, i, "engine"), text(&table, i, "setup"), value);
    }
    ck_csv_table_free(&table);
    return status;
}

ck_Status ck_print_quirks(const char *directory, ck_Error *error) {
    ck_CsvTable table = {0};
    ck_Status status = ck_csv_table_read(&table, directory, &ck_layouts[CK_QUIRKS], error);
    if (!status) printf("%-12s %-40s %-18s %11s %11s %11s\n", "engine", "quirk", "", "as it was", "mended", "physics");
    for (int i = 0; i < table.row_count && !status; i++)
        printf("%-12s %-40.40s %-18.18s %11.4g %11.4g %11.4g\n", text(&table, i, "engine"), text(&table, i, "quirk"),
               text(&table, i, "metric"), number(&table, i, "as_it_was"), number(&table, i, "mended"),
               number(&table, i, "physics"));
    ck_csv_table_free(&table);
    return status;
}
