#include "finding.h"

#include "files.h"
#include "rules.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool ck_row_is(const ck_CsvTable *table, int row, const char *column, const char *value) {
    return !strcmp(ck_csv_text_of(table, row, column), value);
}

bool ck_row_is_same(const ck_CsvTable *table, int row, int other, const char *column) {
    return ck_row_is(table, row, column, ck_csv_text_of(table, other, column));
}

void ck_findings_add(ck_Findings *findings, const char *kind, const char *scene, const char *engine,
                     const char *command, const char *format, ...) {
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

// Rules look for each row's like: their cost is the square of the rows.
#define MOST_RUNS 5000

// A rule is one row.
static const struct {
    ck_LayoutName needs;
    ck_Rule *find;
} rules[] = {
    {CK_RUNS, ck_rule_breakdowns},      {CK_STABILITY, ck_rule_limits},
    {CK_STABILITY, ck_rule_theory},     {CK_PRECISION_SUMMARY, ck_rule_finest},
    {CK_PRECISION, ck_rule_spacing},    {CK_METRICS, ck_rule_single},
    {CK_PRECISION, ck_rule_iterations}, {CK_NEEDS, ck_rule_needless},
    {CK_LEDGER, ck_rule_models},        {CK_RUNS, ck_rule_costs},
    {CK_BENCH, ck_rule_links},
};

ck_Status ck_findings_find(ck_Findings *findings, const ck_CsvTable *const *tables, ck_Error *error) {
    const ck_CsvTable *runs = tables[CK_RUNS];
    *findings = (ck_Findings){0};
    if (runs && runs->row_count > MOST_RUNS) {
        ck_findings_add(findings, "note", "", "", "", "%d runs are too many to be set beside each other: read the CSVs",
                        runs->row_count);
        return findings->has_failed ? ck_fail(error, CK_NO_MEMORY, "out of memory") : CK_OK;
    }
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
        if (tables[rules[i].needs]) rules[i].find(findings, tables);
    return findings->has_failed ? ck_fail(error, CK_NO_MEMORY, "out of memory") : CK_OK;
}

ck_Status ck_findings_read(ck_Findings *findings, const char *directory, ck_Error *error) {
    ck_CsvTable read[CK_REPORT_LAYOUTS] = {{0}};
    const ck_CsvTable *tables[CK_REPORT_LAYOUTS] = {NULL};
    ck_Status status = CK_OK;
    *findings = (ck_Findings){0};
    if (access(directory, R_OK | X_OK))
        return ck_fail(error, ck_file_status(errno), "%s: %s", directory, strerror(errno));
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
