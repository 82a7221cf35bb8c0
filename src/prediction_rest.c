#include "prediction_rest.h"

#include "equilibrium.h"
#include "sweep_order.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

#define ROUNDS 30

// What one sweep makes of a spring: it corrects λ = dt²·T where the spring is longer than at rest by
// ahead, so that its stretch there is s = compliance·T − echo·ahead.
typedef struct Softening {
    double compliance; // m/N
    double echo;       // 1, or what damping makes of it
} Softening;

// xpbd: λ·((1 + γ)·W + α) = s + (1 + γ)·ahead; bars: λ·W = s + ahead; Bullet: λ·W/κ = s + ahead, to first order in
// strain.
static bool soften(Softening *softening, ck_Method method, const ck_Spring *spring, double weight, double dt) {
    double gamma = spring->damping / (spring->stiffness * dt), q = spring->stiffness * dt * dt * weight;
    switch (method) {
    case CK_METHOD_XPBD:
        *softening = (Softening){dt * dt * (1 + gamma) * weight + 1 / spring->stiffness, 1 + gamma};
        return true;
    case CK_METHOD_STOERMER_BARS: *softening = (Softening){dt * dt * weight, 1}; return true;
    case CK_METHOD_BULLET_PBD: *softening = (Softening){dt * dt * weight / fmin(1, q / (1 + q / 2)), 1}; return true;
    default: return false;
    }
}

// Gives each spring of sweeping the stiffness and rest length that the method's stretch s(T) amounts to, at the
// tensions and directions of position. moved is scratch, [3*n].
static bool apply_sweep(ck_Model *sweeping, const ck_Model *model, ck_Method method, double dt, double eased,
                        const double *position, double *moved) {
    for (int i = 0; i < model->particle_count; i++) {
        memset(moved + 3 * i, 0, 3 * sizeof(double));
        double field[3];
        ck_model_field(model, i, field);
        if (!model->pinned[i])
            ck_add_scaled(moved + 3 * i, dt * dt * eased, field); // what gravity has moved before the sweep
    }
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        ck_Spring *soft = &sweeping->springs[i];
        double weight_a = ck_model_inverse_mass(model, spring->a), weight_b = ck_model_inverse_mass(model, spring->b);
        double d[3], shift[3];
        if (weight_a + weight_b == 0) continue;
        ck_subtract(d, position + 3 * spring->b, position + 3 * spring->a);
        ck_subtract(shift, moved + 3 * spring->b, moved + 3 * spring->a);
        double length = ck_length(d), tension = soft->stiffness * (length - soft->rest);
        for (int axis = 0; axis < 3; axis++) d[axis] /= length;
        Softening softening;
        if (!soften(&softening, method, spring, weight_a + weight_b, dt)) return false;
        soft->stiffness = 1 / softening.compliance;
        soft->rest = spring->rest - softening.echo * ck_dot(shift, d);
        ck_add_scaled(moved + 3 * spring->a, weight_a * dt * dt * tension, d);
        ck_add_scaled(moved + 3 * spring->b, -weight_b * dt * dt * tension, d);
    }
    return true;
}

// The springs of a model in the order in which the method sweeps over them; NULL without memory.
static ck_Spring *springs_in_order(const ck_Model *model, ck_Method method, const ck_Settings *used) {
    size_t count = (size_t)model->spring_count;
    ck_Spring *springs = malloc(sizeof *springs * count);
    int *order = malloc(sizeof *order * count);
    bool found = springs && order;
    if (found && method == CK_METHOD_BULLET_PBD && !used->reordered)
        for (size_t i = 0; i < count; i++) order[i] = (int)i;
    else if (found)
        found = !ck_sweep_order(model, method == CK_METHOD_STOERMER_BARS ? CK_PROJECT_BARS : CK_PROJECT_SPRINGS, order);
    for (size_t i = 0; i < count && found; i++) springs[i] = model->springs[order[i]];
    free(order);
    if (found) return springs;
    free(springs);
    return NULL;
}

// The method's rest is the equilibrium of a network whose springs it has softened; how much depends on their tensions
// there, so that the two are found in turn.
bool ck_prediction_rest(const ck_Model *model, ck_Method method, const ck_Settings *used, const double *truth,
                        double *position) {
    Softening softening;
    if (used->iterations != 1 || used->klst > 0 || used->compliance > 0 ||
        (used->relaxation > 0 && used->relaxation != 1) || !model->spring_count ||
        !soften(&softening, method, &model->springs[0], 1, 1))
        return false;
    size_t bytes = 3 * sizeof(double) * (size_t)model->particle_count;
    double dt = model->step / used->substeps, *moved = malloc(bytes), change = INFINITY;
    double eased = method == CK_METHOD_STOERMER_BARS ? 1 / (1 + 0.5 * model->drag * dt) : 1;
    ck_Model ordered = *model, sweeping = *model;
    ordered.springs = springs_in_order(model, method, used);
    sweeping.springs = springs_in_order(model, method, used);
    bool found = moved && ordered.springs && sweeping.springs;
    if (found) memcpy(position, truth, bytes);
    for (int round = 0; round < ROUNDS && found && change > 1e-11 * model->size; round++) {
        ck_Equilibrium rest = {0};
        found = apply_sweep(&sweeping, &ordered, method, dt, eased, position, moved) &&
                !ck_equilibrium_solve(&rest, &sweeping, position, NULL);
        change = 0;
        for (int i = 0; i < model->particle_count && found; i++)
            change = fmax(change, ck_distance(rest.position + 3 * i, position + 3 * i));
        if (found) memcpy(position, rest.position, bytes);
        ck_equilibrium_free(&rest);
    }
    free(moved);
    free(ordered.springs);
    free(sweeping.springs);
    return found && change < 1e-6 * model->size;
}
