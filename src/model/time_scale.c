#include "time_scale.h"

#include "hinges.h"
#include "path.h"
#include "shape.h"
#include "vector.h"
#include "wind.h"

#include <math.h>
#include <stdlib.h>

// Largest eigenvalue of a symmetric 3×3 matrix {xx, yy, zz, xy, xz, yz}.
// Source: Smith 1961, Eigenvalues of a symmetric 3×3 matrix.
static double largest_eigenvalue(const double *m) {
    double mean = (m[0] + m[1] + m[2]) / 3;
    double xx = m[0] - mean, yy = m[1] - mean, zz = m[2] - mean;
    double off = m[3] * m[3] + m[4] * m[4] + m[5] * m[5];
    double p = sqrt((xx * xx + yy * yy + zz * zz + 2 * off) / 6);
    if (!(p > 0)) return mean;
    double determinant =
        xx * (yy * zz - m[5] * m[5]) - m[3] * (m[3] * zz - m[5] * m[4]) + m[4] * (m[3] * m[5] - yy * m[4]);
    double r = determinant / (2 * p * p * p);
    return mean + 2 * p * cos(acos(fmax(-1, fmin(1, r))) / 3);
}

static void add_outer(double *m, double scale, const double *n) {
    m[0] += scale * n[0] * n[0];
    m[1] += scale * n[1] * n[1];
    m[2] += scale * n[2] * n[2];
    m[3] += scale * n[0] * n[1];
    m[4] += scale * n[0] * n[2];
    m[5] += scale * n[1] * n[2];
}

// 1/mass of a particle that is free at some time, else 0.
static double weight_ever(const ck_Model *model, int particle) {
    return ck_model_is_held(model, particle) ? 0 : 1 / model->mass[particle];
}

// The largest 2·w_i·λ_max(Σ value·n·nᵀ) over a particle's springs, of their stiffness or their damping.
static ck_Status largest_rate(const ck_Model *model, const double *position, double (*value)(const ck_Spring *spring),
                              double *largest) {
    *largest = 0;
    double(*sums)[6] = calloc((size_t)model->particle_count, sizeof *sums);
    if (!sums) return CK_NO_MEMORY;
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        double n[3];
        ck_subtract(n, position + 3 * spring->b, position + 3 * spring->a);
        double length = ck_length(n);
        if (!(length > 0)) continue;
        for (int axis = 0; axis < 3; axis++) n[axis] /= length;
        add_outer(sums[spring->a], value(spring), n);
        add_outer(sums[spring->b], value(spring), n);
    }
    for (int i = 0; i < model->particle_count; i++)
        if (!ck_model_is_held(model, i)) *largest = fmax(*largest, 2 * largest_eigenvalue(sums[i]) / model->mass[i]);
    free(sums);
    return CK_OK;
}

static double stiffness_of(const ck_Spring *spring) {
    return spring->stiffness;
}

static double damping_of(const ck_Spring *spring) {
    return spring->damping;
}

ck_Status ck_stability_frequency(const ck_Model *model, double *frequency) {
    return ck_stability_frequency_at(model, model->position, frequency);
}

ck_Status ck_stability_frequency_at(const ck_Model *model, const double *position, double *frequency) {
    double bending = 0;
    ck_Status status = largest_rate(model, position, stiffness_of, frequency);
    if (!status && model->hinge_count) status = ck_hinges_rate(model, &bending);
    *frequency = sqrt(*frequency + bending);
    return status;
}

double ck_stability_damping_rate(const ck_Model *model) {
    double rate;
    if (!(model->terms & CK_TERM_DAMPING)) return 0;
    // without memory the bound that no directions lower
    if (!largest_rate(model, model->position, damping_of, &rate)) return rate;
    for (int i = 0; i < model->spring_count; i++)
        rate = fmax(rate, 4 * model->springs[i].damping * model->spring_count * ck_stability_lightness(model));
    return rate;
}

double ck_stability_verlet_limit(double frequency, double damping) {
    double squared = frequency * frequency;
    return 2 * (sqrt(damping * damping + squared) - damping) / squared;
}

double ck_stability_damping_time(const ck_Model *model) {
    double longest = 0;
    for (int i = 0; i < model->spring_count; i++)
        longest = fmax(longest, model->springs[i].damping / model->springs[i].stiffness);
    return longest;
}

double ck_stability_stiffness_rate(const ck_Model *model) {
    double largest = 0;
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        double weight = weight_ever(model, spring->a) + weight_ever(model, spring->b);
        largest = fmax(largest, spring->stiffness * weight);
    }
    return largest;
}

double ck_stability_load(const ck_Model *model) {
    double load = 0;
    for (int i = 0; i < model->particle_count && (model->pin_count || model->collider_count); i++) {
        double field[3];
        ck_model_field(model, i, field);
        if (!ck_model_is_held(model, i)) load += model->mass[i] * ck_length(field);
    }
    return load;
}

double ck_stability_swing_load(const ck_Model *model) {
    double load = ck_stability_load(model), field[3], reach = 0, depth = 0, drop = 0, mass = 0, fastest = 0;
    ck_model_mean_field(model, field);
    double g = ck_length(field);
    if (!ck_shape_is_chain(model) || model->pin_count != 1 || !model->pinned[0] || !(g > 0)) return load;
    for (int i = 1; i < model->particle_count; i++) {
        double from[3];
        ck_subtract(from, model->position + 3 * i, model->position);
        reach += model->springs[i - 1].rest;
        depth += model->mass[i] * reach;
        drop += model->mass[i] * (reach - ck_dot(from, field) / g);
        mass += model->mass[i];
        fastest = fmax(fastest, ck_length(model->velocity + 3 * i));
    }
    return load * (1 + 2 * fmax(0, drop) / depth + fastest * fastest * mass / (g * depth));
}

double ck_stability_lightness(const ck_Model *model) {
    double largest = 0;
    for (int i = 0; i < model->particle_count; i++) largest = fmax(largest, weight_ever(model, i));
    return largest;
}

double ck_stability_transverse_time(const ck_Model *model) {
    double load = ck_stability_swing_load(model);
    return load > 0 ? sqrt(model->spacing / (ck_stability_lightness(model) * load)) : INFINITY;
}

double ck_stability_bar_time(const ck_Model *model, uint32_t iterations) {
    double load = ck_stability_swing_load(model), limit = 1.0 / 240;
    if (load > 0)
        limit = fmin(limit, sqrt(1e-3 * iterations * model->spacing / (ck_stability_lightness(model) * load)));
    return limit;
}

double ck_stability_bending_time(const ck_Model *model) {
    double rate;
    if (!model->hinge_count) return INFINITY;
    return ck_hinges_rate(model, &rate) ? 0 : 1 / sqrt(rate);
}

double ck_stability_drag_time(const ck_Model *model, double share) {
    const double rate = fmax(model->drag, model->wind.face_count ? ck_wind_rate(model) : 0);
    return rate > 0 ? share / rate : INFINITY;
}

uint32_t ck_stability_substeps(const ck_Model *model, double limit) {
    // a hair of slack, so that a limit of exactly one frame asks for one substep
    double count = ceil(model->step / fmin(limit, ck_path_longest_step(model)) * (1 - 1e-12));
    return (uint32_t)fmax(1, fmin(count, 100000));
}

uint32_t ck_stability_sweeps(const ck_Model *model) {
    int bars = 0;
    for (int i = 0; i < model->spring_count; i++)
        bars += !(model->pinned[model->springs[i].a] && model->pinned[model->springs[i].b]);
    return bars > 3 * (model->particle_count - model->pin_count) ? 4 : 1;
}
