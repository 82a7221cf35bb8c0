// All metrics of one run, for studies that set runs against each other.
#ifndef CK_MEASUREMENT_H
#define CK_MEASUREMENT_H

#include "runner.h"
#include "truth.h"

typedef struct ck_Measurement {
    ck_RunStatus status;
    char reason[256];
    double cpu, time_step;             // s of the measured pass, s
    double values[CK_METRIC_CAPACITY]; // in the order of the metric table; NaN where one does not apply
} ck_Measurement;

// Runs, judges and measures. Errors: CK_NO_MEMORY, CK_IO.
//   reference  the truth's; keep  NULL, or where the run goes, for the caller to free with ck_run_free
ck_Status ck_measurement_take(ck_Measurement *measurement, const ck_Model *model, const ck_Reference *reference,
                              const ck_Engine *engine, const ck_Settings *wanted, const ck_Limits *limits, ck_Run *keep,
                              ck_Error *error);

#endif
