// The layout of explicit.h for regular cloths. Compiled for either precision; see single.h.
#include "explicit_kind.h"
#include "spring_loop.h"

#include <stdlib.h>
#include <string.h>

static const double none[3];

// Pass 0 is the start of the first substep, each other one ends a substep and starts the next. The first row has no
// springs from above; nor has the second, of those that bend.
static void run_row(void *state, long pass, int row) {
    ck_ExplicitCloth *cloth = state;
    if (pass == 0) {
        cloth->loops->explicit_start(cloth, row);
        return;
    }
    if (row == 0) memset(cloth->a, 0, 3 * sizeof(ck_Real) * (size_t)cloth->rows.stride);
    cloth->loops->explicit_row(cloth, row, pass < cloth->substeps);
}

static void follow(ck_ExplicitCloth *cloth) {
    const ck_Real shift[] = {cloth->x[0], cloth->x[CK_STRIPE], cloth->x[2 * CK_STRIPE]};
    if (ck_origin_follows(cloth->origin, shift, cloth->size)) ck_rows_shift(&cloth->rows, cloth->x, shift);
}

static void step(ck_Explicit *body, uint32_t substeps, ck_Waves *waves) {
    ck_ExplicitCloth *cloth = (ck_ExplicitCloth *)body;
    cloth->substeps = substeps;
    // a row reads those below it as the pass before left them
    if (!ck_rows_are_shared(&cloth->rows)) waves = NULL;
    ck_passes_run(waves, &(ck_Passes){run_row, cloth, substeps + 1L, cloth->rows.rows,
                                      cloth->terms & CK_ROW_BENT ? 2 : 1, 12 * sizeof(ck_Real) * cloth->rows.stride});
    if (CK_IS_SINGLE) follow(cloth);
}

static void kick(ck_Explicit *body) {
    ck_ExplicitCloth *cloth = (ck_ExplicitCloth *)body;
    cloth->substeps = 1;
    for (int row = 0; row < cloth->rows.rows; row++) run_row(cloth, 1, row);
}

// A place or a speed of what is near, in double precision: what its digits leave of it in single precision is kept, or
// what slides would be pushed into what it touches, and leave it.
static void take_all(const ck_Real *tiles, const ck_Real *left, long place, const double origin[3], double *to,
                     long stride) {
    if (!CK_IS_SINGLE) ck_tile_take(to, stride, tiles + place);
    for (int axis = 0; axis < 3 && CK_IS_SINGLE; axis++) {
        const long at = place + axis * CK_STRIPE;
        to[axis * stride] = tiles[at] + (origin[axis] + left[at]);
    }
}

static void put_all(ck_Real *tiles, ck_Real *left, long place, const double origin[3], const double *from,
                    long stride) {
    if (!CK_IS_SINGLE) ck_tile_put(tiles + place, from, stride);
    for (int axis = 0; axis < 3 && CK_IS_SINGLE; axis++) {
        const long at = place + axis * CK_STRIPE;
        const double all = from[axis * stride] - origin[axis];
        tiles[at] = (ck_Real)all;
        left[at] = (ck_Real)(all - tiles[at]);
    }
}

// What is new near a surface of a row, behind what is loose.
static void take_row(const ck_ExplicitCloth *shared, int row, ck_Loose *all) {
    const ck_ExplicitCloth cloth = *shared;
    const ck_Loose loose = *all;
    int count = loose.count;
    for (int i = 0; i < cloth.rows.span; i++)
        for (unsigned bits = cloth.found[i]; bits; bits &= bits - 1, count++) {
            const long place = ck_rows_place(&cloth.rows, row, i).tile + __builtin_ctz(bits);
            take_all(cloth.x, cloth.x_left, place, cloth.origin, loose.x + count, loose.stride);
            take_all(cloth.v, cloth.v_left, place, none, loose.v + count, loose.stride);
            ck_tile_take(loose.a + count, loose.stride, cloth.a + place);
            loose.mass[count] = cloth.mass;
            loose.is_alone[count] = 1;
            loose.place[count] = place;
        }
    all->count = count;
}

// Of what is not loose no digits are left.
static void forget_left(const ck_ExplicitCloth *cloth) {
    if (cloth->left) memset(cloth->left, 0, 6 * sizeof *cloth->left * cloth->rows.size);
}

static void see(ck_ExplicitCloth *cloth, const ck_NearSurface *surfaces, int count) {
#ifdef CK_SINGLE
    follow(cloth);
    for (int i = 0; i < count; i++) cloth->seen[i] = ck_lane_surface(&surfaces[i], cloth->origin, cloth->size);
    cloth->surfaces = cloth->seen;
#else
    (void)count;
    cloth->surfaces = surfaces;
#endif
}

static void drift(ck_Explicit *body, const ck_NearSurface *surfaces, int count, ck_Loose *loose, bool is_anew) {
    ck_ExplicitCloth *cloth = (ck_ExplicitCloth *)body;
    see(cloth, surfaces, count);
    if (is_anew) memset(cloth->near, 0, sizeof *cloth->near * (size_t)(cloth->rows.rows * cloth->rows.span));
    // row by row, so that what one step has read the next finds in the cache
    for (int row = 0; row < cloth->rows.rows; row++)
        if (cloth->loops->near_row(cloth, row, count)) take_row(cloth, row, loose);
    if (is_anew) forget_left(cloth);
}

static void turn(ck_Explicit *body, const ck_NearSurface *surfaces, int count, ck_Loose *loose) {
    ck_ExplicitCloth *cloth = (ck_ExplicitCloth *)body;
    cloth->substeps = 1;
    see(cloth, surfaces, count);
    for (int row = 0; row < cloth->rows.rows; row++) {
        run_row(cloth, 1, row);
        if (cloth->loops->near_row(cloth, row, count)) take_row(cloth, row, loose);
    }
}

static void take(const ck_Explicit *body, const ck_Loose *all, int count) {
    const ck_Real *a = ((const ck_ExplicitCloth *)body)->a;
    const ck_Loose loose = *all;
    for (int i = 0; i < count; i++) ck_tile_take(loose.a + i, loose.stride, a + loose.place[i]);
}

static void leave(ck_Explicit *body, const ck_Loose *loose, int which) {
    ck_ExplicitCloth *cloth = (ck_ExplicitCloth *)body;
    const long place = loose->place[which], stripe = place / (3 * CK_STRIPE);
    ck_tile_put(cloth->v + place, loose->v + which, loose->stride);
    cloth->near[stripe] &= (ck_Marks) ~(1u << place % (3 * CK_STRIPE));
    for (int axis = 0; axis < 3 && cloth->left; axis++)
        cloth->x_left[place + axis * CK_STRIPE] = cloth->v_left[place + axis * CK_STRIPE] = 0;
}

static void put(const ck_Explicit *body, const ck_Loose *all, bool is_kicked) {
    const ck_ExplicitCloth cloth = *(const ck_ExplicitCloth *)body;
    const ck_Loose loose = *all;
    const bool predicts = cloth.terms & (CK_ROW_DAMPED | CK_ROW_DRAGGED);
    for (int i = 0; i < loose.count; i++) {
        const long place = loose.place[i];
        if (is_kicked) {
            put_all(cloth.v, cloth.v_left, place, none, loose.v + i, loose.stride);
            continue;
        }
        put_all(cloth.x, cloth.x_left, place, cloth.origin, loose.x + i, loose.stride);
        if (predicts) ck_tile_put(cloth.predicted + place, loose.predicted + i, loose.stride);
    }
}

#ifndef CK_SINGLE
static const double *acceleration(const ck_Explicit *body, size_t *count) {
    const ck_ExplicitCloth *cloth = (const ck_ExplicitCloth *)body;
    *count = 3 * (size_t)(cloth->rows.rows * cloth->rows.stride);
    return cloth->a;
}
#endif

static void read_state(const ck_Explicit *body, double *position, double *velocity) {
    const ck_ExplicitCloth *cloth = (const ck_ExplicitCloth *)body;
    ck_rows_store(&cloth->rows, position, cloth->x, cloth->origin);
    ck_rows_store(&cloth->rows, velocity, cloth->v, none);
    if (!cloth->left) return;
    ck_rows_add(&cloth->rows, position, cloth->x_left);
    ck_rows_add(&cloth->rows, velocity, cloth->v_left);
}

static void destroy(ck_Explicit *body) {
    ck_ExplicitCloth *cloth = (ck_ExplicitCloth *)body;
    free(cloth->state);
    free(cloth->pairs);
    free(cloth->near);
    free(cloth->found);
    free(cloth->seen);
    free(cloth->left);
    free(cloth);
}

static int terms_of(const ck_Model *model, const ck_RowSprings *springs) {
    int terms = (springs->damping > 0 ? CK_ROW_DAMPED : 0) | (model->drag > 0 ? CK_ROW_DRAGGED : 0) |
                (springs->rest[CK_SHEAR] > 0 ? CK_ROW_SHEARED : 0) | (springs->rest[CK_BEND] > 0 ? CK_ROW_BENT : 0);
    // what bends has a loop that knows all else, with the strength 0 for what is not there
    return terms & CK_ROW_BENT ? terms | CK_ROW_DAMPED | CK_ROW_DRAGGED : terms;
}

static void pace(ck_Explicit *body, const ck_ExplicitSetup *setup) {
    ck_ExplicitCloth *cloth = (ck_ExplicitCloth *)body;
    const int columns = setup->model->columns;
    cloth->dt = (ck_Real)setup->dt;
    for (int i = 0; i < setup->model->particle_count; i++)
        cloth->gain[ck_rows_at(&cloth->rows, i / columns, i % columns).single] =
            (ck_Real)(setup->dt * setup->inverse_mass[i]);
}

static void tell_left(const ck_ExplicitCloth *cloth, const ck_ExplicitSetup *setup) {
    const int columns = cloth->rows.columns;
    for (int i = 0; i < cloth->rows.rows * columns; i++) {
        const long place = ck_rows_at(&cloth->rows, i / columns, i % columns).tile;
        put_all(cloth->x, cloth->x_left, place, cloth->origin, setup->position + 3 * i, 1);
        put_all(cloth->v, cloth->v_left, place, none, setup->velocity + 3 * i, 1);
    }
}

// Where it is, and the acceleration there: what a pass gives that goes nowhere.
static void place(ck_Explicit *body, const ck_ExplicitSetup *setup) {
    ck_ExplicitCloth *cloth = (ck_ExplicitCloth *)body;
    if (CK_IS_SINGLE) memcpy(cloth->origin, setup->position, sizeof cloth->origin);
    ck_rows_load(&cloth->rows, cloth->x, setup->position, cloth->origin);
    ck_rows_load(&cloth->rows, cloth->predicted, setup->velocity, none);
    pace(body, setup);
    kick(body);
    ck_rows_load(&cloth->rows, cloth->v, setup->velocity, none);
    if (cloth->left) tell_left(cloth, setup);
}

static bool allocate(ck_ExplicitCloth *cloth, int colliders) {
    const ck_Rows row = {.size = (size_t)cloth->rows.stride};
    const size_t span = (size_t)cloth->rows.span, rows = (size_t)cloth->rows.rows;
    cloth->state = ck_rows_allocate(&cloth->rows, 13);
    cloth->pairs = ck_rows_allocate(&row, 2);
    cloth->near = malloc(sizeof *cloth->near * span * rows);
    cloth->found = malloc(sizeof *cloth->found * span);
    if (CK_IS_SINGLE && colliders) {
        cloth->seen = calloc((size_t)colliders, sizeof *cloth->seen);
        cloth->left = ck_rows_allocate(&cloth->rows, 6);
        if (!cloth->seen || !cloth->left) return false;
        cloth->x_left = cloth->left;
        cloth->v_left = cloth->left + 3 * cloth->rows.size;
    }
    return cloth->state && cloth->pairs && cloth->near && cloth->found;
}

static void place_arrays(ck_ExplicitCloth *cloth) {
    const size_t size = cloth->rows.size;
    cloth->x = cloth->state;
    cloth->v = cloth->state + 3 * size;
    cloth->predicted = cloth->state + 6 * size;
    cloth->a = cloth->state + 9 * size;
    cloth->gain = cloth->state + 12 * size;
    cloth->paired = cloth->pairs;
    cloth->far_paired = cloth->pairs + cloth->rows.stride;
    ck_rows_mark_paired(&cloth->rows, 1, cloth->paired);
    ck_rows_mark_paired(&cloth->rows, 2, cloth->far_paired);
}

static ck_Status create(ck_Explicit **out, const ck_ExplicitSetup *setup, ck_Error *error) {
    const ck_Model *model = setup->model;
    double field[3];
    ck_ExplicitCloth *cloth = calloc(1, sizeof *cloth);
    if (!cloth) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    *cloth = (ck_ExplicitCloth){
        .loops = setup->loops, .rows = ck_rows_of(model), .resistance = (ck_Real)(model->drag * model->mass[0])};
    ck_rows_fit(model, &cloth->springs);
    cloth->terms = terms_of(model, &cloth->springs);
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++)
        cloth->slack[kind] = (ck_Real)(cloth->springs.stiffness[kind] * cloth->springs.rest[kind]);
    if (!allocate(cloth, model->collider_count)) {
        destroy(&cloth->base);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    place_arrays(cloth);
    ck_model_field(model, 0, field);
    for (int axis = 0; axis < 3; axis++) cloth->weight[axis] = (ck_Real)(model->mass[0] * field[axis]);
    cloth->size = model->size;
    cloth->mass = model->mass[0];
    place(&cloth->base, setup);
    *out = &cloth->base;
    return CK_OK;
}

const ck_ExplicitKind ck_explicit_rows = {
    .create = create,
    .place = place,
    .pace = pace,
    .destroy = destroy,
    .step = step,
    .drift = drift,
    .turn = turn,
    .kick = kick,
    .take = take,
    .put = put,
    .leave = leave,
    .read = read_state,
#ifndef CK_SINGLE
    .acceleration = acceleration,
#endif
};
