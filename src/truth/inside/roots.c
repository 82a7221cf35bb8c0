#include "roots.h"

#include "equilibrium.h"
#include "path.h"
#include "process.h"
#include "rest_forms.h"
#include "runge_kutta.h"
#include "springs.h"
#include "time_scale.h"
#include "vector.h"
#include "wind.h"

#include <math.h>
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
        status = ck_truth_need(!ck_wind_blows(model), model, error, "still air: wind has no energy to be least");
    if (!status)
        status = ck_truth_need(model->pin_count > 0, model, error, "pins: without them the body falls for ever");
    return status ? status
                  : ck_truth_need(ck_stability_load(model) > 0, model, error, "gravity or a force on what is free");
}

ck_Status ck_truth_trajectory_check(const ck_Model *model, ck_Error *error) {
    const bool is_rigid = model->terms & CK_TERM_RIGID;
    ck_Status status = ck_truth_need(!is_rigid || ck_springs_start_at_rest(model), model, error,
                                     "bars that start at their lengths: how others snap to them is not known");
    for (int i = 0; i < model->rigid_count && !status; i++)
        status = ck_truth_need(!(ck_length(model->rigid[i].spin) > 0), model, error,
                               "rigid bodies that do not spin: its integrator turns nothing");
    return status ? status
                  : ck_truth_need(!is_rigid || !model->collider_count, model, error,
                                  "springs, or no colliders: its integrator has no rigid bars in contact");
}

ck_Status ck_truth_converged_check(const ck_Model *model, ck_Error *error) {
    ck_Status status =
        ck_truth_need(model->collider_count > 0, model, error, "colliders; without them take trajectory");
    return status ? status : ck_truth_trajectory_check(model, error);
}

ck_Status ck_truth_rest_check(const ck_Model *model, ck_Error *error) {
    return ck_truth_need(!ck_model_ends_moving(model), model, error,
                         "pins and colliders that stay before the end: else nothing comes to rest");
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

// Of a frame, of the reference integrator that follows a release; 0 without memory.
static double release_substeps(const ck_Model *model) {
    double frequency;
    if (ck_stability_frequency(model, &frequency)) return 0;
    // damping narrows the stable range of 2.83/ω
    return ceil(model->step * (frequency + ck_stability_damping_rate(model) + model->drag));
}

// How many substeps of a frame, and springs and particles in all, may be evaluated to follow a release: some minute.
#define MOST_SUBSTEPS 1e5
#define MOST_RELEASE 1.2e10

// The reference knows no rigid bodies, and dampers can make its steps too short.
static bool has_release(const ck_Model *model) {
    const double substeps = release_substeps(model), evaluated = model->spring_count + model->particle_count;
    return !model->rigid_count && substeps <= MOST_SUBSTEPS &&
           4 * substeps * model->frame_count * evaluated <= MOST_RELEASE;
}

const char *ck_truth_equilibrium_leaves_open(const ck_Model *model) {
    return has_release(model) ? NULL : "which the scene may not reach in time";
}

// Where the reference integrator stands when the scene ends: what is left of the motion by then is no engine's error,
// and a scene that cannot be told from rest no better than that has that uncertainty.
static ck_Status integrate_release(ck_Trajectory *release, const ck_Model *model, ck_Error *error) {
    const int substeps = (int)release_substeps(model);
    return substeps > 0 ? ck_reference_follow(release, model, substeps, error)
                        : ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
}

// The release as it is, then nudged; and at last its motion.
typedef struct Starts {
    const ck_Model *model;
    ck_Equilibrium found[STARTS];
    ck_Status status[STARTS];
    ck_Error why[STARTS];
    ck_Trajectory release;
} Starts;

static ck_Status solve_start(void *context, int index, ck_Error *error) {
    Starts *starts = context;
    const ck_Model *model = starts->model;
    // the longest first
    if (index == 0) return has_release(model) ? integrate_release(&starts->release, model, error) : CK_OK;
    int seed = index - 1;
    starts->status[seed] = ck_equilibrium_release(&starts->found[seed], model, seed ? NUDGE * model->spacing : 0,
                                                  (uint64_t)seed, &starts->why[seed]);
    return starts->status[seed] == CK_NO_MEMORY ? ck_fail(error, CK_NO_MEMORY, "%s", starts->why[seed].message) : CK_OK;
}

// Those that end on a saddle are left out: they are no rest position.
ck_Status ck_truth_solve_equilibrium(ck_Truth *truth, const ck_Model *model, ck_Error *error) {
    Starts starts = {.model = model};
    ck_Status status = ck_parallel(STARTS + 1, 0, solve_start, &starts, error);
    for (int seed = 0; seed < STARTS && !status; seed++) {
        if (!starts.status[seed])
            status = add_position(truth, model, starts.found[seed].position, error);
        else if (error)
            *error = starts.why[seed];
    }
    bool is_none = !status && !truth->path_count;
    if (!status && !is_none && starts.release.frame_count > model->frame_count)
        status = add_position(truth, model, ck_trajectory_position(&starts.release, model->frame_count), error);
    for (int seed = 0; seed < STARTS; seed++) ck_equilibrium_free(&starts.found[seed]);
    ck_trajectory_free(&starts.release);
    return is_none ? CK_REFUSED : status;
}

typedef struct Ensemble {
    const ck_Model *model;
    ck_Trajectory *paths;
    int substeps;
} Ensemble;

static ck_Status draw_path(void *context, int index, ck_Error *error) {
    const Ensemble *ensemble = context;
    return ck_reference_integrate(&ensemble->paths[index], ensemble->model, ensemble->substeps,
                                  CK_REFERENCE_NUDGE * ensemble->model->size, (uint64_t)index + 1, error);
}

// To the integrator a rigid body is its centre: so it is right for as long as it touches nothing.
static ck_Status check_untouched(const ck_Model *model, const ck_Trajectory *path, ck_Error *error) {
    for (int frame = 0; frame < path->frame_count && model->rigid_count; frame++)
        if (ck_metric_rigid_gap(model, path, frame) < 0)
            return ck_fail(error, CK_REFUSED,
                           "%s: a rigid body touches something by %g s, which the reference integrator does not know",
                           model->name, frame * model->step);
    return CK_OK;
}

// A first path, and at half its step it and a nudged one side by side. In contact a part of it may do.
double ck_truth_trajectory_work(const ck_Model *model) {
    return (model->collider_count ? 1 : 3) * ck_reference_work(model);
}

ck_Status ck_truth_solve_trajectory(ck_Truth *truth, const ck_Model *model, ck_Error *error) {
    ck_ReferencePath path;
    ck_Status status = ck_reference_path_create(&path, model, error);
    if (!status) status = check_untouched(model, &path.fine, error);
    if (status) {
        ck_reference_path_free(&path);
        return status;
    }
    truth->paths[0] = path.fine;
    truth->paths[1] = path.coarse;
    truth->path_count = 2;
    truth->reference.horizon = path.horizon;
    // beyond the horizon two paths say little of how far any two are apart: more are drawn, all as good
    if (path.horizon >= model->frame_count) return CK_OK;
    Ensemble ensemble = {model, truth->paths + 2, path.substeps / 2};
    truth->path_count = CK_TRUTH_MAX_PATHS;
    return ck_parallel(CK_TRUTH_MAX_PATHS - 2, 0, draw_path, &ensemble, error);
}
