#include "shape.h"

#include "vector.h"

#include <math.h>
#include <string.h>

void ck_capstan_place(const ck_Capstan *capstan, double arc, double *position, double *direction) {
    double half = M_PI * capstan->radius, theta = fmin(M_PI, fmax(0, arc / capstan->radius));
    double below = arc < 0 ? -arc : arc > half ? arc - half : 0;
    for (int axis = 0; axis < 3; axis++) {
        double up = capstan->up[axis], level = capstan->level[axis];
        position[axis] = capstan->center[axis] + capstan->radius * (sin(theta) * up - cos(theta) * level) - below * up;
        direction[axis] = cos(theta) * up + sin(theta) * level;
    }
}

double ck_capstan_arc(const ck_Capstan *capstan, const ck_Model *model, int particle) {
    double from[3];
    ck_subtract(from, model->position + 3 * particle, capstan->center);
    double up = ck_dot(from, capstan->up), level = ck_dot(from, capstan->level);
    if (up < 0) return level < 0 ? up : M_PI * capstan->radius - up;
    return capstan->radius * atan2(up, -level);
}

// Everything alike but the ends, on the ball or straight below its sides.
static bool lies_over(const ck_Capstan *capstan, const ck_Model *model) {
    int last = model->particle_count - 1;
    for (int i = 0; i <= last; i++) {
        double at[3], direction[3], out = 1e-3 * model->spacing;
        ck_capstan_place(capstan, ck_capstan_arc(capstan, model, i), at, direction);
        if (ck_distance(at, model->position + 3 * i) > out) return false;
        if (i && i < last && fabs(model->mass[i] - model->mass[1]) > 1e-12 * model->mass[1]) return false;
    }
    return true;
}

static bool is_round(const ck_Collider *collider) {
    return collider->shape == CK_SPHERE || collider->shape == CK_CYLINDER;
}

// Of a cylinder in the plane of the rope; false where the rope does not go straight across it.
static bool set_center(ck_Capstan *capstan, const ck_Model *model) {
    const ck_Collider *around = &model->colliders[0];
    const double *axis = around->axes[0];
    double from[3];
    memcpy(capstan->center, around->point, sizeof capstan->center);
    if (around->shape == CK_SPHERE) return true;
    ck_subtract(from, model->position, around->point);
    ck_add_scaled(capstan->center, ck_dot(from, axis), axis);
    return fabs(ck_dot(axis, capstan->up)) < 1e-9 && fabs(ck_dot(axis, capstan->level)) < 1e-9;
}

bool ck_capstan_read(ck_Capstan *capstan, const ck_Model *model) {
    unsigned without = CK_TERM_FORCE | CK_TERM_DRAG | CK_TERM_VELOCITY;
    bool fits = ck_shape_is_chain(model) && model->collider_count == 1 && is_round(&model->colliders[0]) &&
                !model->pin_count && (model->terms & CK_TERM_GRAVITY) && !(model->terms & without) &&
                model->particle_count > 3;
    if (!fits) return false;
    int last = model->particle_count - 1;
    double across[3];
    *capstan = (ck_Capstan){.g = ck_length(model->gravity),
                            .radius = model->colliders[0].radius,
                            .friction = model->colliders[0].friction,
                            .density = model->mass[1] / model->springs[1].rest};
    for (int axis = 0; axis < 3; axis++) capstan->up[axis] = -model->gravity[axis] / capstan->g;
    ck_subtract(across, model->position + 3 * last, model->position);
    ck_add_scaled(across, -ck_dot(across, capstan->up), capstan->up);
    if (!(ck_length(across) > 0)) return false;
    ck_add_scaled(capstan->level, 1 / ck_length(across), across);
    if (!set_center(capstan, model)) return false;
    capstan->hang[0] = -ck_capstan_arc(capstan, model, 0);
    capstan->hang[1] = ck_capstan_arc(capstan, model, last) - M_PI * capstan->radius;
    // half a node's rope belongs to each end's neighbour
    capstan->weight[0] = model->mass[0] - 0.5 * model->mass[1];
    capstan->weight[1] = model->mass[last] - 0.5 * model->mass[1];
    bool falls_onwards = capstan->weight[1] + capstan->density * capstan->hang[1] >=
                         capstan->weight[0] + capstan->density * capstan->hang[0];
    return falls_onwards && capstan->hang[0] > 0 && capstan->hang[1] > 0 && lies_over(capstan, model);
}

// Tension at the far tangent point minus what the far side asks for, at accelerations of both ends; slid: m, v: m/s.
static double surplus(const ck_Capstan *capstan, double slid, double v, double a, double b) {
    const int steps = 100;
    double density = capstan->density, g = capstan->g, radius = capstan->radius, dtheta = M_PI / steps;
    double tension = (capstan->weight[0] + density * (capstan->hang[0] - slid)) * (g + a);
    for (int i = 0; i < steps; i++) {
        double k[4];
        for (int stage = 0; stage < 4; stage++) {
            double share = stage == 0 ? 0 : stage == 3 ? 1 : 0.5, theta = (i + share) * dtheta;
            double now = tension + (stage ? share * dtheta * k[stage - 1] : 0);
            k[stage] = capstan->friction * (now + density * (radius * g * sin(theta) - v * v)) +
                       density * radius * (0.5 * (a + b) + g * cos(theta));
        }
        tension += dtheta / 6 * (k[0] + 2 * k[1] + 2 * k[2] + k[3]);
    }
    return tension - (capstan->weight[1] + density * (capstan->hang[1] + slid)) * (g - b);
}

double ck_capstan_friction(const ck_Model *model, double slid, double v, double a, double b) {
    ck_Capstan capstan;
    if (!ck_capstan_read(&capstan, model) || slid >= capstan.hang[0]) return NAN;
    // more friction leaves more tension over: it is found where none is
    double low = 0, high = 10;
    capstan.friction = low;
    if (surplus(&capstan, slid, v, a, b) > 0) return 0;
    for (int i = 0; i < 60; i++) {
        capstan.friction = 0.5 * (low + high);
        if (surplus(&capstan, slid, v, a, b) > 0)
            high = capstan.friction;
        else
            low = capstan.friction;
    }
    return 0.5 * (low + high);
}
