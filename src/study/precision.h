// Work against precision: every engine on one scene, over time steps and iterations.
#ifndef CK_PRECISION_H
#define CK_PRECISION_H

#include "comparison.h"
#include "csv_writer.h"
#include "study.h"

typedef struct ck_PrecisionCase {
    const ck_Engine *engine;
    ck_Settings settings;
    bool is_ladder; // at the engine's own iterations: a point of its order's fit
} ck_PrecisionCase;

typedef struct ck_Precision {
    const ck_Comparison *comparison; // with its truth, outlives this
    ck_Limits limits;
    int repeats;
    double uncertainty; // of the truth's positions, / size: no error is told from a smaller one
    ck_PrecisionCase *cases;
    int case_count;
} ck_Precision;

// Lists the cases: time steps of an eighth to sixteen times as many substeps as each engine's rule takes, at least 512,
// and where it iterates a quarter of and four times its iterations. Errors: CK_BAD_INPUT where the scene's truth has no
// positions, CK_NO_MEMORY. Free with ck_precision_free in any case.
ck_Status ck_precision_create(ck_Precision *precision, const ck_Comparison *comparison,
                              const ck_CompareOptions *options, ck_Error *error);
void ck_precision_free(ck_Precision *precision);

// The study that runs them.
ck_Study ck_precision_study(const ck_Precision *precision);

// Adds a row a case, with the Pareto front marked; and to summary each engine's order, floor and cost to 10, 1, 0.1 %.
void ck_precision_write(const ck_Precision *precision, const ck_JournalRow *rows, ck_Csv *csv, ck_Csv *summary);

// The names of the values of its journal; signature of ck_ValueName.
bool ck_precision_value(int index, char *name, size_t size);

#endif
