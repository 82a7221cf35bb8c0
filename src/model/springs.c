#include "springs.h"

#include "hinges.h"
#include "vector.h"
#include "wind.h"

#include <string.h>

double ck_spring_strain(const ck_Spring *spring, const double *position) {
    return ck_distance(position + 3 * spring->a, position + 3 * spring->b) / spring->rest - 1;
}

double ck_springs_largest_strain(const ck_Model *model, const double *position) {
    double largest = model->spring_count ? -INFINITY : NAN;
    for (int i = 0; i < model->spring_count; i++)
        largest = fmax(largest, ck_spring_strain(&model->springs[i], position));
    return largest;
}

double ck_springs_rms_strain(const ck_Model *model, const double *position) {
    double sum = 0;
    for (int i = 0; i < model->spring_count; i++) {
        double strain = ck_spring_strain(&model->springs[i], position);
        sum += strain * strain;
    }
    return model->spring_count ? sqrt(sum / model->spring_count) : NAN;
}

double ck_springs_energy(const ck_Model *model, const double *position) {
    double energy = 0;
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        double stretch = spring->rest * ck_spring_strain(spring, position);
        if (isfinite(spring->stiffness) && !(spring->pulls_only && stretch < 0))
            energy += 0.5 * spring->stiffness * stretch * stretch;
    }
    return energy;
}

double ck_springs_damping_power(const ck_Model *model, const double *position, const double *velocity) {
    double power = 0;
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        double d[3], v[3];
        ck_subtract(d, position + 3 * spring->b, position + 3 * spring->a);
        ck_subtract(v, velocity + 3 * spring->b, velocity + 3 * spring->a);
        double squared = ck_dot(d, d), along = ck_dot(d, v);
        if (spring->pulls_only && squared < spring->rest * spring->rest) continue;
        if (squared > 0) power += spring->damping * along * along / squared;
    }
    return power;
}

bool ck_springs_start_at_rest(const ck_Model *model) {
    for (int i = 0; i < model->spring_count; i++)
        if (!(fabs(ck_spring_strain(&model->springs[i], model->position)) <= 1e-12)) return false;
    return true;
}

void ck_springs_accelerate(const ck_Model *model, const double *position, const double *velocity,
                           double *acceleration) {
    const bool hangs = model->terms & CK_TERM_PULL_ONLY;
    memset(acceleration, 0, 3 * sizeof(double) * (size_t)model->particle_count);
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        double d[3], v[3];
        ck_subtract(d, position + 3 * spring->b, position + 3 * spring->a);
        ck_subtract(v, velocity + 3 * spring->b, velocity + 3 * spring->a);
        double length = ck_length(d), inverse = 1 / length;
        if (hangs && spring->pulls_only && length < spring->rest) continue;
        double pull =
            (spring->stiffness * (length - spring->rest) + spring->damping * ck_dot(v, d) * inverse) * inverse;
        ck_add_scaled(acceleration + 3 * spring->a, pull, d);
        ck_add_scaled(acceleration + 3 * spring->b, -pull, d);
    }
    if (model->hinge_count) ck_hinges_add_force(model, position, 1, NULL, acceleration);
    if (model->wind.face_count) ck_wind_add_force(model, position, velocity, NULL, acceleration);
    for (int i = 0; i < model->particle_count; i++) {
        double field[3], inverse = 1 / model->mass[i];
        ck_model_field(model, i, field);
        for (int axis = 0; axis < 3; axis++) {
            double *a = acceleration + 3 * i + axis; // the force so far
            *a = model->pinned[i] ? 0 : *a * inverse + field[axis] - model->drag * velocity[3 * i + axis];
        }
    }
}
