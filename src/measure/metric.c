#include "metric.h"

#include "contact_metric.h"
#include "force_metric.h"
#include "path.h"
#include "springs.h"
#include "swing_metric.h"
#include "vector.h"

#include <string.h>

static int last_frame(const ck_Trajectory *trajectory) {
    return trajectory->frame_count - 1;
}

static const double *reference_position(const ck_Reference *reference, int frame) {
    return ck_trajectory_position(&reference->trajectory, reference->is_static ? 0 : frame);
}

// The direction of fall, a unit vector. False without gravity and force.
static bool fall_direction(const ck_Model *model, double *down) {
    ck_model_mean_field(model, down);
    double length = ck_length(down);
    if (!(length > 0)) return false;
    for (int axis = 0; axis < 3; axis++) down[axis] /= length;
    return true;
}

// Drop of the lowest particle that is free at some time below the highest pin, or without pins below the highest start;
// / size.
static double sag_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame, const ck_Reference *reference) {
    (void)reference;
    double down[3], top = INFINITY, bottom = -INFINITY;
    if (!fall_direction(model, down)) return NAN;
    const double *position = ck_trajectory_position(trajectory, frame);
    for (int i = 0; i < ck_model_cloth_count(model); i++) {
        if (model->pinned[i] || !model->pin_count) top = fmin(top, ck_dot(model->position + 3 * i, down));
        if (!ck_model_is_held(model, i)) bottom = fmax(bottom, ck_dot(position + 3 * i, down));
    }
    return isfinite(bottom) ? (bottom - top) / model->size : NAN;
}

// How far the first rigid body's centre has fallen below its start / size.
static double body_drop_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                           const ck_Reference *reference) {
    (void)reference;
    double down[3], way[3];
    if (!model->rigid_count || !fall_direction(model, down)) return NAN;
    const int particle = model->rigid[0].particle;
    ck_subtract(way, ck_trajectory_position(trajectory, frame) + 3 * particle, model->position + 3 * particle);
    return ck_dot(way, down) / model->size;
}

static double stretch_max_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                             const ck_Reference *reference) {
    (void)reference;
    return ck_springs_largest_strain(model, ck_trajectory_position(trajectory, frame));
}

static double stretch_rms_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                             const ck_Reference *reference) {
    (void)reference;
    return ck_springs_rms_strain(model, ck_trajectory_position(trajectory, frame));
}

// mean square distance of two sets of positions, m²
static double mean_square(const ck_Model *model, const double *one, const double *other) {
    double sum = 0;
    for (int i = 0; i < 3 * model->particle_count; i++) sum += (one[i] - other[i]) * (one[i] - other[i]);
    return sum / model->particle_count;
}

static double position_rms_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                              const ck_Reference *reference) {
    if (!reference->trajectory.frame_count) return NAN;
    return sqrt(mean_square(model, ck_trajectory_position(trajectory, frame), reference_position(reference, frame))) /
           model->size;
}

// Against a truth at rest the last frame counts, against a moving one every frame up to its horizon.
static double position_rms_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
    if (reference->is_static || !reference->trajectory.frame_count)
        return position_rms_at(model, trajectory, last_frame(trajectory), reference);
    double sum = 0;
    for (int frame = 0; frame <= reference->horizon; frame++)
        sum += mean_square(model, ck_trajectory_position(trajectory, frame), reference_position(reference, frame));
    return sqrt(sum / (reference->horizon + 1)) / model->size;
}

static double position_rms_between(const ck_Model *model, const ck_Trajectory *one, const ck_Trajectory *other) {
    double sum = 0;
    for (int frame = 0; frame < one->frame_count; frame++)
        sum += mean_square(model, ck_trajectory_position(one, frame), ck_trajectory_position(other, frame));
    return sqrt(sum / one->frame_count) / model->size;
}

static double energy_drift_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
    (void)reference;
    return ck_energy_drift(model, trajectory);
}

// Of a body that nothing else works on.
static double motion_gain_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
    (void)reference;
    return ck_model_is_worked_on(model) || model->segment_count ? NAN : ck_energy_motion_gain(model, trajectory);
}

// True where nothing from outside acts: momentum stays.
static bool is_isolated(const ck_Model *model) {
    return !model->pin_count && !model->collider_count && !(model->drag > 0) && !(model->terms & CK_TERM_FORCE) &&
           !(model->terms & CK_TERM_GRAVITY);
}

// Momentum of a frame and, about a point, its angular momentum; and the sums of their particles' lengths.
typedef struct Momentum {
    double linear[3], angular[3], linear_scale, angular_scale;
} Momentum;

static Momentum momentum_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame, const double *about) {
    Momentum sum = {0};
    for (int i = 0; i < model->particle_count; i++) {
        const double *x = ck_trajectory_position(trajectory, frame) + 3 * i,
                     *v = ck_trajectory_velocity(trajectory, frame) + 3 * i;
        double from[3], turn[3];
        ck_subtract(from, x, about);
        ck_cross(turn, from, v);
        ck_add_scaled(sum.linear, model->mass[i], v);
        ck_add_scaled(sum.angular, model->mass[i], turn);
        sum.linear_scale += model->mass[i] * ck_length(v);
        sum.angular_scale += model->mass[i] * ck_length(turn);
    }
    const ck_Turn *turns = ck_trajectory_turn(trajectory, frame);
    for (int i = 0; i < model->rigid_count; i++) {
        const ck_RigidBody *rigid = &model->rigid[i];
        const ck_Collider now =
            ck_rigid_place(rigid, ck_trajectory_position(trajectory, frame) + 3 * rigid->particle, turns[i].rotation);
        double own[3];
        ck_rigid_momentum(own, rigid, &now, turns[i].spin);
        ck_add_scaled(sum.angular, 1, own);
        sum.angular_scale += ck_length(own);
    }
    return sum;
}

// The largest change of momentum, / the largest sum of its particles'.
static double momentum_change(const ck_Model *model, const ck_Trajectory *trajectory, bool is_angular) {
    if (!is_isolated(model)) return NAN;
    const double *about = ck_trajectory_position(trajectory, 0);
    const Momentum start = momentum_at(model, trajectory, 0, about);
    double change = 0, scale = 0;
    for (int frame = 0; frame < trajectory->frame_count; frame++) {
        const Momentum now = momentum_at(model, trajectory, frame, about);
        change =
            fmax(change, is_angular ? ck_distance(now.angular, start.angular) : ck_distance(now.linear, start.linear));
        scale = fmax(scale, is_angular ? now.angular_scale : now.linear_scale);
    }
    return scale > 0 ? change / scale : NAN;
}

static double momentum_drift_over(const ck_Model *model, const ck_Trajectory *trajectory,
                                  const ck_Reference *reference) {
    (void)reference;
    return momentum_change(model, trajectory, false);
}

static double angular_momentum_drift_over(const ck_Model *model, const ck_Trajectory *trajectory,
                                          const ck_Reference *reference) {
    (void)reference;
    return momentum_change(model, trajectory, true);
}

static double speed_rms(const ck_Model *model, const ck_Trajectory *trajectory, int frame) {
    const double *velocity = ck_trajectory_velocity(trajectory, frame);
    double sum = 0;
    for (int i = 0; i < 3 * model->particle_count; i++) sum += velocity[i] * velocity[i];
    return sqrt(sum / model->particle_count);
}

double ck_metric_still_speed(const ck_Model *model) {
    double down[3] = {0}, start = 0;
    ck_model_mean_field(model, down);
    for (int i = 0; i < model->particle_count; i++) start = fmax(start, ck_length(model->velocity + 3 * i));
    return fmax(1e-9 * model->size, 1e-3 * fmax(sqrt(ck_length(down) * model->size), start));
}

// The first time after which the rms speed stays below ck_metric_still_speed; none if that is not for the last
// twentieth of the run: at a turning point a body is still for a frame.
static double settle_time_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
    (void)reference;
    double still = ck_metric_still_speed(model);
    int frame = last_frame(trajectory);
    if (!(speed_rms(model, trajectory, frame) < still)) return NAN;
    // a body that starts at rest has not settled before it moved
    while (frame > 0 && speed_rms(model, trajectory, frame - 1) < still) frame--;
    return last_frame(trajectory) - frame >= (last_frame(trajectory) + 19) / 20 ? frame * trajectory->step : NAN;
}

bool ck_metric_comes_to_rest(const ck_Model *model, const ck_Trajectory *trajectory) {
    return !isnan(settle_time_over(model, trajectory, NULL));
}

// How far the body moves over the last frames from first on, rms over particles / size.
static double motion_since(const ck_Model *model, const ck_Trajectory *trajectory, int first) {
    double largest = 0;
    for (int frame = first; frame < trajectory->frame_count; frame++)
        largest = fmax(largest, mean_square(model, ck_trajectory_position(trajectory, frame),
                                            ck_trajectory_position(trajectory, last_frame(trajectory))));
    return sqrt(largest) / model->size;
}

// rms acceleration over the last tenth of the run, / that of the field. By differences of velocity, frame to frame. Of
// a body that goes somewhere, by more than a hundredth of its size, it would be the acceleration of its path.
static double jitter_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
    (void)reference;
    double field[3], sum = 0;
    ck_model_mean_field(model, field);
    int last = last_frame(trajectory), first = last - (last + 9) / 10;
    if (!(ck_length(field) > 0) || !model->pin_count || motion_since(model, trajectory, first) > 0.01) return NAN;
    for (int frame = first; frame < last; frame++)
        sum += mean_square(model, ck_trajectory_velocity(trajectory, frame + 1),
                           ck_trajectory_velocity(trajectory, frame));
    return sqrt(sum / (last - first)) / trajectory->step / ck_length(field);
}

// rms difference of a frame's value to that of a moving truth, over the whole run: points may have parted long before.
static double path_rms(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference,
                       double (*value)(const ck_Model *model, const ck_Trajectory *trajectory, int frame)) {
    double sum = 0;
    if (reference->is_static || reference->trajectory.frame_count < trajectory->frame_count) return NAN;
    int frames = reference->ends ? reference->horizon + 1 : trajectory->frame_count;
    for (int frame = 0; frame < frames; frame++) {
        double off = value(model, trajectory, frame) - value(model, &reference->trajectory, frame);
        sum += off * off;
    }
    return sqrt(sum / frames);
}

static double sag_of(const ck_Model *model, const ck_Trajectory *trajectory, int frame) {
    return sag_at(model, trajectory, frame, NULL);
}

static double sag_path_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
    return path_rms(model, trajectory, reference, sag_of);
}

static double energy_of(const ck_Model *model, const ck_Trajectory *trajectory, int frame) {
    ck_Energy energy = ck_energy_at(model, trajectory, frame);
    return ck_energy_total(&energy);
}

static double mechanical_energy_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                                   const ck_Reference *reference) {
    (void)reference;
    return energy_of(model, trajectory, frame);
}

// In units of the energy that the truth turns over.
static double energy_path_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
    double off = path_rms(model, trajectory, reference, energy_of);
    return isnan(off) ? NAN : off / ck_energy_scale(model, &reference->trajectory);
}

static const ck_Metric metrics[] = {
    {"sag", "1", "Largest drop of a free particle below the highest pin at the end / size", CK_TRUTH_OF_STATE,
     .at = sag_at},
    {"stretch_max", "1", "Largest spring strain at the end", CK_TRUTH_OF_STATE, .at = stretch_max_at},
    {"stretch_rms", "1", "Root mean square spring strain at the end", CK_TRUTH_OF_STATE, .at = stretch_rms_at},
    {"stretch_peak", "1", "Largest spring strain of the whole run", CK_TRUTH_OF_STATE, .peak = stretch_max_at},
    {"sag_peak", "1", "Largest drop of a free particle of the whole run / size", CK_TRUTH_OF_STATE, .peak = sag_at},
    {"tension_peak", "N", "Largest pull of a spring of the whole run, by the scene's stiffness", CK_TRUTH_OF_STATE,
     .peak = ck_metric_tension_at},
    {"body_drop", "1", "How far the first rigid body's centre is below its start at the end / size", CK_TRUTH_OF_STATE,
     .at = body_drop_at},
    {"body_drop_peak", "1", "The same of the whole run: the largest", CK_TRUTH_OF_STATE, .peak = body_drop_at},
    {"pin_force", "1", "Mean force on the pins over the last frame, by momentum / weight", CK_TRUTH_OF_STATE,
     .at = ck_metric_pin_force_at},
    {"pin_force_peak", "1", "Largest of a frame's mean force on the pins of the whole run / weight", CK_TRUTH_OF_STATE,
     .peak = ck_metric_pin_force_at},
    {"position_rms", "1", "Root mean square distance to the truth / size", CK_TRUTH_ZERO, .at = position_rms_at,
     .over = position_rms_over, .between = position_rms_between, .to_horizon = true},
    {"energy_drift", "1", "Energy gained, or lost beyond the scene's own damping / what it turns over", CK_TRUTH_ZERO,
     .over = energy_drift_over},
    {"motion_gain", "1", "Energy of motion and height beyond all that there was / what it turns over", CK_TRUTH_ZERO,
     .over = motion_gain_over},
    {"momentum_drift", "1", "Largest change of momentum, of a body that nothing acts on / its particles'",
     CK_TRUTH_ZERO, .over = momentum_drift_over},
    {"angular_momentum_drift", "1",
     "Largest change of angular momentum, of a body that nothing acts on / its particles'", CK_TRUTH_ZERO,
     .over = angular_momentum_drift_over},
    {"settle_time", "s", "Time after which the body stays still", CK_TRUTH_NONE, .over = settle_time_over},
    {"sag_path", "1", "Root mean square difference of sag(t) to the truth's, whole run", CK_TRUTH_ZERO,
     .over = sag_path_over},
    {"energy_path", "1", "Root mean square difference of energy(t) to the truth's / what it turns over", CK_TRUTH_ZERO,
     .over = energy_path_over},
    {"period", "s", "Time of one swing of the centre of mass", CK_TRUTH_OF_STATE, .over = ck_metric_period_over,
     .unsure = ck_metric_period_unsure},
    {"jitter", "1", "Root mean square acceleration at the end / that of the field", CK_TRUTH_ZERO_STILL,
     .over = jitter_over},
    {"penetration_max", "1", "Deepest a particle was inside a collider / spacing", CK_TRUTH_ZERO,
     .at = ck_metric_penetration_at, .peak = ck_metric_penetration_at},
    {"penetration_time", "s", "Time for which a particle is deeper in a collider than a hundredth of the spacing",
     CK_TRUTH_ZERO, .over = ck_metric_penetration_time_over},
    {"contact_share", "1", "Share of free particles on a collider at the end, to a hundredth of the spacing",
     CK_TRUTH_OF_STATE, .at = ck_metric_contact_share_at},
    {"rest_height", "1", "Smallest gap between a particle and a collider / spacing", CK_TRUTH_OF_STATE,
     .at = ck_metric_height_at},
    {"restitution", "1", "Speed after / before the first bounce off a plane", CK_TRUTH_OF_STATE,
     .over = ck_metric_restitution_over},
    {"friction", "1", "Coefficient that explains the way slid along a plane", CK_TRUTH_OF_STATE,
     .over = ck_metric_friction_over},
    {"tunnelled", "1", "Share of particles that have passed through a ball or another solid", CK_TRUTH_ZERO,
     .over = ck_metric_tunnelled_over},
    {"wrap_friction", "1", "Coefficient that explains how a rope slides over a ball", CK_TRUTH_OF_STATE,
     .over = ck_metric_wrap_friction_over},
    {"contact_force", "1", "Force of the colliders at the end / weight", CK_TRUTH_ONE_STILL,
     .over = ck_metric_contact_force_over},
    {"energy", "J", "Mechanical energy, of gravity and force counted from the start; over time only",
     CK_TRUTH_OF_SERIES, .at = mechanical_energy_at},
};

_Static_assert(sizeof metrics / sizeof *metrics <= CK_METRIC_CAPACITY, "raise CK_METRIC_CAPACITY");

int ck_metric_count(void) {
    return sizeof metrics / sizeof *metrics;
}

const ck_Metric *ck_metric_at(int index) {
    return &metrics[index];
}

const ck_Metric *ck_metric_find(const char *name) {
    for (int i = 0; i < ck_metric_count(); i++)
        if (!strcmp(metrics[i].name, name)) return &metrics[i];
    return NULL;
}

bool ck_metric_is_wanted(const ck_Metric *metric, const ck_Model *model) {
    for (int i = 0; i < model->measure_count; i++)
        if (!strcmp(model->measure[i], metric->name)) return true;
    return model->measure_count == 0;
}

double ck_metric_value(const ck_Metric *metric, const ck_Model *model, const ck_Trajectory *trajectory,
                       const ck_Reference *reference) {
    if (metric->truth == CK_TRUTH_OF_SERIES) return NAN;
    if (metric->over) return metric->over(model, trajectory, reference);
    if (!metric->peak) return metric->at(model, trajectory, last_frame(trajectory), reference);
    double largest = NAN;
    for (int frame = 0; frame < trajectory->frame_count; frame++)
        largest = fmax(largest, metric->peak(model, trajectory, frame, reference));
    return largest;
}

double ck_metric_truth(const ck_Metric *metric, const ck_Model *model, const ck_Reference *reference) {
    const bool is_still = reference->is_static || reference->comes_to_rest;
    if (metric->truth == CK_TRUTH_ONE_STILL) return is_still ? 1 : NAN;
    if (metric->truth == CK_TRUTH_NONE || metric->truth == CK_TRUTH_OF_SERIES) return NAN;
    if (!reference->trajectory.frame_count && (!reference->is_invariant || metric->truth == CK_TRUTH_OF_STATE))
        return NAN;
    if (metric->truth == CK_TRUTH_OF_STATE && reference->is_static && !metric->at) return NAN;
    if (metric->truth == CK_TRUTH_OF_STATE && reference->ends &&
        reference->horizon < last_frame(&reference->trajectory))
        return NAN;
    if (metric->truth == CK_TRUTH_OF_STATE) return ck_metric_value(metric, model, &reference->trajectory, reference);
    return metric->truth == CK_TRUTH_ZERO || is_still ? 0 : NAN;
}

double ck_metric_deviation(const ck_Metric *metric, const ck_Model *model, const ck_Trajectory *one,
                           const ck_Trajectory *other, const ck_Reference *reference) {
    if (metric->between) return metric->between(model, one, other);
    return ck_metric_value(metric, model, one, reference) - ck_metric_value(metric, model, other, reference);
}
