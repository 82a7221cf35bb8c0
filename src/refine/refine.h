// Refinement: does each metric of each engine converge as the mesh of the same material gets finer, and to what?
#ifndef CK_REFINE_H
#define CK_REFINE_H

#include "comparison.h"
#include "csv_writer.h"
#include "resize.h"
#include "study.h"

// Segments a row at each level, over the scene's.
#define CK_REFINE_LEVELS 3
extern const int ck_refine_shares[CK_REFINE_LEVELS]; // 1, 2, 4

typedef struct ck_Refine {
    const ck_Comparison *comparison;
    const ck_CompareOptions *options;
    const char *cache; // directory of truths
    ck_SceneResized scenes[CK_REFINE_LEVELS];
    ck_Model models[CK_REFINE_LEVELS];
    int model_count;
    const ck_Engine **engines; // NULL: the scene's truth
    int engine_count;
} ck_Refine;

// Builds the scene at each level. Errors: CK_BAD_INPUT where it cannot be refined, CK_NO_MEMORY. Free with
// ck_refine_free in any case.
//   options, cache  must outlive it
ck_Status ck_refine_create(ck_Refine *refine, const ck_Comparison *comparison, const ck_CompareOptions *options,
                           const char *cache, ck_Error *error);
void ck_refine_free(ck_Refine *refine);

// The study that runs every engine, and solves the truth, at each level.
ck_Study ck_refine_study(const ck_Refine *refine);

// What three values at spacings 1, ½ and ¼ come to.
typedef struct ck_Refinement {
    double order, limit; // of the error in the spacing, by the ratio of differences; extrapolated by it; NaN: none
    const char *verdict; // converges, settled (they differ by less than 0.5 %), does not converge, unknown
} ck_Refinement;

// Source: Richardson 1911; the order of three grids as Roache 1994.
ck_Refinement ck_refine_judge(const double *values);

// Adds a row a level to csv, and one an engine and metric to summary.
void ck_refine_write(const ck_Refine *refine, const ck_JournalRow *rows, ck_Csv *csv, ck_Csv *summary);

// The names of the values of its journal; signature of ck_ValueName.
bool ck_refine_value(int index, char *name, size_t size);

#endif
