#include "kernel_explicit.h"

#include "kernel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Forces of one row's springs, [3][padding + stride + padding]; padding stays 0, so that ends need no test.
typedef double *RowForce[3];

struct ck_ExplicitCloth {
    ck_Rows rows;
    ck_RowSprings springs;
    double dt, drag, field[3]; // field: m/s², on every free particle
    bool has_shear;
    double *x[3], *v[3], *predicted[3], *a[3], *weight, *is_free;
    double *state, *scratch;
    // by where springs lead from a node; down_left from its right neighbour
    RowForce right, far_right, down[2], down_right[2], down_left[2], far_down[3]; // of this row and those before
};

// 1/√x to some two units in the last place, in products only: a vector's square root and division take four times as
// long. The guess is off by at most 3.5 %; each of four Newton steps turns an error e into 1.5·e².
// Source: Lomont 2003, Fast inverse square root, with the constant for doubles.
static inline __attribute__((always_inline)) double inverse_root(double x) {
    uint64_t bits;
    double y, half = 0.5 * x;
    memcpy(&bits, &x, sizeof bits);
    bits = 0x5fe6eb50c7b537a9u - (bits >> 1);
    memcpy(&y, &bits, sizeof y);
    y *= 1.5 - half * y * y;
    y *= 1.5 - half * y * y;
    y *= 1.5 - half * y * y;
    y *= 1.5 - half * y * y;
    return y;
}

// f = [k·(1 − L/l) + c·(v·d)/l²]·d for count springs from one row of nodes to another.
//   x, v  starts of rows of positions and velocities, nodes a to nodes b
static inline __attribute__((always_inline)) void pull(RowForce force, int count, double *const x[3],
                                                       double *const v[3], long a, long b, double stiffness,
                                                       double rest, double damping, const bool damped) {
    const double *ax = x[0] + a, *ay = x[1] + a, *az = x[2] + a, *bx = x[0] + b, *by = x[1] + b, *bz = x[2] + b;
    const double *au = v[0] + a, *av = v[1] + a, *aw = v[2] + a, *bu = v[0] + b, *bv = v[1] + b, *bw = v[2] + b;
    double *restrict fx = force[0], *restrict fy = force[1], *restrict fz = force[2];
#pragma GCC ivdep
    for (int i = 0; i < count; i++) {
        double dx = bx[i] - ax[i], dy = by[i] - ay[i], dz = bz[i] - az[i];
        double squared = dx * dx + dy * dy + dz * dz, inverse = inverse_root(squared);
        double scale = stiffness - stiffness * rest * inverse;
        if (damped) {
            double rate = (bu[i] - au[i]) * dx + (bv[i] - av[i]) * dy + (bw[i] - aw[i]) * dz;
            scale += damping * rate * (inverse * inverse);
        }
        scale = squared > 0 ? scale : 0; // coincident particles have no direction to push in
        fx[i] = scale * dx;
        fy[i] = scale * dy;
        fz[i] = scale * dz;
    }
}

// All springs that start in a row.
static inline __attribute__((always_inline)) void pull_row(ck_ExplicitCloth *cloth, int row, const bool damped,
                                                           const bool bent) {
    const ck_Rows *rows = &cloth->rows;
    const long at = (long)row * rows->stride, next = at + rows->stride;
    const int count = rows->columns, now = row % 2;
    const double *k = cloth->springs.stiffness, *rest = cloth->springs.rest, c = cloth->springs.damping;
    double *const *x = cloth->x, *const *v = cloth->predicted;
    pull(cloth->right, count - 1, x, v, at, at + 1, k[CK_STRUCTURAL], rest[CK_STRUCTURAL], c, damped);
    if (bent && count > 2) pull(cloth->far_right, count - 2, x, v, at, at + 2, k[CK_BEND], rest[CK_BEND], c, damped);
    if (row + 1 < rows->rows) {
        pull(cloth->down[now], count, x, v, at, next, k[CK_STRUCTURAL], rest[CK_STRUCTURAL], c, damped);
        if (cloth->has_shear) {
            pull(cloth->down_right[now], count - 1, x, v, at, next + 1, k[CK_SHEAR], rest[CK_SHEAR], c, damped);
            pull(cloth->down_left[now], count - 1, x, v, at + 1, next, k[CK_SHEAR], rest[CK_SHEAR], c, damped);
        }
    }
    if (bent && row + 2 < rows->rows)
        pull(cloth->far_down[row % 3], count, x, v, at, next + rows->stride, k[CK_BEND], rest[CK_BEND], c, damped);
}

static void clear(RowForce force, int count) {
    for (int axis = 0; axis < 3; axis++) memset(force[axis], 0, sizeof(double) * (size_t)count);
}

// The last rows have no springs downwards; the first have none from above.
static void clear_ends(ck_ExplicitCloth *cloth, int row) {
    const ck_Rows *rows = &cloth->rows;
    if (row == 0) {
        clear(cloth->down[1], rows->columns);
        clear(cloth->down_right[1], rows->columns);
        clear(cloth->down_left[1], rows->columns);
        clear(cloth->far_down[1], rows->columns);
        clear(cloth->far_down[2], rows->columns);
    }
    if (row + 1 == rows->rows) {
        clear(cloth->down[row % 2], rows->columns);
        clear(cloth->down_right[row % 2], rows->columns);
        clear(cloth->down_left[row % 2], rows->columns);
    }
    if (row + 2 >= rows->rows) clear(cloth->far_down[row % 3], rows->columns);
}

// Sums a row's forces along one axis and finishes its substep.
static inline __attribute__((always_inline)) void finish_row(ck_ExplicitCloth *cloth, int row, int axis,
                                                             const bool dragged, const bool bent) {
    const long at = (long)row * cloth->rows.stride;
    const int now = row % 2, before = 1 - now, columns = cloth->rows.columns;
    const double half = 0.5 * cloth->dt, drag = cloth->drag, field = cloth->field[axis];
    const double *right = cloth->right[axis], *far_right = cloth->far_right[axis];
    const double *down = cloth->down[now][axis], *above = cloth->down[before][axis];
    const double *down_right = cloth->down_right[now][axis], *above_left = cloth->down_right[before][axis];
    const double *down_left = cloth->down_left[now][axis], *above_right = cloth->down_left[before][axis];
    const double *far_down = cloth->far_down[row % 3][axis], *far_above = cloth->far_down[(row + 1) % 3][axis];
    const double *weight = cloth->weight + at, *is_free = cloth->is_free + at, *predicted = cloth->predicted[axis] + at;
    double *restrict v = cloth->v[axis] + at, *restrict a = cloth->a[axis] + at;
#pragma GCC ivdep
    for (int i = 0; i < columns; i++) {
        double force = right[i] - right[i - 1] + (down[i] - above[i]) + (down_right[i] - above_left[i - 1]) +
                       (down_left[i - 1] - above_right[i]);
        if (bent) force += far_right[i] - far_right[i - 2] + (far_down[i] - far_above[i]);
        double push = dragged ? field - drag * predicted[i] : field;
        double acceleration = weight[i] * force + is_free[i] * push;
        v[i] += half * (a[i] + acceleration);
        a[i] = acceleration;
    }
}

// x ← x + v·dt + a·dt²/2;  v* = v + a·dt: the first half of a substep, of a row or of all of them.
static inline __attribute__((always_inline)) void advance(ck_ExplicitCloth *cloth, long at, long count) {
    const double dt = cloth->dt, half = 0.5 * dt * dt;
    for (int axis = 0; axis < 3; axis++) {
        const double *v = cloth->v[axis] + at, *a = cloth->a[axis] + at;
        double *restrict x = cloth->x[axis] + at, *restrict predicted = cloth->predicted[axis] + at;
#pragma GCC ivdep
        for (long i = 0; i < count; i++) {
            x[i] += dt * v[i] + half * a[i];
            predicted[i] = v[i] + dt * a[i];
        }
    }
}

// A row whose springs are done is not read again: it can start the next substep, where there is one.
static inline __attribute__((always_inline)) void pass(ck_ExplicitCloth *cloth, bool advances, const bool damped,
                                                       const bool dragged, const bool bent) {
    for (int row = 0; row < cloth->rows.rows; row++) {
        clear_ends(cloth, row);
        pull_row(cloth, row, damped, bent);
        for (int axis = 0; axis < 3; axis++) finish_row(cloth, row, axis, dragged, bent);
        if (advances) advance(cloth, (long)row * cloth->rows.stride, cloth->rows.columns);
    }
}

enum { DAMPED = 1, DRAGGED = 2, BENT = 4 };

// What a scene does not have is not in its pass.
CK_KERNEL static void run_pass(ck_ExplicitCloth *cloth, int terms, bool advances) {
    switch (terms) {
    case 0: pass(cloth, advances, false, false, false); break;
    case DAMPED: pass(cloth, advances, true, false, false); break;
    case DRAGGED: pass(cloth, advances, false, true, false); break;
    case DAMPED | DRAGGED: pass(cloth, advances, true, true, false); break;
    case BENT: pass(cloth, advances, false, false, true); break;
    case BENT | DAMPED: pass(cloth, advances, true, false, true); break;
    case BENT | DRAGGED: pass(cloth, advances, false, true, true); break;
    default: pass(cloth, advances, true, true, true); break;
    }
}

void ck_explicit_step(ck_ExplicitCloth *cloth, uint32_t substeps) {
    int terms = (cloth->springs.damping > 0 ? DAMPED : 0) | (cloth->drag > 0 ? DRAGGED : 0) |
                (cloth->springs.stiffness[CK_BEND] > 0 ? BENT : 0);
    advance(cloth, 0, (long)cloth->rows.rows * cloth->rows.stride);
    for (uint32_t i = 0; i < substeps; i++) run_pass(cloth, terms, i + 1 < substeps);
}

void ck_explicit_read(const ck_ExplicitCloth *cloth, double *position, double *velocity) {
    ck_rows_store(&cloth->rows, position, cloth->x);
    ck_rows_store(&cloth->rows, velocity, cloth->v);
}

static void set_weight(ck_ExplicitCloth *cloth, int particle, double weight) {
    long at = (long)(particle / cloth->rows.columns) * cloth->rows.stride + particle % cloth->rows.columns;
    cloth->weight[at] = weight;
    cloth->is_free[at] = weight > 0;
}

void ck_explicit_destroy(ck_ExplicitCloth *cloth) {
    if (!cloth) return;
    free(cloth->state);
    free(cloth->scratch);
    free(cloth);
}

// Hands out rows of forces from the scratch block, each between two paddings.
static void place_forces(ck_ExplicitCloth *cloth) {
    RowForce *all[] = {&cloth->right,         &cloth->far_right,     &cloth->down[0],      &cloth->down[1],
                       &cloth->down_right[0], &cloth->down_right[1], &cloth->down_left[0], &cloth->down_left[1],
                       &cloth->far_down[0],   &cloth->far_down[1],   &cloth->far_down[2]};
    double *next = cloth->scratch + CK_ROWS_LANES;
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        for (int axis = 0; axis < 3; axis++) {
            (*all[i])[axis] = next;
            next += cloth->rows.stride + CK_ROWS_LANES;
        }
}
#define FORCE_ROWS (11 * 3)

ck_Status ck_explicit_create(ck_ExplicitCloth **out, const ck_Model *model, const ck_RowSprings *springs, double dt,
                             const double *position, const double *velocity, const double *acceleration,
                             const double *inverse_mass, ck_Error *error) {
    ck_ExplicitCloth *cloth = calloc(1, sizeof *cloth);
    if (!cloth) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    *cloth = (ck_ExplicitCloth){.rows = ck_rows_of(model), .springs = *springs, .dt = dt, .drag = model->drag};
    cloth->has_shear = springs->stiffness[CK_SHEAR] > 0;
    ck_Rows force_rows = {.size = (FORCE_ROWS + 1) * (size_t)(cloth->rows.stride + CK_ROWS_LANES)};
    cloth->state = ck_rows_allocate(&cloth->rows, 14);
    cloth->scratch = ck_rows_allocate(&force_rows, 1);
    if (!cloth->state || !cloth->scratch) {
        ck_explicit_destroy(cloth);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    place_forces(cloth);
    const size_t size = cloth->rows.size;
    for (int axis = 0; axis < 3; axis++) {
        cloth->x[axis] = cloth->state + size * (size_t)axis;
        cloth->v[axis] = cloth->state + size * (size_t)(3 + axis);
        cloth->predicted[axis] = cloth->state + size * (size_t)(6 + axis);
        cloth->a[axis] = cloth->state + size * (size_t)(9 + axis);
    }
    cloth->weight = cloth->state + size * 12;
    cloth->is_free = cloth->state + size * 13;
    ck_rows_load(&cloth->rows, cloth->x, position);
    ck_rows_load(&cloth->rows, cloth->v, velocity);
    ck_rows_load(&cloth->rows, cloth->a, acceleration);
    ck_model_field(model, 0, cloth->field);
    for (int i = 0; i < model->particle_count; i++) set_weight(cloth, i, inverse_mass[i]);
    *out = cloth;
    return CK_OK;
}
