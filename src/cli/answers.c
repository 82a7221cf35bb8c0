// What a command's result comes to, in a few lines on the terminal.
#include "command.h"
#include "csv_reader.h"
#include "finding.h"

#include <fnmatch.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// An engine that answers: its error and its cost, ms a simulated second.
typedef struct Candidate {
    const ck_Engine *engine;
    double error, cost;
} Candidate;

static int compare_costs(const void *a, const void *b) {
    double x = ((const Candidate *)a)->cost, y = ((const Candidate *)b)->cost;
    return (x > y) - (x < y);
}

static bool is_ranked(const ck_Arguments *arguments, const char *engine) {
    return !arguments->rank_without || fnmatch(arguments->rank_without, engine, 0);
}

// The engines that came to their end and are within an error, the cheapest first. None is nearer than the truth is
// known.
static int find_candidates(const ck_Arguments *arguments, const ck_Comparison *comparison, double within,
                           double uncertainty, Candidate *found) {
    const ck_Metric *position = ck_metric_find("position_rms");
    int count = 0;
    for (int i = 0; i < comparison->run_count; i++) {
        const ck_Run *run = &comparison->runs[i];
        if (run->status != CK_RUN_OK || run->engine->method == CK_METHOD_STILL || !ck_run_has_all_frames(run) ||
            !is_ranked(arguments, run->engine->name))
            continue;
        double simulated = run->timing.frames * run->model->step,
               error = ck_metric_value(position, run->model, &run->trajectory, &comparison->truth.reference);
        if (error <= within && run->timing.repeat_count)
            found[count++] =
                (Candidate){run->engine, fmax(error, uncertainty), 1e3 * ck_timing_median(&run->timing) / simulated};
    }
    qsort(found, (size_t)count, sizeof *found, compare_costs);
    return count;
}

void ck_answer_cheapest(ck_Arguments *arguments, const ck_Comparison *comparison) {
    ck_Answer *answer = &arguments->answer;
    const char *name = comparison->model.name;
    Candidate found[CK_COMPARISON_MAX_ENGINES];
    if (!comparison->truth.reference.trajectory.frame_count) {
        ck_answer_line(answer, CK_ANSWER_SAYS,
                       "%s: no truth knows its positions; look at what the engines agree on: the page shows it", name);
        return;
    }
    double known = ck_truth_uncertainty(&comparison->truth, &comparison->model, ck_metric_find("position_rms"));
    if (isnan(known)) known = 0;
    const double within = fmax(0.01, known);
    int count = find_candidates(arguments, comparison, within, known, found), timed = 0;
    for (int i = 0; i < comparison->run_count; i++) timed += comparison->runs[i].timing.repeat_count > 0;
    if (!timed) return;
    if (!count) {
        ck_answer_line(
            answer, CK_ANSWER_SAYS,
            "%s: no engine that was timed is within %.2g %% of the truth; 'clothcheck precision' refines them", name,
            100 * within);
        return;
    }
    char next[100] = "";
    if (count > 1)
        snprintf(next, sizeof next, "; next %s: %.2g %%, %.2g times as long", found[1].engine->name,
                 100 * found[1].error, found[1].cost / found[0].cost);
    ck_answer_line(answer, CK_ANSWER_SAYS,
                   "%s: the cheapest within %.2g %% of the truth%s is %s: %.2g %% off, %.3g ms a simulated second%s",
                   name, 100 * within, known > 0.01 ? ", which is not known better," : "", found[0].engine->name,
                   100 * found[0].error, found[0].cost, next);
}

static double value_of(const char *metric, const ck_Run *run, const ck_Model *model, const ck_Reference *reference) {
    return ck_metric_value(ck_metric_find(metric), model, &run->trajectory, reference);
}

static void add_engine(ck_Answer *answer, const ck_Comparison *comparison, int index) {
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
    ck_answer_text(answer, run->model->name);
    ck_answer_text(answer, run->engine->name);
    ck_answer_text(answer, ck_run_status_names[run->status]);
    const double numbers[] = {sag, sag_error, distance, stretch, cost, cost / 60};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) ck_answer_number(answer, numbers[i]);
}

// How well the truth is known, or why there is none.
static void add_truth(ck_Answer *answer, const ck_Comparison *comparison) {
    const ck_Truth *truth = &comparison->truth;
    if (!truth->form) return;
    double known = ck_truth_uncertainty(truth, &comparison->model, ck_metric_find("position_rms"));
    if (truth->path_count && !isnan(known))
        ck_answer_line(answer, CK_ANSWER_NOTE, "truth: %s, known to %.1e of the size", truth->kind, known);
    else if (!truth->path_count && !truth->reference.is_invariant)
        ck_answer_line(answer, CK_ANSWER_NOTE, "truth: %s", truth->kind);
}

void ck_answer_summary(ck_Arguments *arguments, const ck_Comparison *comparison) {
    ck_Answer *answer = &arguments->answer;
    static const ck_AnswerColumn columns[] = {{"scene", "scene", -18, NULL},
                                              {"engine", "engine", -16, NULL},
                                              {"status", "status", -13, NULL},
                                              {"sag", "sag", 10, "%.6f"},
                                              {"sag_error", "error", 9, "%.1e"},
                                              {"position_rms", "rms error", 9, "%.1e"},
                                              {"stretch_max", "stretch", 8, "%.4f"},
                                              {"cpu_ms_per_s", "ms CPU/s", 9, "%.3g"},
                                              {"cpu_ms_per_frame", "ms/frame", 9, "%.3g"},
                                              {NULL, NULL, 0, NULL}};
    ck_answer_table(answer, "runs", NULL, columns);
    for (int i = 0; i < comparison->run_count; i++) add_engine(answer, comparison, i);
    add_truth(answer, comparison);
    for (int i = 0; i < comparison->run_count; i++) {
        const ck_Run *run = &comparison->runs[i];
        if (run->status != CK_RUN_OK && run->status != CK_RUN_UNSUPPORTED)
            ck_answer_line(answer, CK_ANSWER_NOTE, "%s %s: %s", run->engine->name, ck_run_status_names[run->status],
                           run->reason);
    }
    fflush(stdout);
}

static bool is_of(const ck_CsvTable *table, int row, const char *scene, const char *engine) {
    return !strcmp(ck_csv_text_of(table, row, "scene"), scene) && !strcmp(ck_csv_text_of(table, row, "engine"), engine);
}

// True for the first row of an engine on a scene.
static bool is_new(const ck_CsvTable *table, int row, const char *scene) {
    if (strcmp(ck_csv_text_of(table, row, "scene"), scene)) return false;
    for (int i = 0; i < row; i++)
        if (is_of(table, i, scene, ck_csv_text_of(table, row, "engine"))) return false;
    return true;
}

// The value of an engine's row of the summary; NAN where there is none.
static double summary_of(const ck_CsvTable *table, const char *scene, const char *engine, const char *quantity) {
    for (int i = 0; i < table->row_count; i++)
        if (is_of(table, i, scene, engine) && !strcmp(ck_csv_text_of(table, i, "quantity"), quantity))
            return ck_csv_number_of(table, i, "value");
    return NAN;
}

// The cheapest setting of an engine within an error: seconds, substeps and iterations.
static void add_cost(ck_Answer *answer, const ck_CsvTable *table, const char *scene, const char *engine, double error) {
    int best = -1;
    for (int i = 0; i < table->row_count; i++)
        if (is_of(table, i, scene, engine) && !strcmp(ck_csv_text_of(table, i, "status"), "ok") &&
            ck_csv_number_of(table, i, "error") <= error &&
            (best < 0 || ck_csv_number_of(table, i, "cpu_s") < ck_csv_number_of(table, best, "cpu_s")))
            best = i;
    char setting[60] = "";
    if (best >= 0)
        snprintf(setting, sizeof setting, "%s x %s", ck_csv_text_of(table, best, "substeps"),
                 ck_csv_text_of(table, best, "iterations"));
    ck_answer_number(answer, best < 0 ? NAN : ck_csv_number_of(table, best, "cpu_s"));
    ck_answer_text(answer, setting);
}

static void add_precision(ck_Answer *answer, const ck_CsvTable *table, const ck_CsvTable *summary, const char *scene) {
    static const ck_AnswerColumn columns[] = {{"engine", "engine", -16, NULL},
                                              {"least_error", "least", 8, "%.1e"},
                                              {"order", "order", 6, "%.2f"},
                                              {"cpu_to_10_percent_s", "to 10 %, s", 10, "%.3g"},
                                              {"setting_to_10_percent", "", -10, NULL},
                                              {"cpu_to_1_percent_s", "to 1 %, s", 10, "%.3g"},
                                              {"setting_to_1_percent", "", -10, NULL},
                                              {"cpu_to_0.1_percent_s", "to 0.1 %, s", 11, "%.3g"},
                                              {"setting_to_0.1_percent", "", -10, NULL},
                                              {NULL, NULL, 0, NULL}};
    char title[200];
    snprintf(title, sizeof title, "CPU seconds for the whole of %.100s, at so many substeps x iterations a frame",
             scene);
    ck_answer_table(answer, "precision", title, columns);
    for (int i = 0; i < table->row_count; i++) {
        const char *engine = ck_csv_text_of(table, i, "engine");
        if (!is_new(table, i, scene)) continue;
        ck_answer_text(answer, engine);
        ck_answer_number(answer, summary_of(summary, scene, engine, "floor"));
        ck_answer_number(answer, summary_of(summary, scene, engine, "order"));
        add_cost(answer, table, scene, engine, 0.1);
        add_cost(answer, table, scene, engine, 0.01);
        add_cost(answer, table, scene, engine, 0.001);
    }
}

// Who is the cheapest within 1 %.
static void say_precision(ck_Arguments *arguments, const ck_CsvTable *summary, const char *scene) {
    ck_Answer *answer = &arguments->answer;
    int best = -1;
    for (int i = 0; i < summary->row_count; i++) {
        if (strcmp(ck_csv_text_of(summary, i, "scene"), scene)) continue;
        if (!strcmp(ck_csv_text_of(summary, i, "quantity"), "cost_to_1_percent") &&
            is_ranked(arguments, ck_csv_text_of(summary, i, "engine")) &&
            !isnan(ck_csv_number_of(summary, i, "value")) &&
            (best < 0 || ck_csv_number_of(summary, i, "value") < ck_csv_number_of(summary, best, "value")))
            best = i;
    }
    ck_answer_line(answer, CK_ANSWER_NOTE,
                   "every engine was given the same: an eighth to sixteen times the substeps of its own rule, and %g s "
                   "of CPU a run",
                   arguments->options.limits.patience);
    if (best < 0)
        ck_answer_line(answer, CK_ANSWER_SAYS, "%s: no engine comes within 1 %% at any setting tried", scene);
    else
        ck_answer_line(answer, CK_ANSWER_SAYS, "%s: the cheapest way to 1 %% is %s, %.3g s", scene,
                       ck_csv_text_of(summary, best, "engine"), ck_csv_number_of(summary, best, "value"));
}

ck_Status ck_answer_precision(ck_Arguments *arguments, const char *scene, ck_Error *error) {
    ck_CsvTable table = {0}, summary = {0};
    ck_Status status = ck_csv_table_read(&table, arguments->out, &ck_layouts[CK_PRECISION], error);
    if (!status) status = ck_csv_table_read(&summary, arguments->out, &ck_layouts[CK_PRECISION_SUMMARY], error);
    if (!status) add_precision(&arguments->answer, &table, &summary, scene);
    if (!status) say_precision(arguments, &summary, scene);
    if (!status) status = ck_answer_findings(arguments, scene, error);
    ck_csv_table_free(&table);
    ck_csv_table_free(&summary);
    return status;
}

ck_Status ck_answer_stability(ck_Answer *answer, const char *directory, const char *scene, ck_Error *error) {
    static const ck_AnswerColumn columns[] = {{"engine", "engine", -16, NULL},
                                              {"damping", "damping", -10, NULL},
                                              {"critical_step_s", "measured, s", 11, "%.5g"},
                                              {"predicted_step_s", "theory, s", 11, "%.5g"},
                                              {"ratio", "ratio", 7, "%.3f"},
                                              {"status", "status", -13, NULL},
                                              {NULL, NULL, 0, NULL}};
    ck_CsvTable table = {0};
    char title[160];
    snprintf(title, sizeof title, "The longest stable step about the rest of %.100s", scene);
    ck_Status status = ck_csv_table_read(&table, directory, &ck_layouts[CK_STABILITY], error);
    if (!status) ck_answer_table(answer, "stability", title, columns);
    for (int pass = 0; pass < 2 && !status; pass++)
        for (int i = 0; i < table.row_count; i++) {
            double critical = ck_csv_number_of(&table, i, "critical_step_s"),
                   theory = ck_csv_number_of(&table, i, "predicted_step_s");
            if (strcmp(ck_csv_text_of(&table, i, "scene"), scene) ||
                strcmp(ck_csv_text_of(&table, i, "case"), "critical"))
                continue;
            if (pass && isnan(critical))
                ck_answer_line(answer, CK_ANSWER_NOTE, "%s %s: %s", ck_csv_text_of(&table, i, "engine"),
                               ck_csv_text_of(&table, i, "damping"), ck_csv_text_of(&table, i, "reason"));
            if (pass) continue;
            ck_answer_text(answer, ck_csv_text_of(&table, i, "engine"));
            ck_answer_text(answer, ck_csv_text_of(&table, i, "damping"));
            ck_answer_number(answer, critical);
            ck_answer_number(answer, theory);
            ck_answer_number(answer, critical / theory);
            ck_answer_text(answer, ck_csv_text_of(&table, i, "status"));
        }
    ck_csv_table_free(&table);
    return status;
}

// The metrics that a case without a term changes, by how much.
static void list_changes(const ck_CsvTable *table, int first, char *changes, size_t size) {
    size_t used = 0;
    for (int i = first; i < table->row_count && used < size; i++) {
        if (!is_of(table, i, ck_csv_text_of(table, first, "scene"), ck_csv_text_of(table, first, "engine")) ||
            strcmp(ck_csv_text_of(table, i, "left_out"), ck_csv_text_of(table, first, "left_out")) ||
            strcmp(ck_csv_text_of(table, i, "matters"), "yes"))
            continue;
        const char *metric = ck_csv_text_of(table, i, "metric"), *separator = used ? ", " : "";
        double change = ck_csv_number_of(table, i, "change");
        used +=
            (size_t)(isinf(change) ? snprintf(changes + used, size - used, "%s%s (has none %s)", separator, metric,
                                              isnan(ck_csv_number_of(table, i, "with")) ? "with" : "without")
                                   : snprintf(changes + used, size - used, "%s%s by %.2g", separator, metric, change));
    }
}

static void add_need(ck_Answer *answer, const ck_CsvTable *table, int row) {
    char changes[400] = "";
    bool has_metric = *ck_csv_text_of(table, row, "metric");
    if (has_metric) list_changes(table, row, changes, sizeof changes);
    bool was_refused = !strcmp(ck_csv_text_of(table, row, "status"), ck_run_status_names[CK_RUN_REFUSED]);
    ck_answer_text(answer, ck_csv_text_of(table, row, "left_out"));
    ck_answer_text(answer, was_refused ? "not tried" : !has_metric || *changes ? "is needed" : "is not needed");
    ck_answer_number(answer, ck_csv_number_of(table, row, "cpu_with_s"));
    ck_answer_number(answer, ck_csv_number_of(table, row, "cpu_without_s"));
    ck_answer_text(answer, has_metric ? changes : ck_csv_text_of(table, row, "reason"));
}

ck_Status ck_answer_needs(ck_Answer *answer, const char *directory, const char *scene, ck_Error *error) {
    static const ck_AnswerColumn columns[] = {
        {"left_out", "left out", -24, NULL},     {"verdict", "", -13, NULL},        {"cpu_with_s", "CPU, s", 9, "%.3g"},
        {"cpu_without_s", "without", 9, "%.3g"}, {"changes", "changes", -20, NULL}, {NULL, NULL, 0, NULL}};
    ck_CsvTable table = {0};
    ck_Status status = ck_csv_table_read(&table, directory, &ck_layouts[CK_NEEDS], error);
    if (!status) ck_answer_table(answer, "needs", NULL, columns);
    for (int i = 0; i < table.row_count && !status; i++) {
        bool is_first = !strcmp(ck_csv_text_of(&table, i, "scene"), scene);
        for (int k = 0; k < i && is_first; k++)
            is_first = !is_of(&table, k, scene, ck_csv_text_of(&table, i, "engine")) ||
                       strcmp(ck_csv_text_of(&table, k, "left_out"), ck_csv_text_of(&table, i, "left_out"));
        if (is_first) add_need(answer, &table, i);
    }
    ck_csv_table_free(&table);
    return status;
}

ck_Status ck_answer_findings(ck_Arguments *arguments, const char *scene, ck_Error *error) {
    enum { MOST = 8 };
    ck_Findings findings;
    ck_Status status = ck_findings_read(&findings, arguments->out, error);
    int shown = 0;
    for (int i = 0; i < findings.count && !status; i++) {
        if (scene && strcmp(findings.items[i].scene, scene)) continue;
        if (shown++ < MOST)
            ck_answer_line(&arguments->answer, CK_ANSWER_NOTE, "%s: %s", findings.items[i].kind,
                           findings.items[i].text);
    }
    if (shown > MOST) ck_answer_line(&arguments->answer, CK_ANSWER_NEXT, "clothcheck findings %s", arguments->out);
    ck_findings_free(&findings);
    return status;
}

#define COST "cost_to_"

// What it costs each engine to be as right as is asked, where it is at all.
static void add_bench_costs(ck_Answer *answer, const ck_CsvTable *table) {
    static const ck_AnswerColumn columns[] = {
        {"particles", "particles", 9, "%.0f"},        {"engine", "engine", -16, NULL},
        {"setup", "springs and settings", -38, NULL}, {"error", "error", -11, NULL},
        {"ms_per_second", "ms CPU/s", 9, "%.3g"},     {NULL, NULL, 0, NULL}};
    bool is_begun = false;
    for (int i = 0; i < table->row_count; i++) {
        const char *metric = ck_csv_text_of(table, i, "metric");
        const double value = ck_csv_number_of(table, i, "value");
        if (strncmp(metric, COST, strlen(COST)) || isnan(value)) continue;
        if (!is_begun)
            ck_answer_table(answer, "costs", "\nthe cheapest settings within an error of a fine reference", columns);
        is_begun = true;
        ck_answer_number(answer, ck_csv_number_of(table, i, "particles"));
        ck_answer_text(answer, ck_csv_text_of(table, i, "engine"));
        ck_answer_text(answer, ck_csv_text_of(table, i, "setup"));
        ck_answer_text(answer, metric + strlen(COST));
        ck_answer_number(answer, 1e3 * value);
    }
}

#define BENCH_COLUMNS                                                                                                  \
    {"body", "body", -8, NULL}, {"particles", "particles", 9, "%.0f"}, {"engine", "engine", -16, NULL}, {              \
        "setup", "set-up", -28, NULL                                                                                   \
    }

// A part of the benchmark, by its metric: a number for each body, engine and set-up.
typedef struct BenchPart {
    const char *name, *title, *metric;
    double scale; // from the CSV's unit
    ck_AnswerColumn columns[6];
} BenchPart;

static const BenchPart bench_parts[] = {
    {"bench", NULL, "update_time", 1, {BENCH_COLUMNS, {"ns_per_spring", "ns a spring", 11, "%.3g"}}},
    {"seconds",
     "\na simulated second, at each engine's own step",
     "second_time",
     1e3,
     {BENCH_COLUMNS, {"ms_per_second", "ms CPU/s", 11, "%.3g"}}},
    {"strain",
     "\nfrom bars a tenth too long to an rms strain of 4 %",
     "time_to_strain",
     1e3,
     {BENCH_COLUMNS, {"ms_to_strain", "CPU, ms", 11, "%.3g"}}},
    {"growth",
     "\nas a cloth grows",
     "growth_step_time",
     1e3,
     {BENCH_COLUMNS, {"ms_per_step", "ms a step", 11, "%.3g"}}},
};

static void add_bench_part(ck_Answer *answer, const ck_CsvTable *table, const BenchPart *part) {
    bool is_begun = false;
    for (int i = 0; i < table->row_count; i++) {
        const double value = ck_csv_number_of(table, i, "value");
        if (strcmp(ck_csv_text_of(table, i, "metric"), part->metric) || isnan(value)) continue;
        if (!is_begun) ck_answer_table(answer, part->name, part->title, part->columns);
        is_begun = true;
        ck_answer_text(answer, ck_csv_text_of(table, i, "body"));
        ck_answer_number(answer, ck_csv_number_of(table, i, "particles"));
        ck_answer_text(answer, ck_csv_text_of(table, i, "engine"));
        ck_answer_text(answer, ck_csv_text_of(table, i, "setup"));
        ck_answer_number(answer, part->scale * value);
    }
}

static void add_round_trip(ck_Answer *answer, const ck_CsvTable *table) {
    for (int i = 0; i < table->row_count; i++) {
        const double value = ck_csv_number_of(table, i, "value");
        if (strcmp(ck_csv_text_of(table, i, "metric"), "round_trip") || isnan(value)) continue;
        ck_answer_line(answer, CK_ANSWER_NOTE,
                       "%.0f ns from one thread to another and back: some 100 where processors share a cache, and "
                       "where it is 600, small bodies gain little from a second thread",
                       1e9 * value);
    }
}

ck_Status ck_answer_bench(ck_Answer *answer, const char *directory, ck_Error *error) {
    ck_CsvTable table = {0};
    ck_Status status = ck_csv_table_read(&table, directory, &ck_layouts[CK_BENCH], error);
    if (!status) add_round_trip(answer, &table);
    for (size_t i = 0; i < sizeof bench_parts / sizeof *bench_parts && !status; i++)
        add_bench_part(answer, &table, &bench_parts[i]);
    if (!status) add_bench_costs(answer, &table);
    ck_csv_table_free(&table);
    return status;
}

ck_Status ck_answer_quirks(ck_Answer *answer, const char *directory, ck_Error *error) {
    static const ck_AnswerColumn columns[] = {{"engine", "engine", -12, NULL},
                                              {"quirk", "quirk", -40, NULL},
                                              {"metric", "", -18, NULL},
                                              {"as_it_was", "as it was", 11, "%.4g"},
                                              {"mended", "mended", 11, "%.4g"},
                                              {"physics", "physics", 11, "%.4g"},
                                              {NULL, NULL, 0, NULL}};
    ck_CsvTable table = {0};
    ck_Status status = ck_csv_table_read(&table, directory, &ck_layouts[CK_QUIRKS], error);
    if (!status) ck_answer_table(answer, "quirks", NULL, columns);
    for (int i = 0; i < table.row_count && !status; i++) {
        ck_answer_text(answer, ck_csv_text_of(&table, i, "engine"));
        ck_answer_text(answer, ck_csv_text_of(&table, i, "quirk"));
        ck_answer_text(answer, ck_csv_text_of(&table, i, "metric"));
        ck_answer_number(answer, ck_csv_number_of(&table, i, "as_it_was"));
        ck_answer_number(answer, ck_csv_number_of(&table, i, "mended"));
        ck_answer_number(answer, ck_csv_number_of(&table, i, "physics"));
    }
    ck_csv_table_free(&table);
    return status;
}
