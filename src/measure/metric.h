// What is measured of a run. One table row a metric; the same functions measure engines, truths and predictions.
#ifndef CK_METRIC_H
#define CK_METRIC_H

#include "model.h"
#include "trajectory.h"

// A path to measure against: a sampled truth. A static one has a single frame, which stands for all times.
typedef struct ck_Reference {
    ck_Trajectory trajectory; // frame_count 0: there is none
    bool is_static;
    bool is_invariant;  // nothing is known of the shape, only what holds at rest whatever it is
    int horizon;        // the last frame up to which positions can be compared point by point; unused when static
    bool ends;          // at its horizon: of what follows nothing is known
    bool comes_to_rest; // it moves, but is at rest by its end
} ck_Reference;

// What a metric's truth is.
typedef enum ck_MetricTruth {
    CK_TRUTH_OF_STATE,   // the same metric of the truth's own states
    CK_TRUTH_ZERO,       // 0 whenever there is any truth
    CK_TRUTH_ZERO_STILL, // 0 where the truth is at rest, else none
    CK_TRUTH_ONE_STILL,  // 1 where the truth is at rest, else none
    CK_TRUTH_NONE,
    CK_TRUTH_OF_SERIES, // as of the state, but only over time: the metric is no result of a run
} ck_MetricTruth;

typedef struct ck_Metric {
    const char *name, *unit, *title;
    ck_MetricTruth truth;

    // Of one frame; NULL where it only makes sense for a whole run. NaN: does not apply here.
    double (*at)(const ck_Model *model, const ck_Trajectory *trajectory, int frame, const ck_Reference *reference);
    // Of a whole run, which is the largest of its frames. NULL: it is another.
    double (*peak)(const ck_Model *model, const ck_Trajectory *trajectory, int frame, const ck_Reference *reference);
    // Of a whole run. NULL: the largest of its frames, or else that of its last.
    double (*over)(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference);
    // How far two engines are apart. NULL: the difference of their values.
    double (*between)(const ck_Model *model, const ck_Trajectory *one, const ck_Trajectory *other);
    // How far off the value is that is read off a path's frames, in the metric's unit. NULL: by rounding only.
    double (*unsure)(const ck_Model *model, const ck_Trajectory *trajectory);
    bool to_horizon; // reads no frame beyond the truth's horizon
} ck_Metric;

// Room for as many metrics in all that holds a value of each.
#define CK_METRIC_CAPACITY 32

int ck_metric_count(void);
const ck_Metric *ck_metric_at(int index);

// NULL where there is no such metric.
const ck_Metric *ck_metric_find(const char *name);

// True where the scene measures it.
bool ck_metric_is_wanted(const ck_Metric *metric, const ck_Model *model);

// The metric of a run that wrote all its frames. NaN: does not apply here.
double ck_metric_value(const ck_Metric *metric, const ck_Model *model, const ck_Trajectory *trajectory,
                       const ck_Reference *reference);

// The metric's truth. NaN: none.
double ck_metric_truth(const ck_Metric *metric, const ck_Model *model, const ck_Reference *reference);

// Engine minus other, or the distance of their paths; NaN where either has no value.
double ck_metric_deviation(const ck_Metric *metric, const ck_Model *model, const ck_Trajectory *one,
                           const ck_Trajectory *other, const ck_Reference *reference);

// The speed, in m/s, below which a body counts as settled: 0.1 % of √(field·size), or of its start speed without
// field; at least a billionth of its size per second, below which there is only rounding.
double ck_metric_still_speed(const ck_Model *model);

// True for a path that is below that speed for its last twentieth.
bool ck_metric_comes_to_rest(const ck_Model *model, const ck_Trajectory *trajectory);

// The smallest gap of rigid bodies to cloth, colliders and one another at a frame, m; INFINITY without any, or without
// memory.
double ck_metric_rigid_gap(const ck_Model *model, const ck_Trajectory *trajectory, int frame);

#endif
