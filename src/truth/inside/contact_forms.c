#include "contact_forms.h"

#include "collider.h"
#include "rest_forms.h"
#include "springs.h"
#include "vector.h"

#include <string.h>

// A body of which every particle moves alike on the one collider of a scene.
typedef struct Contact {
    const ck_Collider *collider;
    double normal[3], gap; // of the first particle at the start
    double field[3], velocity[3];
    double press; // m/s²: field into the surface
} Contact;

// False where there is not one collider of that shape, or the body has pins, drag, strain, or is not level on a plane.
static bool read_contact(Contact *contact, const ck_Model *model, ck_ColliderShape shape) {
    bool fits = model->collider_count == 1 && model->colliders[0].shape == shape && !model->pin_count &&
                !(model->terms & CK_TERM_DRAG) && ck_springs_start_at_rest(model);
    if (!fits) return false;
    contact->collider = &model->colliders[0];
    contact->gap = ck_collider_gap(contact->collider, model->position, contact->normal);
    ck_model_field(model, 0, contact->field);
    memcpy(contact->velocity, model->velocity, sizeof contact->velocity);
    contact->press = -ck_dot(contact->field, contact->normal);
    for (int i = 1; i < model->particle_count; i++) {
        double normal[3], field[3], gap = ck_collider_gap(contact->collider, model->position + 3 * i, normal);
        ck_model_field(model, i, field);
        fits &= shape == CK_PLANE && fabs(gap - contact->gap) <= 1e-12 * model->size;
        fits &= ck_distance(field, contact->field) <= 1e-12 * ck_length(field);
        fits &= ck_distance(model->velocity + 3 * i, contact->velocity) <= 1e-12 * ck_length(contact->velocity);
    }
    return fits && contact->press > 0;
}

// Moves every particle from its start by the same way.
static void move_all(const ck_Model *model, const double *way, const double *speed, double *position,
                     double *velocity) {
    memcpy(position, model->position, 3 * sizeof(double) * (size_t)model->particle_count);
    for (int i = 0; i < model->particle_count; i++) {
        ck_add_scaled(position + 3 * i, 1, way);
        memcpy(velocity + 3 * i, speed, 3 * sizeof(double));
    }
}

// Height and speed of a bouncing point at a time, from gap and speed at the start.
static void bounce(double *height, double *speed, double gap, double start, double g, double restitution, double time) {
    double first = (start + sqrt(start * start + 2 * g * gap)) / g, impact = sqrt(start * start + 2 * g * gap);
    if (time < first) {
        *height = gap + start * time - 0.5 * g * time * time;
        *speed = start - g * time;
        return;
    }
    double rise = restitution * impact, since = time - first;
    *height = *speed = 0;
    if (restitution < 1 && since >= 2 * rise / (g * (1 - restitution))) return;
    if (!(rise > 0)) return;
    // how many bounces have gone before: each takes e times as long as the last
    double hop = 2 * rise / g;
    if (restitution == 1) {
        since = fmod(since, hop);
    } else {
        double gone = floor(log1p(-since * (1 - restitution) / hop) / log(restitution)),
               passed = pow(restitution, gone);
        since = fmax(0, since - hop * (1 - passed) / (1 - restitution));
        rise *= passed;
    }
    *height = rise * since - 0.5 * g * since * since;
    *speed = rise - g * since;
}

ck_Status ck_truth_bounce(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error) {
    Contact contact = {0};
    double along[3], drift[3];
    bool fits = read_contact(&contact, model, CK_PLANE) && contact.gap >= -1e-9 * model->size;
    if (fits) {
        ck_tangential(along, contact.field, contact.normal);
        ck_tangential(drift, contact.velocity, contact.normal);
        fits = ck_length(along) <= 1e-12 * contact.press &&
               (contact.collider->friction == 0 || ck_length(drift) <= 1e-12 * ck_length(contact.velocity));
    }
    ck_Status status = ck_truth_need(fits, model, error,
                                     "a level body at rest lengths above one plane, pulled straight onto it; no pins, "
                                     "no drag, and friction only where it falls straight");
    if (status) return status;
    double height, speed, way[3] = {0};
    // what lies on the plane has nothing to fall
    double gap = contact.gap > 1e-9 * model->size ? contact.gap : 0;
    bounce(&height, &speed, gap, ck_dot(contact.velocity, contact.normal), contact.press, contact.collider->restitution,
           time);
    ck_add_scaled(way, height - gap, contact.normal);
    ck_add_scaled(way, time, drift);
    ck_add_scaled(drift, speed, contact.normal);
    move_all(model, way, drift, position, velocity);
    return CK_OK;
}

// Way and speed along a line from speed start ≥ 0, driven by drive, held back by at most friction, both in m/s².
static void slide(double *way, double *speed, double start, double drive, double friction, double time) {
    double rate = drive - friction, stop = start > 0 && rate < 0 ? start / -rate : start > 0 ? INFINITY : 0;
    if (time < stop) {
        *way = start * time + 0.5 * rate * time * time;
        *speed = start + rate * time;
        return;
    }
    double slip = fabs(drive) > friction ? drive - copysign(friction, drive) : 0, since = time - stop;
    *way = (stop > 0 ? 0.5 * start * stop : 0) + 0.5 * slip * since * since;
    *speed = slip * since;
}

ck_Status ck_truth_slide(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error) {
    Contact contact = {0};
    double drive[3], line[3] = {0};
    bool fits = read_contact(&contact, model, CK_PLANE) && fabs(contact.gap) <= 1e-9 * model->size &&
                fabs(ck_dot(contact.velocity, contact.normal)) <= 1e-12 * ck_length(contact.velocity);
    if (fits) {
        ck_tangential(drive, contact.field, contact.normal);
        const double *direction = ck_length(contact.velocity) > 0 ? contact.velocity : drive;
        if (ck_length(direction) > 0) ck_add_scaled(line, 1 / ck_length(direction), direction);
        double across[3];
        memcpy(across, drive, sizeof across);
        ck_add_scaled(across, -ck_dot(drive, line), line);
        fits = ck_length(across) <= 1e-12 * ck_length(contact.field);
    }
    ck_Status status = ck_truth_need(fits, model, error,
                                     "a body at rest lengths lying on one plane, moving along it straight up or down "
                                     "or across a level one; no pins, no drag");
    if (status) return status;
    double way, speed, moved[3] = {0}, rate[3] = {0};
    slide(&way, &speed, ck_length(contact.velocity), ck_dot(drive, line), contact.collider->friction * contact.press,
          time);
    ck_add_scaled(moved, way, line);
    ck_add_scaled(rate, speed, line);
    move_all(model, moved, rate, position, velocity);
    return CK_OK;
}

// One step of θ'' = rate·sin θ by the classical fourth-order Runge–Kutta method.
static void roll(double *theta, double *omega, double rate, double dt) {
    double k1 = rate * sin(*theta), w2 = *omega + 0.5 * dt * k1;
    double k2 = rate * sin(*theta + 0.5 * dt * *omega), w3 = *omega + 0.5 * dt * k2;
    double k3 = rate * sin(*theta + 0.5 * dt * w2), w4 = *omega + dt * k3;
    double k4 = rate * sin(*theta + dt * w3);
    *theta += dt / 6 * (*omega + 2 * w2 + 2 * w3 + w4);
    *omega += dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
}

// Angle and rate at a time, or when it leaves; returns how long it has been in the air. Steps of 1/1000 of √(R/g) are
// exact to some 1e-13.
static double roll_until(double *theta, double *omega, double rate, double leave_cosine, double time) {
    double dt = 1e-3 / sqrt(rate), at = 0;
    while (at < time) {
        double before = *theta, before_rate = *omega, step = fmin(dt, time - at);
        roll(theta, omega, rate, step);
        if (cos(*theta) > leave_cosine) {
            at += step;
            continue;
        }
        // back, and up to the angle at which it leaves
        for (double low = 0, high = step;;) {
            double middle = 0.5 * (low + high);
            if (middle <= low || middle >= high) return time - at - low;
            *theta = before;
            *omega = before_rate;
            roll(theta, omega, rate, middle);
            if (cos(*theta) > leave_cosine)
                low = middle;
            else
                high = middle;
        }
    }
    return 0;
}

ck_Status ck_truth_sphere_slide(const ck_Model *model, double time, double *position, double *velocity,
                                ck_Error *error) {
    Contact contact = {0};
    double up[3], down_slope[3], g = 0;
    bool fits = read_contact(&contact, model, CK_SPHERE) && model->particle_count == 1 &&
                fabs(contact.gap) <= 1e-9 * model->size && contact.collider->friction == 0;
    if (fits) {
        g = ck_length(contact.field);
        for (int axis = 0; axis < 3; axis++) up[axis] = -contact.field[axis] / g;
        ck_tangential(down_slope, contact.field, contact.normal);
        double steep = ck_length(down_slope), speed = ck_length(contact.velocity);
        const double *direction = steep > 1e-12 * g ? down_slope : contact.velocity;
        double length = ck_length(direction);
        for (int axis = 0; axis < 3 && length > 0; axis++) down_slope[axis] = direction[axis] / length;
        fits = length > 0 && ck_dot(contact.velocity, down_slope) >= speed * (1 - 1e-12);
    }
    ck_Status status = ck_truth_need(fits, model, error,
                                     "one particle on one ball without friction, off its top or moving, straight down; "
                                     "no drag");
    if (status) return status;
    double radius = contact.collider->radius, start_cosine = ck_dot(contact.normal, up);
    double speed = ck_length(contact.velocity), theta = acos(fmin(1, start_cosine)), omega = speed / radius;
    double leave_cosine = 2.0 / 3 * start_cosine + speed * speed / (3 * g * radius);
    double air = roll_until(&theta, &omega, g / radius, leave_cosine, time);
    // the level direction of its plane
    double level[3];
    ck_tangential(level, down_slope, up);
    double length = ck_length(level);
    for (int axis = 0; axis < 3; axis++) {
        level[axis] /= length;
        double slope = cos(theta) * level[axis] - sin(theta) * up[axis];
        velocity[axis] = radius * omega * slope;
        position[axis] = contact.collider->point[axis] + radius * (sin(theta) * level[axis] + cos(theta) * up[axis]) +
                         air * velocity[axis] + 0.5 * air * air * contact.field[axis];
        velocity[axis] += air * contact.field[axis];
    }
    return CK_OK;
}

void ck_truth_nudge_sphere_slide(ck_Model *model, double share) {
    const ck_Collider *ball = &model->colliders[0];
    double out[3], field[3], way[3];
    ck_subtract(out, model->position, ball->point);
    double radius = ck_length(out);
    for (int axis = 0; axis < 3; axis++) out[axis] /= radius;
    ck_model_field(model, 0, field);
    ck_tangential(way, field, out);
    if (!(ck_length(way) > 1e-12 * ck_length(field))) ck_tangential(way, model->velocity, out);
    ck_add_scaled(out, share / ck_length(way), way);
    double length = ck_length(out);
    memcpy(model->position, ball->point, 3 * sizeof(double));
    ck_add_scaled(model->position, radius / length, out);
}

ck_Status ck_truth_strike(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error) {
    bool fits = model->particle_count == 1 && model->collider_count == 1 &&
                !(model->terms & (CK_TERM_GRAVITY | CK_TERM_FORCE | CK_TERM_DRAG)) && !model->pin_count;
    double normal[3], gap = fits ? ck_collider_gap(&model->colliders[0], model->position, normal) : 0;
    double speed = ck_length(model->velocity);
    fits = fits && gap >= 0 && speed > 0 && -ck_dot(model->velocity, normal) >= speed * (1 - 1e-12);
    ck_Status status = ck_truth_need(fits, model, error, "one particle that flies straight at one collider, no field");
    if (status) return status;
    double hit = gap / speed, back = model->colliders[0].restitution * speed, way[3] = {0}, rate[3] = {0};
    ck_add_scaled(way, time < hit ? -speed * time : back * (time - hit) - gap, normal);
    ck_add_scaled(rate, time < hit ? -speed : back, normal);
    move_all(model, way, rate, position, velocity);
    return CK_OK;
}
