// What is measured of contact. All have the signatures of ck_Metric, and are NaN in a scene without colliders.
#ifndef CK_CONTACT_METRIC_H
#define CK_CONTACT_METRIC_H

#include "metric.h"

// How deep the deepest particle is inside a collider / spacing.
double ck_metric_penetration_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                                const ck_Reference *reference);

// For how long a particle is deeper than a hundredth of the spacing, s, by the frames at which one is.
double ck_metric_penetration_time_over(const ck_Model *model, const ck_Trajectory *trajectory,
                                       const ck_Reference *reference);

// The share of free particles that are no farther from a collider than a hundredth of the spacing.
double ck_metric_contact_share_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                                  const ck_Reference *reference);

// How high the lowest particle is above its nearest collider / spacing.
double ck_metric_height_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                           const ck_Reference *reference);

// √(energy after the first bounce off the first plane / energy at the start), both of the motion along its normal and
// above it: the ratio of speeds.
double ck_metric_restitution_over(const ck_Model *model, const ck_Trajectory *trajectory,
                                  const ck_Reference *reference);

// μ from the way that the centre of mass slides along the first plane between start and end speed:
// [(v_0² − v_1²)/(2·s) + g_t]/g_n.
double ck_metric_friction_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference);

// The share of particles that have passed through a ball: that came nearer to its centre than half its radius, on the
// straight line from frame to frame.
double ck_metric_tunnelled_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference);

// ln(T_2/T_1)/φ of a rope over a ball, from how far its first particle has come: both ends' weights m·(g ± a), φ the
// angle between its ends.
double ck_metric_wrap_friction_over(const ck_Model *model, const ck_Trajectory *trajectory,
                                    const ck_Reference *reference);

// The force of the colliders against the field over the last twentieth of the run / weight; NaN where pins carry some
// of it, and where the engine does not tell.
double ck_metric_contact_force_over(const ck_Model *model, const ck_Trajectory *trajectory,
                                    const ck_Reference *reference);

#endif
