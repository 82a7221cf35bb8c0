#include "shape.h"

#include "hinges.h"
#include "springs.h"
#include "vector.h"

#include <math.h>

bool ck_shape_is_chain(const ck_Model *model) {
    if (model->spring_count != model->particle_count - 1 || !model->spring_count || model->hinge_count) return false;
    for (int i = 0; i < model->spring_count; i++)
        if (model->springs[i].a != i || model->springs[i].b != i + 1) return false;
    return true;
}

bool ck_shape_is_even_chain(const ck_Model *model) {
    if (!ck_shape_is_chain(model)) return false;
    double first[3], other[3];
    ck_subtract(first, model->position + 3, model->position);
    for (int i = 1; i < model->spring_count; i++) {
        ck_subtract(other, model->position + 3 * i + 3, model->position + 3 * i);
        bool same = ck_distance(first, other) <= 1e-12 * model->size;
        if (!same || fabs(model->springs[i].rest - model->springs[0].rest) > 1e-12 * model->springs[0].rest)
            return false;
    }
    return true;
}

bool ck_shape_is_falling(const ck_Model *model) {
    bool falling = !model->wind.face_count && !model->pin_count && !(model->terms & (CK_TERM_COLLIDERS)) &&
                   ck_springs_start_at_rest(model);
    for (int i = 0; i < model->hinge_count; i++)
        falling &= fabs(ck_hinge_angle(&model->hinges[i], model->position) - model->hinges[i].rest) <= 1e-9;
    // springs have nothing to do only where all particles are pushed alike
    double first[3], field[3];
    ck_model_field(model, 0, first);
    for (int i = 1; i < model->particle_count && model->spring_count; i++) {
        ck_model_field(model, i, field);
        falling &= ck_distance(first, field) <= 1e-12 * ck_length(first);
    }
    return falling;
}
