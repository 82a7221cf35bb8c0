#include "bars.h"

#include "vector.h"

#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>

// Newton rounds of a projection; each squares the error.
#define ROUNDS 8
// |l² − L²|/2L² that counts as its length.
#define EXACT 1e-14

// Two bars that meet in a particle.
typedef struct Joint {
    int row, column; // of bars, row ≥ column
    int particle;
    double sign;
} Joint;

struct ck_Bars {
    const ck_Model *model;
    const bool *pinned;
    const ck_Spring **bars; // [count]
    int count;
    double (*directions)[3]; // [count] m, from first end to second, where the matrix was made
    Joint *joints;           // [joint_count] off the diagonal
    int joint_count;
    cholmod_common common;
    cholmod_triplet *triplet;
    cholmod_factor *factor;
    cholmod_dense *right;
};

static double inverse_mass(const ck_Bars *bars, int particle) {
    return bars->pinned[particle] ? 0 : 1 / bars->model->mass[particle];
}

// All pairs of bars at each particle, by bars in the order of their particles.
static bool find_joints(ck_Bars *bars) {
    const int particles = bars->model->particle_count;
    int *first = calloc((size_t)particles + 2, sizeof *first), *of = calloc(2 * (size_t)bars->count + 1, sizeof *of);
    size_t pairs = 0;
    if (first && of) {
        for (int i = 0; i < bars->count; i++) first[bars->bars[i]->a + 2]++, first[bars->bars[i]->b + 2]++;
        for (int i = 0; i < particles; i++) {
            pairs += (size_t)first[i + 2] * (size_t)(first[i + 2] - 1) / 2;
            first[i + 2] += first[i + 1];
        }
        for (int i = 0; i < bars->count; i++)
            of[first[bars->bars[i]->a + 1]++] = i, of[first[bars->bars[i]->b + 1]++] = i;
        bars->joints = malloc((pairs + 1) * sizeof *bars->joints);
    }
    for (int p = 0; p < particles && bars->joints; p++)
        for (int i = first[p]; i < first[p + 1]; i++)
            for (int k = first[p]; k < i; k++) {
                const ck_Spring *one = bars->bars[of[i]], *other = bars->bars[of[k]];
                bars->joints[bars->joint_count++] =
                    (Joint){of[i] > of[k] ? of[i] : of[k], of[i] > of[k] ? of[k] : of[i], p,
                            (one->a == p) == (other->a == p) ? 1 : -1};
            }
    free(first);
    free(of);
    return bars->joints;
}

ck_Status ck_bars_create(ck_Bars **out, const ck_Model *model, const bool *pinned, ck_Error *error) {
    *out = NULL;
    if (!(model->terms & CK_TERM_RIGID)) return CK_OK;
    ck_Bars *bars = calloc(1, sizeof *bars);
    if (!bars) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    cholmod_start(&bars->common);
    bars->common.print = 0;
    bars->common.quick_return_if_not_posdef = 1;
    bars->model = model;
    bars->pinned = pinned;
    bars->bars = malloc(((size_t)model->spring_count + 1) * sizeof *bars->bars);
    bars->directions = malloc(((size_t)model->spring_count + 1) * sizeof *bars->directions);
    for (int i = 0; i < model->spring_count && bars->bars; i++) {
        const ck_Spring *bar = &model->springs[i];
        const bool is_held = ck_model_is_held(model, bar->a) && ck_model_is_held(model, bar->b);
        if (isinf(bar->stiffness) && !is_held) bars->bars[bars->count++] = bar;
    }
    const size_t count = (size_t)bars->count;
    if (bars->bars && bars->directions && find_joints(bars)) {
        bars->triplet =
            cholmod_allocate_triplet(count, count, count + (size_t)bars->joint_count, -1, CHOLMOD_REAL, &bars->common);
        bars->right = cholmod_allocate_dense(count, 1, count, CHOLMOD_REAL, &bars->common);
    }
    if (bars->triplet && bars->right) {
        *out = bars;
        return CK_OK;
    }
    ck_bars_destroy(bars);
    return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
}

void ck_bars_destroy(ck_Bars *bars) {
    if (!bars) return;
    cholmod_free_triplet(&bars->triplet, &bars->common);
    cholmod_free_dense(&bars->right, &bars->common);
    cholmod_free_factor(&bars->factor, &bars->common);
    cholmod_finish(&bars->common);
    free(bars->joints);
    free(bars->directions);
    free(bars->bars);
    free(bars);
}

static void direction(const ck_Spring *bar, const double *position, double *d) {
    ck_subtract(d, position + 3 * bar->b, position + 3 * bar->a);
}

static void put(cholmod_triplet *triplet, int row, int column, double value) {
    ((int *)triplet->i)[triplet->nnz] = row;
    ((int *)triplet->j)[triplet->nnz] = column;
    ((double *)triplet->x)[triplet->nnz++] = value;
}

// J·M⁻¹·Jᵀ, where bar i's row of J is −d at its first end and d at its second.
static bool factorise(ck_Bars *bars, const double *position) {
    cholmod_triplet *triplet = bars->triplet;
    triplet->nnz = 0;
    for (int i = 0; i < bars->count; i++) {
        const double weight = inverse_mass(bars, bars->bars[i]->a) + inverse_mass(bars, bars->bars[i]->b);
        double *d = bars->directions[i];
        direction(bars->bars[i], position, d);
        put(triplet, i, i, weight > 0 ? weight * ck_dot(d, d) : 1);
    }
    for (int i = 0; i < bars->joint_count; i++) {
        const Joint *joint = &bars->joints[i];
        const double along = ck_dot(bars->directions[joint->row], bars->directions[joint->column]);
        put(triplet, joint->row, joint->column, joint->sign * inverse_mass(bars, joint->particle) * along);
    }
    cholmod_sparse *matrix = cholmod_triplet_to_sparse(triplet, 0, &bars->common);
    if (!matrix) return false;
    if (!bars->factor) bars->factor = cholmod_analyze(matrix, &bars->common);
    if (bars->factor) cholmod_factorize(matrix, bars->factor, &bars->common);
    cholmod_free_sparse(&matrix, &bars->common);
    return bars->factor && bars->common.status == CHOLMOD_OK && bars->factor->minor == bars->factor->n;
}

// Solves for the multipliers of what right holds, and adds M⁻¹·Jᵀ times them.
static bool add_pulls(ck_Bars *bars, double *out) {
    cholmod_dense *solved = cholmod_solve(CHOLMOD_A, bars->factor, bars->right, &bars->common);
    if (!solved) return false;
    for (int i = 0; i < bars->count; i++) {
        const ck_Spring *bar = bars->bars[i];
        const double multiplier = ((double *)solved->x)[i];
        const double *d = bars->directions[i];
        ck_add_scaled(out + 3 * bar->a, -inverse_mass(bars, bar->a) * multiplier, d);
        ck_add_scaled(out + 3 * bar->b, inverse_mass(bars, bar->b) * multiplier, d);
    }
    cholmod_free_dense(&solved, &bars->common);
    return true;
}

static bool is_between_pins(const ck_Bars *bars, const ck_Spring *bar) {
    return bars->pinned[bar->a] && bars->pinned[bar->b];
}

bool ck_bars_accelerate(ck_Bars *bars, const double *position, const double *velocity, double *acceleration) {
    double d[3], v[3], a[3];
    for (int i = 0; i < bars->count; i++) {
        const ck_Spring *bar = bars->bars[i];
        direction(bar, position, d);
        direction(bar, velocity, v);
        direction(bar, acceleration, a);
        ((double *)bars->right->x)[i] = is_between_pins(bars, bar) ? 0 : -ck_dot(v, v) - ck_dot(d, a);
    }
    return factorise(bars, position) && add_pulls(bars, acceleration);
}

bool ck_bars_project(ck_Bars *bars, double *position, double *velocity) {
    double d[3], v[3], largest = INFINITY;
    for (int round = 0; round < ROUNDS; round++) {
        const double before = largest;
        largest = 0;
        for (int i = 0; i < bars->count; i++) {
            const ck_Spring *bar = bars->bars[i];
            direction(bar, position, d);
            const double off = is_between_pins(bars, bar) ? 0 : 0.5 * (bar->rest * bar->rest - ck_dot(d, d));
            ((double *)bars->right->x)[i] = off;
            largest = fmax(largest, fabs(off) / (bar->rest * bar->rest));
        }
        // by rounding it may never get closer
        if (largest <= EXACT || (largest < 100 * EXACT && largest >= 0.5 * before)) break;
        if (!(largest < INFINITY) || !factorise(bars, position) || !add_pulls(bars, position)) return false;
    }
    if (!(largest < 100 * EXACT)) return false;
    for (int i = 0; i < bars->count; i++) {
        direction(bars->bars[i], position, d);
        direction(bars->bars[i], velocity, v);
        ((double *)bars->right->x)[i] = is_between_pins(bars, bars->bars[i]) ? 0 : -ck_dot(d, v);
    }
    return factorise(bars, position) && add_pulls(bars, velocity);
}
