// What a scene needs to be modelled: one term left out at a time, and half the resolution.
#ifndef CK_NEEDS_H
#define CK_NEEDS_H

#include "comparison.h"
#include "csv_writer.h"
#include "study.h"
#include "trial.h"

#define CK_NEEDS_MOST 64

typedef struct ck_NeedsCase {
    int term;     // of the table of terms
    int collider; // which one, of the term that leaves one out
    char name[64];
} ck_NeedsCase;

typedef struct ck_Needs {
    const ck_Comparison *comparison;
    const ck_Engine *engine;
    ck_Settings given; // what the user sets of the engine
    double tolerance;  // of a change, in the metric's unit, or relative where it has one
    ck_Limits limits;
    ck_Run base; // the whole scene
    ck_Measurement whole;
    ck_NeedsCase cases[CK_NEEDS_MOST];
    int case_count;
} ck_Needs;

// Runs the whole scene and lists what can be left out. Errors: CK_REFUSED where the engine does not get through it,
// CK_NO_MEMORY, CK_IO. Free with ck_needs_free in any case.
ck_Status ck_needs_create(ck_Needs *needs, const ck_Comparison *comparison, const ck_Engine *engine, double tolerance,
                          const ck_Settings *given, const ck_Limits *limits, ck_Error *error);
void ck_needs_free(ck_Needs *needs);

ck_Study ck_needs_study(const ck_Needs *needs);

// Adds a row a case and metric.
void ck_needs_write(const ck_Needs *needs, const ck_JournalRow *rows, ck_Csv *csv);

// The names of the values of its journal; signature of ck_ValueName.
bool ck_needs_value(int index, char *name, size_t size);

#endif
