#include "force_metric.h"

#include "hinges.h"
#include "springs.h"
#include "vector.h"
#include "wind.h"

#include <math.h>
#include <stdlib.h>

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
static bool add_hinges(const ck_Model *model, const double *position, const bool *is_free, double *force) {
    if (!model->hinge_count) return true;
    double *all = calloc(3 * (size_t)model->particle_count, sizeof *all);
    if (!all) return false;
    ck_hinges_add_force(model, position, 1, NULL, all);
    for (int i = 0; i < model->particle_count; i++)
        if (!is_free[i]) ck_add_scaled(force, 1, all + 3 * i);
    free(all);
    return true;
}

// By the springs and hinges that end at pins, N.
static bool pull_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame, const bool *is_free,
                    double *force) {
    const double *position = ck_trajectory_position(trajectory, frame),
                 *velocity = ck_trajectory_velocity(trajectory, frame);
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        if (is_free[spring->a] == is_free[spring->b]) continue;
        add_pull(spring, position, velocity, is_free[spring->b] ? 1 : -1, force);
    }
    return add_hinges(model, position, is_free, force);
}

// Adds a share of the force of air on what is free, N; false without memory.
static bool add_wind(const ck_Model *model, const ck_Trajectory *trajectory, int frame, const bool *is_free,
                     double share, double *force) {
    if (!model->wind.face_count) return true;
    double *all = calloc(3 * (size_t)model->particle_count, sizeof *all);
    if (!all) return false;
    ck_wind_add_force(model, ck_trajectory_position(trajectory, frame), ck_trajectory_velocity(trajectory, frame), NULL,
                      all);
    for (int i = 0; i < model->particle_count; i++)
        if (is_free[i]) ck_add_scaled(force, share, all + 3 * i);
    free(all);
    return true;
}

// By what is free, N: of all that drove it over the last frame, the part that is not in its momentum. Air by the mean
// of both ends, of second order in the frame; the rest is exact of any solver whose forces within the body cancel, and
// whose drag is the scene's. Of a rest, which is one state, nothing is in it.
static bool balance_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame, const bool *is_free,
                       double *force) {
    const int first = frame > 0 ? frame - 1 : 0;
    const double *now = ck_trajectory_position(trajectory, frame), *before = ck_trajectory_position(trajectory, first),
                 *v_now = ck_trajectory_velocity(trajectory, frame),
                 *v_before = ck_trajectory_velocity(trajectory, first);
    for (int i = 0; i < model->particle_count; i++) {
        if (!is_free[i]) continue;
        double field[3];
        ck_model_field(model, i, field);
        for (int axis = 0; axis < 3; axis++) {
            const int at = 3 * i + axis;
            const double taken = v_now[at] - v_before[at] + model->drag * (now[at] - before[at]);
            force[axis] += model->mass[i] * (field[axis] - taken / trajectory->step);
        }
    }
    if (model->collider_count) ck_add_scaled(force, 1, trajectory->contact + 3 * (size_t)frame);
    return add_wind(model, trajectory, frame, is_free, 0.5, force) &&
           add_wind(model, trajectory, first, is_free, 0.5, force);
}

// Those that no pin holds in the frame that ends here, [n]: pins are let go between frames. At the start those that
// none has; of a path of one state, a rest, those that none keeps. NULL without memory.
static bool *find_free(const ck_Model *model, const ck_Trajectory *trajectory, int frame) {
    bool *is_free = malloc((size_t)model->particle_count + 1);
    if (!is_free) return NULL;
    for (int i = 0; i < model->particle_count; i++) is_free[i] = !model->pinned[i];
    for (int i = 0; i < model->release_count; i++) {
        const ck_Release *release = &model->releases[i];
        for (int k = 0; k < release->particle_count; k++)
            if (release->frame < frame || trajectory->frame_count == 1) is_free[release->particles[k]] = true;
    }
    return is_free;
}

// What a scene changes into is not known here; nor is a collider's force where an engine tells none, as is seen after
// the first frame, or where frames come in parts, of which it tells the last.
static bool is_known(const ck_Model *model, const ck_Trajectory *trajectory, bool is_balanced) {
    if (!is_balanced && (model->terms & CK_TERM_RIGID)) return false;
    if (model->segment_count) return false;
    if (!model->collider_count || trajectory->frame_count == 1) return true;
    return trajectory->contact && !isnan(trajectory->contact[3]) && !(model->terms & CK_TERM_JITTER);
}

double ck_metric_pin_force_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                              const ck_Reference *reference) {
    const bool rests = reference->is_static && trajectory->frame_count == 1 && !model->collider_count,
               is_balanced = frame > 0 || rests;
    double field[3], force[3] = {0};
    bool holds = false;
    ck_model_mean_field(model, field);
    const double weight = ck_model_free_mass(model) * ck_length(field);
    for (int i = 0; i < model->particle_count; i++) holds |= ck_model_is_held(model, i);
    if (!holds || !(weight > 0) || !is_known(model, trajectory, is_balanced)) return NAN;
    bool *is_free = find_free(model, trajectory, frame);
    const bool is_told = is_free && (is_balanced ? balance_at(model, trajectory, frame, is_free, force)
                                                 : pull_at(model, trajectory, frame, is_free, force));
    free(is_free);
    return is_told ? ck_length(force) / weight : NAN;
}
