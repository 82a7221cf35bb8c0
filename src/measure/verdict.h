// Judges a run that reached its end: blow-ups stay finite in some engines, and are then seen by energy and strain.
#ifndef CK_VERDICT_H
#define CK_VERDICT_H

#include "metric.h"
#include "runner.h"

// Replaces an ok status by unsettled, overstretched or energy_gain where the path says so, and gives the reason.
void ck_verdict(ck_Run *run, const ck_Reference *reference);

// The measured pass and its verdict. An engine whose own rule chose a step that blows up steps finer, by halves, at
// most three times, and the reason says so. Arguments and errors are those of ck_run_measure.
ck_Status ck_verdict_run(ck_Run *run, const ck_Model *model, const ck_Reference *reference, const ck_Engine *engine,
                         const ck_Settings *wanted, const ck_Limits *limits, ck_Error *error);

#endif
