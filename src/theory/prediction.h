// What a method's own theory says an engine should show, computed without the engine: a deviation that it explains is a
// known artefact of the method, one that it does not is wrong physics or a bug.
#ifndef CK_PREDICTION_H
#define CK_PREDICTION_H

#include "engine.h"
#include "metric.h"
#include "process.h"
#include "truth.h"

// Samples the predicted path of an engine at the model's frames. Without a theory for this method and truth, the
// prediction stays empty (frame_count 0), which is not an error.
//   used    the settings that the engine ran with
//   limits  it is sampled in a child that keeps them, or stays empty; NULL: here, without any
// Errors: CK_NO_MEMORY. Free with ck_trajectory_free in any case.
ck_Status ck_prediction_create(ck_Reference *prediction, const ck_Model *model, const ck_Engine *engine,
                               const ck_Settings *used, const ck_Truth *truth, const ck_Limits *limits,
                               ck_Error *error);

// The longest stable step that theory gives a method about a rest.

// A small motion about a rest.
typedef struct ck_Vibration {
    double frequency; // rad/s
    double damping;   // 1/s, by springs and drag
} ck_Vibration;

// The longest stable step of a method about a rest, s; NaN: it has none, or none is known. It is the least that the
// fastest motion and that across springs ask for: strong damping along springs, taken implicitly, lengthens the one and
// does not reach the other.
double ck_stability_limit(ck_Method method, ck_Vibration fastest, ck_Vibration across);

#endif
