// Rules of findings: each looks at tables, [CK_REPORT_LAYOUTS], and says a sentence where it holds.
#ifndef CK_RULES_H
#define CK_RULES_H

#include "finding.h"

// An error is one where it is beyond so many uncertainties of the truth, and a thousandth.
#define CK_FINDING_UNCERTAINTIES 10
#define CK_FINDING_LEAST_ERROR 1e-3
// How much worse, dearer or cheaper something must be to be worth a sentence.
#define CK_FINDING_FACTOR 1.25

typedef void ck_Rule(ck_Findings *findings, const ck_CsvTable *const *tables);

// Of a comparison.
ck_Rule ck_rule_breakdowns, ck_rule_single, ck_rule_models, ck_rule_costs;
// Of studies.
ck_Rule ck_rule_finest, ck_rule_spacing, ck_rule_iterations, ck_rule_limits, ck_rule_theory, ck_rule_needless,
    ck_rule_links;

// Adds a sentence; where there is no memory the findings say so.
void ck_findings_add(ck_Findings *findings, const char *kind, const char *scene, const char *engine,
                     const char *command, const char *format, ...) __attribute__((format(printf, 6, 7)));

// True where a row's column holds value; where it holds the same as another row's.
bool ck_row_is(const ck_CsvTable *table, int row, const char *column, const char *value);
bool ck_row_is_same(const ck_CsvTable *table, int row, int other, const char *column);

#endif
