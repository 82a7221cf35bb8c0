#include "tune.h"

#include <math.h>

ck_Status ck_tune_check(const ck_Comparison *comparison, double tolerance, ck_Error *error) {
    const ck_Model *model = &comparison->model;
    const ck_TruthForm *form = model->truth ? ck_truth_form_find(model->truth) : NULL;
    if (isnan(tolerance) || !form || !form->is_static || model->collider_count) return CK_OK;
    if (!(model->terms & (CK_TERM_DRAG | CK_TERM_DAMPING)))
        return ck_fail(error, CK_BAD_INPUT,
                       "%s: without drag and spring damping the scene never comes to its rest, so that no engine comes "
                       "within %g of it; give it drag, or truth: trajectory",
                       comparison->path, tolerance);
    // a cloth swings across its springs, which only drag damps
    double needed = ck_settling_time(model);
    if (model->body != CK_CLOTH || !(needed > model->duration) || isinf(needed)) return CK_OK;
    return ck_fail(error, CK_BAD_INPUT,
                   "%s: drag of %g/s takes some %.3g s to bring the scene to rest, and it has %g s: no engine settles; "
                   "take time.duration of %.0f s, drag of %.2g/s, or truth: trajectory",
                   comparison->path, model->drag, needed, model->duration, ceil(needed),
                   model->drag * needed / model->duration);
}
