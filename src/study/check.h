// Regression: what engines measure on scenes against a committed baseline, within bands that theory gives.
#ifndef CK_CHECK_H
#define CK_CHECK_H

#include "comparison.h"
#include "csv_writer.h"
#include "study.h"
#include "trial.h"

// A row of the baseline.
typedef struct ck_BaselineRow {
    char scene[64], engine[64], status[32], metric[64];
    double value, band; // NaN where the metric did not apply
} ck_BaselineRow;

typedef struct ck_Baseline {
    ck_BaselineRow *rows;
    int count;
} ck_Baseline;

// Reads a file. Errors: CK_BAD_INPUT with file, line and what is wrong; CK_IO, CK_NO_MEMORY. Free with ck_baseline_free
// in any case.
ck_Status ck_baseline_read(ck_Baseline *baseline, const char *path, ck_Error *error);
void ck_baseline_free(ck_Baseline *baseline);

// Adds a row as it is.
void ck_baseline_add(const ck_BaselineRow *row, ck_Csv *csv);

// One run to check, or to make a baseline of.
typedef struct ck_CheckCase {
    const ck_Comparison *comparison; // with its truth
    const ck_Engine *engine;
} ck_CheckCase;

// What a user lets a metric move by, besides its band.
typedef struct ck_Tolerance {
    const char *metric; // NULL: every one
    double value;       // in its unit or, where is_relative, of what it was
    bool is_relative;
} ck_Tolerance;

typedef struct ck_Check {
    ck_CheckCase *cases; // the caller's
    int case_count;
    const ck_Tolerance *tolerances;
    int tolerance_count;
    const ck_CompareOptions *options;
    bool is_update; // finds bands, too
} ck_Check;

// The study that measures. A row holds CPU time, the metrics in their order, then their bands.
ck_Study ck_check_study(const ck_Check *check);

// How far a measured value may be from the baseline's. nudged is the same run's from a start that is off by 1e-12 of
// the size, the farthest of three: what rounding may come to on another machine, of which ten times is allowed, and
// 1e-10 of the value. Of an engine in single precision 1e-6 of the size and 1e-5 of the value: it rounds 1e-12 away.
double ck_check_band(double value, double nudged, bool is_single);

typedef struct ck_Deviation {
    const ck_BaselineRow *row;
    double value;       // now
    const char *status; // now; as in row where it did not change
    double allowed;     // the band, or more where a tolerance says so
    double excess;      // |value − row| / allowed; INFINITY where the status changed or a value came or went
} ck_Deviation;

// Compares a case's measurement with its rows. deviations [baseline->count] gets those beyond their band, worst first
// within the case. Returns how many.
int ck_check_compare(const ck_Check *check, int one, const ck_JournalRow *row, const ck_Baseline *baseline,
                     ck_Deviation *deviations);

// Adds a case's rows to a new baseline. A run that takes longer than a check should, seconds of CPU, is left out.
bool ck_check_add(const ck_CheckCase *one, const ck_JournalRow *row, double seconds, ck_Csv *csv);

// Adds what was measured now to the history of a directory, history.csv, and keeps what it holds. Errors: CK_BAD_INPUT,
// CK_IO, CK_NO_MEMORY.
ck_Status ck_check_remember(const char *directory, const ck_Check *check, const ck_JournalRow *rows, ck_Error *error);

// Writes all cases and their deviations to directory/check.xml, as JUnit XML, whole or not at all. Errors: CK_IO,
// CK_NO_MEMORY.
ck_Status ck_check_write_junit(const char *directory, const ck_Check *check, const ck_JournalRow *rows,
                               const ck_Baseline *baseline, ck_Error *error);

#endif
