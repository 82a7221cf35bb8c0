#include "rest_forms.h"

#include "shape.h"
#include "springs.h"
#include "vector.h"

#include <string.h>

ck_Status ck_truth_need(bool met, const ck_Model *model, ck_Error *error, const char *wanted) {
    return met ? CK_OK : ck_fail(error, CK_BAD_INPUT, "%s: truth %s needs %s", model->name, model->truth, wanted);
}

static double compliance(const ck_Spring *spring) {
    return 1 / spring->stiffness; // 0 for a bar
}

ck_Status ck_truth_vertical_chain(const ck_Model *model, double time, double *position, double *velocity,
                                  ck_Error *error) {
    (void)time;
    bool fits =
        ck_shape_is_chain(model) && model->pin_count == 1 && model->pinned[0] && (model->terms & CK_TERM_GRAVITY);
    ck_Status status =
        ck_truth_need(fits && !model->collider_count, model, error,
                      "a rope or chain of bars without bend springs, pinned at its first particle alone, in gravity");
    if (status) return status;
    memset(velocity, 0, 3 * sizeof(double) * (size_t)model->particle_count);
    memcpy(position, model->position, 3 * sizeof(double));
    double weight[3] = {0}; // N, of what hangs below the spring
    for (int i = 1; i < model->particle_count; i++)
        for (int axis = 0; axis < 3; axis++) weight[axis] += model->mass[i] * model->gravity[axis] + model->force[axis];
    for (int i = 1; i < model->particle_count; i++) {
        double tension = ck_length(weight),
               length = model->springs[i - 1].rest + tension * compliance(&model->springs[i - 1]);
        for (int axis = 0; axis < 3; axis++) {
            position[3 * i + axis] = position[3 * i - 3 + axis] + length * weight[axis] / tension;
            weight[axis] -= model->mass[i] * model->gravity[axis] + model->force[axis];
        }
    }
    return CK_OK;
}

// Lays the rope from its first pin under the tension of its first spring.
//   tension   [3] N in;  position  [3*n] m out
//   jacobian  [9] m/N out: change of the far end with tension, symmetric
static void lay_rope(const ck_Model *model, const double *tension, double *position, double *jacobian) {
    double t[3] = {tension[0], tension[1], tension[2]};
    memset(jacobian, 0, 9 * sizeof(double));
    memcpy(position, model->position, 3 * sizeof(double));
    for (int i = 1; i < model->particle_count; i++) {
        const ck_Spring *spring = &model->springs[i - 1];
        double pull = ck_length(t), scale = spring->rest / pull + compliance(spring);
        for (int row = 0; row < 3; row++) {
            position[3 * i + row] = position[3 * i - 3 + row] + scale * t[row];
            jacobian[4 * row] += scale;
            for (int column = 0; column < 3; column++)
                jacobian[3 * row + column] -= spring->rest * t[row] * t[column] / (pull * pull * pull);
        }
        for (int axis = 0; axis < 3; axis++) t[axis] -= model->mass[i] * model->gravity[axis] + model->force[axis];
    }
}

// Solves a·x = b for a symmetric 3×3 matrix by cofactors.
static void solve_3x3(const double *a, const double *b, double *x) {
    double cofactor[9], determinant = 0;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) {
            int r1 = (row + 1) % 3, r2 = (row + 2) % 3, c1 = (column + 1) % 3, c2 = (column + 2) % 3;
            cofactor[3 * row + column] = a[3 * r1 + c1] * a[3 * r2 + c2] - a[3 * r1 + c2] * a[3 * r2 + c1];
        }
    for (int column = 0; column < 3; column++) determinant += a[column] * cofactor[column];
    for (int row = 0; row < 3; row++) {
        x[row] = 0;
        for (int column = 0; column < 3; column++) x[row] += cofactor[3 * column + row] * b[column] / determinant;
    }
}

// How far the rope under this tension misses its second pin, in m.
static double miss(const ck_Model *model, const double *tension, double *position, double *gap, double *jacobian) {
    int last = model->particle_count - 1;
    lay_rope(model, tension, position, jacobian);
    ck_subtract(gap, model->position + 3 * last, position + 3 * last);
    return ck_length(gap);
}

// The straight line, for bars that just reach from pin to pin.
static void lay_straight(const ck_Model *model, double *position) {
    int last = model->particle_count - 1;
    double chord[3];
    ck_subtract(chord, model->position + 3 * last, model->position);
    double span = ck_length(chord);
    memcpy(position, model->position, 3 * sizeof(double));
    for (int i = 1; i <= last; i++) {
        memcpy(position + 3 * i, position + 3 * i - 3, 3 * sizeof(double));
        ck_add_scaled(position + 3 * i, model->springs[i - 1].rest / span, chord);
    }
}

// By how much bars are longer than their span, / size; below what coordinates resolve there is none.
static double slack_of_bars(const ck_Model *model) {
    double length = 0;
    for (int i = 0; i < model->spring_count; i++) length += model->springs[i].rest;
    double slack =
        (length - ck_distance(model->position, model->position + 3 * (model->particle_count - 1))) / model->size;
    return fabs(slack) < 1e-13 ? 0 : slack;
}

// A shallow rope of bars sags by √(3/8·slack·span): what coordinates round of its slack, its sag is off by as much over
// twice that root.
double ck_truth_catenary_off(const ck_Model *model) {
    double slack = slack_of_bars(model);
    return (model->terms & CK_TERM_RIGID) && slack > 0 ? sqrt(slack + 1e-15) - sqrt(slack) : 0;
}

// Newton with halving on the one unknown vector, the tension at the first pin. The rope's complementary energy is
// convex in it, so that there is one solution.
ck_Status ck_truth_catenary(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error) {
    (void)time;
    int last = model->particle_count - 1;
    bool fits = ck_shape_is_chain(model) && model->pin_count == 2 && model->pinned[0] && model->pinned[last] &&
                (model->terms & CK_TERM_GRAVITY);
    ck_Status status = ck_truth_need(fits && !model->collider_count, model, error,
                                     "a rope or chain of bars without bend springs, pinned at both ends, in gravity");
    if (status) return status;
    memset(velocity, 0, 3 * sizeof(double) * (size_t)model->particle_count);
    if ((model->terms & CK_TERM_RIGID) && slack_of_bars(model) <= 0) {
        lay_straight(model, position);
        return ck_truth_need(slack_of_bars(model) == 0, model, error, "bars that reach from pin to pin");
    }
    double chord[3], tension[3], gap[3], jacobian[9];
    double weight = ck_model_free_mass(model) * ck_length(model->gravity);
    ck_subtract(chord, model->position + 3 * last, model->position);
    for (int axis = 0; axis < 3; axis++)
        tension[axis] =
            0.5 * weight * (chord[axis] / ck_length(chord) + model->gravity[axis] / ck_length(model->gravity));
    double off = miss(model, tension, position, gap, jacobian);
    for (int iteration = 0; iteration < 200 && off > 1e-15 * model->size; iteration++) {
        double change[3], trial[3], trial_gap[3], trial_jacobian[9], trial_off, length = 1;
        solve_3x3(jacobian, gap, change);
        do {
            for (int axis = 0; axis < 3; axis++) trial[axis] = tension[axis] + length * change[axis];
            trial_off = miss(model, trial, position, trial_gap, trial_jacobian);
            length *= 0.5;
        } while (!(trial_off < off) && length > 1e-6);
        if (!(trial_off < off)) break; // rounding is reached
        memcpy(tension, trial, sizeof tension);
        memcpy(gap, trial_gap, sizeof gap);
        memcpy(jacobian, trial_jacobian, sizeof jacobian);
        off = trial_off;
    }
    off = miss(model, tension, position, gap, jacobian);
    return ck_truth_need(off <= 1e-12 * model->size, model, error,
                         "a rope whose shooting converges; this one misses its second pin");
}

ck_Status ck_truth_free_fall(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error) {
    bool fits = ck_shape_is_falling(model) && !(model->terms & CK_TERM_DRAG);
    ck_Status status = ck_truth_need(fits, model, error, "a body without pins, drag, colliders and noise");
    if (status) return status;
    for (int i = 0; i < model->particle_count; i++) {
        double field[3];
        ck_model_field(model, i, field);
        for (int axis = 0; axis < 3; axis++) {
            int at = 3 * i + axis;
            position[at] = model->position[at] + model->velocity[at] * time + 0.5 * field[axis] * time * time;
            velocity[at] = model->velocity[at] + field[axis] * time;
        }
    }
    return CK_OK;
}
