#include "truth_solve.h"

#include "equilibrium.h"
#include "reference.h"

#include <string.h>

// Starts are nudged by up to this share of the spacing: enough to leave a saddle, too little to choose a basin by itself.
#define NUDGE 1e-3

// The release as it is, then nudged. Those that end on a saddle are left out: they are no rest position.
ck_Status ck_truth_solve_equilibrium(ck_Truth *truth, const ck_Model *model, ck_Error *error) {
	ck_Status status = CK_OK;
	for (uint64_t seed = 0; seed < CK_TRUTH_MAX_PATHS && !status; seed++) {
		ck_Equilibrium equilibrium;
		// a single-frame path: the velocities of a new trajectory are 0
		ck_Model still = *model;
		still.frame_count = 0;
		ck_Status found = ck_equilibrium_release(&equilibrium, model, seed ? NUDGE * model->spacing : 0, seed, error);
		if (!found) {
			ck_Trajectory *path = &truth->paths[truth->path_count++];
			status = ck_trajectory_create(path, &still, error);
			if (!status) memcpy(path->data, equilibrium.position, 3 * sizeof(double) * (size_t)model->particle_count);
			path->frame_count = 1;
		}
		if (found == CK_NO_MEMORY) status = found;
		ck_equilibrium_free(&equilibrium);
	}
	if (!status && !truth->path_count) return CK_REFUSED;
	return status;
}

ck_Status ck_truth_solve_trajectory(ck_Truth *truth, const ck_Model *model, ck_Error *error) {
	ck_ReferencePath path;
	ck_Status status = ck_reference_path_create(&path, model, error);
	if (status) {
		ck_reference_path_free(&path);
		return status;
	}
	truth->paths[0] = path.fine;
	truth->paths[1] = path.coarse;
	truth->path_count = 2;
	truth->reference.horizon = path.horizon;
	return CK_OK;
}
