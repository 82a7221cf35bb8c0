// Settings for one engine on one scene: the cheapest that meet a tolerance, or those that come closest.
#ifndef CK_TUNE_H
#define CK_TUNE_H

#include "comparison.h"
#include "csv_writer.h"
#include "journal.h"
#include "trial.h"

// The springs' stiffness, which is the scene's to give, may be varied beside a ck_Slot; and the most that vary at once.
#define CK_TUNE_STIFFNESS (-1)
#define CK_TUNE_VARIABLES 5

typedef struct ck_TuneOptions {
    const ck_Engine *engine;
    double tolerance;                       // of error; NAN: come as close as can be
    const ck_Engine *like;                  // to come close to its path instead of the truth; NULL: the truth
    bool varies_softness, varies_stiffness; // besides substeps, iterations and relaxation, where the engine has them
    char *const *validate;                  // scene paths to try the result on
    int validate_count;
    const char *directory, *question, *cache; // of the journal and the truths of the scenes it is tried on
    ck_Settings given;                        // what the user sets of the engine
    ck_Limits limits;
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

typedef struct ck_Tuning {
    ck_TunePoint best;
    int evaluations;
    bool meets;       // the tolerance, where there is one
    bool is_cheapest; // all that would be cheaper was tried, and misses it
    bool is_late;     // the search ended by its timeout
    char bounds[200]; // which variables ended at a bound; empty: none
} ck_Tuning;

// Whether a goal can be reached by any engine, cheaply: a scene that cannot settle in its duration does not come within
// an error of a truth at rest. Errors: CK_BAD_INPUT, which says what would help.
ck_Status ck_tune_check(const ck_Comparison *comparison, double tolerance, ck_Error *error);

// Searches deterministically: pairs of substeps and iterations from the cheapest on until one is within the tolerance,
// and all that is cheaper; or, without a tolerance or with more to vary, with NLopt, and adds a row an evaluation, one
// for the best and one a scene it is tried on. Errors: CK_BAD_INPUT, CK_NO_MEMORY, CK_IO; CK_REFUSED where the engine
// does not take the scene.
ck_Status ck_tune_run(ck_Tuning *tuning, const ck_Comparison *comparison, const ck_TuneOptions *options, ck_Csv *csv,
                      ck_Error *error);

// The result as lines of a scene file.
void ck_tune_print(const ck_Tuning *tuning, const ck_TuneOptions *options, const ck_Model *model);

#endif
