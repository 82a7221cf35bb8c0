#include "hinges.h"
#include "path.h"
#include "springs.h"

#include "vector.h"

#include <string.h>

// Without what springs hold, which is most of the work.
static ck_Energy without_springs(const ck_Model *model, const ck_Trajectory *trajectory, int frame) {
    const double *position = ck_trajectory_position(trajectory, frame),
                 *velocity = ck_trajectory_velocity(trajectory, frame);
    ck_Energy energy = {0};
    for (int i = 0; i < model->particle_count; i++) {
        double field[3];
        // a pin neither moves nor falls, until it is let go
        ck_model_field(model, i, field);
        energy.kinetic += 0.5 * model->mass[i] * ck_dot(velocity + 3 * i, velocity + 3 * i);
        energy.field -= model->mass[i] * (ck_dot(field, position + 3 * i) - ck_dot(field, model->position + 3 * i));
    }
    const ck_Turn *turn = ck_trajectory_turn(trajectory, frame);
    for (int i = 0; i < model->rigid_count; i++) {
        const ck_RigidBody *rigid = &model->rigid[i];
        const ck_Collider now = ck_rigid_place(rigid, position + 3 * rigid->particle, turn[i].rotation);
        double momentum[3];
        ck_rigid_momentum(momentum, rigid, &now, turn[i].spin);
        energy.kinetic += 0.5 * ck_dot(momentum, turn[i].spin);
    }
    return energy;
}

ck_Energy ck_energy_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame) {
    const double *position = ck_trajectory_position(trajectory, frame);
    ck_Energy energy = without_springs(model, trajectory, frame);
    energy.elastic = ck_springs_energy(model, position) + ck_hinges_energy(model, position);
    return energy;
}

double ck_energy_total(const ck_Energy *energy) {
    return energy->kinetic + energy->elastic + energy->field;
}

double ck_energy_scale(const ck_Model *model, const ck_Trajectory *trajectory) {
    double field[3], mass = ck_model_free_mass(model), drop = 0;
    ck_Energy start = ck_energy_at(model, trajectory, 0);
    double scale = fmax(1e-12 * mass * model->size * model->size, ck_energy_total(&start));
    bool starts_still = true;
    for (int i = 0; i < 3 * model->particle_count; i++) starts_still &= model->velocity[i] == 0;
    ck_model_mean_field(model, field);
    if (starts_still) scale = fmax(scale, ck_length(field) * mass * model->size);
    for (int frame = 1; frame < trajectory->frame_count; frame++)
        drop = fmax(drop, -without_springs(model, trajectory, frame).field);
    return fmax(scale, drop);
}

// How much faster than what drives it a whole body may get, at its resonance or thrown to and fro; and how much higher.
#define DRIVEN 30

// What air, pins and colliders give is what they give; but no body gets many times their speed and height.
static double driven_scale(const ck_Model *model) {
    double speed = ck_length(model->wind.velocity), height = speed * model->duration, mass = 0, field[3];
    for (int i = 0; i < model->path_count; i++)
        for (int frame = 0; frame <= model->frame_count; frame++)
            for (int side = -1; side < 2; side += 2) {
                double moved[3], velocity[3], acceleration[3];
                ck_path_at(&model->paths[i], frame * model->step, side, moved, velocity, acceleration);
                speed = fmax(speed, ck_length(velocity));
                height = fmax(height, ck_length(moved));
            }
    for (int i = 0; i < model->particle_count; i++) mass += model->mass[i];
    ck_model_mean_field(model, field);
    return mass * (0.5 * DRIVEN * DRIVEN * speed * speed + DRIVEN * ck_length(field) * height);
}

double ck_energy_motion_gain(const ck_Model *model, const ck_Trajectory *trajectory) {
    // a scene that changes has what it is changed to
    if (model->segment_count) return 0;
    const double driven = ck_model_is_worked_on(model) ? driven_scale(model) : 0;
    bool is_snapping = (model->terms & CK_TERM_RIGID) && !ck_springs_start_at_rest(model);
    int first = is_snapping ? (trajectory->frame_count + 9) / 10 : 1;
    ck_Energy start = ck_energy_at(model, trajectory, 0);
    double total = ck_energy_total(&start), gained = 0;
    for (int frame = 1; frame < trajectory->frame_count; frame++) {
        ck_Energy energy = without_springs(model, trajectory, frame);
        double motion = energy.kinetic + energy.field;
        if (frame < first)
            total = fmax(total, motion);
        else
            gained = fmax(gained, motion - total);
    }
    return gained / (driven + fmax(ck_energy_scale(model, trajectory), is_snapping ? total : 0));
}

// What drag and springs take at a frame, W. A pin that is not let go has no speed.
static double damping_power(const ck_Model *model, const ck_Trajectory *trajectory, int frame) {
    const double *velocity = ck_trajectory_velocity(trajectory, frame);
    double power = model->terms & CK_TERM_DAMPING
                       ? ck_springs_damping_power(model, ck_trajectory_position(trajectory, frame), velocity)
                       : 0;
    for (int i = 0; i < model->particle_count && model->drag > 0; i++)
        power += model->drag * model->mass[i] * ck_dot(velocity + 3 * i, velocity + 3 * i);
    return power;
}

// True where a start velocity pulls at a rigid bar: making the bar keep its length takes energy at once.
static bool starts_with_a_jerk(const ck_Model *model) {
    bool jerks = false;
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        double d[3], v[3];
        if (isfinite(spring->stiffness)) continue;
        ck_subtract(d, model->position + 3 * spring->b, model->position + 3 * spring->a);
        ck_subtract(v, model->velocity + 3 * spring->b, model->velocity + 3 * spring->a);
        jerks |= fabs(ck_dot(d, v)) > 1e-9 * ck_length(d) * ck_length(v);
    }
    return jerks;
}

static bool loses_otherwise(const ck_Model *model) {
    bool loses = (model->terms & CK_TERM_RIGID) && (!ck_springs_start_at_rest(model) || starts_with_a_jerk(model));
    loses |= model->wind.face_count > 0;
    for (int i = 0; i < model->collider_count; i++)
        loses |= model->colliders[i].restitution < 1 || model->colliders[i].friction > 0;
    for (int i = 0; i < model->rigid_count; i++)
        loses |= model->rigid[i].shape.restitution < 1 || model->rigid[i].shape.friction > 0;
    return loses;
}

double ck_energy_drift(const ck_Model *model, const ck_Trajectory *trajectory) {
    if (ck_model_is_worked_on(model)) return NAN;
    ck_Energy start = ck_energy_at(model, trajectory, 0);
    double total = ck_energy_total(&start), taken = 0, taken_coarsely = 0, unsure = 0, drift = 0;
    double before = damping_power(model, trajectory, 0), even = before;
    bool loses = loses_otherwise(model);
    for (int frame = 1; frame < trajectory->frame_count; frame++) {
        ck_Energy energy = ck_energy_at(model, trajectory, frame);
        double power = damping_power(model, trajectory, frame);
        taken += 0.5 * trajectory->step * (before + power);
        before = power;
        if (frame % 2 == 0) {
            taken_coarsely += trajectory->step * (even + power);
            even = power;
            unsure = fmax(unsure, fabs(taken - taken_coarsely));
        }
        double balance = ck_energy_total(&energy) + taken - total;
        drift = fmax(drift, (loses ? balance : fabs(balance)) - unsure);
    }
    return drift / ck_energy_scale(model, trajectory);
}
