#include "equilibrium.h"

#include "hinges.h"
#include "process.h"
#include "settling.h"
#include "time_scale.h"
#include "touching.h"
#include "vector.h"
#include "wind.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>

#define MAX_ITERATIONS 2000

typedef struct Newton {
    const ck_Model *model;
    ck_Touching *touching; // NULL: nothing can touch
    int *unknown;          // [n] of each particle, −1 where pinned
    int unknowns;          // free particles
    double load;           // N
    double scale;          // N/m, the stiffest spring: what μ is measured in
    cholmod_common common;
    cholmod_triplet *triplet;
    cholmod_factor *factor;
    cholmod_dense *gradient;
    double *position, *trial; // [3*n]
    bool is_starved;          // CHOLMOD found no memory
} Newton;

// Energy, and its gradient over all coordinates, pinned ones too, where gradient is not NULL.
static double energy_of(const ck_Model *model, const double *position, double *gradient) {
    double energy = 0;
    if (gradient) memset(gradient, 0, 3 * sizeof(double) * (size_t)model->particle_count);
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        double d[3];
        ck_subtract(d, position + 3 * spring->b, position + 3 * spring->a);
        double length = ck_length(d), stretch = length - spring->rest;
        if (spring->pulls_only && stretch < 0) continue;
        energy += 0.5 * spring->stiffness * stretch * stretch;
        if (!gradient || !(length > 0)) continue;
        ck_add_scaled(gradient + 3 * spring->a, -spring->stiffness * stretch / length, d);
        ck_add_scaled(gradient + 3 * spring->b, spring->stiffness * stretch / length, d);
    }
    energy += ck_hinges_energy(model, position);
    if (gradient) ck_hinges_add_force(model, position, -1, NULL, gradient);
    for (int i = 0; i < model->particle_count; i++) {
        double field[3], moved[3];
        if (model->pinned[i]) continue;
        ck_model_field(model, i, field);
        ck_subtract(moved, position + 3 * i, model->position + 3 * i);
        energy -= model->mass[i] * ck_dot(field, moved);
        if (gradient) ck_add_scaled(gradient + 3 * i, -model->mass[i], field);
    }
    return energy;
}

// With that of contact.
static double whole_energy(const Newton *newton, const double *position, double *gradient) {
    const double energy = energy_of(newton->model, position, gradient);
    return newton->touching ? energy + ck_touching_energy(newton->touching, position, gradient) : energy;
}

// N/m, of springs
static double stiffest_of(const ck_Model *model) {
    double stiffest = 0;
    for (int i = 0; i < model->spring_count; i++) stiffest = fmax(stiffest, model->springs[i].stiffness);
    return stiffest;
}

double ck_equilibrium_tolerance(const ck_Model *model) {
    const double rounding =
        DBL_EPSILON * stiffest_of(model) * model->size * sqrt(3.0 * model->particle_count) / ck_stability_load(model);
    return fmax(CK_EQUILIBRIUM_RESIDUAL, rounding);
}

double ck_equilibrium_energy(const ck_Model *model, const double *position) {
    return energy_of(model, position, NULL);
}

static double norm_of_free(const ck_Model *model, const double *gradient) {
    double sum = 0;
    for (int i = 0; i < model->particle_count; i++)
        if (!model->pinned[i]) sum += ck_dot(gradient + 3 * i, gradient + 3 * i);
    return sqrt(sum);
}

// What counts as touched, of the size: contact is found to some 1e-15 of it.
#define NEAR 1e-9

double ck_equilibrium_residual(const ck_Model *model, const double *position) {
    double *gradient = malloc(3 * sizeof(double) * (size_t)model->particle_count);
    if (!gradient) return -1;
    const double origin[3] = {0};
    ck_Touching *touching;
    bool is_outside = true;
    energy_of(model, position, gradient);
    ck_Status status = ck_touching_create(&touching, model, origin, 1);
    if (!status && touching) is_outside = ck_touching_hold(touching, position, NEAR * model->size, gradient);
    double residual = is_outside ? norm_of_free(model, gradient) / ck_stability_load(model) : INFINITY;
    ck_touching_free(touching);
    free(gradient);
    return status ? -1 : residual;
}

// Adds one 3×3 block below or on the diagonal; the triplet's duplicates are summed by CHOLMOD.
static void add_block(Newton *newton, int row, int column, const double *block, double sign) {
    cholmod_triplet *triplet = newton->triplet;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int r = 3 * row + i, c = 3 * column + j;
            if (r < c) continue;
            ((int *)triplet->i)[triplet->nnz] = r;
            ((int *)triplet->j)[triplet->nnz] = c;
            ((double *)triplet->x)[triplet->nnz++] = sign * block[3 * i + j];
        }
}

// w_i·w_j·(pull·I + turn·v·vᵀ) for each pair of a hinge's particles.
static void add_hinge(Newton *newton, const ck_Hinge *hinge) {
    const ck_HingeState state = ck_hinge_state(hinge, newton->position);
    double block[9];
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            block[3 * row + column] =
                state.turn * state.vector[row] * state.vector[column] + (row == column ? state.pull : 0);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k <= i; k++) {
            if (hinge->particles[i] < 0 || hinge->particles[k] < 0) continue;
            const int a = newton->unknown[hinge->particles[i]], b = newton->unknown[hinge->particles[k]];
            if (a >= 0 && b >= 0)
                add_block(newton, a > b ? a : b, a > b ? b : a, block, hinge->weights[i] * hinge->weights[k]);
        }
}

// A pair that may touch. Of one that does not, zeros keep the pattern that the factor is of.
static void add_pair(Newton *newton, const ck_TouchingPair *pair) {
    double block[9] = {0};
    const bool touches = ck_touching_block(newton->touching, pair, newton->position, block);
    const int a = newton->unknown[pair->particle], b = pair->other < 0 ? -1 : newton->unknown[pair->other];
    if (!touches && (a < 0 || b < 0)) return;
    if (a >= 0) add_block(newton, a, a, block, 1);
    if (b >= 0) add_block(newton, b, b, block, 1);
    if (a >= 0 && b >= 0) add_block(newton, a > b ? a : b, a > b ? b : a, block, -1);
}

// k·[n·nᵀ + (1 − L/l)·(I − n·nᵀ)] of every spring, and shift on the diagonal.
static void assemble(Newton *newton, double shift) {
    const ck_Model *model = newton->model;
    newton->triplet->nnz = 0;
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        double d[3], block[9];
        ck_subtract(d, newton->position + 3 * spring->b, newton->position + 3 * spring->a);
        double length = ck_length(d), across = 1 - spring->rest / length;
        if (spring->pulls_only && across < 0) continue;
        for (int row = 0; row < 3; row++)
            for (int column = 0; column < 3; column++)
                block[3 * row + column] = spring->stiffness * ((1 - across) * d[row] * d[column] / (length * length) +
                                                               (row == column ? across : 0));
        int a = newton->unknown[spring->a], b = newton->unknown[spring->b];
        if (a >= 0) add_block(newton, a, a, block, 1);
        if (b >= 0) add_block(newton, b, b, block, 1);
        if (a >= 0 && b >= 0) add_block(newton, a > b ? a : b, a > b ? b : a, block, -1);
    }
    for (int i = 0; i < model->hinge_count; i++) add_hinge(newton, &model->hinges[i]);
    for (int i = 0; newton->touching && i < newton->touching->count; i++) add_pair(newton, &newton->touching->pairs[i]);
    const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int i = 0; i < newton->unknowns; i++) add_block(newton, i, i, identity, shift);
}

// Factorises the Hessian plus shift·I. False where that is not positive definite, or there is no memory.
static bool factorise(Newton *newton, double shift) {
    assemble(newton, shift);
    cholmod_sparse *hessian = cholmod_triplet_to_sparse(newton->triplet, 0, &newton->common);
    if (hessian && !newton->factor) newton->factor = cholmod_analyze(hessian, &newton->common);
    newton->is_starved |= !newton->factor;
    if (newton->factor) cholmod_factorize(hessian, newton->factor, &newton->common);
    newton->is_starved |= !hessian || newton->common.status == CHOLMOD_OUT_OF_MEMORY;
    bool definite =
        !newton->is_starved && newton->common.status == CHOLMOD_OK && newton->factor->minor == newton->factor->n;
    cholmod_free_sparse(&hessian, &newton->common);
    return definite;
}

//   touching  taken over; NULL: none
static ck_Status start_newton(Newton *newton, const ck_Model *model, ck_Touching *touching, const double *start) {
    *newton = (Newton){.model = model, .touching = touching, .load = ck_stability_load(model)};
    size_t count = (size_t)model->particle_count;
    newton->unknown = malloc(count * sizeof(int));
    newton->position = malloc(3 * count * sizeof(double));
    newton->trial = malloc(3 * count * sizeof(double));
    cholmod_start(&newton->common);
    newton->common.print = 0;
    newton->common.quick_return_if_not_posdef = 1;
    newton->common.final_ll = 1; // LDLᵀ would go on past a negative pivot
    if (!newton->unknown || !newton->position || !newton->trial) return CK_NO_MEMORY;
    memcpy(newton->position, start, 3 * count * sizeof(double));
    for (size_t i = 0; i < count; i++) newton->unknown[i] = model->pinned[i] ? -1 : newton->unknowns++;
    newton->scale = stiffest_of(model);
    const size_t pairs = newton->touching ? (size_t)newton->touching->count : 0;
    size_t size = 3 * (size_t)newton->unknowns, entries = 21 * ((size_t)model->spring_count + pairs) +
                                                          78 * (size_t)model->hinge_count +
                                                          6 * (size_t)newton->unknowns;
    newton->triplet = cholmod_allocate_triplet(size, size, entries, -1, CHOLMOD_REAL, &newton->common);
    newton->gradient = cholmod_allocate_dense(size, 1, size, CHOLMOD_REAL, &newton->common);
    return newton->triplet && newton->gradient ? CK_OK : CK_NO_MEMORY;
}

static void end_newton(Newton *newton) {
    cholmod_free_triplet(&newton->triplet, &newton->common);
    cholmod_free_dense(&newton->gradient, &newton->common);
    cholmod_free_factor(&newton->factor, &newton->common);
    cholmod_finish(&newton->common);
    ck_touching_free(newton->touching);
    free(newton->unknown);
    free(newton->trial);
    free(newton->position);
}

static void pack(const Newton *newton, const double *all) {
    for (int i = 0; i < newton->model->particle_count; i++)
        if (newton->unknown[i] >= 0)
            memcpy((double *)newton->gradient->x + 3 * newton->unknown[i], all + 3 * i, 3 * sizeof(double));
}

// Halves the step until the energy falls, or, where rounding hides that, the residual does. False where neither does.
static bool search_line(Newton *newton, const double *step, double *energy, double *residual, double *gradient) {
    const ck_Model *model = newton->model;
    for (double length = 1; length > 1e-10; length *= 0.5) {
        memcpy(newton->trial, newton->position, 3 * sizeof(double) * (size_t)model->particle_count);
        for (int i = 0; i < model->particle_count; i++)
            if (newton->unknown[i] >= 0) ck_add_scaled(newton->trial + 3 * i, -length, step + 3 * newton->unknown[i]);
        double trial_energy = whole_energy(newton, newton->trial, gradient),
               trial_residual = norm_of_free(model, gradient) / newton->load;
        bool flat = fabs(trial_energy - *energy) <= 1e-12 * fmax(fabs(*energy), newton->load * model->size * 1e-3);
        if (!(trial_energy < *energy && !flat) && !(flat && trial_residual < *residual)) continue;
        double *swapped = newton->position;
        newton->position = newton->trial;
        newton->trial = swapped;
        *energy = trial_energy;
        *residual = trial_residual;
        return true;
    }
    return false;
}

// So many steps in which the energy only rounds and the residual is not halved end on a saddle: a step off it is told
// from rounding by its residual alone, and comes to nothing.
#define STANDSTILL 100

typedef struct Progress {
    double energy, residual;
} Progress;

// True where so many steps came to nothing; asked after each.
static bool stands_still(Progress *last, int iteration, double energy, double residual) {
    if ((iteration + 1) % STANDSTILL) return false;
    const bool falls = last->energy - energy > 1e-12 * fabs(energy);
    const bool is_still = !falls && !(residual < 0.5 * last->residual);
    *last = (Progress){energy, residual};
    return is_still;
}

// Iterates until no step improves any more, which is beyond the residual that is asked for: a truth's last digits
// count.
static int iterate(Newton *newton, double *energy, double *residual, double *gradient) {
    double shift = 0;
    int iteration = 0;
    Progress last = {INFINITY, INFINITY};
    *energy = whole_energy(newton, newton->position, gradient);
    *residual = norm_of_free(newton->model, gradient) / newton->load;
    for (; iteration < MAX_ITERATIONS && !ck_child_interrupted; iteration++) {
        bool definite = factorise(newton, shift);
        while (!definite && !newton->is_starved && shift < 1e6 * newton->scale) {
            shift = fmax(4 * shift, 1e-6 * newton->scale);
            definite = factorise(newton, shift);
        }
        whole_energy(newton, newton->position, gradient);
        pack(newton, gradient);
        cholmod_dense *step =
            definite ? cholmod_solve(CHOLMOD_A, newton->factor, newton->gradient, &newton->common) : NULL;
        newton->is_starved |= definite && !step;
        double before = *residual;
        bool moved = step && search_line(newton, step->x, energy, residual, gradient);
        cholmod_free_dense(&step, &newton->common);
        if (!moved || stands_still(&last, iteration, *energy, *residual)) break;
        if (shift == 0 && *residual<CK_EQUILIBRIUM_RESIDUAL && * residual> 0.5 * before) break; // rounding is reached
        shift = shift > 1e-9 * newton->scale ? shift / 10 : 0;
    }
    return iteration;
}

// Positions about the body's first particle: far from the origin doubles would tell neighbours apart by less.
static double *about_first(const ck_Model *model, const double *position) {
    double *moved = malloc(3 * sizeof(double) * (size_t)model->particle_count);
    for (int i = 0; moved && i < 3 * model->particle_count; i++) moved[i] = position[i] - model->position[i % 3];
    return moved;
}

static ck_Status check(const ck_Model *model, ck_Error *error) {
    const unsigned beyond = CK_TERM_RIGID | CK_TERM_RELEASE | CK_TERM_MOVES | CK_TERM_MOVING_COLLIDERS;
    if ((model->terms & beyond) || !model->pin_count || !(ck_stability_load(model) > 0) || ck_wind_blows(model))
        return ck_fail(error, CK_REFUSED,
                       "%s: equilibrium needs pins that stay, a load, springs that stretch, still air and colliders "
                       "that stay",
                       model->name);
    bool rubs = false, turns = false;
    for (int i = 0; i < model->collider_count; i++) rubs |= model->colliders[i].friction > 0;
    for (int i = 0; i < model->rigid_count; i++) {
        rubs |= model->rigid[i].shape.friction > 0;
        turns |= model->rigid[i].shape.shape != CK_SPHERE;
    }
    if (rubs)
        return ck_fail(error, CK_REFUSED, "%s: with friction a body rests in many places: there is no one equilibrium",
                       model->name);
    return turns
               ? ck_fail(error, CK_REFUSED, "%s: how a box that moves rests is not solved; take a sphere", model->name)
               : CK_OK;
}

// Rounds in which forces of contact are found, by the stiffness below a hundredth of the rest of the last each; and how
// far gaps may be off, / size.
#define CONTACT_ROUNDS 60
#define CONTACT_STIFFNESS 100
#define CONTACT_GAP 1e-14

// Newton, and where something may touch again with the forces that it makes, until these stay.
static void minimise(Newton *newton, ck_Equilibrium *equilibrium, double *gradient) {
    double last = INFINITY;
    for (int round = 0; round < CONTACT_ROUNDS && !ck_child_interrupted; round++) {
        equilibrium->iterations += iterate(newton, &equilibrium->energy, &equilibrium->residual, gradient);
        if (!newton->touching) return;
        const double off = ck_touching_update(newton->touching, newton->position) / newton->model->size;
        equilibrium->gap = off;
        // what is rounded does not get less
        if (off <= CONTACT_GAP || (off < 1e-11 && off > 0.5 * last)) return;
        last = off;
    }
}

ck_Status ck_equilibrium_solve(ck_Equilibrium *equilibrium, const ck_Model *model, const double *start,
                               ck_Error *error) {
    *equilibrium = (ck_Equilibrium){0};
    if (check(model, error)) return CK_REFUSED;
    Newton newton = {0};
    ck_Model near = *model;
    near.position = about_first(model, model->position);
    double *begin = about_first(model, start);
    ck_Touching *touching = NULL;
    ck_Status status = near.position && begin ? ck_touching_create(&touching, model, model->position,
                                                                   CONTACT_STIFFNESS * stiffest_of(model))
                                              : CK_NO_MEMORY;
    if (!status) status = start_newton(&newton, &near, touching, begin);
    double *gradient = malloc(3 * sizeof(double) * (size_t)model->particle_count);
    if (status || !gradient) {
        status = ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
        goto cleanup;
    }
    minimise(&newton, equilibrium, gradient);
    equilibrium->is_minimum = factorise(&newton, 0);
    if (newton.is_starved) {
        status = ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
        goto cleanup;
    }
    equilibrium->position = newton.position;
    newton.position = NULL;
    for (int i = 0; i < 3 * model->particle_count; i++) equilibrium->position[i] += model->position[i % 3];
    if (!(equilibrium->gap <= 1e-9) || !(equilibrium->residual <= ck_equilibrium_tolerance(model)) ||
        !equilibrium->is_minimum)
        status =
            ck_fail(error, CK_REFUSED, "%s: no stable equilibrium: Newton stopped at %.2g of the load%s", model->name,
                    equilibrium->residual, equilibrium->is_minimum ? "" : ", where the energy has no minimum");
cleanup:
    free(gradient);
    free(begin);
    free(near.position);
    end_newton(&newton);
    return status;
}

struct ck_Stiffness {
    Newton newton;
};

ck_Status ck_stiffness_create(ck_Stiffness **out, const ck_Model *model, const double *position) {
    ck_Stiffness *stiffness = *out = calloc(1, sizeof *stiffness);
    if (!stiffness) return CK_NO_MEMORY;
    ck_Status status = start_newton(&stiffness->newton, model, NULL, position);
    if (!status && !factorise(&stiffness->newton, 0)) status = stiffness->newton.is_starved ? CK_NO_MEMORY : CK_REFUSED;
    if (!status) return CK_OK;
    ck_stiffness_destroy(stiffness);
    *out = NULL;
    return status;
}

ck_Status ck_stiffness_solve(ck_Stiffness *stiffness, const double *force, double *moved) {
    Newton *newton = &stiffness->newton;
    pack(newton, force);
    cholmod_dense *step = cholmod_solve(CHOLMOD_A, newton->factor, newton->gradient, &newton->common);
    if (!step) return CK_NO_MEMORY;
    memset(moved, 0, 3 * sizeof(double) * (size_t)newton->model->particle_count);
    for (int i = 0; i < newton->model->particle_count; i++)
        if (newton->unknown[i] >= 0)
            memcpy(moved + 3 * i, (double *)step->x + 3 * newton->unknown[i], 3 * sizeof(double));
    cholmod_free_dense(&step, &newton->common);
    return CK_OK;
}

void ck_stiffness_destroy(ck_Stiffness *stiffness) {
    if (!stiffness) return;
    end_newton(&stiffness->newton);
    free(stiffness);
}

ck_Status ck_equilibrium_release(ck_Equilibrium *equilibrium, const ck_Model *model, double nudge, uint64_t seed,
                                 ck_Error *error) {
    *equilibrium = (ck_Equilibrium){0};
    if (check(model, error)) return CK_REFUSED;
    double *position = malloc(3 * sizeof(double) * (size_t)model->particle_count);
    if (!position) return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
    ck_Status status = ck_settle(model, nudge, seed, stiffest_of(model), position, error);
    if (!status) status = ck_equilibrium_solve(equilibrium, model, position, error);
    free(position);
    return status;
}

void ck_equilibrium_free(ck_Equilibrium *equilibrium) {
    free(equilibrium->position);
    *equilibrium = (ck_Equilibrium){0};
}
