// Settings for one engine on one scene: the cheapest that meet a goal, or those that come closest to it.
#ifndef CK_TUNE_H
#define CK_TUNE_H

#include "comparison.h"
#include "csv_writer.h"
#include "journal.h"
#include "trial.h"

// The springs' stiffness, which is the scene's to give, may be varied beside a ck_Slot; and the most that vary at once.
#define CK_TUNE_STIFFNESS (-1)
#define CK_TUNE_VARIABLES 5

// What is asked for. Without a bound the least error is looked for, with one the least work within it; with frame alone
// the least error for that cost.
typedef struct ck_TuneGoal {
    double error;          // a bound; NAN: none
    double stretch;        // a bound of the largest strain at the end; NAN: none
    double frame;          // s of CPU that 1/60 s of the scene may cost; NAN: any
    ck_TrialGoal aim;      // of the error, in place of the truth
    const ck_Engine *like; // or its path; NULL: none
} ck_TuneGoal;

typedef struct ck_TuneOptions {
    const ck_Engine *engine;
    ck_TuneGoal goal;
    bool varies_softness, varies_stiffness; // besides substeps, iterations and relaxation, where the engine has them
    char *const *validate;                  // scene paths to try the result on
    int validate_count;
    const char *directory, *question, *cache; // of the journal and the truths of the scenes it is tried on
    ck_Settings given;                        // what the user sets of the engine
    ck_Limits limits;
    int jobs;                                      // that try settings side by side; 0: one a core
    double timeout;                                // s of wall time for the whole search; INFINITY: any
    void (*progress)(int evaluation, double best); // may be NULL
} ck_TuneOptions;

// One setting, tried.
typedef struct ck_TunePoint {
    ck_Settings settings;
    double stiffness; // times the scene's
    double work;      // sweeps of all springs per simulated second, one more a substep: a cost that no clock blurs
    ck_Trial trial;
    double static_error, dynamic_error;
} ck_TunePoint;

// The best on another scene.
typedef struct ck_TuneValidation {
    char scene[64];
    ck_TunePoint point;
} ck_TuneValidation;

typedef struct ck_Tuning {
    ck_TunePoint best;
    ck_TunePoint *points;           // [point_count] all that was tried
    int point_count, best_index;    // best is points[best_index]
    double uncertainty;             // below which errors are alike
    ck_TuneValidation *validations; // [validate_count]
    int validation_count;
    bool meets;       // the goal's bounds, where it has any
    bool is_cheapest; // all that would be cheaper was tried, and misses it
    bool is_late;     // the search ended by its timeout
    char bounds[200]; // which variables ended at a bound; empty: none
} ck_Tuning;

// Whether a goal can be reached by any engine, cheaply: a scene that cannot settle in its duration does not come within
// an error of a truth at rest. Errors: CK_BAD_INPUT, which says what would help.
ck_Status ck_tune_check(const ck_Comparison *comparison, double tolerance, ck_Error *error);

// Searches deterministically, but for what a frame costs: with a bound, pairs of substeps and iterations from the
// cheapest on until one is within it, and all that is cheaper; without one, pairs from the cheapest on for as long as
// they are cheap enough and more work helps, and then around the best, with NLopt; with more to vary, NLopt alone. Adds
// a row an evaluation, one for the best and one a scene it is tried on. Errors: CK_BAD_INPUT, CK_NO_MEMORY, CK_IO;
// CK_REFUSED where the engine does not take the scene. Free with ck_tuning_free in any case.
ck_Status ck_tune_run(ck_Tuning *tuning, const ck_Comparison *comparison, const ck_TuneOptions *options, ck_Csv *csv,
                      ck_Error *error);
void ck_tuning_free(ck_Tuning *tuning);

// True where no point that was tried does less work and errs no more, to a fiftieth.
bool ck_tuning_is_on_front(const ck_Tuning *tuning, int point);

// s of CPU for 1/60 s of the scene.
double ck_tune_frame_cost(const ck_TunePoint *point, const ck_Model *model);

#endif
