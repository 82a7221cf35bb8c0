// The layout of explicit.h for any body: chunks of a list of springs in the place of rows.
#include "list_loop.h"

#include <stdlib.h>
#include <string.h>

// Doubles between arrays, so that equal places do not share a cache set.
#define APART 40

// A pass that advances leaves its points in the other array.
static void run_chunk(void *state, long pass, int chunk) {
    ck_ExplicitList *list = state;
    if (pass == 0)
        list->loops->list_start(list, chunk, list->now);
    else
        list->loops->list_chunk(list, chunk, (list->now + pass - 1) % 2, pass < list->substeps);
}

static size_t chunk_bytes(const ck_SpringList *springs) {
    const size_t places = (size_t)(springs->places / springs->chunks + 1),
                 vectors = (size_t)(springs->first[springs->places / CK_STRIPE] / springs->chunks + 1);
    size_t value_bytes = 0;
    for (int value = 0; value < CK_SPRING_VALUES; value++)
        value_bytes += springs->values[value].step ? sizeof(double) : 0;
    return places * (4 * CK_POINT + 3 * 3 + 2) * sizeof(double) +
           vectors * CK_STRIPE * (sizeof(uint32_t) + value_bytes);
}

static void step(ck_Explicit *body, uint32_t substeps, ck_Waves *waves) {
    ck_ExplicitList *list = (ck_ExplicitList *)body;
    list->substeps = substeps;
    ck_passes_run(waves,
                  &(ck_Passes){run_chunk, list, substeps + 1L, list->springs.chunks, 1, chunk_bytes(&list->springs)});
    list->now = (list->now + (int)((substeps + 1) % 2)) % 2;
}

static void kick(ck_Explicit *body) {
    ck_ExplicitList *list = (ck_ExplicitList *)body;
    list->substeps = 1;
    for (int chunk = 0; chunk < list->springs.chunks; chunk++) run_chunk(list, 1, chunk);
}

// From a point to where the coordinates of loose ones stand so far apart.
CK_INLINE void take_point(double *to, long stride, const double *from) {
    for (int axis = 0; axis < 3; axis++) to[axis * stride] = from[axis];
}

CK_INLINE void put_point(double *to, const double *from, long stride) {
    for (int axis = 0; axis < 3; axis++) to[axis] = from[axis * stride];
}

// What is new near a surface of a chunk, behind what is loose.
static void take_chunk(const ck_ExplicitList *list, int chunk, ck_Loose *loose) {
    for (int group = list->springs.chunk_start[chunk]; group < list->springs.chunk_start[chunk + 1]; group++)
        for (unsigned bits = list->found[group]; bits; bits &= bits - 1) {
            const long place = CK_STRIPE * (long)group + __builtin_ctz(bits);
            const int i = loose->count++;
            take_point(loose->x + i, loose->stride, list->x[list->now] + CK_POINT * place);
            ck_tile_take(loose->v + i, loose->stride, list->v + ck_tile_of(place));
            ck_tile_take(loose->a + i, loose->stride, list->a + ck_tile_of(place));
            loose->mass[i] = list->mass[place];
            loose->is_alone[i] = 1;
            loose->place[i] = place;
        }
}

static void start_chunk(ck_ExplicitList *list, int chunk, const ck_NearSurface *surfaces, int count, ck_Loose *loose) {
    if (list->loops->near_chunk(list, chunk, surfaces, count)) take_chunk(list, chunk, loose);
    run_chunk(list, 0, chunk);
}

static void drift(ck_Explicit *body, const ck_NearSurface *surfaces, int count, ck_Loose *loose, bool is_anew) {
    ck_ExplicitList *list = (ck_ExplicitList *)body;
    if (is_anew) memset(list->near, 0, (size_t)(list->springs.places / CK_STRIPE));
    for (int chunk = 0; chunk < list->springs.chunks; chunk++) start_chunk(list, chunk, surfaces, count, loose);
}

// A chunk's springs lead to the one before, which so starts when both are done.
static void turn(ck_Explicit *body, const ck_NearSurface *surfaces, int count, ck_Loose *loose) {
    ck_ExplicitList *list = (ck_ExplicitList *)body;
    const int chunks = list->springs.chunks;
    list->substeps = 1;
    for (int chunk = 0; chunk <= chunks; chunk++) {
        if (chunk < chunks) run_chunk(list, 1, chunk);
        if (chunk > 0) start_chunk(list, chunk - 1, surfaces, count, loose);
    }
}

static void take(const ck_Explicit *body, const ck_Loose *loose, int count) {
    const ck_ExplicitList *list = (const ck_ExplicitList *)body;
    for (int i = 0; i < count; i++) ck_tile_take(loose->a + i, loose->stride, list->a + ck_tile_of(loose->place[i]));
}

static void put(const ck_Explicit *body, const ck_Loose *loose, bool is_kicked) {
    const ck_ExplicitList *list = (const ck_ExplicitList *)body;
    for (int i = 0; i < loose->count; i++) {
        const long place = loose->place[i];
        if (is_kicked) {
            ck_tile_put(list->v + ck_tile_of(place), loose->v + i, loose->stride);
            continue;
        }
        put_point(list->x[list->now] + CK_POINT * place, loose->x + i, loose->stride);
        put_point(list->predicted[list->now] + CK_POINT * place, loose->predicted + i, loose->stride);
    }
}

static void leave(ck_Explicit *body, const ck_Loose *loose, int which) {
    ck_ExplicitList *list = (ck_ExplicitList *)body;
    const long place = loose->place[which];
    ck_tile_put(list->v + ck_tile_of(place), loose->v + which, loose->stride);
    list->near[place / CK_STRIPE] &= (uint8_t) ~(1u << place % CK_STRIPE);
}

// From [3*n] to points, and back.
static void scatter_points(const ck_ExplicitList *list, double *points, const double *vectors) {
    for (int i = 0; i < list->springs.places; i++)
        if (list->springs.particle[i] >= 0)
            put_point(points + CK_POINT * (long)i, vectors + 3 * (long)list->springs.particle[i], 1);
}

static void gather_points(const ck_ExplicitList *list, double *vectors, const double *points) {
    for (int i = 0; i < list->springs.places; i++)
        if (list->springs.particle[i] >= 0)
            take_point(vectors + 3 * (long)list->springs.particle[i], 1, points + CK_POINT * (long)i);
}

// The same to tiles, and back.
static void scatter_tiles(const ck_ExplicitList *list, double *tiles, const double *vectors) {
    for (int i = 0; i < list->springs.places; i++)
        if (list->springs.particle[i] >= 0)
            ck_tile_put(tiles + ck_tile_of(i), vectors + 3 * (long)list->springs.particle[i], 1);
}

static void gather_tiles(const ck_ExplicitList *list, double *vectors, const double *tiles) {
    for (int i = 0; i < list->springs.places; i++)
        if (list->springs.particle[i] >= 0)
            ck_tile_take(vectors + 3 * (long)list->springs.particle[i], 1, tiles + ck_tile_of(i));
}

static void read_state(const ck_Explicit *body, double *position, double *velocity) {
    const ck_ExplicitList *list = (const ck_ExplicitList *)body;
    gather_points(list, position, list->x[list->now]);
    gather_tiles(list, velocity, list->v);
}

// A kick that goes nowhere: v is not read where others step.
void ck_explicit_pull(ck_Explicit *body, const double *position, const double *velocity, double *acceleration) {
    ck_ExplicitList *list = (ck_ExplicitList *)body;
    scatter_points(list, list->x[list->now], position);
    scatter_points(list, list->predicted[list->now], velocity);
    memset(list->v, 0, 3 * sizeof(double) * (size_t)list->springs.places);
    kick(body);
    gather_tiles(list, acceleration, list->a);
}

static void destroy(ck_Explicit *body) {
    ck_ExplicitList *list = (ck_ExplicitList *)body;
    ck_spring_list_free(&list->springs);
    free(list->state);
    free(list);
}

static int terms_of(const ck_Model *model) {
    int terms = model->drag > 0 ? CK_LIST_DRAGGED : 0;
    for (int i = 0; i < model->spring_count; i++)
        terms |=
            (model->springs[i].damping > 0 ? CK_LIST_DAMPED : 0) | (model->springs[i].pulls_only ? CK_LIST_HANGS : 0);
    return terms;
}

static void pace(ck_Explicit *body, const ck_ExplicitSetup *setup) {
    ck_ExplicitList *list = (ck_ExplicitList *)body;
    list->dt = setup->dt;
    for (int i = 0; i < setup->model->particle_count; i++)
        list->gain[list->springs.place[i]] = setup->dt * setup->inverse_mass[i];
}

static const double *acceleration(const ck_Explicit *body, size_t *count) {
    const ck_ExplicitList *list = (const ck_ExplicitList *)body;
    *count = 3 * (size_t)list->springs.places;
    return list->a;
}

static void place(ck_Explicit *body, const ck_ExplicitSetup *setup) {
    ck_ExplicitList *list = (ck_ExplicitList *)body;
    const ck_Model *model = setup->model;
    for (int i = 0; i < model->particle_count; i++) {
        const int at = list->springs.place[i];
        double load[3];
        list->mass[at] = model->mass[i];
        list->resistance[at] = model->drag * model->mass[i];
        ck_model_field(model, i, load);
        for (int axis = 0; axis < 3; axis++) load[axis] *= model->mass[i];
        ck_tile_put(list->load + ck_tile_of(at), load, 1);
    }
    pace(body, setup);
    scatter_points(list, list->x[list->now], setup->position);
    scatter_points(list, list->predicted[list->now], setup->velocity);
    // where it is, and the acceleration there: what a kick gives that goes nowhere
    kick(body);
    scatter_tiles(list, list->v, setup->velocity);
}

static bool allocate(ck_ExplicitList *list) {
    const size_t places = (size_t)list->springs.places, points = CK_POINT * places + APART, tiles = 3 * places + APART;
    const size_t bytes = (4 * points + 3 * tiles + 3 * places) * sizeof(double) + 2 * places / CK_STRIPE;
    list->state = aligned_alloc(64, (bytes + 63) / 64 * 64);
    if (!list->state) return false;
    memset(list->state, 0, bytes);
    for (int i = 0; i < 2; i++) {
        list->x[i] = list->state + 2 * i * points;
        list->predicted[i] = list->x[i] + points;
    }
    list->v = list->state + 4 * points;
    list->a = list->v + tiles;
    list->load = list->a + tiles;
    list->gain = list->load + tiles;
    list->resistance = list->gain + places;
    list->mass = list->resistance + places;
    list->near = (uint8_t *)(list->mass + places);
    list->found = list->near + places / CK_STRIPE;
    return true;
}

static ck_Status create(ck_Explicit **out, const ck_ExplicitSetup *setup, ck_Error *error) {
    ck_ExplicitList *list = calloc(1, sizeof *list);
    if (!list) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Status status = ck_spring_list_build(&list->springs, setup->model, error);
    if (!status && !allocate(list)) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (status) {
        destroy(&list->base);
        return status;
    }
    list->loops = setup->loops;
    list->dt = setup->dt;
    list->terms = terms_of(setup->model);
    place(&list->base, setup);
    *out = &list->base;
    return CK_OK;
}

const ck_ExplicitKind ck_explicit_list = {
    .create = create,
    .place = place,
    .pace = pace,
    .acceleration = acceleration,
    .destroy = destroy,
    .step = step,
    .drift = drift,
    .turn = turn,
    .kick = kick,
    .take = take,
    .put = put,
    .leave = leave,
    .read = read_state,
};
