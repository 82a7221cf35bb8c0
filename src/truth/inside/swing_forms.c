#include "swing_forms.h"

#include "motion_forms.h"
#include "rest_forms.h"
#include "shape.h"
#include "springs.h"
#include "vector.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

// Jacobi's sn, cn, dn by the arithmetic–geometric mean. Source: Abramowitz and Stegun 16.4.
static void jacobi(double u, double modulus, double *sn, double *cn, double *dn) {
    double a[16], c[16], b = sqrt(1 - modulus * modulus);
    int last = 0;
    a[0] = 1;
    c[0] = modulus;
    while (last < 15 && fabs(c[last]) > 1e-17) {
        a[last + 1] = 0.5 * (a[last] + b);
        c[last + 1] = 0.5 * (a[last] - b);
        b = sqrt(a[last] * b);
        last++;
    }
    double phase = ldexp(a[last] * u, last);
    for (int i = last; i > 0; i--) phase = 0.5 * (phase + asin(c[i] * sin(phase) / a[i]));
    *sn = sin(phase);
    *cn = cos(phase);
    *dn = sqrt(1 - modulus * modulus * *sn * *sn);
}

ck_Status ck_truth_pendulum(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error) {
    unsigned others = CK_TERM_FORCE | CK_TERM_DRAG | CK_TERM_VELOCITY | CK_TERM_COLLIDERS | CK_TERM_RELEASE;
    double g = ck_length(model->gravity), bar[3] = {0}, side[3] = {0}, down[3],
           length = model->spring_count ? model->springs[0].rest : 1, start = 0;
    bool fits = model->particle_count == 2 && model->spring_count == 1 && model->pinned[0] && !model->pinned[1] &&
                g > 0 && (model->terms & CK_TERM_RIGID) && !(model->terms & others) && ck_springs_start_at_rest(model);
    if (fits) {
        ck_subtract(bar, model->position + 3, model->position);
        for (int axis = 0; axis < 3; axis++) down[axis] = model->gravity[axis] / g;
        memcpy(side, bar, sizeof side);
        ck_add_scaled(side, -ck_dot(bar, down), down);
        start = atan2(ck_length(side), ck_dot(bar, down));
        fits = start > 1e-6 && start < pi - 1e-6;
    }
    ck_Status status = ck_truth_need(
        fits, model, error, "one rigid bar from a pin, let go at rest off the vertical in gravity, and no other term");
    if (status) return status;
    double reach = ck_length(side), modulus = sin(0.5 * start), rate = sqrt(g / length), sn, cn, dn;
    jacobi(rate * time, modulus, &sn, &cn, &dn);
    double half = modulus * cn / dn, angle = 2 * asin(half);
    double speed = -2 * modulus * rate * (1 - modulus * modulus) * sn / (dn * dn) / sqrt(1 - half * half);
    ck_truth_start_from(model, position, velocity);
    memcpy(position + 3, position, 3 * sizeof(double));
    ck_add_scaled(position + 3, length * cos(angle), down);
    ck_add_scaled(position + 3, length * sin(angle) / reach, side);
    ck_add_scaled(velocity + 3, -length * speed * sin(angle), down);
    ck_add_scaled(velocity + 3, length * speed * cos(angle) / reach, side);
    return CK_OK;
}

void ck_truth_nudge_pendulum(ck_Model *model, double share) {
    double bar[3], down[3];
    ck_subtract(bar, model->position + 3, model->position);
    double length = ck_length(bar), g = ck_length(model->gravity);
    for (int axis = 0; axis < 3; axis++) {
        bar[axis] /= length;
        down[axis] = model->gravity[axis] / g;
    }
    ck_tangential(down, down, bar);
    ck_add_scaled(bar, share / ck_length(down), down);
    double turned = ck_length(bar);
    memcpy(model->position + 3, model->position, 3 * sizeof(double));
    ck_add_scaled(model->position + 3, length / turned, bar);
}

// What moves by springs and the field alone.
static bool is_undamped(const ck_Model *model) {
    return !(model->terms & (CK_TERM_DAMPING | CK_TERM_DRAG | CK_TERM_FORCE)) && !model->collider_count;
}

ck_Status ck_truth_conical_pendulum(const ck_Model *model, double time, double *position, double *velocity,
                                    ck_Error *error) {
    double along[3], down[3], radius[3], depth = 0, off = INFINITY;
    const double g = ck_length(model->gravity), *v = model->velocity + 3;
    bool fits = ck_shape_is_chain(model) && model->particle_count == 2 && model->pin_count == 1 && model->pinned[0] &&
                g > 0 && is_undamped(model);
    if (fits) {
        ck_subtract(along, model->position + 3, model->position);
        for (int axis = 0; axis < 3; axis++) down[axis] = model->gravity[axis] / g;
        depth = ck_dot(along, down);
        for (int axis = 0; axis < 3; axis++) radius[axis] = along[axis] - depth * down[axis];
        // the spring carries the weight, and turns the speed; both as shares of what they should be
        const ck_Spring *spring = &model->springs[0];
        const double length = ck_length(along), pull = model->mass[1] * g * length / depth,
                     wanted = isinf(spring->stiffness) ? spring->rest : spring->rest + pull / spring->stiffness,
                     speed = ck_length(radius) * sqrt(g / depth);
        off = fmax(fabs(length / wanted - 1), fabs(ck_length(v) / speed - 1)) +
              (fabs(ck_dot(v, radius)) / ck_length(radius) + fabs(ck_dot(v, down))) / speed;
    }
    ck_Status status =
        ck_truth_need(depth > 0 && off < 1e-6, model, error,
                      "one spring or bar from a pin, undamped, whose mass starts on its circle: level, "
                      "across its radius r, at r*sqrt(g/h), and its spring as long as m*g*l/h stretches it");
    if (status) return status;
    ck_truth_start_from(model, position, velocity);
    const double rate = sqrt(g / depth), cosine = cos(rate * time), sine = sin(rate * time);
    for (int axis = 0; axis < 3; axis++) {
        position[3 + axis] = model->position[axis] + depth * down[axis] + cosine * radius[axis] + sine * v[axis] / rate;
        velocity[3 + axis] = cosine * v[axis] - sine * rate * radius[axis];
    }
    return CK_OK;
}

ck_Status ck_truth_plucked_mass(const ck_Model *model, double time, double *position, double *velocity,
                                ck_Error *error) {
    double line[3], pluck[3] = {0}, half = 0, amplitude = 0;
    bool fits = ck_shape_is_chain(model) && model->particle_count == 3 && model->pin_count == 2 && model->pinned[0] &&
                model->pinned[2] && is_undamped(model) && !(model->terms & (CK_TERM_GRAVITY | CK_TERM_VELOCITY)) &&
                model->springs[0].stiffness == model->springs[1].stiffness && isfinite(model->springs[0].stiffness);
    if (fits) {
        ck_subtract(line, model->position + 6, model->position);
        half = 0.5 * ck_length(line);
        for (int axis = 0; axis < 3; axis++)
            pluck[axis] = model->position[3 + axis] - 0.5 * (model->position[axis] + model->position[6 + axis]);
        amplitude = ck_length(pluck);
        for (int i = 0; i < 2; i++) fits &= fabs(model->springs[i].rest / half - 1) < 1e-9;
        fits &= fabs(ck_dot(pluck, line)) < 1e-9 * half * amplitude && amplitude > 0 && amplitude < 0.2 * half;
    }
    ck_Status status = ck_truth_need(fits, model, error,
                                     "a mass between two alike springs that are pinned at their other ends and have no "
                                     "tension along the line, plucked across it by less than a fifth of a spring");
    if (status) return status;
    double sn, cn, dn;
    const double rate = amplitude / half * sqrt(model->springs[0].stiffness / model->mass[1]);
    jacobi(rate * time, sqrt(0.5), &sn, &cn, &dn);
    ck_truth_start_from(model, position, velocity);
    for (int axis = 0; axis < 3; axis++) {
        position[3 + axis] += (cn - 1) * pluck[axis];
        velocity[3 + axis] = -rate * sn * dn * pluck[axis];
    }
    return CK_OK;
}
