#include "force_metric.h"

#include "hinges.h"
#include "springs.h"
#include "vector.h"
#include "wind.h"

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

// By the springs and hinges that end at pins that stay, N.
static bool pull_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame, double *force) {
    const double *position = ck_trajectory_position(trajectory, frame),
                 *velocity = ck_trajectory_velocity(trajectory, frame);
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        const bool a = ck_model_is_held(model, spring->a), b = ck_model_is_held(model, spring->b);
        if (a && !b) add_pull(spring, position, velocity, 1, force);
        if (b && !a) add_pull(spring, position, velocity, -1, force);
    }
    return add_hinges(model, position, force);
}

// True where no pin holds a particle in the frame that ends here: pins are let go between frames.
static bool is_free_before(const ck_Model *model, int particle, int frame) {
    return !model->pinned[particle] || ck_model_release_time(model, particle) < (frame - 0.5) * model->step;
}

// Adds a share of the force of air on what is free, N; false without memory.
static bool add_wind(const ck_Model *model, const ck_Trajectory *trajectory, int frame, int until, double share,
                     double *force) {
    if (!model->wind.face_count) return true;
    double *all = calloc(3 * (size_t)model->particle_count, sizeof *all);
    if (!all) return false;
    ck_wind_add_force(model, ck_trajectory_position(trajectory, frame), ck_trajectory_velocity(trajectory, frame), NULL,
                      all);
    for (int i = 0; i < model->particle_count; i++)
        if (is_free_before(model, i, until)) ck_add_scaled(force, share, all + 3 * i);
    free(all);
    return true;
}

// By what is free, N: of all that drove it over the last frame, the part that is not in its momentum. Air by the mean
// of both ends, of second order in the frame; the rest is exact of any solver whose forces within the body cancel.
static bool balance_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame, double *force) {
    const double *now = ck_trajectory_position(trajectory, frame),
                 *before = ck_trajectory_position(trajectory, frame - 1),
                 *v_now = ck_trajectory_velocity(trajectory, frame),
                 *v_before = ck_trajectory_velocity(trajectory, frame - 1);
    if (model->collider_count && !trajectory->contact) return false;
    for (int i = 0; i < model->particle_count; i++) {
        if (!is_free_before(model, i, frame)) continue;
        double field[3];
        ck_model_field(model, i, field);
        for (int axis = 0; axis < 3; axis++) {
            const int at = 3 * i + axis;
            force[axis] +=
                model->mass[i] *
                (field[axis] - (v_now[at] - v_before[at] + model->drag * (now[at] - before[at])) / trajectory->step);
        }
    }
    if (model->collider_count) ck_add_scaled(force, 1, trajectory->contact + 3 * frame);
    return add_wind(model, trajectory, frame, frame, 0.5, force) &&
           add_wind(model, trajectory, frame - 1, frame, 0.5, force);
}

double ck_metric_pin_force_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                              const ck_Reference *reference) {
    (void)reference;
    double field[3], force[3] = {0};
    bool holds = false;
    ck_model_mean_field(model, field);
    const double weight = ck_model_free_mass(model) * ck_length(field);
    for (int i = 0; i < model->particle_count; i++) holds |= ck_model_is_held(model, i);
    if (!holds || !(weight > 0) || (frame == 0 && (model->terms & CK_TERM_RIGID))) return NAN;
    const bool is_told =
        frame == 0 ? pull_at(model, trajectory, frame, force) : balance_at(model, trajectory, frame, force);
    return is_told ? ck_length(force) / weight : NAN;
}
