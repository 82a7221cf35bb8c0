// The metric of swinging: how long the centre of mass takes from one pass through its rest to the next of its kind.
#ifndef CK_SWING_METRIC_H
#define CK_SWING_METRIC_H

#include "metric.h"

// The mean time from one pass to the next in the same direction, of the centre of mass along the direction in which it
// moves most, in s. Each pass is through the place that its extremes swing about, so that neither the start
// nor damping matters. Swings below a twentieth of the largest, or a millionth of the size, do not count; NaN
// where fewer than three passes do, or no pin holds the body. Positions alone are read, by polynomials through eight
// frames.
double ck_metric_period_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference);

// How far that reading may be off, in s: what six frames in place of eight change.
double ck_metric_period_unsure(const ck_Model *model, const ck_Trajectory *trajectory);

#endif
