// What a scene can be scored against without trusting any engine.
#ifndef CK_TRUTH_H
#define CK_TRUTH_H

#include "metric.h"
#include "model.h"
#include "status.h"

// One closed form: a table row each.
typedef struct ck_TruthForm {
	const char *name;   // as a scene names it
	const char *kind;   // "closed form", …
	const char *source; // the formula and where it is from
	bool is_static;

	// Writes the state at time s: [3*n] m, [3*n] m/s. A static form ignores time.
	// Errors: CK_BAD_INPUT where the model is not what the formula is for; the message says what it needs.
	ck_Status (*at)(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error);
} ck_TruthForm;

typedef struct ck_Truth {
	const ck_TruthForm *form; // NULL: the scene has none
	ck_Reference reference;
	double uncertainty; // relative to a metric's value: of a closed form, rounding
} ck_Truth;

int ck_truth_count(void);
const ck_TruthForm *ck_truth_form_at(int index);

// NULL where there is no such form.
const ck_TruthForm *ck_truth_form_find(const char *name);

// The truth that the model names, sampled at its frames.
// Errors: CK_BAD_INPUT for an unknown name or a model that the form is not for, CK_NO_MEMORY. Free in any case.
ck_Status ck_truth_create(ck_Truth *truth, const ck_Model *model, ck_Error *error);

// Accepts a zeroed truth.
void ck_truth_free(ck_Truth *truth);

#endif
