#include "bending_forms.h"

#include "rest_forms.h"
#include "vector.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

// Steps of the fourth order between two nodes: of 40 nodes, halving them moves the tip by less than 1e-12 up to
// wL³/EI = 1e3.
#define STEPS 64

// An elastica from its tip on, σ = L − s, and φ its angle from straight down: φ'' = (load·σ + end)·sin φ.
typedef struct Elastica {
    double load, end; // w/EI, 1/m³, and P/EI, 1/m²
} Elastica;

// Angle, its slope, and how far down and sideways it has come, m.
typedef struct Section {
    double angle, slope, down, aside;
} Section;

static Section rate(const Elastica *elastica, double from_tip, const Section *at) {
    return (Section){at->slope, (elastica->load * from_tip + elastica->end) * sin(at->angle), cos(at->angle),
                     sin(at->angle)};
}

static Section moved(const Section *at, const Section *by, double step) {
    return (Section){at->angle + step * by->angle, at->slope + step * by->slope, at->down + step * by->down,
                     at->aside + step * by->aside};
}

// Goes on by a length in steps of the classical fourth order, or until it has turned beyond an angle: there it would
// only wind to and fro. Source: Kutta 1901.
static void follow(const Elastica *elastica, Section *at, double from_tip, double length, int steps, double beyond) {
    const double h = length / steps;
    for (int i = 0; i < steps && at->angle <= beyond; i++) {
        const double here = from_tip + i * h;
        const Section k1 = rate(elastica, here, at), half = moved(at, &k1, h / 2),
                      k2 = rate(elastica, here + h / 2, &half), second = moved(at, &k2, h / 2),
                      k3 = rate(elastica, here + h / 2, &second), end = moved(at, &k3, h),
                      k4 = rate(elastica, here + h, &end);
        const Section mean = {(k1.angle + 2 * k2.angle + 2 * k3.angle + k4.angle) / 6,
                              (k1.slope + 2 * k2.slope + 2 * k3.slope + k4.slope) / 6,
                              (k1.down + 2 * k2.down + 2 * k3.down + k4.down) / 6,
                              (k1.aside + 2 * k2.aside + 2 * k3.aside + k4.aside) / 6};
        *at = moved(at, &mean, h);
    }
}

// True where a tip at an angle of that logarithm turns the clamp by no more than wanted.
static bool turns_less(const Elastica *elastica, double logarithm, double wanted, double length, int steps) {
    Section at = {.angle = exp(logarithm)};
    follow(elastica, &at, 0, length, steps, wanted);
    return at.angle <= wanted;
}

// The angle of the tip for which the clamp, a length away, has the one wanted: by halving its logarithm, as a long
// elastica hangs down but for a small angle. Both grow together.
static double shoot(const Elastica *elastica, double wanted, double length, int steps) {
    double low = log(wanted) - 700, high = log(wanted);
    // a coarse one says where, if it is as good as that
    const double coarse = steps > 1000 ? log(shoot(elastica, wanted, length, steps / 16)) : high;
    if (coarse < high && turns_less(elastica, coarse - 1e-4, wanted, length, steps) &&
        !turns_less(elastica, coarse + 1e-4, wanted, length, steps)) {
        low = coarse - 1e-4;
        high = coarse + 1e-4;
    }
    for (int i = 0; i < 200 && high - low > 1e-16 * fabs(low); i++) {
        const double middle = 0.5 * (low + high);
        *(turns_less(elastica, middle, wanted, length, steps) ? &low : &high) = middle;
    }
    return exp(0.5 * (low + high));
}

double ck_truth_elastica_droop(double load) {
    const Elastica elastica = {load, 0};
    const int steps = 160 * STEPS;
    Section at = {.angle = shoot(&elastica, M_PI / 2, 1, steps)};
    follow(&elastica, &at, 0, 1, steps, M_PI);
    return at.down;
}

// True for a rope whose particles start in a line, alike but for the last, with the first two pinned.
static bool is_held_rope(const ck_Model *model) {
    const int last = model->particle_count - 1;
    bool fits = model->body == CK_ROPE && last >= 3 && model->pin_count == 2 && model->pinned[0] && model->pinned[1] &&
                model->bending > 0 && model->spring_count == last && !(model->terms & CK_TERM_FORCE) &&
                !model->collider_count && model->hinges[0].rest == 0;
    for (int i = 0; i < last && fits; i++) fits = model->springs[i].kind == CK_STRUCTURAL;
    return fits;
}

ck_Status ck_truth_cantilever(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error) {
    (void)time;
    double along[3], down[3], aside[3], g = ck_length(model->gravity);
    ck_subtract(along, model->position + 3, model->position);
    const double spacing = ck_length(along);
    for (int axis = 0; axis < 3; axis++) along[axis] /= spacing;
    for (int axis = 0; axis < 3 && g > 0; axis++) down[axis] = model->gravity[axis] / g;
    const double cosine = g > 0 ? ck_dot(along, down) : 1, sine = sqrt(fmax(0, 1 - cosine * cosine));
    ck_Status status = ck_truth_need(
        is_held_rope(model) && g > 0 && sine > 1e-9, model, error,
        "a straight rope without second neighbours whose bending rests flat, with its first two particles "
        "pinned alone, in gravity that is not along it");
    if (status) return status;
    for (int axis = 0; axis < 3; axis++) aside[axis] = (along[axis] - cosine * down[axis]) / sine;
    const int last = model->particle_count - 1;
    const double weight = model->mass[1] * g,
                 length = (last - 0.5) * spacing, // from the middle of the first segment
        bending = model->bending;
    const Elastica elastica = {weight / spacing / bending, (model->mass[last] * g - 0.5 * weight) / bending};
    // half steps in the clamp's half segment
    const double wanted = acos(cosine);
    Section at = {.angle = shoot(&elastica, wanted, length, (last - 1) * STEPS + STEPS / 2)};
    memset(velocity, 0, 3 * sizeof(double) * (size_t)model->particle_count);
    memcpy(position, model->position, 6 * sizeof(double));
    // places as seen from the tip, then from the second particle
    for (int i = last; i >= 1; i--) {
        for (int axis = 0; axis < 3 && i > 1; axis++)
            position[3 * i + axis] = -at.down * down[axis] - at.aside * aside[axis];
        if (i > 1) follow(&elastica, &at, (last - i) * spacing, spacing, STEPS, M_PI);
    }
    for (int i = 2; i <= last; i++)
        for (int axis = 0; axis < 3; axis++)
            position[3 * i + axis] += model->position[3 + axis] + at.down * down[axis] + at.aside * aside[axis];
    return CK_OK;
}

double ck_truth_cantilever_off(const ck_Model *model) {
    const double weight = ck_model_free_mass(model) * ck_length(model->gravity);
    return 0.5 * weight / (model->springs[0].stiffness * model->springs[0].rest);
}
