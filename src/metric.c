#include "metric.h"

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
	ck_model_field(model, 0, down);
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

static double stretch_max_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame, const ck_Reference *reference) {
	(void)reference;
	double largest = -INFINITY;
	for (int i = 0; i < model->spring_count; i++) largest = fmax(largest, strain(&model->springs[i], ck_trajectory_position(trajectory, frame)));
	return model->spring_count ? largest : NAN;
}

static double stretch_rms_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame, const ck_Reference *reference) {
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

static double position_rms_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame, const ck_Reference *reference) {
	if (!reference->trajectory.frame_count) return NAN;
	return sqrt(mean_square(model, ck_trajectory_position(trajectory, frame), reference_position(reference, frame))) / model->size;
}

// Against a truth at rest the last frame counts, against a moving one every frame.
static double position_rms_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
	if (reference->is_static || !reference->trajectory.frame_count) return position_rms_at(model, trajectory, last_frame(trajectory), reference);
	double sum = 0;
	for (int frame = 0; frame < trajectory->frame_count; frame++)
		sum += mean_square(model, ck_trajectory_position(trajectory, frame), reference_position(reference, frame));
	return sqrt(sum / trajectory->frame_count) / model->size;
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
	const double *position = ck_trajectory_position(trajectory, frame), *velocity = ck_trajectory_velocity(trajectory, frame);
	Energy energy = {0};
	for (int i = 0; i < model->particle_count; i++) {
		double field[3];
		if (model->pinned[i]) continue;
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
	double scale = fmax(drop, total);
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
	ck_model_field(model, 0, down);
	for (int i = 0; i < model->particle_count; i++) start = fmax(start, ck_length(model->velocity + 3 * i));
	return 1e-3 * fmax(sqrt(ck_length(down) * model->size), start);
}

// The first time after which the rms speed stays below ck_metric_still_speed; none if it does not.
static double settle_time_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
	(void)reference;
	double still = ck_metric_still_speed(model);
	int frame = last_frame(trajectory);
	if (!(speed_rms(model, trajectory, frame) < still)) return NAN;
	// a body that starts at rest has not settled before it moved
	while (frame > 0 && speed_rms(model, trajectory, frame - 1) < still) frame--;
	return frame * trajectory->step;
}

// rms acceleration over the last tenth of the run, / that of the field. By differences of velocity, frame to frame.
static double jitter_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
	(void)reference;
	double field[3], sum = 0;
	ck_model_field(model, 0, field);
	int last = last_frame(trajectory), first = last - (last + 9) / 10;
	if (!(ck_length(field) > 0) || !model->pin_count) return NAN;
	for (int frame = first; frame < last; frame++)
		sum += mean_square(model, ck_trajectory_velocity(trajectory, frame + 1), ck_trajectory_velocity(trajectory, frame));
	return sqrt(sum / (last - first)) / trajectory->step / ck_length(field);
}

static const ck_Metric metrics[] = {
	{"sag", "1", "Largest drop below the highest pin / size", CK_TRUTH_OF_STATE, .at = sag_at},
	{"stretch_max", "1", "Largest spring strain", CK_TRUTH_OF_STATE, .at = stretch_max_at},
	{"stretch_rms", "1", "Root mean square spring strain", CK_TRUTH_OF_STATE, .at = stretch_rms_at},
	{"position_rms", "1", "Root mean square distance to the truth / size", CK_TRUTH_ZERO, position_rms_at, position_rms_over, position_rms_between},
	{"energy_drift", "1", "Gained energy / largest potential drop", CK_TRUTH_ZERO, .over = energy_drift_over},
	{"settle_time", "s", "Time after which the body stays still", CK_TRUTH_NONE, .over = settle_time_over},
	{"jitter", "1", "Root mean square acceleration at the end / g", CK_TRUTH_ZERO_STILL, .over = jitter_over},
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

double ck_metric_value(const ck_Metric *metric, const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
	if (metric->over) return metric->over(model, trajectory, reference);
	return metric->at(model, trajectory, last_frame(trajectory), reference);
}

double ck_metric_truth(const ck_Metric *metric, const ck_Model *model, const ck_Reference *reference) {
	if (!reference->trajectory.frame_count || metric->truth == CK_TRUTH_NONE) return NAN;
	if (metric->truth == CK_TRUTH_OF_STATE) return ck_metric_value(metric, model, &reference->trajectory, reference);
	return metric->truth == CK_TRUTH_ZERO || reference->is_static ? 0 : NAN;
}

double ck_metric_deviation(const ck_Metric *metric, const ck_Model *model, const ck_Trajectory *one, const ck_Trajectory *other,
						   const ck_Reference *reference) {
	if (metric->between) return metric->between(model, one, other);
	return ck_metric_value(metric, model, one, reference) - ck_metric_value(metric, model, other, reference);
}
