#include "springs.h"

#include "vector.h"

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
        if (isfinite(spring->stiffness)) energy += 0.5 * spring->stiffness * stretch * stretch;
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
        if (squared > 0) power += spring->damping * along * along / squared;
    }
    return power;
}

bool ck_springs_start_at_rest(const ck_Model *model) {
    for (int i = 0; i < model->spring_count; i++)
        if (!(fabs(ck_spring_strain(&model->springs[i], model->position)) <= 1e-12)) return false;
    return true;
}
