// Which of a network's rests an engine came to. Minima of the energy are not unique: a body that lies in another fold
// than the truth's is told from one that misses its own.
#ifndef CK_FOLD_H
#define CK_FOLD_H

#include "runner.h"
#include "truth.h"

// All NaN where there is nothing to tell: the scene has no rest of springs, or the run none of its own.
typedef struct ck_Fold {
    double own;    // rms distance of the run's end to the minimum that Newton finds from there, / size
    double apart;  // rms distance of that minimum to the truth's, / size
    double energy; // of that minimum over the truth's, J
} ck_Fold;

// Polishes where a run came to rest by Newton, in a child; NaN where it does not get there within its limits.
// Errors: CK_NO_MEMORY, CK_IO.
ck_Status ck_fold_find(ck_Fold *fold, const ck_Run *run, const ck_Truth *truth, const ck_Limits *limits,
                       ck_Error *error);

// True where the minimum is another than the truth's: farther from it than the truth is known, and by far farther than
// the run is from the minimum.
bool ck_fold_is_another(const ck_Fold *fold, const ck_Truth *truth, const ck_Model *model);

#endif
