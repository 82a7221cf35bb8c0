// Rules of a comparison: of runs, their errors and their costs.
#include "rules.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Of engines on a scene, and of scenes, that are looked at.
#define MOST 256

// The row of an engine on a scene, of what a third column says; NULL: of any. -1: none.
static int find(const ck_CsvTable *table, const char *scene, const char *engine, const char *column,
                const char *value) {
    for (int i = 0; table && i < table->row_count; i++)
        if (ck_row_is(table, i, "scene", scene) && ck_row_is(table, i, "engine", engine) &&
            (!column || ck_row_is(table, i, column, value)))
            return i;
    return -1;
}

// True where no row before is of the same engine.
static bool is_first_of_engine(const ck_CsvTable *table, int row) {
    int before = 0;
    while (before < row && !ck_row_is_same(table, before, row, "engine")) before++;
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

static bool has_broken_down(const ck_CsvTable *runs, int row) {
    static const char *const statuses[] = {"diverged", "energy_gain", "overstretched", "aborted"};
    for (size_t i = 0; i < sizeof statuses / sizeof *statuses; i++)
        if (ck_row_is(runs, row, "status", statuses[i])) return true;
    return false;
}

// One sentence an engine: all scenes on which it breaks down, and why on the first.
void ck_rule_breakdowns(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *runs = tables[CK_RUNS];
    for (int i = 0; i < runs->row_count; i++) {
        bool is_first = has_broken_down(runs, i);
        for (int k = 0; k < i && is_first; k++)
            is_first = !has_broken_down(runs, k) || !ck_row_is_same(runs, k, i, "engine");
        if (!is_first) continue;
        char scenes[160] = "";
        size_t used = 0;
        bool is_cut = false;
        for (int k = i; k < runs->row_count; k++) {
            const char *scene = ck_csv_text_of(runs, k, "scene");
            if (!has_broken_down(runs, k) || !ck_row_is_same(runs, k, i, "engine")) continue;
            // whole names, and room for the dots
            is_cut |= used + strlen(scene) + 10 > sizeof scenes;
            if (!is_cut) used += (size_t)snprintf(scenes + used, sizeof scenes - used, "%s%s", used ? ", " : "", scene);
        }
        const char *reason = ck_csv_text_of(runs, i, "reason"), *end = strchr(reason, ';');
        ck_findings_add(findings, "breakdown", ck_csv_text_of(runs, i, "scene"), ck_csv_text_of(runs, i, "engine"),
                        ck_csv_text_of(runs, i, "command"), "%s breaks down on %s%s; on %s: %.*s",
                        ck_csv_text_of(runs, i, "engine"), scenes, is_cut ? " …" : "", ck_csv_text_of(runs, i, "scene"),
                        end ? (int)(end - reason) : 200, reason);
    }
}

// The error that counts on a scene, of its positions; NaN where it is within what the truth is known to.
static double error_of(const ck_CsvTable *metrics, const char *scene, const char *engine) {
    int row = find(metrics, scene, engine, "metric", "position_rms");
    if (row < 0) return NAN;
    double error = ck_csv_number_of(metrics, row, "error"), known = ck_csv_number_of(metrics, row, "truth_uncertainty");
    return error > CK_FINDING_UNCERTAINTIES * known || isnan(known) ? error : NAN;
}

static bool is_ok(const ck_CsvTable *const *tables, const char *scene, const char *engine) {
    int run = find(tables[CK_RUNS], scene, engine, NULL, NULL);
    return run >= 0 && ck_row_is(tables[CK_RUNS], run, "status", "ok");
}

static bool has(const ck_CsvTable *ledger, const char *scene, const char *engine, const char *quantity) {
    int row = find(ledger, scene, engine, "quantity", quantity);
    return row >= 0 && !ck_row_is(ledger, row, "match", "impossible");
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
        if (ck_row_is(metrics, i, "scene", scene) && ck_row_is(metrics, i, "metric", "position_rms") && !isnan(error) &&
            is_ok(tables, scene, engine) && has(tables[CK_LEDGER], scene, engine, quantity))
            errors[count++] = error;
    }
    return count < 2 ? NAN : median(errors, count);
}

// A row that an engine cannot meet, of something that was asked for and that the scene's truth can show: what ends a
// motion does not change a rest.
static bool is_missed(const ck_CsvTable *const *tables, int row) {
    const ck_CsvTable *ledger = tables[CK_LEDGER];
    if (!ck_row_is(ledger, row, "match", "impossible") || !(ck_csv_number_of(ledger, row, "wanted") > 0)) return false;
    if (ck_row_is(ledger, row, "quantity", "physics")) return false; // an origin's quirk: claims shows those
    if (!ck_row_is(ledger, row, "quantity", "spring damping")) return true;
    int metric = find(tables[CK_METRICS], ck_csv_text_of(ledger, row, "scene"), ck_csv_text_of(ledger, row, "engine"),
                      "metric", "position_rms");
    return metric >= 0 && ck_row_is(tables[CK_METRICS], metric, "truth_kind", "trajectory");
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
        if (!ck_row_is(ledger, i, "engine", engine) || !is_missed(tables, i) || !is_ok(tables, scene, engine)) continue;
        double error = error_of(tables[CK_METRICS], scene, engine),
               others = middle_error(tables, scene, ck_csv_text_of(ledger, i, "quantity"));
        if (!(error > CK_FINDING_LEAST_ERROR && error > 3 * others)) continue;
        lack.scenes += last < 0 || !ck_row_is_same(ledger, last, i, "scene");
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
        const bool has_unit = !ck_row_is(ledger, i, "unit", "1");
        if (ck_row_is_same(ledger, i, row, "scene") && ck_row_is_same(ledger, i, row, "engine") && is_missed(tables, i))
            used += (size_t)snprintf(list + used, size - used, "%s%s (%g%s%s)", used ? " and no " : "",
                                     ck_csv_text_of(ledger, i, "quantity"), ck_csv_number_of(ledger, i, "wanted"),
                                     has_unit ? " " : "", has_unit ? ck_csv_text_of(ledger, i, "unit") : "");
    }
}

// What an engine cannot model, where it shows: one sentence an engine.
void ck_rule_models(ck_Findings *findings, const ck_CsvTable *const *tables) {
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
        ck_findings_add(
            findings, "model", scene, engine, command,
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
        int other = ck_row_is(runs, i, "engine", pair->engine) ? find(runs, scene, pair->other, NULL, NULL) : -1;
        if (other < 0 || !ck_row_is(runs, i, "status", "ok") || !ck_row_is(runs, other, "status", "ok")) continue;
        const int host = ck_csv_table_extra(runs, "host");
        if (host >= 0 && strcmp(ck_csv_table_text(runs, i, host), ck_csv_table_text(runs, other, host))) continue;
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
void ck_rule_costs(ck_Findings *findings, const ck_CsvTable *const *tables) {
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
        ck_findings_add(
            findings, "cost", costs.scene, pair.engine, command,
            "%s takes %.2g of the time of %s, %s (%.2g to %.2g, on %d %s), and is %.2g %% off where that is "
            "%.2g %% (medians)",
            pair.engine, ratio, pair.other, pair.difference, costs.ratios[0], costs.ratios[count - 1], count,
            count == 1 ? "scene" : "scenes", 100 * median(costs.errors[0], count),
            100 * median(costs.errors[1], count));
    }
}

// Where single precision is the error: one sentence an engine, of the scene on which it is the largest.
void ck_rule_single(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *metrics = tables[CK_METRICS];
    Pair pair;
    for (int i = 0; i < metrics->row_count; i++) {
        bool is_single =
            is_first_of_engine(metrics, i) && find_pair(&pair, ck_csv_text_of(metrics, i, "engine")) && pair.is_single;
        int worst = -1;
        double least = NAN;
        for (int k = i; k < metrics->row_count && is_single; k++) {
            if (!ck_row_is(metrics, k, "engine", pair.engine) || !ck_row_is(metrics, k, "metric", "position_rms"))
                continue;
            const char *scene = ck_csv_text_of(metrics, k, "scene");
            int twin = find(metrics, scene, pair.other, "metric", "position_rms");
            double error = error_of(metrics, scene, pair.engine),
                   other = twin < 0 ? NAN : ck_csv_number_of(metrics, twin, "error");
            if (!(error > CK_FINDING_LEAST_ERROR && error > 10 * other)) continue;
            if (worst >= 0 && error <= ck_csv_number_of(metrics, worst, "error")) continue;
            worst = k;
            least = other;
        }
        if (worst < 0) continue;
        const char *scene = ck_csv_text_of(metrics, worst, "scene");
        char command[200];
        snprintf(command, sizeof command, "clothcheck run %s --engine %s --engine %s", scene, pair.engine, pair.other);
        ck_findings_add(findings, "rounding", scene, pair.engine, command,
                        "%s on %s: single precision is %.3g %% of the size off, where %s, in double, is %.2g %% off",
                        pair.engine, scene, 100 * ck_csv_number_of(metrics, worst, "error"), pair.other, 100 * least);
    }
}
