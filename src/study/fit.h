// Stiffness, damping and drag from a measurement: the values at which the scene's truth, or an engine, comes closest to
// it, each with the interval that the measurement's own uncertainty leaves.
#ifndef CK_FIT_H
#define CK_FIT_H

#include "comparison.h"
#include "csv_writer.h"
#include "recording.h"

// What may be fitted: all of them scale what the scene gives as a start.
typedef enum ck_FitParameter { CK_FIT_STIFFNESS, CK_FIT_DAMPING, CK_FIT_DRAG, CK_FIT_PARAMETERS } ck_FitParameter;
extern const char *const ck_fit_names[CK_FIT_PARAMETERS]; // as in --vary
extern const char *const ck_fit_units[CK_FIT_PARAMETERS];

// The rest of the scene's measurement is its key measured.
typedef struct ck_FitData {
    ck_Recording points; // some particles at some times
    double uncertainty;  // m, standard, of each coordinate
} ck_FitData;

typedef struct ck_FitOptions {
    const ck_Engine *engine; // NULL: the scene's truth
    ck_Settings settings;    // of the engine
    bool varies[CK_FIT_PARAMETERS];
    ck_Limits limits;
} ck_FitOptions;

typedef struct ck_Fit {
    double start[CK_FIT_PARAMETERS], value[CK_FIT_PARAMETERS], low[CK_FIT_PARAMETERS],
        high[CK_FIT_PARAMETERS];                              // SI, 95 %
    double correlation[CK_FIT_PARAMETERS][CK_FIT_PARAMETERS]; // of the logarithms
    double misfit;                 // rms of what is left, in units of the uncertainty: about 1 where the model is right
    int evaluations, number_count; // runs of the model, and numbers that were measured
} ck_Fit;

// Levenberg and Marquardt on the logarithms, derivatives by differences. What is left beyond the uncertainty widens the
// intervals. Errors: CK_BAD_INPUT where nothing is measured or varied, a start is 0, or the model cannot be run;
// CK_REFUSED where the data say nothing of a parameter; CK_NO_MEMORY, CK_IO.
ck_Status ck_fit_run(ck_Fit *fit, const ck_Comparison *comparison, const ck_FitData *data, const ck_FitOptions *options,
                     ck_Error *error);

// A row for each parameter.
void ck_fit_write(const ck_Fit *fit, const ck_Comparison *comparison, const ck_FitOptions *options, ck_Csv *csv);

#endif
