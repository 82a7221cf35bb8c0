#include "roots.h"

#include "equilibrium.h"
#include "rest_forms.h"
#include "runge_kutta.h"
#include "time_scale.h"

#include <string.h>

// Starts are nudged by up to this share of the spacing: enough to leave a saddle, too little to choose a basin by
// itself.
#define NUDGE 1e-3
#define STARTS 4

ck_Status ck_truth_equilibrium_check(const ck_Model *model, ck_Error *error) {
    ck_Status status = ck_truth_need(!(model->terms & CK_TERM_RIGID), model, error,
                                     "springs that stretch: rigid bars have no energy to be least; for them there are "
                                     "vertical_chain, catenary and rest");
    if (!status)
        status = ck_truth_need(model->pin_count > 0, model, error, "pins: without them the body falls for ever");
    return status ? status
                  : ck_truth_need(ck_stability_load(model) > 0, model, error, "gravity or a force on what is free");
}

ck_Status ck_truth_trajectory_check(const ck_Model *model, ck_Error *error) {
    return ck_truth_need(!(model->terms & CK_TERM_RIGID), model, error,
                         "springs: its integrator has no rigid bars; for them there are pendulum and free_fall");
}

// Adds a path of a single frame at rest.
static ck_Status add_position(ck_Truth *truth, const ck_Model *model, const double *position, ck_Error *error) {
    ck_Trajectory *path = &truth->paths[truth->path_count++];
    ck_Model still = *model;
    still.frame_count = 0;
    ck_Status status = ck_trajectory_create(path, &still, error);
    if (!status) memcpy(path->data, position, 3 * sizeof(double) * (size_t)model->particle_count);
    path->frame_count = 1;
    return status;
}

// Where the reference integrator stands when the scene ends: what is left of the motion by then is no engine's error,
// and a scene that cannot be told from rest no better than that has that uncertainty.
static ck_Status add_end_of_release(ck_Truth *truth, const ck_Model *model, ck_Error *error) {
    double frequency;
    ck_Trajectory release = {0};
    ck_Status status = ck_stability_frequency(model, &frequency);
    // damping narrows the stable range of 2.78/ω
    double limit = 1 / (frequency + frequency * frequency * ck_stability_damping_time(model) + model->drag);
    if (!status)
        status = ck_reference_integrate(&release, model, (int)ck_stability_substeps(model, limit), 0, 0, error);
    if (!status && release.frame_count > model->frame_count)
        status = add_position(truth, model, ck_trajectory_position(&release, model->frame_count), error);
    ck_trajectory_free(&release);
    return status;
}

// The release as it is, then nudged. Those that end on a saddle are left out: they are no rest position.
ck_Status ck_truth_solve_equilibrium(ck_Truth *truth, const ck_Model *model, ck_Error *error) {
    ck_Status status = CK_OK, found = CK_OK;
    for (uint64_t seed = 0; seed < STARTS && !status; seed++) {
        ck_Equilibrium equilibrium;
        found = ck_equilibrium_release(&equilibrium, model, seed ? NUDGE * model->spacing : 0, seed, error);
        if (!found) status = add_position(truth, model, equilibrium.position, error);
        if (found == CK_NO_MEMORY) status = found;
        ck_equilibrium_free(&equilibrium);
    }
    if (!status && !truth->path_count) return CK_REFUSED;
    return status ? status : add_end_of_release(truth, model, error);
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
    // beyond the horizon two paths say little of how far any two are apart: more are drawn, all as good
    for (uint64_t seed = 1; path.horizon < model->frame_count && truth->path_count < CK_TRUTH_MAX_PATHS && !status;
         seed++)
        status = ck_reference_integrate(&truth->paths[truth->path_count++], model, path.substeps / 2,
                                        CK_REFERENCE_NUDGE * model->size, seed, error);
    return status;
}
