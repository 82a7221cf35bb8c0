// The layout of explicit.h for regular cloths.
#include "explicit_kind.h"
#include "spring_loop.h"

#include <stdlib.h>
#include <string.h>

// Pass 0 is the start of the first substep, each other one ends a substep and starts the next. The first row has no
// springs from above; nor has the second, of those that bend.
static void run_row(void *state, long pass, int row) {
    ck_ExplicitCloth *cloth = state;
    if (pass == 0) {
        cloth->loops->explicit_start(cloth, row);
        return;
    }
    if (row == 0) memset(cloth->a, 0, 3 * sizeof(double) * (size_t)cloth->rows.stride);
    cloth->loops->explicit_row(cloth, row, pass < cloth->substeps);
}

static void step(ck_Explicit *body, uint32_t substeps, ck_Waves *waves) {
    ck_ExplicitCloth *cloth = (ck_ExplicitCloth *)body;
    cloth->substeps = substeps;
    // a row reads those below it as the pass before left them
    ck_passes_run(waves, &(ck_Passes){run_row, cloth, substeps + 1L, cloth->rows.rows,
                                      cloth->terms & CK_ROW_BENT ? 2 : 1, 12 * sizeof(double) * cloth->rows.stride});
}

static void drift(ck_Explicit *body) {
    ck_ExplicitCloth *cloth = (ck_ExplicitCloth *)body;
    for (int row = 0; row < cloth->rows.rows; row++) run_row(cloth, 0, row);
}

static void kick(ck_Explicit *body) {
    ck_ExplicitCloth *cloth = (ck_ExplicitCloth *)body;
    cloth->substeps = 1;
    for (int row = 0; row < cloth->rows.rows; row++) run_row(cloth, 1, row);
}

static int find_near(const ck_Explicit *body, const ck_NearSurface *surfaces, int count, int *particles) {
    const ck_ExplicitCloth *cloth = (const ck_ExplicitCloth *)body;
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

static void take(const ck_Explicit *body, int particle, double *position, double *velocity, double *acceleration) {
    const ck_ExplicitCloth *cloth = (const ck_ExplicitCloth *)body;
    const long tile = tile_of(cloth, particle);
    for (int axis = 0; axis < 3; axis++) {
        position[axis] = cloth->x[tile + axis * CK_STRIPE];
        velocity[axis] = cloth->v[tile + axis * CK_STRIPE];
        acceleration[axis] = cloth->a[tile + axis * CK_STRIPE];
    }
}

static void put(const ck_Explicit *body, int particle, const double *velocity, const double *position,
                const double *predicted) {
    const ck_ExplicitCloth *cloth = (const ck_ExplicitCloth *)body;
    const long tile = tile_of(cloth, particle);
    for (int axis = 0; axis < 3; axis++) {
        cloth->v[tile + axis * CK_STRIPE] = velocity[axis];
        if (position) cloth->x[tile + axis * CK_STRIPE] = position[axis];
        if (predicted) cloth->predicted[tile + axis * CK_STRIPE] = predicted[axis];
    }
}

static void read_state(const ck_Explicit *body, double *position, double *velocity) {
    const ck_ExplicitCloth *cloth = (const ck_ExplicitCloth *)body;
    ck_rows_store(&cloth->rows, position, cloth->x);
    ck_rows_store(&cloth->rows, velocity, cloth->v);
}

static void destroy(ck_Explicit *body) {
    ck_ExplicitCloth *cloth = (ck_ExplicitCloth *)body;
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

// Where it is, and the acceleration there: what a pass gives that goes nowhere.
static void place(ck_Explicit *body, const ck_ExplicitSetup *setup) {
    ck_ExplicitCloth *cloth = (ck_ExplicitCloth *)body;
    const ck_Model *model = setup->model;
    ck_rows_load(&cloth->rows, cloth->x, setup->position);
    ck_rows_load(&cloth->rows, cloth->predicted, setup->velocity);
    for (int i = 0; i < model->particle_count; i++)
        cloth->gain[ck_rows_at(&cloth->rows, i / model->columns, i % model->columns).single] =
            setup->dt * setup->inverse_mass[i];
    kick(body);
    ck_rows_load(&cloth->rows, cloth->v, setup->velocity);
}

static ck_Status create(ck_Explicit **out, const ck_ExplicitSetup *setup, ck_Error *error) {
    const ck_Model *model = setup->model;
    ck_ExplicitCloth *cloth = calloc(1, sizeof *cloth);
    if (!cloth) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    *cloth = (ck_ExplicitCloth){
        .loops = setup->loops, .rows = ck_rows_of(model), .dt = setup->dt, .resistance = model->drag * model->mass[0]};
    ck_rows_fit(model, &cloth->springs);
    cloth->terms = terms_of(model, &cloth->springs);
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++)
        cloth->slack[kind] = cloth->springs.stiffness[kind] * cloth->springs.rest[kind];
    const ck_Rows row = {.size = (size_t)cloth->rows.stride};
    cloth->state = ck_rows_allocate(&cloth->rows, 13);
    cloth->pairs = ck_rows_allocate(&row, 3);
    cloth->near_vectors = malloc((size_t)cloth->rows.span * sizeof *cloth->near_vectors);
    if (!cloth->state || !cloth->pairs || !cloth->near_vectors) {
        destroy(&cloth->base);
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
    ck_model_field(model, 0, cloth->weight);
    for (int axis = 0; axis < 3; axis++) cloth->weight[axis] *= model->mass[0];
    place(&cloth->base, setup);
    *out = &cloth->base;
    return CK_OK;
}

const ck_ExplicitKind ck_explicit_rows = {create, place, destroy, step, drift, kick, find_near, take, put, read_state};
