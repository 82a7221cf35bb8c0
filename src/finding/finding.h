// Results that a person should know, in words: each a sentence of a kind, with its numbers and the command that shows
// it.
#ifndef CK_FINDING_H
#define CK_FINDING_H

#include "csv_reader.h"

#include <stdbool.h>

typedef struct ck_Finding {
    const char *kind; // breakdown, rounding, setting, model, cost
    char scene[101], engine[64];
    char text[500], command[200];
} ck_Finding;

typedef struct ck_Findings {
    ck_Finding *items; // [count], by kind
    int count;
    bool has_failed; // there was no memory for one
} ck_Findings;

// Looks for what the rules of finding.c know in tables, [CK_REPORT_LAYOUTS], NULL where there is none. Nothing is said
// of differences within the uncertainty of a truth, or of costs whose intervals meet. Errors: CK_NO_MEMORY. Free with
// ck_findings_free in any case.
ck_Status ck_findings_find(ck_Findings *findings, const ck_CsvTable *const *tables, ck_Error *error);

// The same of the CSVs of a directory. Errors: those of ck_csv_table_read.
ck_Status ck_findings_read(ck_Findings *findings, const char *directory, ck_Error *error);

// Accepts zeroed ones.
void ck_findings_free(ck_Findings *findings);

#endif
