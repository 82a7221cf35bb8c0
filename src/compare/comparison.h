// One scene, every engine: measured, judged, timed, and set against truth and theory.
#ifndef CK_COMPARISON_H
#define CK_COMPARISON_H

#include "engines.h"
#include "fold.h"
#include "prediction.h"
#include "process.h"
#include "runner.h"
#include "scene.h"
#include "trial.h"
#include "truth.h"

// The most engines of one comparison.
#define CK_COMPARISON_MAX_ENGINES 32

typedef struct ck_Override {
    const ck_Engine *engine;
    ck_Settings settings; // not set where it leaves the scene's
} ck_Override;

#define CK_REPEAT_UNTIL_KNOWN (-1)

typedef struct ck_CompareOptions {
    const ck_Engine *const *engines;
    int engine_count;
    const ck_Override *overrides;
    int override_count;
    int repeats;               // timed; 0: no timing; CK_REPEAT_UNTIL_KNOWN: as ck_timing_is_known says
    double consistency_budget; // s of CPU time that an engine's self-consistency may take; 0: not measured
    double budget;             // s of CPU time per timed repeat at most
    double enough;             // s of wall time for all repeats of an engine, where they end when it is known
    int jobs;                  // that measure side by side; 0: one a core
    uint64_t seed;             // of the order in which engines are timed
    ck_Limits limits;
    const char *cache; // directory of computed truths; NULL: none
    // Called before each run with what is about to happen; may be NULL.
    void (*progress)(const char *scene, const char *engine, const char *doing);
} ck_CompareOptions;

// All engines of the table, timed until it is known, repeats of at most half a second, self-consistency up to 0.3 s,
// seed 1, default limits.
ck_CompareOptions ck_compare_options_default(void);

typedef struct ck_Comparison {
    const char *path; // of the scene file, as the user gave it
    ck_Scene scene;
    ck_Model model;
    ck_Truth truth;
    ck_Run *runs; // [run_count], one an engine, in the order of options.engines
    ck_Reference *predictions;
    double (*consistency)[CK_CONSISTENCY_STEPS]; // of each run, NaN where it was not measured
    ck_Fold *folds;                              // of each run
    int run_count;
} ck_Comparison;

// The scene's settings of an engine, with what the caller overrides.
ck_Settings ck_comparison_settings(const ck_Engine *engine, const ck_Scene *scene, const ck_CompareOptions *options);

// Loads and compiles a scene and checks that it has the truth it names; runs nothing. path must outlive the comparison.
// Errors: CK_BAD_INPUT, CK_NO_MEMORY, CK_IO. Free with ck_comparison_free in any case.
ck_Status ck_comparison_load(ck_Comparison *comparison, const char *path, ck_Error *error);

// Finds the truth, where it is not there yet, and runs every engine. Errors: CK_NO_MEMORY, CK_IO. How the engines fared
// is in the runs.
ck_Status ck_comparison_run(ck_Comparison *comparison, const ck_CompareOptions *options, ck_Error *error);

// Frees what the runs and the truth hold, and keeps the scene. Accepts a zeroed comparison.
void ck_comparison_free_runs(ck_Comparison *comparison);
void ck_comparison_free(ck_Comparison *comparison);

// What a run is scored by: the scene and its truth, or of a run that was cut both up to there. False where it cannot be
// scored: it has no path, or the truth knows only the end.
bool ck_comparison_scores(const ck_Comparison *comparison, int run, ck_Model *model, ck_Reference *reference);

// Which engine stands apart: by its error where there is a truth, else by its distance to the others.

typedef struct ck_Outlier {
    int run;         // index of the run; −1: none stands apart
    bool has_truth;  // distances are errors
    double distance; // of it to the truth, or its median distance to the others
    double rest;     // median of the others' errors, or of their distances among themselves
} ck_Outlier;

// A run stands apart where its distance is more than three times the rest's, more than 0.1 % (of the metric's truth
// where that has a unit) and more than the truth's uncertainty: below that there is only noise. Engines without a
// method (that do nothing) and runs that did not end ok do not count; of fewer than three none stands apart.
ck_Outlier ck_outlier_find(const ck_Comparison *comparison, const ck_Metric *metric);

#endif
