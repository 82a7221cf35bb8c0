// The layout of explicit.h for any body: chunks of a list of springs in the place of rows.
#include "list_loop.h"

#include <stdlib.h>
#include <string.h>

static void run_chunk(void *state, long pass, int chunk) {
    ck_ExplicitList *list = state;
    if (pass == 0)
        list->loops->list_start(list, chunk);
    else
        list->loops->list_chunk(list, chunk, pass < list->substeps);
}

static size_t chunk_bytes(const ck_SpringList *springs) {
    const size_t places = (size_t)(springs->places / springs->chunks + 1),
                 packs = (size_t)(springs->pack_start[springs->chunks] / springs->chunks + 1);
    return places * (5 * CK_POINT + 2) * sizeof(double) +
           packs * (sizeof(ck_Pack) + CK_PACK * (CK_POINT + 2) * sizeof(double));
}

static void step(ck_Explicit *body, uint32_t substeps, ck_Waves *waves) {
    ck_ExplicitList *list = (ck_ExplicitList *)body;
    list->substeps = substeps;
    ck_passes_run(waves,
                  &(ck_Passes){run_chunk, list, substeps + 1L, list->springs.chunks, 1, chunk_bytes(&list->springs)});
}

static void kick(ck_Explicit *body) {
    ck_ExplicitList *list = (ck_ExplicitList *)body;
    list->substeps = 1;
    for (int chunk = 0; chunk < list->springs.chunks; chunk++) run_chunk(list, 1, chunk);
}

CK_INLINE void take_point(double *to, long stride, const double *from) {
    for (int axis = 0; axis < 3; axis++) to[axis * stride] = from[axis];
}

// Those of a chunk that are marked near, and free; returns how many there are by then.
static int take_chunk(const ck_ExplicitList *list, int chunk, ck_Near *near, const ck_Loose *loose) {
    const int *start = list->springs.chunk_start + chunk;
    int found = loose->count;
    for (int quad = start[0] / CK_QUAD; quad < start[1] / CK_QUAD; quad++)
        for (unsigned bits = list->near[quad]; bits; bits &= bits - 1) {
            const int place = CK_QUAD * quad + __builtin_ctz(bits);
            if (!(list->gain[place] > 0)) continue;
            take_point(loose->x + found, loose->stride, list->seats[place].x);
            take_point(loose->v + found, loose->stride, list->v + CK_POINT * (long)place);
            take_point(loose->a + found, loose->stride, list->a + CK_POINT * (long)place);
            near[found++] = (ck_Near){list->springs.particle[place], place};
        }
    return found;
}

static bool drift(ck_Explicit *body, const ck_NearSurface *surfaces, int count, ck_Near *near, ck_Loose *loose) {
    ck_ExplicitList *list = (ck_ExplicitList *)body;
    bool are_kept = true;
    loose->count = 0;
    for (int chunk = 0; chunk < list->springs.chunks; chunk++) {
        const int *start = list->springs.chunk_start + chunk, first = start[0] / CK_QUAD;
        ck_NearPart *part = &list->parts[chunk];
        list->loops->near_chunk(list, chunk, surfaces, count, list->near);
        if (!ck_near_is_kept(part, loose->count, list->near + first, list->near_before + first,
                             (size_t)(start[1] / CK_QUAD - first))) {
            *part = (ck_NearPart){loose->count, take_chunk(list, chunk, near, loose) - loose->count};
            are_kept = false;
        }
        loose->count += part->count;
        run_chunk(list, 0, chunk);
    }
    return are_kept;
}

static void take(const ck_Explicit *body, const ck_Near *near, const ck_Loose *loose) {
    const ck_ExplicitList *list = (const ck_ExplicitList *)body;
    for (int i = 0; i < loose->count; i++) take_point(loose->a + i, loose->stride, list->a + CK_POINT * near[i].place);
}

static void put(const ck_Explicit *body, const ck_Near *near, const ck_Loose *loose, bool is_kicked) {
    const ck_ExplicitList *list = (const ck_ExplicitList *)body;
    for (int i = 0; i < loose->count; i++)
        for (int axis = 0; axis < 3; axis++) {
            const long from = axis * loose->stride + i;
            if (is_kicked) {
                list->v[CK_POINT * near[i].place + axis] = loose->v[from];
                continue;
            }
            list->seats[near[i].place].x[axis] = loose->x[from];
            list->seats[near[i].place].predicted[axis] = loose->predicted[from];
        }
}

// From [3*n] to places that stand so many doubles apart, and back.
static void scatter(const ck_ExplicitList *list, double *places, long apart, const double *vectors) {
    for (int i = 0; i < list->springs.places; i++)
        if (list->springs.particle[i] >= 0)
            memcpy(places + apart * i, vectors + 3 * (long)list->springs.particle[i], 3 * sizeof *places);
}

static void gather(const ck_ExplicitList *list, double *vectors, const double *places, long apart) {
    for (int i = 0; i < list->springs.places; i++)
        if (list->springs.particle[i] >= 0)
            memcpy(vectors + 3 * (long)list->springs.particle[i], places + apart * i, 3 * sizeof *places);
}

static void seat(const ck_ExplicitList *list, const double *position, const double *predicted) {
    scatter(list, list->seats->x, sizeof(ck_Seat) / sizeof(double), position);
    scatter(list, list->seats->predicted, sizeof(ck_Seat) / sizeof(double), predicted);
}

static void read_state(const ck_Explicit *body, double *position, double *velocity) {
    const ck_ExplicitList *list = (const ck_ExplicitList *)body;
    gather(list, position, list->seats->x, sizeof(ck_Seat) / sizeof(double));
    gather(list, velocity, list->v, CK_POINT);
}

// A kick that goes nowhere: v is not read where others step.
void ck_explicit_pull(ck_Explicit *body, const double *position, const double *velocity, double *acceleration) {
    ck_ExplicitList *list = (ck_ExplicitList *)body;
    seat(list, position, velocity);
    memset(list->v, 0, CK_POINT * sizeof(double) * (size_t)list->springs.places);
    kick(body);
    gather(list, acceleration, list->a, CK_POINT);
}

static void destroy(ck_Explicit *body) {
    ck_ExplicitList *list = (ck_ExplicitList *)body;
    ck_spring_list_free(&list->springs);
    free(list->state);
    free(list->parts);
    free(list);
}

static int terms_of(const ck_Model *model) {
    int terms = 0;
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
    *count = CK_POINT * (size_t)list->springs.places;
    return list->a;
}

static void place(ck_Explicit *body, const ck_ExplicitSetup *setup) {
    ck_ExplicitList *list = (ck_ExplicitList *)body;
    const ck_Model *model = setup->model;
    for (int i = 0; i < model->particle_count; i++) {
        const int at = list->springs.place[i];
        double *load = list->load + CK_POINT * (long)at;
        list->resistance[at] = model->drag * model->mass[i];
        ck_model_field(model, i, load);
        for (int axis = 0; axis < 3; axis++) load[axis] *= model->mass[i];
    }
    for (int chunk = 0; chunk < list->springs.chunks; chunk++) list->parts[chunk].first = -1;
    pace(body, setup);
    seat(list, setup->position, setup->velocity);
    // where it is, and the acceleration there: what a kick gives that goes nowhere
    kick(body);
    scatter(list, list->v, CK_POINT, setup->velocity);
}

static bool allocate(ck_ExplicitList *list) {
    const size_t places = (size_t)list->springs.places,
                 springs = (size_t)list->springs.pack_start[list->springs.chunks] * CK_PACK + 2;
    const size_t bytes = (places * (5 * CK_POINT + 3) + springs * CK_POINT + 8) * sizeof(double);
    list->parts = malloc(sizeof *list->parts * (size_t)list->springs.chunks);
    list->state = aligned_alloc(64, (bytes + 63) / 64 * 64);
    if (!list->parts || !list->state) return false;
    memset(list->state, 0, bytes);
    list->seats = (ck_Seat *)list->state;
    list->force = list->state + 2 * CK_POINT * places;
    list->v = list->force + CK_POINT * springs;
    list->a = list->v + CK_POINT * places;
    list->load = list->a + CK_POINT * places;
    list->gain = list->load + CK_POINT * places;
    list->resistance = list->gain + places;
    list->near = (uint8_t *)(list->resistance + places);
    list->near_before = list->near + places / CK_QUAD;
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

const ck_ExplicitKind ck_explicit_list = {create, place, pace, acceleration, destroy,   step,
                                          drift,  kick,  take, put,          read_state};
