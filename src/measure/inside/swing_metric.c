#include "swing_metric.h"

#include "statistics.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

// Swings smaller than this share of the largest, and than this share of the size, are not counted.
#define SMALL_SWING 0.05
#define NO_SWING 1e-6
#define MOST_POINTS 8

static bool is_held_anywhere(const ck_Model *model) {
    for (int i = 0; i < model->particle_count; i++)
        if (ck_model_is_held(model, i)) return true;
    return false;
}

// The largest eigenvector of a symmetric 3×3 matrix {xx, yy, zz, xy, xz, yz}, by power iteration.
static void principal_direction(const double *m, double *direction) {
    const double rows[3][3] = {{m[0], m[3], m[4]}, {m[3], m[1], m[5]}, {m[4], m[5], m[2]}};
    int largest = m[0] >= m[1] ? 0 : 1;
    if (m[2] > m[largest]) largest = 2;
    memcpy(direction, rows[largest], 3 * sizeof(double));
    for (int round = 0; round < 200; round++) {
        double length = ck_length(direction), next[3];
        if (!(length > 0)) return;
        for (int axis = 0; axis < 3; axis++) direction[axis] /= length;
        for (int axis = 0; axis < 3; axis++) next[axis] = ck_dot(rows[axis], direction);
        memcpy(direction, next, sizeof next);
    }
    double length = ck_length(direction);
    for (int axis = 0; axis < 3 && length > 0; axis++) direction[axis] /= length;
}

// Where the centre of mass is along the direction in which it moves most, at every frame; NULL without memory.
static double *read_swing(const ck_Model *model, const ck_Trajectory *trajectory) {
    int frames = trajectory->frame_count;
    double *center = calloc(4 * (size_t)frames, sizeof *center), *swing = center ? center + 3 * (size_t)frames : NULL;
    double mass = ck_model_free_mass(model), mean[3] = {0}, spread[6] = {0}, direction[3];
    for (int frame = 0; frame < frames && center; frame++) {
        for (int i = 0; i < model->particle_count; i++)
            if (!model->pinned[i])
                ck_add_scaled(center + 3 * frame, model->mass[i] / mass,
                              ck_trajectory_position(trajectory, frame) + 3 * i);
        ck_add_scaled(mean, 1.0 / frames, center + 3 * frame);
    }
    for (int frame = 0; frame < frames && center; frame++) {
        double *d = center + 3 * frame;
        ck_subtract(d, d, mean);
        const double products[6] = {d[0] * d[0], d[1] * d[1], d[2] * d[2], d[0] * d[1], d[0] * d[2], d[1] * d[2]};
        for (int i = 0; i < 6; i++) spread[i] += products[i];
    }
    principal_direction(spread, direction);
    for (int frame = 0; frame < frames && center; frame++) swing[frame] = ck_dot(center + 3 * frame, direction);
    if (center) memmove(center, swing, (size_t)frames * sizeof *center);
    return center;
}

// A polynomial through a few frames' values, in Newton's form: its nodes are first, first + 1, …
typedef struct Curve {
    double differences[MOST_POINTS];
    int first, points;
} Curve;

// Through so many frames around one, or all there are.
static Curve curve_around(const double *swing, int frames, double at, int points) {
    Curve curve = {.points = points < frames ? points : frames, .first = (int)ceil(at) - points / 2};
    if (curve.first > frames - curve.points) curve.first = frames - curve.points;
    if (curve.first < 0) curve.first = 0;
    memcpy(curve.differences, swing + curve.first, (size_t)curve.points * sizeof *swing);
    for (int order = 1; order < curve.points; order++)
        for (int i = curve.points - 1; i >= order; i--)
            curve.differences[i] = (curve.differences[i] - curve.differences[i - 1]) / order;
    return curve;
}

// By Horner's rule, for value and slope at once.
static double value_at(const Curve *curve, double at, double *slope) {
    double value = curve->differences[curve->points - 1];
    *slope = 0;
    for (int i = curve->points - 2; i >= 0; i--) {
        *slope = *slope * (at - curve->first - i) + value;
        value = value * (at - curve->first - i) + curve->differences[i];
    }
    return value;
}

// Where the curve's slope, or its value less a level, changes sign between two times that it does between, in frames.
static double find_change(const Curve *curve, double low, double high, bool of_slope, double level) {
    double slope, value = value_at(curve, low, &slope);
    bool is_above = of_slope ? slope > 0 : value > level;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        value = value_at(curve, middle, &slope);
        if ((of_slope ? slope > 0 : value > level) == is_above)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

typedef struct Extreme {
    double time, value; // frames, m
} Extreme;

static Extreme read_extreme(const double *swing, int frames, int frame, int points) {
    if (frame == 0) return (Extreme){0, swing[0]}; // starts at rest
    Curve curve = curve_around(swing, frames, frame, points);
    double slope, time = find_change(&curve, frame - 1, frame + 1, true, 0);
    return (Extreme){time, value_at(&curve, time, &slope)};
}

// Walks from one extreme to the next that is at least a swing away, so that ripples on the way do not count. A start is
// only an extreme where the body starts at rest. Returns how many there are.
static int find_extremes(const double *swing, int frames, double least, bool starts_at_rest, int points,
                         Extreme *extremes) {
    int at[2] = {0, 0}, towards = -1, count = 0; // the lowest and the highest frame since the last extreme
    for (int frame = 1; frame < frames; frame++) {
        if (swing[frame] < swing[at[0]]) at[0] = frame;
        if (swing[frame] > swing[at[1]]) at[1] = frame;
        for (int kind = 0; kind < 2; kind++) {
            if (towards == 1 - kind || fabs(swing[frame] - swing[at[kind]]) <= least) continue;
            if (at[kind] > 0 || starts_at_rest) extremes[count++] = read_extreme(swing, frames, at[kind], points);
            towards = 1 - kind;
            at[1 - kind] = frame;
        }
    }
    return count;
}

// The place of rest that three extremes in a row swing about, where each is as far from it as the last times a share:
// exact for a linear swing with damping, and the middle of one without. Source: Aitken 1926.
static double rest_of(const Extreme *three) {
    double before = three[0].value - three[1].value, after = three[2].value - three[1].value;
    return three[1].value + before * after / (before + after);
}

// The median of all of them: ripples move each a little.
static double place_of_rest(const Extreme *extremes, int count, double *rests) {
    for (int i = 0; i + 2 < count; i++) rests[i] = rest_of(extremes + i);
    return ck_median(rests, count - 2);
}

// When the swing from extreme i to the next passes a place; NaN where it does not.
static double passing_time(const double *swing, int frames, const Extreme *extremes, int i, double rest, int points) {
    double from = extremes[i].time, to = extremes[i + 1].time;
    bool is_above = extremes[i].value > rest;
    if ((extremes[i + 1].value > rest) == is_above) return NAN;
    int frame = (int)ceil(from);
    while (frame < to && (swing[frame] > rest) == is_above) frame++;
    Curve curve = curve_around(swing, frames, frame, points);
    return find_change(&curve, fmax(from, frame - 1), fmin(to, frame), false, rest);
}

// A period, and by how much passes of one direction differ in it from those of the other: what has a period has none
// of that.
typedef struct Period {
    double mean, scatter;
} Period;

// The mean time between passes of one direction, of both directions together, in frames; NaN with fewer than three
// passes. rests is scratch, [count].
static Period mean_period(const double *swing, int frames, const Extreme *extremes, int count, double *rests,
                          int points) {
    if (count < 4) return (Period){NAN, 0};
    double rest = place_of_rest(extremes, count, rests), before[2] = {NAN, NAN}, span[2] = {0};
    int periods[2] = {0};
    for (int i = 0; i + 1 < count; i++) {
        double time = passing_time(swing, frames, extremes, i, rest, points);
        if (isnan(time)) before[0] = before[1] = NAN;
        if (!isnan(before[i % 2])) span[i % 2] += time - before[i % 2], periods[i % 2]++;
        before[i % 2] = time;
    }
    if (!(periods[0] + periods[1])) return (Period){NAN, 0};
    bool has_both = periods[0] && periods[1];
    return (Period){(span[0] + span[1]) / (periods[0] + periods[1]),
                    has_both ? 0.5 * fabs(span[0] / periods[0] - span[1] / periods[1]) : 0};
}

// In seconds.
static Period period_with(const ck_Model *model, const ck_Trajectory *trajectory, int points) {
    int frames = trajectory->frame_count;
    double *swing = frames > 3 && is_held_anywhere(model) ? read_swing(model, trajectory) : NULL;
    Extreme *extremes = swing ? malloc((size_t)frames * sizeof *extremes) : NULL;
    double *rests = extremes ? malloc((size_t)frames * sizeof *rests) : NULL;
    double low = INFINITY, high = -INFINITY;
    Period period = {NAN, 0};
    for (int frame = 0; frame < frames && rests; frame++) {
        low = fmin(low, swing[frame]);
        high = fmax(high, swing[frame]);
    }
    double least = fmax(SMALL_SWING * (high - low), NO_SWING * model->size);
    bool starts_at_rest = !(model->terms & (CK_TERM_VELOCITY | CK_TERM_RELEASE));
    if (rests) {
        int count = find_extremes(swing, frames, least, starts_at_rest, points, extremes);
        period = mean_period(swing, frames, extremes, count, rests, points);
        period.mean *= trajectory->step;
        period.scatter *= trajectory->step;
    }
    free(rests);
    free(extremes);
    free(swing);
    return period;
}

double ck_metric_period_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
    (void)reference;
    return period_with(model, trajectory, MOST_POINTS).mean;
}

double ck_metric_period_unsure(const ck_Model *model, const ck_Trajectory *trajectory) {
    Period period = period_with(model, trajectory, MOST_POINTS);
    return fabs(period.mean - period_with(model, trajectory, MOST_POINTS - 2).mean) + period.scatter;
}
