// Which engine stands apart from the others, judged without any truth.
#ifndef CK_OUTLIER_H
#define CK_OUTLIER_H

#include "comparison.h"

typedef struct ck_Outlier {
    int run;         // index of the run farthest from the others; −1: fewer than three engines have a value
    double distance; // median distance of it to the others
    double rest;     // median distance of the others among themselves
} ck_Outlier;

// Engines without a method (the null engine) and runs without a path do not count.
ck_Outlier ck_outlier_find(const ck_Comparison *comparison, const ck_Metric *metric);

#endif
