#include "spring_list.h"

#include <stdlib.h>
#include <string.h>

// Particles of a chunk at least: those of springs enough for some packs.
#define LEAST_CHUNK 64

// What the building needs.
typedef struct Order {
    const ck_Model *model;
    int *first, *neighbours; // [n + 1], [2*springs]: the particles that springs join to each
    int *rank, *queue;       // [n] of each particle in the new order, and back
    int *seen;               // [n] the number of the search that saw it last
    int *by_rank, *springs;  // [n + 1], [springs]: those whose lower end has each rank
} Order;

static void free_order(Order *order) {
    free(order->first);
    free(order->neighbours);
    free(order->rank);
    free(order->queue);
    free(order->seen);
    free(order->by_rank);
    free(order->springs);
}

static int *allocate(int count) {
    return calloc((size_t)count + 1, sizeof(int));
}

static bool allocate_order(Order *order, const ck_Model *model) {
    const int particles = model->particle_count, springs = model->spring_count;
    *order = (Order){.model = model,
                     .first = allocate(particles + 1),
                     .neighbours = allocate(2 * springs),
                     .rank = allocate(particles),
                     .queue = allocate(particles),
                     .seen = allocate(particles),
                     .by_rank = allocate(particles + 1),
                     .springs = allocate(springs)};
    return order->first && order->neighbours && order->rank && order->queue && order->seen && order->by_rank &&
           order->springs;
}

// From counts at i + 1 to where each begins.
static void add_up(int *starts, int count) {
    for (int i = 0; i < count; i++) starts[i + 1] += starts[i];
}

static void find_neighbours(Order *order) {
    const ck_Model *model = order->model;
    int *fill = order->queue;
    for (int i = 0; i < model->spring_count; i++) {
        order->first[model->springs[i].a + 1]++;
        order->first[model->springs[i].b + 1]++;
    }
    add_up(order->first, model->particle_count);
    memcpy(fill, order->first, sizeof *fill * (size_t)model->particle_count);
    for (int i = 0; i < model->spring_count; i++) {
        order->neighbours[fill[model->springs[i].a]++] = model->springs[i].b;
        order->neighbours[fill[model->springs[i].b]++] = model->springs[i].a;
    }
}

// Appends all that is joined to a particle, nearest first, to the queue's end; returns the new end.
static int search(Order *order, int from, int end, int number) {
    int *queue = order->queue, done = end;
    queue[end++] = from;
    order->seen[from] = number;
    while (done < end) {
        const int particle = queue[done++];
        for (int i = order->first[particle]; i < order->first[particle + 1]; i++) {
            const int other = order->neighbours[i];
            if (order->seen[other] == number) continue;
            order->seen[other] = number;
            queue[end++] = other;
        }
    }
    return end;
}

// Cuthill and McKee 1969, from the particle that is farthest from the first of each part: no spring then leads farther
// than two layers are wide. Returns how far in ranks.
static int rank_particles(Order *order) {
    const ck_Model *model = order->model;
    int end = 0, number = 0, reach = 1;
    for (int i = 0; i < model->particle_count; i++) {
        if (order->seen[i]) continue;
        const int last = order->queue[search(order, i, end, ++number) - 1];
        end = search(order, last, end, ++number);
    }
    for (int i = 0; i < end; i++) order->rank[order->queue[i]] = i;
    for (int i = 0; i < model->spring_count; i++) {
        const int apart = abs(order->rank[model->springs[i].a] - order->rank[model->springs[i].b]);
        if (apart > reach) reach = apart;
    }
    return reach;
}

// A spring's end whose rank is lower, or the other one.
static int end_of(const Order *order, const ck_Spring *spring, bool is_lower) {
    return (order->rank[spring->a] < order->rank[spring->b]) == is_lower ? spring->a : spring->b;
}

static void sort_springs(Order *order) {
    const ck_Model *model = order->model;
    int *fill = order->seen;
    for (int i = 0; i < model->spring_count; i++)
        order->by_rank[order->rank[end_of(order, &model->springs[i], true)] + 1]++;
    add_up(order->by_rank, model->particle_count);
    memcpy(fill, order->by_rank, sizeof *fill * (size_t)model->particle_count);
    for (int i = 0; i < model->spring_count; i++)
        order->springs[fill[order->rank[end_of(order, &model->springs[i], true)]]++] = i;
}

// A particle, and how many springs it is the end of, either way: places with as many need no springs without force.
typedef struct Degrees {
    int lower, upper, particle;
} Degrees;

static int compare_degrees(const void *a, const void *b) {
    const Degrees *x = a, *y = b;
    if (x->lower != y->lower) return x->lower - y->lower;
    return x->upper != y->upper ? x->upper - y->upper : x->particle - y->particle;
}

// Springs of a quad after those of the one before.
static void add_quad(ck_SpringList *list, int quad, const Degrees *degrees, int count) {
    const ck_Quad *before = quad > 0 ? &list->quads[quad - 1] : &(ck_Quad){0};
    ck_Quad *added = &list->quads[quad];
    *added = (ck_Quad){before->first + CK_QUAD * (before->lower + before->upper), 0, 0};
    for (int i = 0; i < count; i++) {
        if (degrees[i].lower > added->lower) added->lower = degrees[i].lower;
        if (degrees[i].upper > added->upper) added->upper = degrees[i].upper;
    }
}

// Gives a chunk's particles their places from the first on; returns where the next chunk begins. At least one is spare.
static int place_chunk(ck_SpringList *list, const Order *order, Degrees *degrees, int from, int to, int place) {
    const int count = to - from, end = place + (count / CK_QUAD + 1) * CK_QUAD;
    for (int rank = from; rank < to; rank++) {
        const int particle = order->queue[rank], lower = order->by_rank[rank + 1] - order->by_rank[rank];
        degrees[rank - from] = (Degrees){lower, order->first[particle + 1] - order->first[particle] - lower, particle};
    }
    qsort(degrees, (size_t)count, sizeof *degrees, compare_degrees);
    for (int i = 0; place + i < end; i++) {
        list->particle[place + i] = i < count ? degrees[i].particle : -1;
        if (i < count) list->place[degrees[i].particle] = place + i;
        if (i % CK_QUAD == 0)
            add_quad(list, (place + i) / CK_QUAD, degrees + i, count - i < CK_QUAD ? count - i : CK_QUAD);
    }
    return end;
}

static void put_ends(ck_Pack *pack, int lane, int a, int b) {
    pack->a[lane] = (uint32_t)a * CK_SEAT_BYTES;
    pack->b[lane] = (uint32_t)b * CK_SEAT_BYTES;
}

static double value_of(const ck_Spring *spring, ck_SpringValue value) {
    switch (value) {
    case CK_OF_STIFFNESS: return spring->stiffness;
    case CK_OF_SLACK: return spring->stiffness * spring->rest;
    case CK_OF_DAMPING: return spring->damping;
    default: return spring->pulls_only ? spring->rest * spring->rest : 0;
    }
}

static void put_spring(ck_SpringList *list, int pack, int lane, const ck_Spring *spring) {
    for (int value = 0; value < CK_SPRING_VALUES; value++)
        list->values[value].of[list->values[value].step * pack + lane] = value_of(spring, value);
}

static bool is_alike(const ck_Model *model, ck_SpringValue value) {
    for (int i = 1; i < model->spring_count; i++)
        if (value_of(&model->springs[i], value) != value_of(&model->springs[0], value)) return false;
    return true;
}

// Zeroed, so that what fills a pack up pulls nothing; where all are alike it has no length to pull along.
static bool allocate_values(ck_SpringList *list, const ck_Model *model, size_t packs) {
    bool has_memory = true;
    for (int value = 0; value < CK_SPRING_VALUES; value++) {
        const bool alike = is_alike(model, value);
        const size_t bytes = sizeof(double) * CK_PACK * (alike ? 1 : packs);
        list->values[value] = (ck_SpringValues){aligned_alloc(64, bytes), alike ? 0 : CK_PACK};
        if (list->values[value].of) memset(list->values[value].of, 0, bytes);
        has_memory &= list->values[value].of != NULL;
    }
    return has_memory;
}

// Joins a place with its next spring of a kind; so many it has already.
static void join(ck_SpringList *list, int place, int nth, uint32_t spring) {
    list->joined[list->quads[place / CK_QUAD].first + nth * CK_QUAD + place % CK_QUAD] = spring * CK_FORCE_BYTES;
}

// counts: [places] springs that a place has so far, either way.
static void pack_chunk(ck_SpringList *list, const Order *order, int chunk, int from, int to, Degrees *counts) {
    const int spare = list->chunk_start[chunk + 1] - 1;
    for (int pack = list->pack_start[chunk], next = from; pack < list->pack_start[chunk + 1]; pack++)
        for (int lane = 0; lane < CK_PACK; lane++, next++) {
            if (next >= to) {
                put_ends(&list->packs[pack], lane, spare, spare);
                continue;
            }
            const ck_Spring *spring = &order->model->springs[order->springs[next]];
            const int a = list->place[end_of(order, spring, true)], b = list->place[end_of(order, spring, false)];
            const uint32_t number = (uint32_t)(pack * CK_PACK + lane);
            put_ends(&list->packs[pack], lane, a, b);
            put_spring(list, pack, lane, spring);
            join(list, a, counts[a].lower++, number);
            join(list, b, list->quads[b / CK_QUAD].lower + counts[b].upper++, number);
        }
}

static int first_rank(const Order *order, int chunk, int size) {
    const int particles = order->model->particle_count;
    return chunk * size < particles ? chunk * size : particles;
}

// All chunks' places and numbers of packs. Returns false without memory.
static bool place_particles(ck_SpringList *list, const Order *order, int size) {
    const int particles = order->model->particle_count, most = particles + CK_QUAD * list->chunks;
    Degrees *degrees = malloc(sizeof *degrees * (size_t)size);
    list->chunk_start = allocate(list->chunks);
    list->pack_start = allocate(list->chunks);
    list->place = allocate(particles);
    list->particle = allocate(most);
    list->quads = calloc((size_t)(most / CK_QUAD), sizeof *list->quads);
    const bool has_memory =
        degrees && list->chunk_start && list->pack_start && list->place && list->particle && list->quads;
    for (int i = 0; i < list->chunks && has_memory; i++) {
        const int from = first_rank(order, i, size), to = first_rank(order, i + 1, size);
        list->chunk_start[i + 1] = place_chunk(list, order, degrees, from, to, list->chunk_start[i]);
        list->pack_start[i + 1] =
            list->pack_start[i] + (order->by_rank[to] - order->by_rank[from] + CK_PACK - 1) / CK_PACK;
    }
    if (has_memory) list->places = list->chunk_start[list->chunks];
    free(degrees);
    return has_memory;
}

static bool pack_springs(ck_SpringList *list, const Order *order, int size) {
    const int packs = list->pack_start[list->chunks];
    const ck_Quad *last = &list->quads[list->places / CK_QUAD - 1];
    const int joined = last->first + CK_QUAD * (last->lower + last->upper);
    Degrees *counts = calloc((size_t)list->places, sizeof *counts);
    list->joined = malloc(sizeof *list->joined * ((size_t)joined + 1));
    list->packs = aligned_alloc(64, sizeof *list->packs * ((size_t)packs + 1));
    const bool has_memory =
        allocate_values(list, order->model, (size_t)packs + 1) && counts && list->joined && list->packs;
    for (int i = 0; i < joined && has_memory; i++) list->joined[i] = (uint32_t)(packs * CK_PACK) * CK_FORCE_BYTES;
    for (int i = 0; i < list->chunks && has_memory; i++)
        pack_chunk(list, order, i, order->by_rank[first_rank(order, i, size)],
                   order->by_rank[first_rank(order, i + 1, size)], counts);
    free(counts);
    return has_memory;
}

static bool build(ck_SpringList *list, Order *order) {
    find_neighbours(order);
    const int reach = rank_particles(order), size = reach > LEAST_CHUNK ? reach : LEAST_CHUNK;
    list->chunks = (order->model->particle_count + size - 1) / size;
    sort_springs(order);
    return place_particles(list, order, size) && pack_springs(list, order, size);
}

ck_Status ck_spring_list_build(ck_SpringList *list, const ck_Model *model, ck_Error *error) {
    Order order = {0};
    *list = (ck_SpringList){0};
    if (model->particle_count > CK_MOST_LISTED || model->spring_count > CK_MOST_LISTED)
        return ck_fail(error, CK_REFUSED, "steps at most %d particles and springs that are no regular cloth",
                       CK_MOST_LISTED);
    const bool is_built = allocate_order(&order, model) && build(list, &order);
    free_order(&order);
    return is_built ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
}

void ck_spring_list_free(ck_SpringList *list) {
    free(list->chunk_start);
    free(list->pack_start);
    free(list->place);
    free(list->particle);
    free(list->joined);
    free(list->quads);
    free(list->packs);
    for (int value = 0; value < CK_SPRING_VALUES; value++) free(list->values[value].of);
    *list = (ck_SpringList){0};
}
