// Rules of studies: of precision, stability, needs and speed.
#include "rules.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The smallest command that shows what a study found of an engine.
static void command_of(char *command, size_t size, const char *study, const char *scene, const char *engine) {
    snprintf(command, size, "clothcheck %s %s --engine %s", study, scene, engine);
}

// Finer steps that make it worse, as the study of precision found.
void ck_rule_finest(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *summary = tables[CK_PRECISION_SUMMARY];
    for (int i = 0; i < summary->row_count; i++) {
        const bool is_rounding = ck_row_is(summary, i, "quantity", "finest_before_rounding");
        if (!is_rounding && !ck_row_is(summary, i, "quantity", "finest_useful_substeps")) continue;
        const char *scene = ck_csv_text_of(summary, i, "scene"), *engine = ck_csv_text_of(summary, i, "engine");
        char command[200];
        command_of(command, sizeof command, "precision", scene, engine);
        ck_findings_add(findings, is_rounding ? "rounding" : "setting", scene, engine, command,
                        "%s on %s: more than %s substeps a frame are no use: %s", engine, scene,
                        ck_csv_text_of(summary, i, "value"), ck_csv_text_of(summary, i, "reason"));
    }
}

// What a point falls by in a step is rounded away where it is less than half the spacing of numbers.
static bool is_lost(const ck_CsvTable *table, int row) {
    return ck_csv_number_of(table, row, "rounding") >= 0.5;
}

// The step from which on falling is rounded away: one sentence an engine.
void ck_rule_spacing(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *table = tables[CK_PRECISION];
    for (int first = 0, said = -1; first < table->row_count; first++) {
        if (!is_lost(table, first) || !(ck_csv_number_of(table, first, "error") > CK_FINDING_LEAST_ERROR)) continue;
        if (said >= 0 && ck_row_is_same(table, said, first, "engine") && ck_row_is_same(table, said, first, "scene"))
            continue;
        int coarsest = first;
        for (int i = first; i < table->row_count; i++)
            if (ck_row_is_same(table, i, first, "scene") && ck_row_is_same(table, i, first, "engine") &&
                is_lost(table, i) && ck_row_is(table, i, "status", "ok") &&
                ck_csv_number_of(table, i, "substeps") < ck_csv_number_of(table, coarsest, "substeps"))
                coarsest = i;
        said = first;
        const char *scene = ck_csv_text_of(table, first, "scene"), *engine = ck_csv_text_of(table, first, "engine");
        char command[200];
        command_of(command, sizeof command, "precision", scene, engine);
        ck_findings_add(
            findings, "rounding", scene, engine, command,
            "%s on %s: at %s substeps a frame a step falls by %.2g of the spacing of its numbers, and it is "
            "%.2g %% off",
            engine, scene, ck_csv_text_of(table, coarsest, "substeps"),
            1 / ck_csv_number_of(table, coarsest, "rounding"), 100 * ck_csv_number_of(table, coarsest, "error"));
    }
}

// More iterations at the same step that cost more, and leave the error where it was.
void ck_rule_iterations(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *table = tables[CK_PRECISION];
    for (int few = 0, said = -1; few < table->row_count; few++) {
        if (!ck_row_is(table, few, "status", "ok") || !(ck_csv_number_of(table, few, "error") > CK_FINDING_LEAST_ERROR))
            continue;
        if (is_lost(table, few)) continue; // no iteration helps
        if (said >= 0 && ck_row_is_same(table, said, few, "engine") && ck_row_is_same(table, said, few, "scene"))
            continue;
        int many = -1;
        for (int i = 0; i < table->row_count; i++)
            if (ck_row_is_same(table, i, few, "scene") && ck_row_is_same(table, i, few, "engine") &&
                ck_row_is(table, i, "status", "ok") && ck_row_is_same(table, i, few, "substeps") &&
                ck_csv_number_of(table, i, "iterations") > ck_csv_number_of(table, many < 0 ? few : many, "iterations"))
                many = i;
        if (many < 0) continue;
        const double before = ck_csv_number_of(table, few, "error"), after = ck_csv_number_of(table, many, "error"),
                     dearer = ck_csv_number_of(table, many, "cpu_s") / ck_csv_number_of(table, few, "cpu_s");
        if (!(after > 0.8 * before && dearer > CK_FINDING_FACTOR)) continue;
        const char *scene = ck_csv_text_of(table, few, "scene"), *engine = ck_csv_text_of(table, few, "engine");
        char command[200];
        command_of(command, sizeof command, "precision", scene, engine);
        ck_findings_add(
            findings, "setting", scene, engine, command,
            "%s on %s: %s iterations in place of %s, at %s substeps a frame, cost %.2g times as much, and the error is "
            "%.2g %% where it was %.2g %%",
            engine, scene, ck_csv_text_of(table, many, "iterations"), ck_csv_text_of(table, few, "iterations"),
            ck_csv_text_of(table, few, "substeps"), dearer, 100 * after, 100 * before);
        said = few;
    }
}

// A critical step of the scene's own damping and stiffness.
static bool is_critical(const ck_CsvTable *table, int row) {
    return ck_row_is(table, row, "case", "critical") && ck_row_is(table, row, "damping", "scene") &&
           ck_csv_number_of(table, row, "stiffness_factor") == 1;
}

// The engine of a scene with the shortest critical step beyond one; -1: none.
static int next_critical(const ck_CsvTable *table, int scene, int after) {
    int next = -1;
    for (int i = 0; i < table->row_count; i++) {
        const double step = ck_csv_number_of(table, i, "critical_step_s"),
                     least = after < 0 ? 0 : ck_csv_number_of(table, after, "critical_step_s");
        if (!ck_row_is_same(table, i, scene, "scene") || !is_critical(table, i) || !(step > 0)) continue;
        // those that are alike come in the table's order
        if (step < least || (step == least && i <= after)) continue;
        if (next < 0 || step < ck_csv_number_of(table, next, "critical_step_s")) next = i;
    }
    return next;
}

// Steps beyond which each engine breaks down: one sentence a scene.
void ck_rule_limits(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *table = tables[CK_STABILITY];
    for (int i = 0; i < table->row_count; i++) {
        int before = 0;
        while (before < i && !ck_row_is_same(table, before, i, "scene")) before++;
        const int first = before == i ? next_critical(table, i, -1) : -1;
        if (first < 0) continue;
        char list[300] = "", command[200];
        size_t used = 0;
        for (int row = first; row >= 0 && used < sizeof list; row = next_critical(table, i, row))
            used += (size_t)snprintf(list + used, sizeof list - used, "%s%s %.3g ms", used ? ", " : "",
                                     ck_csv_text_of(table, row, "engine"),
                                     1e3 * ck_csv_number_of(table, row, "critical_step_s"));
        const char *scene = ck_csv_text_of(table, i, "scene");
        snprintf(command, sizeof command, "clothcheck stability %s", scene);
        ck_findings_add(findings, "breakdown", scene, ck_csv_text_of(table, first, "engine"), command,
                        "on %s longer steps than these blow up: %s%s", scene, list, used >= sizeof list ? " …" : "");
    }
}

// Where a method fails long before, or after, its theory.
void ck_rule_theory(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *table = tables[CK_STABILITY];
    for (int i = 0; i < table->row_count; i++) {
        const double ratio = ck_csv_number_of(table, i, "ratio");
        if (!is_critical(table, i) || !(ratio > CK_FINDING_FACTOR || ratio < 1 / CK_FINDING_FACTOR)) continue;
        const char *scene = ck_csv_text_of(table, i, "scene"), *engine = ck_csv_text_of(table, i, "engine");
        char command[200];
        command_of(command, sizeof command, "stability", scene, engine);
        ck_findings_add(findings, "breakdown", scene, engine, command,
                        "%s on %s: its longest stable step is %.3g ms, %.2g of that of its theory", engine, scene,
                        1e3 * ck_csv_number_of(table, i, "critical_step_s"), ratio);
    }
}

// True where a term's leaving out ran to its end and moved no metric beyond the tolerance.
static bool is_needless(const ck_CsvTable *table, int first) {
    bool has_metric = false;
    for (int i = first; i < table->row_count; i++) {
        if (!ck_row_is_same(table, i, first, "scene") || !ck_row_is_same(table, i, first, "left_out") ||
            !ck_row_is_same(table, i, first, "engine"))
            continue;
        if (!ck_row_is(table, i, "status", "ok") || ck_row_is(table, i, "matters", "yes")) return false;
        has_metric |= ck_row_is(table, i, "matters", "no");
    }
    return has_metric;
}

// Terms that a scene does not need.
void ck_rule_needless(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *table = tables[CK_NEEDS];
    for (int i = 0; i < table->row_count; i++) {
        int before = 0;
        while (before < i &&
               !(ck_row_is_same(table, before, i, "scene") && ck_row_is_same(table, before, i, "left_out") &&
                 ck_row_is_same(table, before, i, "engine")))
            before++;
        if (before < i || !is_needless(table, i)) continue;
        const double with = ck_csv_number_of(table, i, "cpu_with_s"),
                     without = ck_csv_number_of(table, i, "cpu_without_s");
        const char *scene = ck_csv_text_of(table, i, "scene"), *engine = ck_csv_text_of(table, i, "engine");
        char command[200], saved[80] = "";
        snprintf(command, sizeof command, "clothcheck needs %s --engine %s", scene, engine);
        if (with > CK_FINDING_FACTOR * without)
            snprintf(saved, sizeof saved, ", and %s takes %.2g of the time without", engine, without / with);
        ck_findings_add(findings, "model", scene, engine, command,
                        "%s can do without '%s': no metric moves by more than %s%s", scene,
                        ck_csv_text_of(table, i, "left_out"), ck_csv_text_of(table, i, "tolerance"), saved);
    }
}

// True where no later row is of the same engine and set-up on a larger cloth.
static bool is_largest(const ck_CsvTable *table, int row) {
    for (int i = 0; i < table->row_count; i++)
        if (ck_row_is_same(table, i, row, "engine") && ck_row_is_same(table, i, row, "setup") &&
            ck_row_is_same(table, i, row, "metric") && ck_row_is_same(table, i, row, "body") &&
            ck_csv_number_of(table, i, "particles") > ck_csv_number_of(table, row, "particles"))
            return false;
    return true;
}

// How much dearer a spring is elsewhere than in the native solver of the same kind, on the largest cloth.
void ck_rule_links(ck_Findings *findings, const ck_CsvTable *const *tables) {
    const ck_CsvTable *table = tables[CK_BENCH];
    for (int i = 0; i < table->row_count; i++) {
        const double low = ck_csv_number_of(table, i, "low"), high = ck_csv_number_of(table, i, "high");
        if (!ck_row_is(table, i, "metric", "update_over_native") || !ck_row_is(table, i, "body", "cloth") ||
            !(low > CK_FINDING_FACTOR || high < 1 / CK_FINDING_FACTOR) || !is_largest(table, i))
            continue;
        const char *engine = ck_csv_text_of(table, i, "engine"), *setup = ck_csv_text_of(table, i, "setup");
        ck_findings_add(findings, "cost", "", engine, "clothcheck bench",
                        "%s%s%s takes %.2g times as long for a spring and sweep as the native solver of its kind (%.2g "
                        "to %.2g), on a cloth of %s particles",
                        engine, *setup ? ", " : "", setup, ck_csv_number_of(table, i, "value"), low, high,
                        ck_csv_text_of(table, i, "particles"));
    }
}
