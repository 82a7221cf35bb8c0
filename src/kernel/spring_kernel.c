#include "spring_kernel.h"

#include "spring_loop.h"

#include <stdlib.h>
#include <string.h>

// Pass 0 is the start of the first substep, each other one ends a substep and starts the next. The first row has no
// springs from above; nor has the second, of those that bend.
static void run_row(ck_ExplicitCloth *cloth, long pass, int row) {
    if (pass == 0) {
        cloth->loops->explicit_start(cloth, row);
        return;
    }
    if (row == 0) memset(cloth->a, 0, 3 * sizeof(double) * (size_t)cloth->rows.stride);
    cloth->loops->explicit_row(cloth, row, pass < cloth->substeps);
}

// A row reads those below it as the pass before left them.
static int reach_of(const ck_ExplicitCloth *cloth) {
    return cloth->terms & CK_ROW_BENT ? 2 : 1;
}

static void run_wave(void *state, long block, int wave) {
    ck_ExplicitCloth *cloth = state;
    for (int i = 0; i < cloth->depth; i++) {
        const long pass = block * cloth->depth + i;
        const int row = wave - reach_of(cloth) * i;
        if (pass <= cloth->substeps && row >= 0 && row < cloth->rows.rows) run_row(cloth, pass, row);
    }
}

void ck_explicit_step(ck_ExplicitCloth *cloth, uint32_t substeps, ck_Waves *waves) {
    const long passes = substeps + 1L;
    const int reach = reach_of(cloth);
    cloth->substeps = substeps;
    cloth->depth = ck_waves_depth(waves, passes, cloth->rows.rows, reach, 12 * sizeof(double) * cloth->rows.stride);
    ck_waves_run(waves, &(ck_WaveWork){run_wave, cloth, (passes + cloth->depth - 1) / cloth->depth,
                                       cloth->rows.rows + reach * (cloth->depth - 1), reach * cloth->depth});
}

void ck_explicit_drift(ck_ExplicitCloth *cloth) {
    for (int row = 0; row < cloth->rows.rows; row++) run_row(cloth, 0, row);
}

void ck_explicit_kick(ck_ExplicitCloth *cloth) {
    cloth->substeps = 1;
    for (int row = 0; row < cloth->rows.rows; row++) run_row(cloth, 1, row);
}

int ck_explicit_find_near(const ck_ExplicitCloth *cloth, const ck_NearSurface *surfaces, int count, int *particles) {
    const ck_Rows *rows = &cloth->rows;
    int found = 0;
    for (int row = 0; row < rows->rows; row++) {
        int vectors = cloth->loops->near_row(cloth, row, surfaces, count, cloth->near, cloth->near_vectors);
        for (int i = 0; i < vectors; i++)
            for (int lane = 0; lane < CK_STRIPE; lane++) {
                const int vector = cloth->near_vectors[i], column = lane * rows->span + vector;
                const long single = ck_rows_place(rows, row, vector).single + lane;
                if (column < rows->columns && cloth->near[vector * CK_STRIPE + lane] > 0 && cloth->gain[single] > 0)
                    particles[found++] = row * rows->columns + column;
            }
    }
    return found;
}

static long tile_of(const ck_ExplicitCloth *cloth, int particle) {
    return ck_rows_at(&cloth->rows, particle / cloth->rows.columns, particle % cloth->rows.columns).tile;
}

void ck_explicit_take(const ck_ExplicitCloth *cloth, int particle, double *position, double *velocity,
                      double *acceleration) {
    const long tile = tile_of(cloth, particle);
    for (int axis = 0; axis < 3; axis++) {
        position[axis] = cloth->x[tile + axis * CK_STRIPE];
        velocity[axis] = cloth->v[tile + axis * CK_STRIPE];
        acceleration[axis] = cloth->a[tile + axis * CK_STRIPE];
    }
}

void ck_explicit_put(const ck_ExplicitCloth *cloth, int particle, const double *velocity, const double *position,
                     const double *predicted) {
    const long tile = tile_of(cloth, particle);
    for (int axis = 0; axis < 3; axis++) {
        cloth->v[tile + axis * CK_STRIPE] = velocity[axis];
        if (position) cloth->x[tile + axis * CK_STRIPE] = position[axis];
        if (predicted) cloth->predicted[tile + axis * CK_STRIPE] = predicted[axis];
    }
}

void ck_explicit_read(const ck_ExplicitCloth *cloth, double *position, double *velocity) {
    ck_rows_store(&cloth->rows, position, cloth->x);
    ck_rows_store(&cloth->rows, velocity, cloth->v);
}

void ck_explicit_destroy(ck_ExplicitCloth *cloth) {
    if (!cloth) return;
    free(cloth->state);
    free(cloth->pairs);
    free(cloth->near_vectors);
    free(cloth);
}

static int terms_of(const ck_Model *model, const ck_RowSprings *springs) {
    int terms = (springs->damping > 0 ? CK_ROW_DAMPED : 0) | (model->drag > 0 ? CK_ROW_DRAGGED : 0) |
                (springs->rest[CK_SHEAR] > 0 ? CK_ROW_SHEARED : 0) | (springs->rest[CK_BEND] > 0 ? CK_ROW_BENT : 0);
    // what bends has a loop that knows all else, with the strength 0 for what is not there
    return terms & CK_ROW_BENT ? terms | CK_ROW_DAMPED | CK_ROW_DRAGGED : terms;
}

ck_Status ck_explicit_create(ck_ExplicitCloth **out, const ck_Loops *loops, const ck_Model *model,
                             const ck_RowSprings *springs, double dt, const double *position, const double *velocity,
                             const double *acceleration, const double *inverse_mass, ck_Error *error) {
    ck_ExplicitCloth *cloth = calloc(1, sizeof *cloth);
    if (!cloth) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    *cloth = (ck_ExplicitCloth){.loops = loops,
                                .rows = ck_rows_of(model),
                                .springs = *springs,
                                .dt = dt,
                                .resistance = model->drag * model->mass[0]};
    cloth->terms = terms_of(model, springs);
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++)
        cloth->slack[kind] = springs->stiffness[kind] * springs->rest[kind];
    const ck_Rows row = {.size = (size_t)cloth->rows.stride};
    cloth->state = ck_rows_allocate(&cloth->rows, 13);
    cloth->pairs = ck_rows_allocate(&row, 3);
    cloth->near_vectors = malloc((size_t)cloth->rows.span * sizeof *cloth->near_vectors);
    if (!cloth->state || !cloth->pairs || !cloth->near_vectors) {
        ck_explicit_destroy(cloth);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    const size_t size = cloth->rows.size;
    cloth->x = cloth->state;
    cloth->v = cloth->state + 3 * size;
    cloth->predicted = cloth->state + 6 * size;
    cloth->a = cloth->state + 9 * size;
    cloth->gain = cloth->state + 12 * size;
    cloth->paired = cloth->pairs;
    cloth->far_paired = cloth->pairs + row.size;
    cloth->near = cloth->pairs + 2 * row.size;
    ck_rows_mark_paired(&cloth->rows, 1, cloth->paired);
    ck_rows_mark_paired(&cloth->rows, 2, cloth->far_paired);
    ck_rows_load(&cloth->rows, cloth->x, position);
    ck_rows_load(&cloth->rows, cloth->v, velocity);
    ck_rows_load(&cloth->rows, cloth->a, acceleration);
    ck_model_field(model, 0, cloth->weight);
    for (int axis = 0; axis < 3; axis++) cloth->weight[axis] *= model->mass[0];
    for (int i = 0; i < model->particle_count; i++)
        cloth->gain[ck_rows_at(&cloth->rows, i / model->columns, i % model->columns).single] = dt * inverse_mass[i];
    *out = cloth;
    return CK_OK;
}
