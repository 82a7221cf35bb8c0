// Which engine stands apart: by its error where there is a truth, else by its distance to the others.
#ifndef CK_OUTLIER_H
#define CK_OUTLIER_H

#include "comparison.h"

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
