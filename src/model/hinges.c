#include "hinges.h"

#include "vector.h"

#include <math.h>
#include <stdlib.h>

// The angle of a vector of length r: 2·asin(r/2), which has no end where bars stretch.
static double angle_of(double r) {
    return r * (1 + r * r / 24);
}

static void vector_of(double *vector, const ck_Hinge *hinge, const double *position) {
    vector[0] = vector[1] = vector[2] = 0;
    for (int i = 0; i < 4; i++)
        if (hinge->particles[i] >= 0) ck_add_scaled(vector, hinge->weights[i], position + 3 * hinge->particles[i]);
}

double ck_hinge_angle(const ck_Hinge *hinge, const double *position) {
    double vector[3];
    vector_of(vector, hinge, position);
    return angle_of(ck_length(vector));
}

// With E = ½·s·(g − g₀)², g = r + r³/24: E' = s·(g − g₀)·g', E'' = s·(g'² + (g − g₀)·g''), g' = 1 + r²/8, g'' = r/4.
ck_HingeState ck_hinge_state(const ck_Hinge *hinge, const double *position) {
    ck_HingeState state;
    vector_of(state.vector, hinge, position);
    const double squared = ck_dot(state.vector, state.vector), r = sqrt(squared), s = hinge->stiffness;
    const double slope = 1 + squared / 8, over = angle_of(r) - hinge->rest;
    state.energy = 0.5 * s * over * over;
    // g/r, which is 1 where it is flat; a rest that is not flat gives a flat one no direction to turn to
    const double share = hinge->rest > 0 ? (r > 0 ? over / r : 0) : 1 + squared / 24;
    state.pull = s * share * slope;
    state.turn = squared > 0 ? s * (slope * slope + 0.25 * over * r - share * slope) / squared : 0;
    return state;
}

double ck_hinges_energy(const ck_Model *model, const double *position) {
    double energy = 0;
    for (int i = 0; i < model->hinge_count; i++) energy += ck_hinge_state(&model->hinges[i], position).energy;
    return energy;
}

void ck_hinges_add_force(const ck_Model *model, const double *position, double factor, const double *by, double *out) {
    for (int i = 0; i < model->hinge_count; i++) {
        const ck_Hinge *hinge = &model->hinges[i];
        const ck_HingeState state = ck_hinge_state(hinge, position);
        for (int k = 0; k < 4; k++) {
            const int particle = hinge->particles[k];
            if (particle >= 0)
                ck_add_scaled(out + 3 * particle, -factor * hinge->weights[k] * state.pull * (by ? by[particle] : 1),
                              state.vector);
        }
    }
}

ck_Status ck_hinges_rate(const ck_Model *model, double *rate) {
    *rate = 0;
    double *rows = calloc((size_t)model->particle_count, sizeof *rows);
    if (!rows) return CK_NO_MEMORY;
    for (int i = 0; i < model->hinge_count; i++) {
        const ck_Hinge *hinge = &model->hinges[i];
        double shares[4] = {0}, sum = 0;
        for (int k = 0; k < 4; k++) {
            const int particle = hinge->particles[k];
            if (particle >= 0 && !ck_model_is_held(model, particle))
                shares[k] = fabs(hinge->weights[k]) / sqrt(model->mass[particle]);
            sum += shares[k];
        }
        for (int k = 0; k < 4; k++)
            if (shares[k] > 0) rows[hinge->particles[k]] += hinge->stiffness * shares[k] * sum;
    }
    for (int i = 0; i < model->particle_count; i++) *rate = fmax(*rate, rows[i]);
    free(rows);
    return CK_OK;
}

const char *ck_hinges_unit(const ck_Model *model) {
    return model->body == CK_ROPE ? "N*m2" : "N*m";
}
