// Where rounding beats a method: numbers have a spacing, and a short step moves a point by less.
#ifndef CK_ROUNDING_H
#define CK_ROUNDING_H

#include "model.h"

#include <stdbool.h>

// The spacing of numbers at a scene's farthest coordinate over the way that the field moves a point in a step, g·dt²:
// by that share a velocity read off two positions is wrong, and from ½ on the fall of a step is rounded away. NaN
// without a field.
double ck_rounding_share(const ck_Model *model, double dt, bool is_single);

// The step, s, at which that share is 1. NaN without a field.
double ck_rounding_step(const ck_Model *model, bool is_single);

#endif
