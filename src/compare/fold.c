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

// In memory that a child shares.
typedef struct Search {
    const ck_Run *run;
    const ck_Truth *truth;
    ck_Fold *fold;
} Search;

static void find(void *context) {
    const Search *search = context;
    const ck_Model *model = search->run->model;
    const double *end = ck_trajectory_position(&search->run->trajectory, model->frame_count);
    const double *right = ck_trajectory_position(&search->truth->reference.trajectory, 0);
    ck_Equilibrium own = {0};
    if (!ck_equilibrium_solve(&own, model, end, NULL))
        *search->fold = (ck_Fold){rms_distance(model, end, own.position), rms_distance(model, own.position, right),
                                  own.energy - ck_equilibrium_energy(model, right)};
    ck_equilibrium_free(&own);
}

ck_Status ck_fold_find(ck_Fold *fold, const ck_Run *run, const ck_Truth *truth, const ck_Limits *limits,
                       ck_Error *error) {
    ck_ChildResult child;
    *fold = (ck_Fold){NAN, NAN, NAN};
    if (!has_rest(run, truth)) return CK_OK;
    ck_Fold *found = ck_shared_allocate(sizeof *found);
    if (!found) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    *found = *fold;
    // what is not found within the limits is not known
    ck_Status status = ck_child_run(&child, find, &(Search){run, truth, found}, limits, error);
    if (!status && child.end == CK_CHILD_DONE) *fold = *found;
    ck_shared_free(found, sizeof *found);
    return status;
}

bool ck_fold_is_another(const ck_Fold *fold, const ck_Truth *truth, const ck_Model *model) {
    double known = ck_truth_uncertainty(truth, model, ck_metric_find("position_rms"));
    return fold->apart > 10 * known && fold->apart > 1e-6 && fold->apart > 3 * fold->own;
}
