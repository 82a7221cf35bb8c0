// Closed forms of what bends. Those with a time have the signature of ck_TruthForm.at.
#ifndef CK_BENDING_FORMS_H
#define CK_BENDING_FORMS_H

#include "model.h"

// A rope that bends and hardly stretches, held by its first two particles, under its weight and that of its end. The
// clamp is in the middle of its first segment, and half of the last particle is a weight at the tip: so that a rope of
// N segments comes to it with 1/N².
ck_Status ck_truth_cantilever(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error);

// What it stretches, which the form leaves out: at most half of the weight over a spring's stiffness and
// length, the mean of a rope that hangs straight down.
double ck_truth_cantilever_off(const ck_Model *model);

// The droop of the tip / length of an elastica clamped level: wL³/EI = load. By shooting: to 1e-12 up to 1e4, 1e-9 up
// to 1e6.
double ck_truth_elastica_droop(double load);

#endif
