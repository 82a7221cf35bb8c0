#include "force_metric.h"

#include "hinges.h"
#include "springs.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

double ck_metric_tension_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                            const ck_Reference *reference) {
    (void)reference;
    double largest = NAN;
    if (model->terms & CK_TERM_RIGID) return NAN;
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        const double strain = ck_spring_strain(spring, ck_trajectory_position(trajectory, frame));
        largest = fmax(largest, fmax(0, spring->stiffness * spring->rest * strain));
    }
    return largest;
}

// Adds what a spring pulls its first end with, N.
static void add_pull(const ck_Spring *spring, const double *position, const double *velocity, double sign,
                     double *force) {
    double d[3], v[3];
    ck_subtract(d, position + 3 * spring->b, position + 3 * spring->a);
    ck_subtract(v, velocity + 3 * spring->b, velocity + 3 * spring->a);
    const double length = ck_length(d);
    if (!(length > 0) || (spring->pulls_only && length < spring->rest)) return;
    const double pull = spring->stiffness * (length - spring->rest) + spring->damping * ck_dot(v, d) / length;
    ck_add_scaled(force, sign * pull / length, d);
}

// The hinges' part of the force on pins; false without memory.
static bool add_hinges(const ck_Model *model, const double *position, double *force) {
    if (!model->hinge_count) return true;
    double *all = calloc(3 * (size_t)model->particle_count, sizeof *all);
    if (!all) return false;
    ck_hinges_add_force(model, position, 1, NULL, all);
    for (int i = 0; i < model->particle_count; i++)
        if (ck_model_is_held(model, i)) ck_add_scaled(force, 1, all + 3 * i);
    free(all);
    return true;
}

double ck_metric_pin_force_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                              const ck_Reference *reference) {
    (void)reference;
    const double *position = ck_trajectory_position(trajectory, frame),
                 *velocity = ck_trajectory_velocity(trajectory, frame);
    double field[3], force[3] = {0};
    bool holds = false;
    ck_model_mean_field(model, field);
    const double weight = ck_model_free_mass(model) * ck_length(field);
    if ((model->terms & CK_TERM_RIGID) || !(weight > 0)) return NAN;
    for (int i = 0; i < model->particle_count; i++) holds |= ck_model_is_held(model, i);
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        const bool a = ck_model_is_held(model, spring->a), b = ck_model_is_held(model, spring->b);
        if (a && !b) add_pull(spring, position, velocity, 1, force);
        if (b && !a) add_pull(spring, position, velocity, -1, force);
    }
    return holds && add_hinges(model, position, force) ? ck_length(force) / weight : NAN;
}
