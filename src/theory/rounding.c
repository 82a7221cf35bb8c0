#include "rounding.h"

#include "vector.h"

#include <math.h>

double ck_rounding_step(const ck_Model *model, bool is_single) {
    double field[3], farthest = 0;
    ck_model_mean_field(model, field);
    for (int i = 0; i < 3 * model->particle_count; i++) farthest = fmax(farthest, fabs(model->position[i]));
    // of a power of two and all that is below the next
    const double spacing = farthest > 0 ? ldexp(is_single ? 0x1p-23 : 0x1p-52, ilogb(farthest)) : 0;
    return ck_length(field) > 0 ? sqrt(spacing / ck_length(field)) : NAN;
}

double ck_rounding_share(const ck_Model *model, double dt, bool is_single) {
    const double share = ck_rounding_step(model, is_single) / dt;
    return share * share;
}
