#include "kernel_explicit.h"

#include <stdlib.h>

struct ck_ExplicitCloth {
    ck_Rows rows;
    ck_RowSprings springs;
    double dt, drag, lightness, field[3]; // lightness: 1/kg; field: m/s², on every free particle
    int terms;
    uint32_t substeps;                  // of this call
    double *x[3], *v[3], *predicted[3]; // v, between substeps of a call, is half a substep ahead
    double *a[3];                       // acceleration at the end of a call, else the sum of forces so far
    double *is_free, *paired, *far_paired;
    double *state, *pairs;
};

enum { DAMPED = 1, DRAGGED = 2, SHEARED = 4, BENT = 8, ALL_TERMS = 15 };

// The springs of one vector of a row to the vector on its right and to the row below; DOWN_LEFT leads from the vector
// on the right to the one below this.
enum { RIGHT, DOWN, DOWN_RIGHT, DOWN_LEFT, SPRINGS };

typedef struct Ends {
    long a, b;
    ck_SpringKind kind;
} Ends;

// [k·(1 − L/l) + c·(v·d)/l²]·d, N, on the nodes at a from springs to those at b. Springs go through each operation
// together: a processor would not look far enough ahead to fill the wait for one's result with another's work.
CK_INLINE void pull(const ck_ExplicitCloth *cloth, ck_Lanes3 *force, const Ends *ends, const int count,
                    const int terms) {
    ck_Lanes squared[SPRINGS], inverse[SPRINGS], scale[SPRINGS];
    for (int i = 0; i < count; i++) {
        force[i] = ck_lanes3_subtract(ck_lanes3_load(cloth->x, ends[i].b), ck_lanes3_load(cloth->x, ends[i].a));
        squared[i] = ck_lanes3_dot(force[i], force[i]);
    }
    ck_lanes_inverse_root(inverse, squared, count);
    for (int i = 0; i < count; i++) {
        const double stiffness = cloth->springs.stiffness[ends[i].kind], rest = cloth->springs.rest[ends[i].kind];
        scale[i] = stiffness - stiffness * rest * inverse[i];
    }
    for (int i = 0; i < count && (terms & DAMPED); i++) {
        ck_Lanes3 v = ck_lanes3_subtract(ck_lanes3_load(cloth->predicted, ends[i].b),
                                         ck_lanes3_load(cloth->predicted, ends[i].a));
        scale[i] += cloth->springs.damping * ck_lanes3_dot(v, force[i]) * (inverse[i] * inverse[i]);
    }
    // coincident particles have no direction to push in
    for (int i = 0; i < count; i++)
        force[i] = ck_lanes3_scale(ck_lanes_where(squared[i] > (ck_Lanes){0}, scale[i]), force[i]);
}

CK_INLINE void add(double *const to[3], long at, ck_Lanes3 value) {
    ck_lanes3_store(to, at, ck_lanes3_add(ck_lanes3_load(to, at), value));
}

// Springs over two columns and over two rows: their sums go through memory. The row two below starts its sum here.
CK_INLINE void bend_row(const ck_ExplicitCloth *cloth, int row, const int terms) {
    const ck_Rows *rows = &cloth->rows;
    const long at = row * rows->stride, far = 2 * rows->stride;
    const ck_Lanes3 none = {{0}, {0}, {0}};
    const bool is_low = row + 2 >= rows->rows;
    for (int i = 0; i < rows->span; i++) {
        long from = at + (long)i * CK_LANES, right = at + ck_rows_right(rows, i, 2);
        ck_Lanes3 force[2];
        pull(cloth, force, (const Ends[]){{from, right, CK_BEND}, {from, is_low ? from : from + far, CK_BEND}}, 2,
             terms);
        force[0] = ck_lanes3_scale(ck_lanes_load(cloth->far_paired + i * CK_LANES), force[0]);
        add(cloth->a, from, ck_lanes3_add(force[0], force[1]));
        add(cloth->a, right, ck_lanes3_subtract(none, force[0]));
        if (!is_low) ck_lanes3_store(cloth->a, from + far, ck_lanes3_subtract(none, force[1]));
    }
}

// A last row's springs down lead from nodes to themselves or are not paired: they pull nothing.
CK_INLINE void pull_vector(const ck_ExplicitCloth *cloth, ck_Lanes3 *force, int row, int vector, const int terms) {
    const ck_Rows *rows = &cloth->rows;
    const long at = row * rows->stride, below = row + 1 < rows->rows ? at + rows->stride : at;
    const long here = (long)vector * CK_LANES, right = ck_rows_right(rows, vector, 1);
    const Ends ends[] = {{at + here, at + right, CK_STRUCTURAL},
                         {at + here, below + here, CK_STRUCTURAL},
                         {at + here, below + right, CK_SHEAR},
                         {at + right, below + here, CK_SHEAR}};
    const ck_Lanes paired = ck_lanes_load(cloth->paired + here);
    pull(cloth, force, ends, terms & SHEARED ? SPRINGS : 2, terms);
    force[RIGHT] = ck_lanes3_scale(paired, force[RIGHT]);
    for (int i = DOWN_RIGHT; i < SPRINGS && (terms & SHEARED); i++)
        force[i] = ck_lanes3_scale(row + 1 < rows->rows ? paired : (ck_Lanes){0}, force[i]);
}

// a ← w·force + field − drag·v*;  v ← v + a·dt/2, and with another substep to come x ← x + v·dt + a·dt²/2, v* = v +
// a·dt
CK_INLINE void finish(const ck_ExplicitCloth *cloth, long at, ck_Lanes3 force, bool advances, const int terms) {
    const double dt = cloth->dt, half = 0.5 * dt, light = cloth->lightness, drag = cloth->drag;
    const ck_Lanes is_free = ck_lanes_load(cloth->is_free + at);
    const ck_Lanes forces[3] = {force.x, force.y, force.z};
    for (int axis = 0; axis < 3; axis++) {
        double *x = cloth->x[axis] + at, *v = cloth->v[axis] + at, *predicted = cloth->predicted[axis] + at;
        ck_Lanes push = light * forces[axis] + cloth->field[axis];
        if (terms & DRAGGED) push -= drag * ck_lanes_load(predicted);
        ck_Lanes a = is_free * push, velocity = ck_lanes_load(v) + half * a;
        if (advances) {
            ck_Lanes kicked = velocity + half * a;
            ck_lanes_store(x, ck_lanes_load(x) + dt * kicked);
            if (terms & (DAMPED | DRAGGED)) ck_lanes_store(predicted, kicked + half * a);
            ck_lanes_store(v, kicked);
        } else {
            ck_lanes_store(v, velocity);
            ck_lanes_store(cloth->a[axis] + at, a);
        }
    }
}

// A row whose springs are done is not read again: its nodes end their substep, and start the next, at once. Springs
// from the left are those of the vector before, kept; the first vector's are the last's, one lane on.
CK_INLINE void pass(const ck_ExplicitCloth *cloth, int row, bool advances, const int terms) {
    const ck_Rows *rows = &cloth->rows;
    const long at = row * rows->stride, stride = rows->stride;
    const ck_Lanes3 none = {{0}, {0}, {0}};
    ck_Lanes3 last[SPRINGS], now[SPRINGS], left_right, left_down_right = none, left_down_left = none;
    if (terms & BENT) bend_row(cloth, row, terms);
    pull_vector(cloth, last, row, rows->span - 1, terms);
    left_right = ck_lanes3_next(last[RIGHT]);
    if (terms & SHEARED) left_down_right = ck_lanes3_next(last[DOWN_RIGHT]);
    if (terms & SHEARED) left_down_left = ck_lanes3_next(last[DOWN_LEFT]);
    for (int i = 0; i < rows->span; i++) {
        const long from = at + (long)i * CK_LANES;
        if (i + 1 < rows->span)
            pull_vector(cloth, now, row, i, terms);
        else
            memcpy(now, last, sizeof now);
        ck_Lanes3 force = ck_lanes3_add(ck_lanes3_load(cloth->a, from), ck_lanes3_subtract(now[RIGHT], left_right));
        ck_Lanes3 below = now[DOWN];
        force = ck_lanes3_add(force, now[DOWN]);
        if (terms & SHEARED) {
            force = ck_lanes3_add(force, ck_lanes3_add(now[DOWN_RIGHT], left_down_left));
            below = ck_lanes3_add(below, ck_lanes3_add(now[DOWN_LEFT], left_down_right));
            left_down_right = now[DOWN_RIGHT];
            left_down_left = now[DOWN_LEFT];
        }
        left_right = now[RIGHT];
        if (row + 1 < rows->rows)
            ck_lanes3_store(
                cloth->a, from + stride,
                ck_lanes3_subtract((terms & BENT) && row > 0 ? ck_lanes3_load(cloth->a, from + stride) : none, below));
        finish(cloth, from, force, advances, terms);
    }
}

// What a scene does not have is not in its pass. The copy is known to share no memory with the arrays: what stands in
// it need not be read again after each store.
CK_KERNEL static void pass_row(const ck_ExplicitCloth *shared, int row, bool advances) {
    const ck_ExplicitCloth local = *shared, *cloth = &local;
    switch (local.terms) {
    case 0: pass(cloth, row, advances, 0); break;
    case DAMPED: pass(cloth, row, advances, DAMPED); break;
    case DRAGGED: pass(cloth, row, advances, DRAGGED); break;
    case DAMPED | DRAGGED: pass(cloth, row, advances, DAMPED | DRAGGED); break;
    case SHEARED: pass(cloth, row, advances, SHEARED); break;
    case SHEARED | DAMPED: pass(cloth, row, advances, SHEARED | DAMPED); break;
    case SHEARED | DRAGGED: pass(cloth, row, advances, SHEARED | DRAGGED); break;
    case SHEARED | DAMPED | DRAGGED: pass(cloth, row, advances, SHEARED | DAMPED | DRAGGED); break;
    case BENT | DAMPED | DRAGGED: pass(cloth, row, advances, BENT | DAMPED | DRAGGED); break;
    default: pass(cloth, row, advances, ALL_TERMS); break;
    }
}

// The first row has no springs from above; nor has the second, of those that bend.
static void run_wave(void *state, long substep, int row) {
    ck_ExplicitCloth *cloth = state;
    if (row == 0)
        for (int axis = 0; axis < 3; axis++) memset(cloth->a[axis], 0, sizeof(double) * (size_t)cloth->rows.stride);
    pass_row(cloth, row, substep + 1 < cloth->substeps);
}

// x ← x + v·dt + a·dt²/2;  v* = v + a·dt;  v ← v + a·dt/2: the start of a call's first substep.
static void advance(ck_ExplicitCloth *cloth) {
    const double dt = cloth->dt, half = 0.5 * dt;
    for (int axis = 0; axis < 3; axis++)
        for (size_t i = 0; i < cloth->rows.size; i++) {
            double a = cloth->a[axis][i], kicked = cloth->v[axis][i] + half * a;
            cloth->x[axis][i] += dt * kicked;
            cloth->predicted[axis][i] = kicked + half * a;
            cloth->v[axis][i] = kicked;
        }
}

void ck_explicit_step(ck_ExplicitCloth *cloth, uint32_t substeps, ck_Waves *waves) {
    // a row reads those below it as the substep before left them
    int reach = cloth->terms & BENT ? 2 : 1;
    cloth->substeps = substeps;
    advance(cloth);
    ck_waves_run(waves, &(ck_WaveWork){run_wave, cloth, substeps, cloth->rows.rows, reach});
}

void ck_explicit_read(const ck_ExplicitCloth *cloth, double *position, double *velocity) {
    ck_rows_store(&cloth->rows, position, cloth->x);
    ck_rows_store(&cloth->rows, velocity, cloth->v);
}

void ck_explicit_destroy(ck_ExplicitCloth *cloth) {
    if (!cloth) return;
    free(cloth->state);
    free(cloth->pairs);
    free(cloth);
}

static int terms_of(const ck_Model *model, const ck_RowSprings *springs) {
    int terms = (springs->damping > 0 ? DAMPED : 0) | (model->drag > 0 ? DRAGGED : 0) |
                (springs->rest[CK_SHEAR] > 0 ? SHEARED : 0) | (springs->rest[CK_BEND] > 0 ? BENT : 0);
    // what bends has a pass that knows all else, with the strength 0 for what is not there
    return terms & BENT ? terms | DAMPED | DRAGGED : terms;
}

ck_Status ck_explicit_create(ck_ExplicitCloth **out, const ck_Model *model, const ck_RowSprings *springs, double dt,
                             const double *position, const double *velocity, const double *acceleration,
                             const double *inverse_mass, ck_Error *error) {
    ck_ExplicitCloth *cloth = calloc(1, sizeof *cloth);
    if (!cloth) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    *cloth = (ck_ExplicitCloth){
        .rows = ck_rows_of(model), .springs = *springs, .dt = dt, .drag = model->drag, .lightness = 1 / model->mass[0]};
    cloth->terms = terms_of(model, springs);
    const ck_Rows row = {.size = (size_t)cloth->rows.stride};
    cloth->state = ck_rows_allocate(&cloth->rows, 13);
    cloth->pairs = ck_rows_allocate(&row, 2);
    if (!cloth->state || !cloth->pairs) {
        ck_explicit_destroy(cloth);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    const size_t size = cloth->rows.size;
    for (int axis = 0; axis < 3; axis++) {
        cloth->x[axis] = cloth->state + size * (size_t)axis;
        cloth->v[axis] = cloth->state + size * (size_t)(3 + axis);
        cloth->predicted[axis] = cloth->state + size * (size_t)(6 + axis);
        cloth->a[axis] = cloth->state + size * (size_t)(9 + axis);
    }
    cloth->is_free = cloth->state + size * 12;
    cloth->paired = cloth->pairs;
    cloth->far_paired = cloth->pairs + row.size;
    ck_rows_mark_paired(&cloth->rows, 1, cloth->paired);
    ck_rows_mark_paired(&cloth->rows, 2, cloth->far_paired);
    ck_rows_load(&cloth->rows, cloth->x, position);
    ck_rows_load(&cloth->rows, cloth->v, velocity);
    ck_rows_load(&cloth->rows, cloth->a, acceleration);
    ck_model_field(model, 0, cloth->field);
    for (int i = 0; i < model->particle_count; i++)
        cloth->is_free[ck_rows_at(&cloth->rows, i / model->columns, i % model->columns)] = inverse_mass[i] > 0;
    *out = cloth;
    return CK_OK;
}
