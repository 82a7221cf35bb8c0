#include "contact_metric.h"

#include "collider.h"
#include "path.h"
#include "rigid.h"
#include "shape.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

static bool is_pinned_at(const ck_Model *model, int particle, int frame) {
    if (!model->pinned[particle]) return false;
    for (int i = 0; i < model->release_count; i++)
        for (int j = 0; j < model->releases[i].particle_count && model->releases[i].frame <= frame; j++)
            if (model->releases[i].particles[j] == particle) return false;
    return true;
}

// The gap of a particle at a frame to the nearest collider, m; INFINITY where it is pinned then, or is no cloth's.
static double gap_of(const ck_Model *model, const double *position, int particle, int frame) {
    double smallest = INFINITY, normal[3], v[3], a[3];
    if (particle >= ck_model_cloth_count(model)) return smallest;
    for (int j = 0; j < model->collider_count && !is_pinned_at(model, particle, frame); j++) {
        const ck_Collider now = ck_collider_at(&model->colliders[j], frame * model->step, -1, v, a);
        smallest = fmin(smallest, ck_collider_gap(&now, position + 3 * particle, normal));
    }
    return smallest;
}

double ck_metric_rigid_gap(const ck_Model *model, const ck_Trajectory *trajectory, int frame) {
    const size_t bodies = (size_t)model->rigid_count;
    const double *position = ck_trajectory_position(trajectory, frame);
    const ck_Turn *turn = ck_trajectory_turn(trajectory, frame);
    double smallest = INFINITY, v[3], a[3];
    if (!bodies) return smallest;
    ck_Collider *now = malloc(sizeof *now * (bodies + (size_t)model->collider_count));
    ck_Touch *touches = malloc(sizeof *touches * ck_rigid_most_touches(model));
    for (int i = 0; i < model->collider_count && now; i++)
        now[bodies + (size_t)i] = ck_collider_at(&model->colliders[i], frame * model->step, -1, v, a);
    for (int i = 0; i < model->rigid_count && now; i++)
        now[i] = ck_rigid_place(&model->rigid[i], position + 3 * model->rigid[i].particle, turn[i].rotation);
    const int count =
        now && touches ? ck_rigid_find_touches(model, position, now, now + bodies, model->size, touches) : 0;
    for (int i = 0; i < count; i++) {
        const bool is_pin = touches[i].rigid < 0 && is_pinned_at(model, touches[i].particle, frame);
        if (!is_pin) smallest = fmin(smallest, touches[i].gap);
    }
    free(now);
    free(touches);
    return smallest;
}

// the smallest gap of all particles that are free at a frame to all colliders, and that of rigid bodies, m
static double smallest_gap(const ck_Model *model, const ck_Trajectory *trajectory, int frame) {
    const double *position = ck_trajectory_position(trajectory, frame);
    double smallest = ck_metric_rigid_gap(model, trajectory, frame);
    for (int i = 0; i < model->particle_count; i++) smallest = fmin(smallest, gap_of(model, position, i, frame));
    return isfinite(smallest) ? smallest : NAN;
}

// What counts as on a surface and as deep in it, in spacings: a hundredth.
#define NEAR 0.01

double ck_metric_penetration_time_over(const ck_Model *model, const ck_Trajectory *trajectory,
                                       const ck_Reference *reference) {
    int deep = 0;
    if (!model->collider_count && !model->rigid_count) return NAN;
    for (int frame = 0; frame < trajectory->frame_count; frame++)
        deep += ck_metric_penetration_at(model, trajectory, frame, reference) > NEAR;
    return deep * trajectory->step;
}

double ck_metric_contact_share_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                                  const ck_Reference *reference) {
    (void)reference;
    const double *position = ck_trajectory_position(trajectory, frame);
    int touching = 0, count = 0;
    for (int i = 0; i < model->particle_count; i++) {
        const double gap = gap_of(model, position, i, frame);
        count += isfinite(gap);
        touching += gap <= NEAR * model->spacing;
    }
    return count ? (double)touching / count : NAN;
}

double ck_metric_height_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                           const ck_Reference *reference) {
    (void)reference;
    return smallest_gap(model, trajectory, frame) / model->spacing;
}

double ck_metric_penetration_at(const ck_Model *model, const ck_Trajectory *trajectory, int frame,
                                const ck_Reference *reference) {
    double height = ck_metric_height_at(model, trajectory, frame, reference);
    return isnan(height) ? NAN : fmax(0, -height);
}

static const ck_Collider *first_plane(const ck_Model *model) {
    if (model->rigid_count) return NULL; // they would be part of what bounces
    for (int i = 0; i < model->collider_count; i++)
        if (model->colliders[i].shape == CK_PLANE && !model->pin_count) return &model->colliders[i];
    return NULL;
}

// Mean position and velocity of the whole body, weighted by mass.
static void center_of_mass(const ck_Model *model, const ck_Trajectory *trajectory, int frame, double *position,
                           double *velocity) {
    double mass = ck_model_free_mass(model);
    memset(position, 0, 3 * sizeof(double));
    memset(velocity, 0, 3 * sizeof(double));
    for (int i = 0; i < model->particle_count; i++) {
        ck_add_scaled(position, model->mass[i] / mass, ck_trajectory_position(trajectory, frame) + 3 * i);
        ck_add_scaled(velocity, model->mass[i] / mass, ck_trajectory_velocity(trajectory, frame) + 3 * i);
    }
}

// A body that falls on a plane: its lowest point, its speed and the energy of both, per mass.
typedef struct Flight {
    const ck_Model *model;
    const ck_Trajectory *trajectory;
    const ck_Collider *plane;
    double base;  // m, from the lowest point to the centre of mass
    double press; // m/s², of the field into the plane
} Flight;

typedef struct Height {
    double gap, speed, energy; // m, m/s away from the plane, J/kg
} Height;

static Height height_at(const Flight *flight, int frame) {
    double position[3], velocity[3], normal[3];
    center_of_mass(flight->model, flight->trajectory, frame, position, velocity);
    Height height = {.gap = ck_collider_gap(flight->plane, position, normal) - flight->base};
    height.speed = ck_dot(velocity, normal);
    height.energy = 0.5 * height.speed * height.speed + flight->press * height.gap;
    return height;
}

// The first frame at which the speed is another than that of free flight from the frame before; 0: none.
static int first_impact(const Flight *flight) {
    double step = flight->trajectory->step;
    for (int frame = 1; frame < flight->trajectory->frame_count; frame++) {
        Height before = height_at(flight, frame - 1), now = height_at(flight, frame);
        double jump = now.speed - before.speed + flight->press * step;
        // what no first-order method is off by in a step, and less than any rebound that a step can tell
        if (before.speed - flight->press * step < 0 && jump > 0.25 * flight->press * step) return frame;
    }
    return 0;
}

// How many impacts there were up to a time since the first, of one after the other hop that last 2·e^j·v/g each, where
// energy fell to a share in all; its restitution is put there. 0: none fits.
#define MOST_IMPACTS 12

static int count_impacts(double share, double speed, double press, double since, double slack, double *restitution) {
    for (int n = 1; n <= MOST_IMPACTS; n++) {
        double e = pow(share, 0.5 / n), end = 0, start = 0;
        for (int j = 1; j <= n; j++) {
            start = end;
            end += 2 * pow(e, j) * speed / press;
        }
        if (since < start - slack || since > end + slack) continue;
        *restitution = e;
        return n;
    }
    return 0;
}

// Of the frames of the first hop the one next to its apex tells best: there the height is what is left of an impact. A
// hop between two frames is told by how many fit; where the body lies still by the next frame, frames are too coarse.
double ck_metric_restitution_over(const ck_Model *model, const ck_Trajectory *trajectory,
                                  const ck_Reference *reference) {
    (void)reference;
    Flight flight = {model, trajectory, first_plane(model), 0, 0};
    double field[3], normal[3], lowest = INFINITY, restitution = NAN, step = trajectory->step;
    if (!flight.plane) return NAN;
    ck_model_mean_field(model, field);
    flight.press = -ck_dot(field, flight.plane->normal);
    for (int i = 0; i < model->particle_count; i++)
        lowest = fmin(lowest, ck_collider_gap(flight.plane, model->position + 3 * i, normal));
    flight.base = height_at(&flight, 0).gap - lowest;
    int frame = flight.press > 0 ? first_impact(&flight) : 0;
    // a body that starts on the plane has nothing to bounce with
    if (!frame || !(lowest > 1e-3 * model->spacing)) return NAN;
    Height before = height_at(&flight, frame - 1), after = height_at(&flight, frame);
    // until the impact nothing but drag takes energy
    if (!(model->drag > 0)) before.energy = height_at(&flight, 0).energy;
    double speed = sqrt(2 * before.energy), since = step - (before.speed + speed) / flight.press;
    double share = fmax(0, after.energy) / before.energy;
    // a plane that takes all speed leaves none for hops that a frame could miss
    double missed = since * flight.press / (2 * speed + since * flight.press);
    if (share < 1e-9) return missed < 0.02 || flight.plane->restitution == 0 ? 0 : NAN;
    if (count_impacts(share, speed, flight.press, since, 0.2 * step, &restitution) != 1) return restitution;
    double returns = (after.speed + sqrt(2 * fmax(0, after.energy))) / flight.press;
    for (int next = frame; next < trajectory->frame_count && (next - frame) * step <= returns - 0.5 * step; next++) {
        Height height = height_at(&flight, next);
        if (fabs(height.speed) <= fabs(after.speed)) after = height;
    }
    return sqrt(fmax(0, after.energy) / before.energy);
}

double ck_metric_friction_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
    (void)reference;
    const ck_Collider *plane = first_plane(model);
    double field[3], drive[3], from[3], to[3], start[3], end[3], line[3] = {0}, normal[3];
    if (!plane) return NAN;
    for (int i = 0; i < model->particle_count; i++)
        if (fabs(ck_collider_gap(plane, model->position + 3 * i, normal)) > 1e-3 * model->spacing) return NAN;
    ck_model_mean_field(model, field);
    double press = -ck_dot(field, plane->normal);
    memcpy(drive, field, sizeof drive);
    ck_add_scaled(drive, press, plane->normal);
    center_of_mass(model, trajectory, 0, from, start);
    center_of_mass(model, trajectory, trajectory->frame_count - 1, to, end);
    const double *direction = ck_length(start) > ck_metric_still_speed(model) ? start : drive;
    if (!(ck_length(direction) > 0) || !(press > 0)) return NAN;
    ck_add_scaled(line, 1 / ck_length(direction), direction);
    // what is driven across its way slides along a curve
    double across[3];
    memcpy(across, drive, sizeof across);
    ck_add_scaled(across, -ck_dot(drive, line), line);
    if (ck_length(across) > 1e-9 * ck_length(field)) return NAN;
    ck_subtract(to, to, from);
    double way = ck_dot(to, line), first = ck_dot(start, line), last = ck_dot(end, line);
    // one that sticks tells nothing but that μ is enough, and one that came back has slid farther than it got
    if (!(way > 1e-2 * model->spacing) || last < -ck_metric_still_speed(model)) return NAN;
    return ((first * first - last * last) / (2 * way) + ck_dot(drive, line)) / press;
}

// The least gap of a particle's way from one frame to the next, as the collider sees it, which may move.
static double least_gap(const ck_Collider *collider, const ck_Trajectory *trajectory, int frame, int particle) {
    double from[3], to[3], moved[3], speed[3], gain[3];
    memcpy(from, ck_trajectory_position(trajectory, frame) + 3 * particle, sizeof from);
    memcpy(to, ck_trajectory_position(trajectory, frame + 1) + 3 * particle, sizeof to);
    if (collider->path) {
        ck_path_at(collider->path, frame * trajectory->step, -1, moved, speed, gain);
        ck_add_scaled(from, -1, moved);
        ck_path_at(collider->path, (frame + 1) * trajectory->step, -1, moved, speed, gain);
        ck_add_scaled(to, -1, moved);
    }
    return ck_collider_least_gap(collider, from, to);
}

double ck_metric_tunnelled_over(const ck_Model *model, const ck_Trajectory *trajectory, const ck_Reference *reference) {
    (void)reference;
    int solids = 0, passed = 0;
    for (int j = 0; j < model->collider_count; j++) solids += model->colliders[j].shape != CK_PLANE;
    for (int i = 0; i < ck_model_cloth_count(model) && solids; i++) {
        bool through = false;
        if (ck_model_is_held(model, i)) continue; // a pin may be inside
        for (int frame = 0; frame + 1 < trajectory->frame_count && !through; frame++)
            for (int j = 0; j < model->collider_count; j++)
                through |=
                    model->colliders[j].shape != CK_PLANE && least_gap(&model->colliders[j], trajectory, frame, i) <
                                                                 -0.5 * ck_collider_breadth(&model->colliders[j]);
        passed += through;
    }
    return solids ? (double)passed / ck_model_cloth_count(model) : NAN;
}

// A parabola of least squares through an end's way along the rope, over 2·half + 1 frames: m, m/s and m/s² at the
// middle.
typedef struct Slide {
    double way, speed, acceleration;
} Slide;

static Slide fit_slide(const ck_Model *model, const ck_Trajectory *trajectory, int particle, double sign, int middle,
                       int half) {
    double field[3], squares = 0, fourth = 0, way = 0, rate = 0, bend = 0, count = 2 * half + 1,
                     step = trajectory->step;
    ck_model_mean_field(model, field);
    for (int k = -half; k <= half; k++) squares += (double)k * k, fourth += (double)k * k * k * k;
    for (int k = -half; k <= half; k++) {
        double from[3];
        ck_subtract(from, ck_trajectory_position(trajectory, middle + k) + 3 * particle,
                    model->position + 3 * particle);
        double slid = sign * ck_dot(from, field) / ck_length(field);
        way += slid / count;
        rate += slid * k / squares;
        bend += slid * (k * k - squares / count) / (fourth - squares * squares / count);
    }
    return (Slide){way - bend * squares / count, rate / step, 2 * bend / (step * step)};
}

// The start, in which tensions find their profile, is left out: motion is that of the second half of the run. The ends
// bounce against each other; as friction takes its share of whatever tension there is, their means tell.
double ck_metric_wrap_friction_over(const ck_Model *model, const ck_Trajectory *trajectory,
                                    const ck_Reference *reference) {
    (void)reference;
    double field[3];
    ck_model_mean_field(model, field);
    int frames = trajectory->frame_count - 1, half = frames / 4;
    const ck_ColliderShape shape = model->collider_count == 1 ? model->colliders[0].shape : CK_PLANE;
    bool over_ball = (shape == CK_SPHERE || shape == CK_CYLINDER) && !model->pin_count;
    if (!over_ball || !ck_shape_is_chain(model) || half < 2 || !(ck_length(field) > 0)) return NAN;
    Slide first = fit_slide(model, trajectory, 0, -1, frames - half, half),
          last = fit_slide(model, trajectory, model->particle_count - 1, 1, frames - half, half);
    return ck_capstan_friction(model, 0.5 * (first.way + last.way), 0.5 * (first.speed + last.speed),
                               first.acceleration, last.acceleration);
}

double ck_metric_contact_force_over(const ck_Model *model, const ck_Trajectory *trajectory,
                                    const ck_Reference *reference) {
    (void)reference;
    double field[3], sum = 0, weight = ck_model_free_mass(model);
    int released = 0, last = trajectory->frame_count - 1, first = last - last / 20;
    for (int i = 0; i < model->release_count; i++) released += model->releases[i].particle_count;
    ck_model_mean_field(model, field);
    double strength = ck_length(field);
    // of frames in parts an engine tells the last part's
    if (!trajectory->contact || (model->terms & CK_TERM_JITTER) || released < model->pin_count || !(strength > 0))
        return NAN;
    for (int i = 0; i < model->particle_count; i++)
        if (model->pinned[i]) weight += model->mass[i];
    for (int frame = first; frame <= last; frame++)
        sum -= ck_dot(trajectory->contact + 3 * (size_t)frame, field) / strength;
    return sum / (last - first + 1) / (weight * strength);
}
