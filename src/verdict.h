// Judges a run that reached its end: blow-ups stay finite in some engines, and are then seen by energy and strain.
#ifndef CK_VERDICT_H
#define CK_VERDICT_H

#include "metric.h"
#include "runner.h"

// Replaces an ok status by unsettled, overstretched or energy_gain where the path says so, and gives the reason.
void ck_verdict(ck_Run *run, const ck_Reference *reference);

#endif
