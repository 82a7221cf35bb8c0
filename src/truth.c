#include "truth.h"

#include "truth_forms.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

// Adding a truth is one function in truth_forms.h and one row here.
static const ck_TruthForm forms[] = {
	{"vertical_chain", "closed form", "u_j = [m*g*(j*N - j*(j-1)/2) + j*M*g]/k: sum of the weights below each spring", true, ck_truth_vertical_chain},
	{"catenary", "closed form", "discrete elastic catenary: l_i = L + |T_i|/k, T_i = T_0 - sum of the weights before, shot to the far pin", true, ck_truth_catenary},
	{"free_fall", "closed form", "x = x_0 + v_0*t + a*t^2/2", false, ck_truth_free_fall},
	{"oscillator", "closed form", "damped oscillator: u'' = -(k/m)*u - (c/m)*u'", false, ck_truth_oscillator},
};

int ck_truth_count(void) {
	return sizeof forms / sizeof *forms;
}

const ck_TruthForm *ck_truth_form_at(int index) {
	return &forms[index];
}

const ck_TruthForm *ck_truth_form_find(const char *name) {
	for (int i = 0; i < ck_truth_count(); i++)
		if (!strcmp(forms[i].name, name)) return &forms[i];
	return NULL;
}

static ck_Status fail_unknown(const ck_Model *model, ck_Error *error) {
	char known[300] = "";
	for (int i = 0; i < ck_truth_count(); i++)
		snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i ? ", " : "", forms[i].name);
	return ck_fail(error, CK_BAD_INPUT, "%s: there is no truth %s; known are %s", model->name, model->truth, known);
}

ck_Status ck_truth_create(ck_Truth *truth, const ck_Model *model, ck_Error *error) {
	*truth = (ck_Truth){0};
	if (!model->truth) return CK_OK;
	truth->form = ck_truth_form_find(model->truth);
	if (!truth->form) return fail_unknown(model, error);
	ck_Reference *reference = &truth->reference;
	reference->is_static = truth->form->is_static;
	truth->uncertainty = DBL_EPSILON;
	ck_Status status = ck_trajectory_create(&reference->trajectory, model, error);
	int frames = reference->is_static ? 1 : model->frame_count + 1;
	for (int frame = 0; frame < frames && !status; frame++) {
		status = truth->form->at(model, frame * model->step, ck_trajectory_position(&reference->trajectory, frame),
								 ck_trajectory_velocity(&reference->trajectory, frame), error);
		reference->trajectory.frame_count = frame + 1;
	}
	return status;
}

void ck_truth_free(ck_Truth *truth) {
	ck_trajectory_free(&truth->reference.trajectory);
	*truth = (ck_Truth){0};
}
