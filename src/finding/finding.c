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
// Of engines on a scene, and of scenes, that are looked at.
#define MOST 256

static bool is(const ck_CsvTable *table, int row, const char *column, const char *value) {
    return !strcmp(ck_csv_text_of(table, row, column), value);
}

static bool is_same(const ck_CsvTable *table, int row, int other, const char *column) {
    return is(table, row, column, ck_csv_text_of(table, other, column));
}

// The row of an engine on a scene, of what a third column says; NULL: of any. -1: none.
static int find(const ck_CsvTable *table, const char *scene, const char *engine, const char *column,
                const char *value) {
    for (int i = 0; table && i < table->row_count; i++)
        if (is(table, i, "scene", scene) && is(table, i, "engine", engine) && (!column || is(table, i, column, value)))
            return i;
    return -1;
}

// True where no row before is of the same engine.
static bool is_first_of_engine(const ck_CsvTable *table, int row) {
    int before = 0;
    while (before < row && !is_same(table, before, row, "engine")) before++;
    return before == row;
}

static int compare_numbers(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *numbers, int count) {
    qsort(numbers, (size_t)count, sizeof *numbers, compare_numbers);
    return numbers[count / 2];
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
                                         ck_csv_text_of(runs, k, "scene"));
        const char *reason = ck_csv_text_of(runs, i, "reason"), *end = strchr(reason, ';');
        add(findings, "breakdown", ck_csv_text_of(runs, i, "scene"), ck_csv_text_of(runs, i, "engine"),
            ck_csv_text_of(runs, i, "command"), "%s breaks down on %.150s%s; on %s: %.*s",
            ck_csv_text_of(runs, i, "engine"), scenes, used >= sizeof scenes ? " …" : "",
            ck_csv_text_of(runs, i, "scene"), end ? (int)(end - reason) : 200, reason);
    }
}

// Finer steps that make it worse, as the study of precision found.
static void find_finest(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *summary = tables[CK_PRECISION_SUMMARY];
    for (int i = 0; i < summary->row_count; i++) {
        const bool is_rounding = is(summary, i, "quantity", "finest_before_rounding");
        if (!is_rounding && !is(summary, i, "quantity", "finest_useful_substeps")) continue;
        const char *scene = ck_csv_text_of(summary, i, "scene"), *engine = ck_csv_text_of(summary, i, "engine");
        char command[200];
        snprintf(command, sizeof command, "clothcheck precision %s --engine %s", scene, engine);
        add(findings, is_rounding ? "rounding" : "setting", scene, engine, command,
            "%s on %s: more than %s substeps a frame are no use: %s", engine, scene,
            ck_csv_text_of(summary, i, "value"), ck_csv_text_of(summary, i, "reason"));
    }
}

// More iterations at the same step that cost more, and leave the error where it was.
static void find_iterations(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *table = tables[CK_PRECISION];
    for (int few = 0, said = -1; few < table->row_count; few++) {
        if (!is(table, few, "status", "ok") || !(ck_csv_number_of(table, few, "error") > LEAST_ERROR)) continue;
        if (said >= 0 && is_same(table, said, few, "engine") && is_same(table, said, few, "scene")) continue;
        int many = -1;
        for (int i = 0; i < table->row_count; i++)
            if (is_same(table, i, few, "scene") && is_same(table, i, few, "engine") && is(table, i, "status", "ok") &&
                is_same(table, i, few, "substeps") &&
                ck_csv_number_of(table, i, "iterations") > ck_csv_number_of(table, many < 0 ? few : many, "iterations"))
                many = i;
        if (many < 0) continue;
        const double before = ck_csv_number_of(table, few, "error"), after = ck_csv_number_of(table, many, "error"),
                     dearer = ck_csv_number_of(table, many, "cpu_s") / ck_csv_number_of(table, few, "cpu_s");
        if (!(after > 0.8 * before && dearer > FACTOR)) continue;
        const char *scene = ck_csv_text_of(table, few, "scene"), *engine = ck_csv_text_of(table, few, "engine");
        char command[200];
        snprintf(command, sizeof command, "clothcheck precision %s --engine %s", scene, engine);
        add(findings, "setting", scene, engine, command,
            "%s on %s: %s iterations in place of %s, at %s substeps a frame, cost %.2g times as much, and the error is "
            "%.2g %% where it was %.2g %%",
            engine, scene, ck_csv_text_of(table, many, "iterations"), ck_csv_text_of(table, few, "iterations"),
            ck_csv_text_of(table, few, "substeps"), dearer, 100 * after, 100 * before);
        said = few;
    }
}

// The error that counts on a scene, of its positions; NaN where it is within what the truth is known to.
static double error_of(const ck_CsvTable *metrics, const char *scene, const char *engine) {
    int row = find(metrics, scene, engine, "metric", "position_rms");
    if (row < 0) return NAN;
    double error = ck_csv_number_of(metrics, row, "error"), known = ck_csv_number_of(metrics, row, "truth_uncertainty");
    return error > UNCERTAINTIES * known || isnan(known) ? error : NAN;
}

static bool is_ok(const ck_CsvTable *const *tables, const char *scene, const char *engine) {
    int run = find(tables[CK_RUNS], scene, engine, NULL, NULL);
    return run >= 0 && is(tables[CK_RUNS], run, "status", "ok");
}

static bool has(const ck_CsvTable *ledger, const char *scene, const char *engine, const char *quantity) {
    int row = find(ledger, scene, engine, "quantity", quantity);
    return row >= 0 && !is(ledger, row, "match", "impossible");
}

// The median error of the engines that came to their end and whose ledger meets a quantity; NaN where there are fewer
// than two.
static double middle_error(const ck_CsvTable *const *tables, const char *scene, const char *quantity) {
    const ck_CsvTable *metrics = tables[CK_METRICS];
    double errors[MOST];
    int count = 0;
    for (int i = 0; i < metrics->row_count && count < MOST; i++) {
        const char *engine = ck_csv_text_of(metrics, i, "engine");
        const double error = ck_csv_number_of(metrics, i, "error");
        if (is(metrics, i, "scene", scene) && is(metrics, i, "metric", "position_rms") && !isnan(error) &&
            is_ok(tables, scene, engine) && has(tables[CK_LEDGER], scene, engine, quantity))
            errors[count++] = error;
    }
    return count < 2 ? NAN : median(errors, count);
}

// A row that an engine cannot meet, of something that was asked for and that the scene's truth can show: what ends a
// motion does not change a rest.
static bool is_missed(const ck_CsvTable *const *tables, int row) {
    const ck_CsvTable *ledger = tables[CK_LEDGER];
    if (!is(ledger, row, "match", "impossible") || !(ck_csv_number_of(ledger, row, "wanted") > 0)) return false;
    if (is(ledger, row, "quantity", "physics")) return false; // an origin's quirk: claims shows those
    if (!is(ledger, row, "quantity", "spring damping")) return true;
    int metric = find(tables[CK_METRICS], ck_csv_text_of(ledger, row, "scene"), ck_csv_text_of(ledger, row, "engine"),
                      "metric", "position_rms");
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
        const char *scene = ck_csv_text_of(ledger, i, "scene");
        if (!is(ledger, i, "engine", engine) || !is_missed(tables, i) || !is_ok(tables, scene, engine)) continue;
        double error = error_of(tables[CK_METRICS], scene, engine),
               others = middle_error(tables, scene, ck_csv_text_of(ledger, i, "quantity"));
        if (!(error > LEAST_ERROR && error > 3 * others)) continue;
        lack.scenes += last < 0 || !is_same(ledger, last, i, "scene");
        last = i;
        if (error > lack.error) lack = (Lack){i, error, others, lack.scenes};
    }
    return lack;
}

// "friction (0.3) and no spring damping (0.02 N*s/m)": all that the engine of a row misses on its scene.
static void list_missed(const ck_CsvTable *const *tables, int row, char *list, size_t size) {
    const ck_CsvTable *ledger = tables[CK_LEDGER];
    size_t used = 0;
    for (int i = 0; i < ledger->row_count && used < size; i++) {
        const bool has_unit = !is(ledger, i, "unit", "1");
        if (is_same(ledger, i, row, "scene") && is_same(ledger, i, row, "engine") && is_missed(tables, i))
            used += (size_t)snprintf(list + used, size - used, "%s%s (%g%s%s)", used ? " and no " : "",
                                     ck_csv_text_of(ledger, i, "quantity"), ck_csv_number_of(ledger, i, "wanted"),
                                     has_unit ? " " : "", has_unit ? ck_csv_text_of(ledger, i, "unit") : "");
    }
}

// What an engine cannot model, where it shows: one sentence an engine.
static void find_models(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *ledger = tables[CK_LEDGER];
    for (int i = 0; i < ledger->row_count && tables[CK_METRICS] && tables[CK_RUNS]; i++) {
        const char *engine = ck_csv_text_of(ledger, i, "engine");
        const Lack lack = is_first_of_engine(ledger, i) ? find_lack(tables, engine) : (Lack){.worst = -1};
        if (lack.worst < 0) continue;
        char missed[200] = "", command[200], elsewhere[60] = "";
        const char *scene = ck_csv_text_of(ledger, lack.worst, "scene");
        list_missed(tables, lack.worst, missed, sizeof missed);
        if (lack.scenes > 1) snprintf(elsewhere, sizeof elsewhere, "; so it is on %d more", lack.scenes - 1);
        snprintf(command, sizeof command, "clothcheck run %s --engine %s", scene, engine);
        add(findings, "model", scene, engine, command,
            "%s has no %s, which may be why it is %.3g %% of the size off on %s, where the middle of those that have "
            "it is %.2g %% "
            "off%s",
            engine, missed, 100 * lack.error, scene, 100 * lack.others, elsewhere);
    }
}

// Engines that differ in one thing.
typedef struct Pair {
    char engine[64], other[64];
    const char *difference;
    bool is_single; // and the other double precision
} Pair;

static bool find_pair(Pair *pair, const char *engine) {
    const char *suffix = strstr(engine, "-float");
    const bool is_single = suffix && !suffix[6], is_stock = !strcmp(engine, "bullet-stock");
    *pair = (Pair){.difference = is_single ? "in double precision" : "with its corrections", .is_single = is_single};
    snprintf(pair->engine, sizeof pair->engine, "%s", engine);
    if (is_single)
        snprintf(pair->other, sizeof pair->other, "%.*s", (int)(suffix - engine), engine);
    else
        strcpy(pair->other, "bullet-pbd");
    return is_single || is_stock;
}

// True where more than a twentieth of a run's cost is that of talking to its process, which is not the engine's.
static bool is_talk(const ck_CsvTable *const *tables, int run) {
    const ck_CsvTable *runs = tables[CK_RUNS], *ledger = tables[CK_LEDGER];
    int row =
        find(ledger, ck_csv_text_of(runs, run, "scene"), ck_csv_text_of(runs, run, "engine"), "quantity", "message");
    if (row < 0) return false;
    const double frame = ck_csv_number_of(runs, run, "time_step_s") * ck_csv_number_of(runs, run, "substeps"),
                 frames = ck_csv_number_of(runs, run, "simulated_s") / frame;
    return frames * ck_csv_number_of(ledger, row, "native_value") > 0.05 * ck_csv_number_of(runs, run, "cpu_median_s");
}

// How many times as long the first of a pair takes, and both errors, by scenes.
typedef struct Costs {
    double ratios[MOST], errors[2][MOST];
    int count;
    const char *scene; // one of them
} Costs;

// Of the scenes on which both are ok, with costs whose intervals are apart.
static void gather(Costs *costs, const ck_CsvTable *const *tables, const Pair *pair) {
    const ck_CsvTable *runs = tables[CK_RUNS], *metrics = tables[CK_METRICS];
    costs->count = 0;
    for (int i = 0; i < runs->row_count && costs->count < MOST; i++) {
        const char *scene = ck_csv_text_of(runs, i, "scene");
        int other = is(runs, i, "engine", pair->engine) ? find(runs, scene, pair->other, NULL, NULL) : -1;
        if (other < 0 || !is(runs, i, "status", "ok") || !is(runs, other, "status", "ok")) continue;
        if (is_talk(tables, i)) continue;
        int rows[2] = {find(metrics, scene, pair->engine, "metric", "position_rms"),
                       find(metrics, scene, pair->other, "metric", "position_rms")};
        bool is_apart = ck_csv_number_of(runs, i, "cpu_high_s") < ck_csv_number_of(runs, other, "cpu_low_s") ||
                        ck_csv_number_of(runs, i, "cpu_low_s") > ck_csv_number_of(runs, other, "cpu_high_s");
        if (!is_apart || rows[0] < 0 || rows[1] < 0 || isnan(ck_csv_number_of(metrics, rows[0], "error"))) continue;
        costs->scene = scene;
        costs->ratios[costs->count] =
            ck_csv_number_of(runs, i, "cpu_median_s") / ck_csv_number_of(runs, other, "cpu_median_s");
        for (int k = 0; k < 2; k++) costs->errors[k][costs->count] = ck_csv_number_of(metrics, rows[k], "error");
        costs->count++;
    }
}

// Single precision beside double, and a stock engine beside the corrected one: one sentence a pair.
static void find_costs(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *runs = tables[CK_RUNS];
    Costs costs;
    Pair pair;
    for (int i = 0; i < runs->row_count && tables[CK_METRICS]; i++) {
        if (!is_first_of_engine(runs, i) || !find_pair(&pair, ck_csv_text_of(runs, i, "engine"))) continue;
        gather(&costs, tables, &pair);
        const int count = costs.count;
        if (!count) continue;
        const double ratio = median(costs.ratios, count);
        char command[200];
        snprintf(command, sizeof command, "clothcheck run %s --engine %s --engine %s", costs.scene, pair.engine,
                 pair.other);
        add(findings, "cost", costs.scene, pair.engine, command,
            "%s takes %.2g of the time of %s, %s (%.2g to %.2g, on %d %s), and is %.2g %% off where that is "
            "%.2g %% (medians)",
            pair.engine, ratio, pair.other, pair.difference, costs.ratios[0], costs.ratios[count - 1], count,
            count == 1 ? "scene" : "scenes", 100 * median(costs.errors[0], count),
            100 * median(costs.errors[1], count));
    }
}

// Where single precision is the error: one sentence an engine, of the scene on which it is the largest.
static void find_single(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *metrics = tables[CK_METRICS];
    Pair pair;
    for (int i = 0; i < metrics->row_count; i++) {
        bool is_single =
            is_first_of_engine(metrics, i) && find_pair(&pair, ck_csv_text_of(metrics, i, "engine")) && pair.is_single;
        int worst = -1;
        double least = NAN;
        for (int k = i; k < metrics->row_count && is_single; k++) {
            if (!is(metrics, k, "engine", pair.engine) || !is(metrics, k, "metric", "position_rms")) continue;
            const char *scene = ck_csv_text_of(metrics, k, "scene");
            int twin = find(metrics, scene, pair.other, "metric", "position_rms");
            double error = error_of(metrics, scene, pair.engine),
                   other = twin < 0 ? NAN : ck_csv_number_of(metrics, twin, "error");
            if (!(error > LEAST_ERROR && error > 10 * other)) continue;
            if (worst >= 0 && error <= ck_csv_number_of(metrics, worst, "error")) continue;
            worst = k;
            least = other;
        }
        if (worst < 0) continue;
        const char *scene = ck_csv_text_of(metrics, worst, "scene");
        char command[200];
        snprintf(command, sizeof command, "clothcheck run %s --engine %s --engine %s", scene, pair.engine, pair.other);
        add(findings, "rounding", scene, pair.engine, command,
            "%s on %s: single precision is %.3g %% of the size off, where %s, in double, is %.2g %% off", pair.engine,
            scene, 100 * ck_csv_number_of(metrics, worst, "error"), pair.other, 100 * least);
    }
}

// A rule is one row.
static const struct {
    ck_LayoutName needs;
    void (*find)(ck_Findings *findings, const ck_CsvTable *const *tables);
} rules[] = {
    {CK_RUNS, find_breakdowns}, {CK_PRECISION_SUMMARY, find_finest},
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
