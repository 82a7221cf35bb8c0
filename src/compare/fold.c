#include "fold.h"

#include "equilibrium.h"
#include "vector.h"

// Newton from a rest takes a second or so for so many particles.
#define MOST_PARTICLES 5000

static double rms_distance(const ck_Model *model, const double *one, const double *other) {
    double sum = 0;
    for (int i = 0; i < 3 * model->particle_count; i++) sum += (one[i] - other[i]) * (one[i] - other[i]);
    return sqrt(sum / model->particle_count) / model->size;
}

static bool has_rest(const ck_Run *run, const ck_Truth *truth) {
    const unsigned foreign = CK_TERM_RIGID | CK_TERM_COLLIDERS | CK_TERM_RELEASE | CK_TERM_MOVES;
    const ck_Model *model = run->model;
    return run->status == CK_RUN_OK && ck_run_has_all_frames(run) && run->engine->method != CK_METHOD_STILL &&
           truth->path_count && truth->reference.is_static && !(model->terms & foreign) &&
           model->particle_count <= MOST_PARTICLES;
}

ck_Status ck_fold_find(ck_Fold *fold, const ck_Run *run, const ck_Truth *truth, ck_Error *error) {
    *fold = (ck_Fold){NAN, NAN, NAN};
    if (!has_rest(run, truth)) return CK_OK;
    const ck_Model *model = run->model;
    const double *end = ck_trajectory_position(&run->trajectory, model->frame_count);
    const double *right = ck_trajectory_position(&truth->reference.trajectory, 0);
    ck_Equilibrium own = {0};
    ck_Error why = {0};
    ck_Status status = ck_equilibrium_solve(&own, model, end, &why);
    if (!status)
        *fold = (ck_Fold){rms_distance(model, end, own.position), rms_distance(model, own.position, right),
                          own.energy - ck_equilibrium_energy(model, right)};
    ck_equilibrium_free(&own);
    return status == CK_NO_MEMORY ? ck_fail(error, status, "%s", why.message) : CK_OK;
}

bool ck_fold_is_another(const ck_Fold *fold, const ck_Truth *truth, const ck_Model *model) {
    double known = ck_truth_uncertainty(truth, model, ck_metric_find("position_rms"));
    return fold->apart > 10 * known && fold->apart > 1e-6 && fold->apart > 3 * fold->own;
}
