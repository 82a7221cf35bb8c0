// Closed forms of rest and of falling. Those with a time have the signature of ck_TruthForm.at.
#ifndef CK_REST_FORMS_H
#define CK_REST_FORMS_H

#include "model.h"

// A rope hanging from its first particle, at rest along gravity.
ck_Status ck_truth_vertical_chain(const ck_Model *model, double time, double *position, double *velocity,
                                  ck_Error *error);

// A rope pinned at both ends, at rest.
ck_Status ck_truth_catenary(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error);

// How far coordinates leave it off, / size.
double ck_truth_catenary_off(const ck_Model *model);

// Any body without pins, drag and colliders, whose springs start at rest.
ck_Status ck_truth_free_fall(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error);

// What the forms ask of a model: fails with "NAME: truth TRUTH needs WANTED" unless met.
ck_Status ck_truth_need(bool met, const ck_Model *model, ck_Error *error, const char *wanted);

#endif
