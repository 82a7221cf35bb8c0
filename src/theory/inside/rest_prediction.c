#include "rest_prediction.h"

#include "constraint_kernel.h"
#include "equilibrium.h"
#include "shape.h"
#include "time_scale.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

#define ROUNDS 400
// The longest way, / size, that a round may still move a particle: rounding; and what is as good as at rest.
#define STILL 1e-13
#define RESOLVED 1e-9

// One substep of a method from a state without speed.
typedef struct Substep {
    const ck_Model *model;
    ck_Method method;
    const ck_Settings *used;
    const ck_Spring **order; // [springs] as the sweep comes to them
    double dt, eased;        // s; what drag leaves of the field's push
    double found;            // the share of a place's pulls that a substep finds anew: the rest it begins with
    double *line;            // [5*springs] what solving lines needs
    double *tension;         // [springs] N, in that order: what all sweeps have corrected by, / (found·dt²)
} Substep;

// XPBD's Δλ of one sweep; a bar has no compliance and no damping.
static double xpbd_correction(const Substep *step, const ck_Spring *spring, double length, double start_along,
                              double lambda, double weight) {
    double dt = step->dt, k = spring->stiffness;
    double inverse = step->used->softness > 0 ? step->used->softness : 1 / k;
    double compliance = inverse / (dt * dt), gamma = spring->damping * inverse / dt;
    double residual = length - spring->rest + compliance * lambda + gamma * (length - start_along);
    return -step->used->relaxation * residual / ((1 + gamma) * weight + compliance);
}

// What a sweep moves the ends of a spring apart by, times 1/W, along the unit vector that it leaves in along.
static double correct(const Substep *step, const ck_Spring *spring, const double *before, const double *now,
                      double lambda, double weight, double *along) {
    double d[3], old[3], rest = spring->rest;
    ck_subtract(d, now + 3 * spring->b, now + 3 * spring->a);
    ck_subtract(old, before + 3 * spring->b, before + 3 * spring->a);
    double length = ck_length(d), started = ck_length(old);
    for (int axis = 0; axis < 3; axis++) along[axis] = d[axis] / length;
    if (step->method == CK_METHOD_XPBD)
        return xpbd_correction(step, spring, length, ck_dot(old, along), lambda, weight);
    if (step->method == CK_METHOD_STOERMER_BARS) {
        for (int axis = 0; axis < 3; axis++) along[axis] = old[axis] / started;
        return -0.5 * step->used->relaxation * (length * length - rest * rest) / (rest * rest) * started / weight;
    }
    // Bullet's link, with the bridge's correction to Hooke's law, but where the user or a bar gives the share
    double q = spring->stiffness * step->dt * step->dt * weight;
    bool is_own = step->used->softness > 0 || isinf(q);
    double share = step->used->softness > 0      ? step->used->softness
                   : isinf(q)                    ? 1
                   : step->used->iterations == 1 ? fmin(1, q / (1 + q / 2))
                                                 : 1 - pow(1 + q, -1.0 / step->used->iterations);
    double h = is_own ? 1 : fmax(share, started * (started + rest) / (started * started + rest * rest));
    double squared = length * length;
    return -share / h / weight * length * (squared - rest * rest) / (squared + rest * rest);
}

// Where the line ends that begins with a spring: the next one's upper end is no longer the last one's lower one, or it
// leads elsewhere.
static int end_of_line(const Substep *step, int first) {
    const ck_Spring *spring = step->order[first];
    const int apart = spring->b - spring->a;
    int end = first + 1;
    while (end < step->model->spring_count && step->order[end]->a == step->order[end - 1]->b &&
           step->order[end]->b - step->order[end]->a == apart && step->order[end]->kind == spring->kind)
        end++;
    return end;
}

// The springs of a line together, by elimination down it, and back: the particle between two couples them.
static void solve_line(const Substep *step, const double *before, double *now, int first, int end) {
    const int count = end - first;
    double *normals = step->line, *moves = normals + 3 * count, *shares = moves + count, inverse = 0, residual = 0;
    for (int i = 0; i < count; i++) {
        const ck_Spring *spring = step->order[first + i];
        double *normal = normals + 3 * i, way[3], started[3];
        ck_subtract(way, now + 3 * spring->b, now + 3 * spring->a);
        ck_subtract(started, before + 3 * spring->b, before + 3 * spring->a);
        const double length = ck_length(way), weight = ck_model_inverse_mass(step->model, spring->a),
                     both = weight + ck_model_inverse_mass(step->model, spring->b),
                     softness = step->used->softness > 0 ? step->used->softness : 1 / spring->stiffness,
                     gamma = spring->damping * softness / step->dt,
                     compliance = softness / (step->found * step->eased * step->dt * step->dt);
        for (int axis = 0; axis < 3; axis++) normal[axis] = way[axis] / length;
        const double coupling = i ? -weight * ck_dot(normal, normal - 3) : 0;
        shares[i] = coupling * inverse;
        inverse = 1 / (both + compliance / (1 + gamma) - shares[i] * coupling);
        residual = -(length - spring->rest - compliance * step->tension[first + i] +
                     gamma * (length - ck_dot(started, normal))) /
                       (1 + gamma) -
                   shares[i] * residual;
        moves[i] = residual * inverse;
    }
    for (int i = count - 1; i >= 0; i--) {
        const ck_Spring *spring = step->order[first + i];
        if (i + 1 < count) moves[i] -= shares[i + 1] * moves[i + 1];
        step->tension[first + i] -= moves[i];
        ck_add_scaled(now + 3 * spring->a, -ck_model_inverse_mass(step->model, spring->a) * moves[i], normals + 3 * i);
        ck_add_scaled(now + 3 * spring->b, ck_model_inverse_mass(step->model, spring->b) * moves[i], normals + 3 * i);
    }
}

static void sweep_lines(const Substep *step, const double *before, double *now) {
    for (int first = 0, end; first < step->model->spring_count; first = end) {
        end = end_of_line(step, first);
        solve_line(step, before, now, first, end);
    }
}

static bool is_turned(const Substep *step, uint32_t sweep) {
    return step->method == CK_METHOD_STOERMER_BARS &&
           ck_sweep_is_turned(CK_PROJECT_BARS, sweep, step->used->iterations);
}

static void sweep_springs(const Substep *step, uint32_t sweep, const double *before, double *now) {
    const ck_Model *model = step->model;
    for (int k = 0; k < model->spring_count; k++) {
        const int i = is_turned(step, sweep) ? model->spring_count - 1 - k : k;
        const ck_Spring *spring = step->order[i];
        double weight_a = ck_model_inverse_mass(model, spring->a), weight_b = ck_model_inverse_mass(model, spring->b),
               along[3];
        if (weight_a + weight_b == 0) continue;
        double lambda = -step->tension[i];
        double change = correct(step, spring, before, now, lambda, weight_a + weight_b, along);
        step->tension[i] -= change;
        ck_add_scaled(now + 3 * spring->a, -weight_a * change, along);
        ck_add_scaled(now + 3 * spring->b, weight_b * change, along);
    }
}

// after  [3*n] out, m. The tensions of the sweeps, and of what it began with, are left in step->tension.
static void take(const Substep *step, const double *position, double *after) {
    const ck_Model *model = step->model;
    memcpy(after, position, 3 * sizeof(double) * (size_t)model->particle_count);
    for (int i = 0; i < model->particle_count; i++) {
        double field[3];
        ck_model_field(model, i, field);
        if (!model->pinned[i]) ck_add_scaled(after + 3 * i, step->found * step->dt * step->dt * step->eased, field);
    }
    memset(step->tension, 0, sizeof(double) * (size_t)model->spring_count);
    for (uint32_t sweep = 0; sweep < step->used->iterations; sweep++)
        if (step->method == CK_METHOD_STOERMER_LINES)
            sweep_lines(step, position, after);
        else
            sweep_springs(step, sweep, position, after);
    for (int i = 0; i < model->spring_count; i++) step->tension[i] /= step->found * step->dt * step->dt;
}

// The network that a substep amounts to in the large: n sweeps give each spring 1/k + w·dt²/n, w the mean weight of its
// ends, under the tension that they found. Springs that are pushed, whose slopes across would be negative, are taken to
// be pulled a little: slopes only say how fast the rest is found.
static void soften(ck_Spring *springs, const Substep *step, const double *position) {
    const ck_Model *model = step->model;
    double largest = 0;
    for (int i = 0; i < model->spring_count; i++) largest = fmax(largest, step->tension[i]);
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = step->order[i];
        double weight = ck_model_inverse_mass(model, spring->a) + ck_model_inverse_mass(model, spring->b);
        double length = ck_distance(position + 3 * spring->b, position + 3 * spring->a);
        double compliance = 1 / spring->stiffness, share = 1;
        if (step->used->softness > 0 && step->method == CK_METHOD_XPBD) compliance = step->used->softness;
        if (step->method == CK_METHOD_STOERMER_BARS) compliance = 0;
        if (step->method == CK_METHOD_BULLET_PBD && step->used->softness > 0)
            compliance = 0, share = step->used->softness;
        compliance += 0.5 * weight * step->found * step->dt * step->dt / share / step->used->iterations;
        if (step->method == CK_METHOD_XPBD) compliance += 0.5 * weight * step->dt * spring->damping / spring->stiffness;
        springs[i] = *spring;
        springs[i].stiffness = 1 / compliance;
        springs[i].rest = length - fmax(1e-3 * largest, step->tension[i]) * compliance;
    }
}

bool ck_prediction_sweeps(ck_Method method) {
    return method == CK_METHOD_XPBD || method == CK_METHOD_STOERMER_BARS || method == CK_METHOD_BULLET_PBD ||
           method == CK_METHOD_STOERMER_LINES;
}

// NULL without memory.
static const ck_Spring **springs_in_order(const ck_Model *model, const ck_Engine *engine, const ck_Settings *used) {
    ck_Method method = engine->method;
    const ck_Setting *reordered = ck_setting_find(engine->settings, "reordered");
    size_t count = (size_t)model->spring_count;
    const ck_Spring **springs = malloc(sizeof *springs * count);
    int *order = malloc(sizeof *order * count);
    bool found = springs && order;
    if (found && method == CK_METHOD_BULLET_PBD && !(reordered && ck_settings_get(used, reordered->slot) > 0))
        for (size_t i = 0; i < count; i++) order[i] = (int)i;
    else if (found)
        found = !ck_sweep_order(model,
                                method == CK_METHOD_STOERMER_BARS    ? CK_PROJECT_BARS
                                : method == CK_METHOD_STOERMER_LINES ? CK_PROJECT_LINES
                                                                     : CK_PROJECT_SPRINGS,
                                method == CK_METHOD_BULLET_PBD ? 1 : used->iterations, order);
    for (size_t i = 0; i < count && found; i++) springs[i] = &model->springs[order[i]];
    free(order);
    if (found) return springs;
    free(springs);
    return NULL;
}

// What would move each particle as far as a substep does, N.
static void find_force(const Substep *step, const double *position, const double *after, double *force) {
    const ck_Model *model = step->model;
    for (int i = 0; i < 3 * model->particle_count; i++)
        force[i] = (after[i] - position[i]) * model->mass[i / 3] / (step->found * step->dt * step->dt);
}

static double longest(const double *moved, int particles) {
    double largest = 0;
    for (int i = 0; i < particles; i++) largest = fmax(largest, ck_length(moved + 3 * i));
    return largest;
}

// So many steps before are mixed into the next. Source: Anderson 1965, Iterative procedures for nonlinear integral
// equations.
#define DEPTH 6

typedef struct Mixer {
    int size, count;        // numbers of a step; steps so far
    double *places, *steps; // [DEPTH][size] differences of places and of steps, the newest at (count − 1) mod DEPTH
    double *place, *step;   // [size] the last
} Mixer;

static double product(const double *a, const double *b, int size) {
    double sum = 0;
    for (int i = 0; i < size; i++) sum += a[i] * b[i];
    return sum;
}

// Solves a small symmetric system in place by Gauss's elimination; its matrix is made regular by its caller.
static void eliminate(double a[DEPTH][DEPTH + 1], int count) {
    for (int pivot = 0; pivot < count; pivot++)
        for (int row = 0; row < count; row++) {
            double share = row == pivot ? 0 : a[row][pivot] / a[pivot][pivot];
            for (int column = pivot; column <= count; column++) a[row][column] -= share * a[pivot][column];
        }
    for (int row = 0; row < count; row++) a[row][count] /= a[row][row];
}

// Turns the step from a place into one that the steps before foresee to end nearer to rest.
static void mix(Mixer *mixer, const double *place, double *step) {
    const int size = mixer->size, kept = mixer->count < DEPTH ? mixer->count : DEPTH;
    if (mixer->count > 0) {
        double *places = mixer->places + (size_t)((mixer->count - 1) % DEPTH) * (size_t)size,
               *steps = mixer->steps + (size_t)((mixer->count - 1) % DEPTH) * (size_t)size;
        for (int i = 0; i < size; i++) {
            places[i] = place[i] - mixer->place[i];
            steps[i] = step[i] - mixer->step[i];
        }
    }
    memcpy(mixer->place, place, sizeof *place * (size_t)size);
    memcpy(mixer->step, step, sizeof *step * (size_t)size);
    mixer->count++;
    double a[DEPTH][DEPTH + 1];
    for (int row = 0; row < kept; row++) {
        const double *steps = mixer->steps + (size_t)row * (size_t)size;
        for (int column = 0; column < kept; column++)
            a[row][column] = product(steps, mixer->steps + (size_t)column * (size_t)size, size);
        a[row][row] = a[row][row] * (1 + 1e-12) + 1e-300;
        a[row][kept] = product(steps, step, size);
    }
    eliminate(a, kept);
    for (int row = 0; row < kept; row++)
        for (int i = 0; i < size; i++) {
            size_t at = (size_t)row * (size_t)size + (size_t)i;
            step[i] -= a[row][kept] * (mixer->places[at] + mixer->steps[at]);
        }
}

// Slopes are found anew after so many rounds: bars that start at the true rest carry other tensions than at their own.
#define RENEWED 20

// after, force and moved are scratch, [3*n]; springs, too, [springs].
static bool find_rest(const Substep *step, ck_Spring *springs, double *position, double *after, double *force,
                      double *moved, Mixer *mixer) {
    ck_Model soft = *step->model;
    ck_Stiffness *stiffness = NULL;
    soft.terms &= ~(unsigned)CK_TERM_RIGID;
    soft.springs = springs;
    double before = INFINITY;
    bool goes_on = true, is_found = false;
    for (int round = 0; round < ROUNDS && goes_on && !is_found; round++) {
        take(step, position, after);
        find_force(step, position, after, force);
        if (round % RENEWED == 0) {
            ck_stiffness_destroy(stiffness);
            soften(springs, step, position);
            goes_on = !ck_stiffness_create(&stiffness, &soft, position);
            mixer->count = 0;
        }
        goes_on = goes_on && !ck_stiffness_solve(stiffness, force, moved);
        double way = goes_on ? longest(moved, step->model->particle_count) / step->model->size : INFINITY;
        goes_on &= way < 1;
        // rounding is reached where it no longer comes closer
        is_found = way < STILL || (way < RESOLVED && way > 0.95 * before);
        before = way;
        if (goes_on) mix(mixer, position, moved);
        for (int i = 0; i < 3 * step->model->particle_count && goes_on; i++) position[i] += moved[i];
    }
    ck_stiffness_destroy(stiffness);
    return goes_on && (is_found || before < RESOLVED);
}

bool ck_prediction_rest(const ck_Model *model, const ck_Engine *engine, const ck_Settings *used, const double *truth,
                        double *position) {
    const unsigned foreign = CK_TERM_COLLIDERS | CK_TERM_RELEASE | CK_TERM_MOVES;
    ck_Method method = engine->method;
    ck_RowSprings rows;
    // of other chains the lines are not those of the order
    if (method == CK_METHOD_STOERMER_LINES && !ck_shape_is_chain(model) && !ck_projection_fits(model, &rows))
        return false;
    if (!ck_prediction_sweeps(method) || !model->spring_count || !used->iterations || (model->terms & foreign))
        return false;
    size_t vector = 3 * (size_t)model->particle_count, count = (size_t)model->spring_count;
    ck_Settings settings = *used;
    if (!(settings.relaxation > 0)) settings.relaxation = 1;
    Substep step = {.model = model, .method = method, .used = &settings, .dt = model->step / used->substeps};
    step.eased = method == CK_METHOD_STOERMER_BARS || method == CK_METHOD_STOERMER_LINES
                     ? 1 / (1 + 0.5 * model->drag * step.dt)
                     : 1;
    step.found = method == CK_METHOD_STOERMER_LINES ? 1 - CK_LINES_KEPT : 1;
    step.order = springs_in_order(model, engine, used);
    step.tension = malloc(sizeof(double) * count);
    step.line = malloc(sizeof(double) * 5 * count);
    ck_Spring *springs = malloc(sizeof *springs * count);
    double *scratch = malloc((5 + 2 * DEPTH) * vector * sizeof *scratch);
    bool found = step.order && step.tension && step.line && springs && scratch;
    if (found) {
        memcpy(position, truth, vector * sizeof *position);
        Mixer mixer = {.size = (int)vector,
                       .place = scratch + 3 * vector,
                       .step = scratch + 4 * vector,
                       .places = scratch + 5 * vector,
                       .steps = scratch + (5 + DEPTH) * vector};
        found = find_rest(&step, springs, position, scratch, scratch + vector, scratch + 2 * vector, &mixer);
    }
    free(step.order);
    free(step.tension);
    free(step.line);
    free(springs);
    free(scratch);
    return found;
}
