#include "finding.h"

#include "files.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// An error is one where it is beyond so many uncertainties of the truth, and a thousandth.
#define UNCERTAINTIES 10
#define LEAST_ERROR 1e-3
// How much worse, dearer or cheaper something must be to be worth a sentence.
#define FACTOR 1.25

static double number(const ck_CsvTable *table, int row, const char *column) {
    return ck_csv_table_number(table, row, ck_layout_column(table->layout, column));
}

static const char *text(const ck_CsvTable *table, int row, const char *column) {
    return ck_csv_table_text(table, row, ck_layout_column(table->layout, column));
}

static bool is(const ck_CsvTable *table, int row, const char *column, const char *value) {
    return !strcmp(text(table, row, column), value);
}

static bool is_same(const ck_CsvTable *table, int row, int other, const char *column) {
    return is(table, row, column, text(table, other, column));
}

// The row of an engine on a scene, of what a third column says; NULL: of any. -1: none.
static int find(const ck_CsvTable *table, const char *scene, const char *engine, const char *column,
                const char *value) {
    for (int i = 0; table && i < table->row_count; i++)
        if (is(table, i, "scene", scene) && is(table, i, "engine", engine) && (!column || is(table, i, column, value)))
            return i;
    return -1;
}

static void add(ck_Findings *findings, const char *kind, const char *scene, const char *engine, const char *command,
                const char *format, ...) __attribute__((format(printf, 6, 7)));
static void add(ck_Findings *findings, const char *kind, const char *scene, const char *engine, const char *command,
                const char *format, ...) {
    ck_Finding *more = realloc(findings->items, sizeof *more * (size_t)(findings->count + 1));
    findings->has_failed |= !more;
    if (!more) return;
    findings->items = more;
    ck_Finding *finding = &more[findings->count++];
    *finding = (ck_Finding){.kind = kind};
    snprintf(finding->scene, sizeof finding->scene, "%s", scene);
    snprintf(finding->engine, sizeof finding->engine, "%s", engine);
    snprintf(finding->command, sizeof finding->command, "%s", command);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(finding->text, sizeof finding->text, format, arguments);
    va_end(arguments);
}

static bool has_broken_down(const ck_CsvTable *runs, int row) {
    static const char *const statuses[] = {"diverged", "energy_gain", "overstretched", "aborted"};
    for (size_t i = 0; i < sizeof statuses / sizeof *statuses; i++)
        if (is(runs, row, "status", statuses[i])) return true;
    return false;
}

// One sentence an engine: all scenes on which it breaks down, and why on the first.
static void find_breakdowns(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *runs = tables[CK_RUNS];
    for (int i = 0; i < runs->row_count; i++) {
        bool is_first = has_broken_down(runs, i);
        for (int k = 0; k < i && is_first; k++) is_first = !has_broken_down(runs, k) || !is_same(runs, k, i, "engine");
        if (!is_first) continue;
        char scenes[160] = "";
        size_t used = 0;
        for (int k = i; k < runs->row_count && used < sizeof scenes; k++)
            if (has_broken_down(runs, k) && is_same(runs, k, i, "engine"))
                used += (size_t)snprintf(scenes + used, sizeof scenes - used, "%s%s", used ? ", " : "",
                                         text(runs, k, "scene"));
        const char *reason = text(runs, i, "reason"), *end = strchr(reason, ';');
        add(findings, "breakdown", text(runs, i, "scene"), text(runs, i, "engine"), text(runs, i, "command"),
            "%s breaks down on %.150s%s; on %s: %.*s", text(runs, i, "engine"), scenes,
            used >= sizeof scenes ? " …" : "", text(runs, i, "scene"), end ? (int)(end - reason) : 200, reason);
    }
}

// Finer steps that make it worse, as the study of precision found.
static void find_rounding(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *summary = tables[CK_PRECISION_SUMMARY];
    for (int i = 0; i < summary->row_count; i++) {
        if (!is(summary, i, "quantity", "finest_useful_substeps")) continue;
        const char *scene = text(summary, i, "scene"), *engine = text(summary, i, "engine");
        bool is_rounding = strstr(text(summary, i, "reason"), "not by rounding") == NULL;
        char command[200];
        snprintf(command, sizeof command, "clothcheck precision %s --engine %s", scene, engine);
        add(findings, is_rounding ? "rounding" : "setting", scene, engine, command,
            "%s on %s: more than %s substeps a frame are no use: %s", engine, scene, text(summary, i, "value"),
            text(summary, i, "reason"));
    }
}

// More iterations at the same step that cost more, and leave the error where it was.
static void find_iterations(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *table = tables[CK_PRECISION];
    for (int few = 0, said = -1; few < table->row_count; few++) {
        if (!is(table, few, "status", "ok") || !(number(table, few, "error") > LEAST_ERROR)) continue;
        if (said >= 0 && is_same(table, said, few, "engine") && is_same(table, said, few, "scene")) continue;
        int many = -1;
        for (int i = 0; i < table->row_count; i++)
            if (is_same(table, i, few, "scene") && is_same(table, i, few, "engine") && is(table, i, "status", "ok") &&
                is_same(table, i, few, "substeps") &&
                number(table, i, "iterations") > number(table, many < 0 ? few : many, "iterations"))
                many = i;
        if (many < 0) continue;
        const double before = number(table, few, "error"), after = number(table, many, "error"),
                     dearer = number(table, many, "cpu_s") / number(table, few, "cpu_s");
        if (!(after > 0.8 * before && dearer > FACTOR)) continue;
        const char *scene = text(table, few, "scene"), *engine = text(table, few, "engine");
        char command[200];
        snprintf(command, sizeof command, "clothcheck precision %s --engine %s", scene, engine);
        add(findings, "setting", scene, engine, command,
            "%s on %s: %s iterations in place of %s, at %s substeps a frame, cost %.2g times as much, and the error is "
            "%.2g %% where it was %.2g %%",
            engine, scene, text(table, many, "iterations"), text(table, few, "iterations"),
            text(table, few, "substeps"), dearer, 100 * after, 100 * before);
        said = few;
    }
}

// The error that counts on a scene, of its positions; NaN where it is within what the truth is known to.
static double error_of(const ck_CsvTable *metrics, const char *scene, const char *engine) {
    int row = find(metrics, scene, engine, "metric", "position_rms");
    if (row < 0) return NAN;
    double error = number(metrics, row, "error"), known = number(metrics, row, "truth_uncertainty");
    return error > UNCERTAINTIES * known || isnan(known) ? error : NAN;
}

// The middle error of the engines whose ledger meets a quantity; NaN where there are fewer than two.
static double middle_error(const ck_CsvTable *const *tables, const char *scene, const char *quantity) {
    const ck_CsvTable *ledger = tables[CK_LEDGER];
    double errors[64];
    int count = 0;
    for (int i = 0; i < ledger->row_count && count < 64; i++) {
        int row;
        if (!is(ledger, i, "scene", scene) || !is(ledger, i, "quantity", quantity) ||
            is(ledger, i, "match", "impossible") ||
            (row = find(tables[CK_METRICS], scene, text(ledger, i, "engine"), "metric", "position_rms")) < 0 ||
            isnan(number(tables[CK_METRICS], row, "error")))
            continue;
        int place = count++;
        const double error = number(tables[CK_METRICS], row, "error");
        for (; place && errors[place - 1] > error; place--) errors[place] = errors[place - 1];
        errors[place] = error;
    }
    return count < 2 ? NAN : errors[count / 2];
}

// A row that an engine cannot meet, of something that was asked for and that the scene's truth can show: what ends a
// motion does not change a rest.
static bool is_missed(const ck_CsvTable *const *tables, int row) {
    const ck_CsvTable *ledger = tables[CK_LEDGER];
    if (!is(ledger, row, "match", "impossible") || !(number(ledger, row, "wanted") > 0)) return false;
    if (is(ledger, row, "quantity", "physics")) return false; // an origin's quirk: claims shows those
    if (!is(ledger, row, "quantity", "spring damping")) return true;
    int metric =
        find(tables[CK_METRICS], text(ledger, row, "scene"), text(ledger, row, "engine"), "metric", "position_rms");
    return metric >= 0 && is(tables[CK_METRICS], metric, "truth_kind", "trajectory");
}

// An engine's errors on the scenes that ask for what it cannot model.
typedef struct Lack {
    int worst;            // row of the ledger
    double error, others; // there
    int scenes;
} Lack;

static Lack find_lack(const ck_CsvTable *const *tables, const char *engine) {
    const ck_CsvTable *ledger = tables[CK_LEDGER];
    Lack lack = {.worst = -1};
    for (int i = 0, last = -1; i < ledger->row_count; i++) {
        const char *scene = text(ledger, i, "scene");
        int run = find(tables[CK_RUNS], scene, engine, NULL, NULL);
        if (!is(ledger, i, "engine", engine) || !is_missed(tables, i) || run < 0 ||
            !is(tables[CK_RUNS], run, "status", "ok"))
            continue;
        double error = error_of(tables[CK_METRICS], scene, engine),
               others = middle_error(tables, scene, text(ledger, i, "quantity"));
        if (!(error > LEAST_ERROR && error > 3 * others)) continue;
        lack.scenes += last < 0 || !is_same(ledger, last, i, "scene");
        last = i;
        if (error > lack.error) lack = (Lack){i, error, others, lack.scenes};
    }
    return lack;
}

// What an engine cannot model, where it shows: one sentence an engine.
static void find_models(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *ledger = tables[CK_LEDGER];
    for (int i = 0; i < ledger->row_count && tables[CK_METRICS] && tables[CK_RUNS]; i++) {
        bool is_first = true;
        for (int k = 0; k < i && is_first; k++) is_first = !is_same(ledger, k, i, "engine");
        const char *engine = text(ledger, i, "engine");
        const Lack lack = is_first ? find_lack(tables, engine) : (Lack){.worst = -1};
        if (lack.worst < 0) continue;
        char quantities[200] = "", command[200], elsewhere[60] = "";
        const char *scene = text(ledger, lack.worst, "scene");
        size_t used = 0;
        for (int k = 0; k < ledger->row_count && used < sizeof quantities; k++)
            if (is_same(ledger, k, lack.worst, "scene") && is(ledger, k, "engine", engine) && is_missed(tables, k))
                used += (size_t)snprintf(quantities + used, sizeof quantities - used, "%s%s (%g%s%s)",
                                         used ? " and no " : "", text(ledger, k, "quantity"),
                                         number(ledger, k, "wanted"), is(ledger, k, "unit", "1") ? "" : " ",
                                         is(ledger, k, "unit", "1") ? "" : text(ledger, k, "unit"));
        if (lack.scenes > 1) snprintf(elsewhere, sizeof elsewhere, "; so it is on %d more", lack.scenes - 1);
        snprintf(command, sizeof command, "clothcheck run %s --engine %s", scene, engine);
        add(findings, "model", scene, engine, command,
            "%s has no %s, and is %.3g %% of the size off on %s, where the middle of those that have it is %.2g %% "
            "off%s",
            engine, quantities, 100 * lack.error, scene, 100 * lack.others, elsewhere);
    }
}

// Engines that differ in one thing.
typedef struct Pair {
    char engine[64], other[64];
    const char *difference;
} Pair;

static bool find_pair(Pair *pair, const char *engine) {
    const char *suffix = strstr(engine, "-float");
    bool is_single = suffix && !suffix[6], is_stock = !strcmp(engine, "bullet-stock");
    *pair = (Pair){.difference = is_single ? "in double precision" : "with its corrections"};
    snprintf(pair->engine, sizeof pair->engine, "%s", engine);
    snprintf(pair->other, sizeof pair->other, "%.*s", is_single ? (int)(suffix - engine) : 10,
             is_single ? engine : "bullet-pbd");
    return is_single || is_stock;
}

static int compare_numbers(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *numbers, int count) {
    qsort(numbers, (size_t)count, sizeof *numbers, compare_numbers);
    return numbers[count / 2];
}

// On the scenes on which both are ok, with costs whose intervals are apart: how many times as long the first takes, and
// both errors. Returns the number of scenes, at most 256.
static int gather(const ck_CsvTable *const *tables, const Pair *pair, double ratios[256], double errors[2][256]) {
    const ck_CsvTable *runs = tables[CK_RUNS], *metrics = tables[CK_METRICS];
    int count = 0;
    for (int i = 0; i < runs->row_count && count < 256; i++) {
        const char *scene = text(runs, i, "scene");
        int other = is(runs, i, "engine", pair->engine) ? find(runs, scene, pair->other, NULL, NULL) : -1;
        if (other < 0 || !is(runs, i, "status", "ok") || !is(runs, other, "status", "ok")) continue;
        int rows[2] = {find(metrics, scene, pair->engine, "metric", "position_rms"),
                       find(metrics, scene, pair->other, "metric", "position_rms")};
        bool is_apart = number(runs, i, "cpu_high_s") < number(runs, other, "cpu_low_s") ||
                        number(runs, i, "cpu_low_s") > number(runs, other, "cpu_high_s");
        if (!is_apart || rows[0] < 0 || rows[1] < 0 || isnan(number(metrics, rows[0], "error"))) continue;
        ratios[count] = number(runs, i, "cpu_median_s") / number(runs, other, "cpu_median_s");
        for (int k = 0; k < 2; k++) errors[k][count] = number(metrics, rows[k], "error");
        count++;
    }
    return count;
}

// Single precision beside double, and a stock engine beside the corrected one: one sentence a pair.
static void find_costs(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *runs = tables[CK_RUNS];
    double ratios[256], errors[2][256];
    Pair pair;
    for (int i = 0; i < runs->row_count && tables[CK_METRICS]; i++) {
        bool is_first = find_pair(&pair, text(runs, i, "engine"));
        for (int k = 0; k < i && is_first; k++) is_first = !is_same(runs, k, i, "engine");
        int count = is_first ? gather(tables, &pair, ratios, errors) : 0;
        if (!count) continue;
        const double ratio = median(ratios, count);
        char command[200];
        snprintf(command, sizeof command, "clothcheck run %s --engine %s --engine %s", text(runs, i, "scene"),
                 pair.engine, pair.other);
        add(findings, "cost", text(runs, i, "scene"), pair.engine, command,
            "%s takes %.2g of the time of %s, %s (%.2g to %.2g, on %d scenes), and is %.2g %% off where that is "
            "%.2g %% (medians)",
            pair.engine, ratio, pair.other, pair.difference, ratios[0], ratios[count - 1], count,
            100 * median(errors[0], count), 100 * median(errors[1], count));
    }
}

// Where single precision is the error: one sentence an engine, of the scene on which it is the largest.
static void find_single(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *metrics = tables[CK_METRICS];
    Pair pair;
    for (int i = 0; i < metrics->row_count; i++) {
        bool is_first = find_pair(&pair, text(metrics, i, "engine")) && strcmp(pair.engine, "bullet-stock");
        for (int k = 0; k < i && is_first; k++) is_first = !is_same(metrics, k, i, "engine");
        int worst = -1;
        double least = NAN;
        for (int k = i; k < metrics->row_count && is_first; k++) {
            if (!is(metrics, k, "engine", pair.engine) || !is(metrics, k, "metric", "position_rms")) continue;
            const char *scene = text(metrics, k, "scene");
            int twin = find(metrics, scene, pair.other, "metric", "position_rms");
            double error = error_of(metrics, scene, pair.engine),
                   other = twin < 0 ? NAN : number(metrics, twin, "error");
            if (!(error > LEAST_ERROR && error > 10 * other)) continue;
            if (worst >= 0 && error <= number(metrics, worst, "error")) continue;
            worst = k;
            least = other;
        }
        if (worst < 0) continue;
        const char *scene = text(metrics, worst, "scene");
        char command[200];
        snprintf(command, sizeof command, "clothcheck run %s --engine %s --engine %s", scene, pair.engine, pair.other);
        add(findings, "rounding", scene, pair.engine, command,
            "%s on %s: single precision is %.3g %% of the size off, where %s, in double, is %.2g %% off", pair.engine,
            scene, 100 * number(metrics, worst, "error"), pair.other, 100 * least);
    }
}

// A rule is one row.
static const struct {
    ck_LayoutName needs;
    void (*find)(ck_Findings *findings, const ck_CsvTable *const *tables);
} rules[] = {
    {CK_RUNS, find_breakdowns}, {CK_PRECISION_SUMMARY, find_rounding},
    {CK_METRICS, find_single},  {CK_PRECISION, find_iterations},
    {CK_LEDGER, find_models},   {CK_RUNS, find_costs},
};

ck_Status ck_findings_find(ck_Findings *findings, const ck_CsvTable *const *tables, ck_Error *error) {
    *findings = (ck_Findings){0};
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
        if (tables[rules[i].needs]) rules[i].find(findings, tables);
    return findings->has_failed ? ck_fail(error, CK_NO_MEMORY, "out of memory") : CK_OK;
}

ck_Status ck_findings_read(ck_Findings *findings, const char *directory, ck_Error *error) {
    ck_CsvTable read[CK_REPORT_LAYOUTS] = {{0}};
    const ck_CsvTable *tables[CK_REPORT_LAYOUTS] = {NULL};
    ck_Status status = CK_OK;
    *findings = (ck_Findings){0};
    for (size_t i = 0; i < sizeof rules / sizeof *rules + 1 && !status; i++) {
        const ck_LayoutName name = i ? rules[i - 1].needs : CK_METRICS;
        char *path = ck_path_join(directory, ck_layouts[name].file);
        if (!path) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
        if (path && !access(path, F_OK) && !tables[name]) {
            status = ck_csv_table_read(&read[name], directory, &ck_layouts[name], error);
            tables[name] = &read[name];
        }
        free(path);
    }
    if (!status) status = ck_findings_find(findings, tables, error);
    for (int i = 0; i < CK_REPORT_LAYOUTS; i++) ck_csv_table_free(&read[i]);
    return status;
}

void ck_findings_free(ck_Findings *findings) {
    free(findings->items);
    *findings = (ck_Findings){0};
}
