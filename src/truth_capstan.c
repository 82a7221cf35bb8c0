// A rope that slides over a ball.
#include "shape.h"
#include "truth_contact.h"
#include "truth_forms.h"
#include "vector.h"

#include <string.h>

// A chain over the upper half of a ball. Angles run from the tangent point of its first side over the top.
typedef struct Capstan {
    const ck_Collider *ball;
    double up[3], level[3]; // unit; level points to the last particle's side
    double g, radius, friction;
    double hang[2], weight[2]; // m of rope below the tangent points and kg at their ends, first side and last
    double density;            // kg/m
} Capstan;

// Where a point of the rope is that lies arc metres after the first tangent point, and which way it moves.
static void place(const Capstan *capstan, double arc, double *position, double *direction) {
    double half = M_PI * capstan->radius, theta = fmin(M_PI, fmax(0, arc / capstan->radius));
    double below = arc < 0 ? -arc : arc > half ? arc - half : 0;
    for (int axis = 0; axis < 3; axis++) {
        double up = capstan->up[axis], level = capstan->level[axis];
        position[axis] =
            capstan->ball->point[axis] + capstan->radius * (sin(theta) * up - cos(theta) * level) - below * up;
        direction[axis] = cos(theta) * up + sin(theta) * level;
    }
}

// The arc at which a particle lies at the start: its chords are taken for arcs.
static double arc_of(const Capstan *capstan, const ck_Model *model, int particle) {
    double from[3];
    ck_subtract(from, model->position + 3 * particle, capstan->ball->point);
    double up = ck_dot(from, capstan->up), level = ck_dot(from, capstan->level);
    if (up < 0) return level < 0 ? up : M_PI * capstan->radius - up;
    return capstan->radius * atan2(up, -level);
}

// Everything alike but the ends, on the ball or straight below its sides.
static bool lies_over(const Capstan *capstan, const ck_Model *model) {
    int last = model->particle_count - 1;
    for (int i = 0; i <= last; i++) {
        double at[3], direction[3], out = 1e-3 * model->spacing;
        place(capstan, arc_of(capstan, model, i), at, direction);
        if (ck_distance(at, model->position + 3 * i) > out) return false;
        if (i && i < last && fabs(model->mass[i] - model->mass[1]) > 1e-12 * model->mass[1]) return false;
    }
    return true;
}

static bool read_capstan(Capstan *capstan, const ck_Model *model) {
    unsigned without = CK_TERM_FORCE | CK_TERM_DRAG | CK_TERM_VELOCITY;
    bool fits = ck_shape_is_chain(model) && model->collider_count == 1 && model->colliders[0].shape == CK_SPHERE &&
                !model->pin_count && (model->terms & CK_TERM_GRAVITY) && !(model->terms & without) &&
                model->particle_count > 3;
    if (!fits) return false;
    int last = model->particle_count - 1;
    double across[3];
    *capstan = (Capstan){.ball = &model->colliders[0],
                         .g = ck_length(model->gravity),
                         .radius = model->colliders[0].radius,
                         .friction = model->colliders[0].friction,
                         .density = model->mass[1] / model->springs[1].rest};
    for (int axis = 0; axis < 3; axis++) capstan->up[axis] = -model->gravity[axis] / capstan->g;
    ck_subtract(across, model->position + 3 * last, model->position);
    ck_add_scaled(across, -ck_dot(across, capstan->up), capstan->up);
    if (!(ck_length(across) > 0)) return false;
    ck_add_scaled(capstan->level, 1 / ck_length(across), across);
    capstan->hang[0] = -arc_of(capstan, model, 0);
    capstan->hang[1] = arc_of(capstan, model, last) - M_PI * capstan->radius;
    // half a node's rope belongs to each end's neighbour
    capstan->weight[0] = model->mass[0] - 0.5 * model->mass[1];
    capstan->weight[1] = model->mass[last] - 0.5 * model->mass[1];
    bool falls_onwards = capstan->weight[1] + capstan->density * capstan->hang[1] >=
                         capstan->weight[0] + capstan->density * capstan->hang[0];
    return falls_onwards && capstan->hang[0] > 0 && capstan->hang[1] > 0 && lies_over(capstan, model);
}

// Tension at the far tangent point minus what the far side asks for, at an acceleration; slid: m, v: m/s.
static double surplus(const Capstan *capstan, double slid, double v, double a) {
    const int steps = 100;
    double density = capstan->density, g = capstan->g, radius = capstan->radius, dtheta = M_PI / steps;
    double tension = (capstan->weight[0] + density * (capstan->hang[0] - slid)) * (g + a);
    for (int i = 0; i < steps; i++) {
        double k[4];
        for (int stage = 0; stage < 4; stage++) {
            double share = stage == 0 ? 0 : stage == 3 ? 1 : 0.5, theta = (i + share) * dtheta;
            double now = tension + (stage ? share * dtheta * k[stage - 1] : 0);
            k[stage] = capstan->friction * (now + density * (radius * g * sin(theta) - v * v)) +
                       density * radius * (a + g * cos(theta));
        }
        tension += dtheta / 6 * (k[0] + 2 * k[1] + 2 * k[2] + k[3]);
    }
    return tension - (capstan->weight[1] + density * (capstan->hang[1] + slid)) * (g - a);
}

// surplus is linear in a; a rope that friction holds does not start, and one that moves is not driven back here.
static double acceleration(const Capstan *capstan, double slid, double v) {
    double at_zero = surplus(capstan, slid, v, 0), slope = surplus(capstan, slid, v, 1) - at_zero;
    return fmax(0, -at_zero / slope);
}

// By the midpoint rule: acceleration hardly changes as it slides.
static void slide_for(const Capstan *capstan, double time, double *slid, double *v) {
    const int steps = 200;
    const double dt = time / steps;
    *slid = *v = 0;
    for (int i = 0; i < steps && time > 0; i++) {
        double half = acceleration(capstan, *slid, *v);
        double middle = acceleration(capstan, *slid + 0.5 * dt * *v, *v + 0.5 * dt * half);
        *slid += dt * (*v + 0.5 * dt * middle);
        *v += dt * middle;
    }
}

ck_Status ck_truth_capstan(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error) {
    Capstan capstan = {0};
    bool fits = read_capstan(&capstan, model);
    double slid = 0, v = 0;
    if (fits) slide_for(&capstan, model->duration, &slid, &v);
    fits = fits && slid < capstan.hang[0];
    ck_Status status =
        ck_truth_need(fits, model, error,
                      "a chain of equal nodes but for its end weights, over the upper half of one ball "
                      "and hanging down on both sides to the end, the last side heavier, in gravity alone");
    if (status) return status;
    slide_for(&capstan, time, &slid, &v);
    for (int i = 0; i < model->particle_count; i++) {
        double direction[3];
        place(&capstan, arc_of(&capstan, model, i) + slid, position + 3 * i, direction);
        for (int axis = 0; axis < 3; axis++) velocity[3 * i + axis] = v * direction[axis];
    }
    return CK_OK;
}

double ck_truth_capstan_off(const ck_Model *model) {
    Capstan capstan, polygon;
    if (!read_capstan(&capstan, model)) return 0;
    polygon = capstan;
    double corner = 2 * asin(0.5 * model->springs[1].rest / capstan.radius), mu = capstan.friction;
    polygon.friction =
        log((cos(0.5 * corner) + mu * sin(0.5 * corner)) / (cos(0.5 * corner) - mu * sin(0.5 * corner))) / corner;
    double off = acceleration(&capstan, 0, 0) - acceleration(&polygon, 0, 0);
    double stretch = 0, load = fmax(capstan.weight[0], capstan.weight[1]) * capstan.g;
    for (int i = 0; i < model->spring_count; i++) stretch += load / model->springs[i].stiffness;
    return (0.5 * fabs(off) * model->duration * model->duration + stretch) / model->size;
}
