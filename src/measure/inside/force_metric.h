// What springs and pins carry, by the scene's own stiffness. All have the signatures of ck_Metric; rigid bars tell no
// force, and have none of these.
#ifndef CK_FORCE_METRIC_H
#define CK_FORCE_METRIC_H

#include "metric.h"

// The largest pull of a spring, N.
double ck_metric_tension_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                            const ck_Reference *reference);

// The force on all pins at a frame, by the springs and hinges that end there, / weight of what is free at the start.
// At rest it is 1, unless a solver's springs are not the scene's. NaN without pins or field.
double ck_metric_pin_force_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                              const ck_Reference *reference);

#endif
