#include "metric.h"

#include "metric_contact.h"
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

// Drop of the lowest particle below the highest pin, or without pins below the highest start; / size.
static double sag_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame, const ck_Reference *reference) {
    (void)reference;
    double down[3], top = INFINITY, bottom = -INFINITY;
    if (!fall_direction(model, down)) return NAN;
    const double *position = ck_trajectory_position(trajectory, frame);
    for (int i = 0; i < model->particle_count; i++) {
        if (model->pinned[i] || !model->pin_count) top = fmin(top, ck_dot(model->position + 3 * i, down));
        bottom = fmax(bottom, ck_dot(position + 3 * i, down));
    }
    return (bottom - top) / model->size;
}

static double strain(const ck_Spring *spring, const double *position) {
    return ck_distance(position + 3 * spring->a, position + 3 * spring->b) / spring->rest - 1;
}

static double stretch_max_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                             const ck_Reference *reference) {
    (void)reference;
    double largest = -INFINITY;
    for (int i = 0; i < model->spring_count; i++)
        largest = fmax(largest, strain(&model->springs[i], ck_trajectory_position(trajectory, frame)));
    return model->spring_count ? largest : NAN;
}

static double stretch_rms_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                             const ck_Reference *reference) {
    (void)reference;
    double sum = 0;
    for (int i = 0; i < model->spring_count; i++) {
        double value = strain(&model->springs[i], ck_trajectory_position(trajectory, frame));
        sum += value * value;
    }
    return model->spring_count ? sqrt(sum / model->spring_count) : NAN;
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

typedef struct Energy {
    double kinetic, elastic, field; // J
} Energy;

static Energy energy_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame) {
    const double *position = ck_trajectory_position(trajectory, frame),
                 *velocity = ck_trajectory_velocity(trajectory, frame);
    Energy energy = {0};
    for (int i = 0; i < model->particle_count; i++) {
        double field[3];
        // a pin neither moves nor falls, until it is let go
        ck_model_field(model, i, field);
        energy.kinetic += 0.5 * model->mass[i] * ck_dot(velocity + 3 * i, velocity + 3 * i);
        energy.field -= model->mass[i] * (ck_dot(field, position + 3 * i) - ck_dot(field, model->position + 3 * i));
    }
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        double stretch = spring->rest * strain(spring, position);
        if (isfinite(spring->stiffness)) energy.elastic += 0.5 * spring->stiffness * stretch * stretch;
    }
    return energy;
}

// Energy gained over the start, / the largest drop of potential or the energy there was at the start.
static double energy_drift_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
    (void)reference;
    Energy start = energy_at(model, trajectory, 0);
    double total = start.kinetic + start.elastic, gained = 0, drop = 0;
    for (int frame = 1; frame < trajectory->frame_count; frame++) {
        Energy energy = energy_at(model, trajectory, frame);
        gained = fmax(gained, energy.kinetic + energy.elastic + energy.field - total);
        drop = fmax(drop, -energy.field);
    }
    // below the energy of a millionth of its size per second there is only rounding
    double rounding = 1e-12 * ck_model_free_mass(model) * model->size * model->size;
    double scale = fmax(rounding, fmax(drop, total));
    return scale > 0 ? gained / scale : NAN;
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

// rms acceleration over the last tenth of the run, / that of the field. By differences of velocity, frame to frame.
static double jitter_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
    (void)reference;
    double field[3], sum = 0;
    ck_model_mean_field(model, field);
    int last = last_frame(trajectory), first = last - (last + 9) / 10;
    if (!(ck_length(field) > 0) || !model->pin_count) return NAN;
    for (int frame = first; frame < last; frame++)
        sum += mean_square(model, ck_trajectory_velocity(trajectory, frame + 1),
                           ck_trajectory_velocity(trajectory, frame));
    return sqrt(sum / (last - first)) / trajectory->step / ck_length(field);
}

// Where the body swings: its centre of mass along the start velocity, or without one along its level offset from the
// pins.
static bool swing_direction(const ck_Model *model, double *direction, double *origin) {
    double center[3] = {0}, pins[3] = {0}, down[3], mass = ck_model_free_mass(model);
    memset(direction, 0, 3 * sizeof(double));
    for (int i = 0; i < model->particle_count; i++) {
        if (!model->pinned[i]) ck_add_scaled(center, model->mass[i] / mass, model->position + 3 * i);
        if (!model->pinned[i]) ck_add_scaled(direction, model->mass[i] / mass, model->velocity + 3 * i);
        if (model->pinned[i]) ck_add_scaled(pins, 1.0 / model->pin_count, model->position + 3 * i);
    }
    memcpy(origin, center, sizeof center);
    if (!(ck_length(direction) > 0) && fall_direction(model, down)) {
        ck_subtract(direction, center, pins);
        ck_add_scaled(direction, -ck_dot(direction, down), down);
        memcpy(origin, pins, sizeof pins);
    }
    return model->pin_count && ck_length(direction) > 1e-9 * model->size;
}

// Where the cubic through two frames' values and rates crosses 0, as a share of the step. Its error is of fourth order.
static double crossing(double from, double to, double from_rate, double to_rate) {
    double low = 0, high = 1;
    for (int i = 0; i < 60; i++) {
        double t = 0.5 * (low + high), s = 1 - t;
        double value =
            s * s * (1 + 2 * t) * from + t * t * (3 - 2 * t) * to + s * s * t * from_rate - t * t * s * to_rate;
        if ((value > 0) == (from > 0))
            low = t;
        else
            high = t;
    }
    return 0.5 * (low + high);
}

// Twice the mean time between the centre of mass's passes through rest; none with fewer than three of them.
static double period_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
    (void)reference;
    double direction[3], origin[3], before = 0, rate_before = 0, first = 0, last = 0, mass = ck_model_free_mass(model);
    int passes = 0;
    if (!swing_direction(model, direction, origin)) return NAN;
    for (int frame = 0; frame < trajectory->frame_count; frame++) {
        double now = -ck_dot(origin, direction), rate = 0;
        for (int i = 0; i < model->particle_count; i++) {
            if (model->pinned[i]) continue;
            now += model->mass[i] / mass * ck_dot(ck_trajectory_position(trajectory, frame) + 3 * i, direction);
            rate += model->mass[i] / mass * ck_dot(ck_trajectory_velocity(trajectory, frame) + 3 * i, direction) *
                    trajectory->step;
        }
        // a start at rest's place is no pass: it would be found by rounding only
        if (frame > 1 && (now > 0) != (before > 0)) {
            last = (frame - 1 + crossing(before, now, rate_before, rate)) * trajectory->step;
            if (!passes++) first = last;
        }
        before = now;
        rate_before = rate;
    }
    return passes > 2 ? 2 * (last - first) / (passes - 1) : NAN;
}

// rms difference of a frame's value to that of a moving truth, over the whole run: points may have parted long before.
static double path_rms(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference,
                       double (*value)(const ck_Model *model, const ck_Trajectory *trajectory, int frame)) {
    double sum = 0;
    if (reference->is_static || reference->trajectory.frame_count < trajectory->frame_count) return NAN;
    for (int frame = 0; frame < trajectory->frame_count; frame++) {
        double off = value(model, trajectory, frame) - value(model, &reference->trajectory, frame);
        sum += off * off;
    }
    return sqrt(sum / trajectory->frame_count);
}

static double sag_of(const ck_Model *model, const ck_Trajectory *trajectory, int frame) {
    return sag_at(model, trajectory, frame, NULL);
}

static double sag_path_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
    return path_rms(model, trajectory, reference, sag_of);
}

static double energy_of(const ck_Model *model, const ck_Trajectory *trajectory, int frame) {
    Energy energy = energy_at(model, trajectory, frame);
    return energy.kinetic + energy.elastic + energy.field;
}

static double mechanical_energy_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                                   const ck_Reference *reference) {
    (void)reference;
    return energy_of(model, trajectory, frame);
}

// In units of the energy that the truth turns over: its largest drop of potential, or what it has at the start.
static double energy_path_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
    double off = path_rms(model, trajectory, reference, energy_of);
    Energy start = energy_at(model, trajectory, 0);
    double scale = start.kinetic + start.elastic;
    for (int frame = 0; frame < reference->trajectory.frame_count && !isnan(off); frame++)
        scale = fmax(scale, -energy_at(model, &reference->trajectory, frame).field);
    return scale > 0 ? off / scale : NAN;
}

static const ck_Metric metrics[] = {
    {"sag", "1", "Largest drop below the highest pin / size", CK_TRUTH_OF_STATE, .at = sag_at},
    {"stretch_max", "1", "Largest spring strain", CK_TRUTH_OF_STATE, .at = stretch_max_at},
    {"stretch_rms", "1", "Root mean square spring strain", CK_TRUTH_OF_STATE, .at = stretch_rms_at},
    {"position_rms", "1", "Root mean square distance to the truth / size", CK_TRUTH_ZERO, position_rms_at,
     position_rms_over, position_rms_between},
    {"energy_drift", "1", "Gained energy / largest potential drop or start energy", CK_TRUTH_ZERO,
     .over = energy_drift_over},
    {"settle_time", "s", "Time after which the body stays still", CK_TRUTH_NONE, .over = settle_time_over},
    {"sag_path", "1", "Root mean square difference of sag(t) to the truth's, whole run", CK_TRUTH_ZERO,
     .over = sag_path_over},
    {"energy_path", "1", "Root mean square difference of energy(t) to the truth's / what it turns over", CK_TRUTH_ZERO,
     .over = energy_path_over},
    {"period", "s", "Time of one swing of the centre of mass", CK_TRUTH_OF_STATE, .over = period_over},
    {"jitter", "1", "Root mean square acceleration at the end / that of the field", CK_TRUTH_ZERO_STILL,
     .over = jitter_over},
    {"penetration_max", "1", "Deepest a particle was inside a collider / spacing", CK_TRUTH_ZERO,
     .at = ck_metric_penetration_at, .over = ck_metric_penetration_over},
    {"rest_height", "1", "Smallest gap between a particle and a collider / spacing", CK_TRUTH_OF_STATE,
     .at = ck_metric_height_at},
    {"restitution", "1", "Speed after / before the first bounce off a plane", CK_TRUTH_OF_STATE,
     .over = ck_metric_restitution_over},
    {"friction", "1", "Coefficient that explains the way slid along a plane", CK_TRUTH_OF_STATE,
     .over = ck_metric_friction_over},
    {"tunnelled", "1", "Share of particles that have passed through a ball", CK_TRUTH_ZERO,
     .over = ck_metric_tunnelled_over},
    {"wrap_friction", "1", "Coefficient that explains how a rope slides over a ball", CK_TRUTH_OF_STATE,
     .over = ck_metric_wrap_friction_over},
    {"contact_force", "1", "Force of the colliders at the end / weight", CK_TRUTH_ONE_STILL,
     .over = ck_metric_contact_force_over},
    {"energy", "J", "Mechanical energy, of gravity and force counted from the start; over time only",
     CK_TRUTH_OF_SERIES, .at = mechanical_energy_at},
};

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
    return metric->at(model, trajectory, last_frame(trajectory), reference);
}

double ck_metric_truth(const ck_Metric *metric, const ck_Model *model, const ck_Reference *reference) {
    if (metric->truth == CK_TRUTH_ONE_STILL) return reference->is_static ? 1 : NAN;
    if (metric->truth == CK_TRUTH_NONE || metric->truth == CK_TRUTH_OF_SERIES) return NAN;
    if (!reference->trajectory.frame_count && (!reference->is_invariant || metric->truth == CK_TRUTH_OF_STATE))
        return NAN;
    if (metric->truth == CK_TRUTH_OF_STATE && reference->is_static && !metric->at) return NAN;
    if (metric->truth == CK_TRUTH_OF_STATE) return ck_metric_value(metric, model, &reference->trajectory, reference);
    return metric->truth == CK_TRUTH_ZERO || reference->is_static ? 0 : NAN;
}

double ck_metric_deviation(const ck_Metric *metric, const ck_Model *model, const ck_Trajectory *one,
                           const ck_Trajectory *other, const ck_Reference *reference) {
    if (metric->between) return metric->between(model, one, other);
    return ck_metric_value(metric, model, one, reference) - ck_metric_value(metric, model, other, reference);
}
