// What springs and pins carry. All have the signatures of ck_Metric.
#ifndef CK_FORCE_METRIC_H
#define CK_FORCE_METRIC_H

#include "metric.h"

// The largest pull of a spring by the scene's own stiffness, N; NaN of rigid bars.
double ck_metric_tension_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                            const ck_Reference *reference);

// The mean force on the pins over the frame that ends here, by the balance of momentum of all that is free then, /
// weight of what is free at the start. So it is the solver's own force, whether it has springs, bars or multipliers: 1
// of whatever rests, however far its springs are from their lengths, and of a truth at rest that no collider bears. At
// the start, and of a truth at rest that colliders bear, it is what springs and hinges pull with that end at pins;
// rigid bars tell nothing there. NaN without pins or field, where the force of colliders is not told for whole frames,
// and where the scene changes. Cost: one pass over particles.
double ck_metric_pin_force_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                              const ck_Reference *reference);

#endif
