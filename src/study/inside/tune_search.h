// What a search for settings has tried: each setting once, from the journal or by running it.
#ifndef CK_TUNE_SEARCH_H
#define CK_TUNE_SEARCH_H

#include "tune.h"

// The most settings that one search tries.
#define CK_TUNE_MOST_POINTS 1500
// The most that are tried side by side.
#define CK_TUNE_MOST_BATCH 64
// The value of a setting that fails.
#define CK_TUNE_FAILED 1e3

typedef struct ck_TuneSearch {
    const ck_Comparison *comparison;
    const ck_TuneOptions *options;
    ck_Csv *csv;
    ck_Journal journal;
    ck_Run like;        // its path, where the goal is like an engine
    ck_TrialGoal aim;   // of the error
    double uncertainty; // of the truth, where the error is to it: no error is told from a smaller one
    ck_TunePoint points[CK_TUNE_MOST_POINTS];
    double values[CK_TUNE_MOST_POINTS]; // of what is searched for: the less, the better
    char keys[CK_TUNE_MOST_POINTS][256];
    int point_count, best;
    ck_JournalRow kept[CK_TUNE_MOST_POINTS]; // of the journal
    char kept_keys[CK_TUNE_MOST_POINTS][256];
    int kept_count;
    double deadline; // of ck_wall
    bool is_late;
    ck_Status status;
    ck_Error *error;
} ck_TuneSearch;

// Opens the journal of the options' directory and takes what it holds. Errors: CK_IO, CK_NO_MEMORY.
ck_Status ck_tune_search_open(ck_TuneSearch *search, ck_Error *error);

// Tries points side by side, those that are not known yet, and tells of each in the order given.
//   indices  [count] out: where they are among those tried; negative: not tried, by an error or for lack of time
void ck_tune_try(ck_TuneSearch *search, const ck_TunePoint *points, int count, int *indices);

// True where the goal has a bound, on error or stretch.
bool ck_tune_has_bound(const ck_TuneGoal *goal);
// True where a point is within all that the goal bounds.
bool ck_tune_meets(const ck_TuneSearch *search, const ck_TunePoint *point);

// Runs one point on a scene. Errors: CK_NO_MEMORY, CK_IO.
ck_Status ck_tune_run_on(ck_TunePoint *point, const ck_Comparison *comparison, const ck_TrialGoal *aim,
                         const ck_TuneOptions *options, ck_Error *error);

void ck_tune_add_row(ck_Csv *csv, const ck_Model *model, const ck_TuneOptions *options, const char *role,
                     const ck_TunePoint *point, bool meets, const char *bounds);

#endif
