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
} Order;

static void free_order(Order *order) {
    free(order->first);
    free(order->neighbours);
    free(order->rank);
    free(order->queue);
    free(order->seen);
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
                     .seen = allocate(particles)};
    return order->first && order->neighbours && order->rank && order->queue && order->seen;
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

// A particle, and how many springs it has.
typedef struct Degree {
    int springs, particle, rank;
} Degree;

static int compare_degrees(const void *a, const void *b) {
    const Degree *x = a, *y = b;
    return x->springs != y->springs ? x->springs - y->springs : x->rank - y->rank;
}

// Gives a chunk's particles their places from a group on, those with as many springs together: each place of a group
// has room for as many as any of them has. Returns where the next chunk begins.
static int place_chunk(ck_SpringList *list, const Order *order, Degree *degrees, int from, int to, int group) {
    const int count = to - from, end = group + (count + CK_STRIPE - 1) / CK_STRIPE;
    for (int rank = from; rank < to; rank++) {
        const int particle = order->queue[rank];
        degrees[rank - from] = (Degree){order->first[particle + 1] - order->first[particle], particle, rank};
    }
    qsort(degrees, (size_t)count, sizeof *degrees, compare_degrees);
    for (int i = 0; i < (end - group) * CK_STRIPE; i++) {
        list->particle[group * CK_STRIPE + i] = i < count ? degrees[i].particle : -1;
        if (i < count) list->place[degrees[i].particle] = group * CK_STRIPE + i;
    }
    for (int i = group; i < end; i++) {
        const int last = (i - group + 1) * CK_STRIPE - 1;
        list->first[i + 1] = list->first[i] + degrees[last < count ? last : count - 1].springs;
    }
    return end;
}

// All chunks' places. Returns false without memory.
static bool place_particles(ck_SpringList *list, const Order *order, int size) {
    const int particles = order->model->particle_count, groups = particles / CK_STRIPE + list->chunks;
    Degree *degrees = malloc(sizeof *degrees * (size_t)size);
    list->chunk_start = allocate(list->chunks);
    list->place = allocate(particles);
    list->particle = allocate(groups * CK_STRIPE);
    list->first = allocate(groups);
    const bool has_memory = degrees && list->chunk_start && list->place && list->particle && list->first;
    for (int i = 0; i < list->chunks && has_memory; i++) {
        const int from = i * size, to = particles - from < size ? particles : from + size;
        list->chunk_start[i + 1] = place_chunk(list, order, degrees, from, to, list->chunk_start[i]);
    }
    if (has_memory) list->places = list->chunk_start[list->chunks] * CK_STRIPE;
    free(degrees);
    return has_memory;
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

// Zeroed where there is no spring; where all are alike, such a one has no length to pull along.
static bool allocate_values(ck_SpringList *list, const ck_Model *model, size_t vectors) {
    bool has_memory = true;
    for (int value = 0; value < CK_SPRING_VALUES; value++) {
        const bool alike = is_alike(model, value);
        const size_t bytes = sizeof(double) * CK_STRIPE * (alike ? 1 : vectors);
        list->values[value] = (ck_SpringValues){aligned_alloc(64, bytes), alike ? 0 : CK_STRIPE};
        if (list->values[value].of) memset(list->values[value].of, 0, bytes);
        has_memory &= list->values[value].of != NULL;
    }
    return has_memory;
}

// A place's next spring; so many it has already.
static void join(ck_SpringList *list, int place, int nth, const ck_Spring *spring, int other) {
    const int vector = list->first[place / CK_STRIPE] + nth, lane = place % CK_STRIPE;
    list->to[CK_STRIPE * (long)vector + lane] = (uint32_t)other * CK_POINT_BYTES;
    put_spring(list, vector, lane, spring);
}

static bool join_springs(ck_SpringList *list, const ck_Model *model) {
    const int groups = list->places / CK_STRIPE;
    const size_t vectors = (size_t)list->first[groups] + 1;
    int *counts = allocate(list->places);
    list->to = malloc(sizeof *list->to * CK_STRIPE * vectors);
    const bool has_memory = allocate_values(list, model, vectors) && counts && list->to;
    for (int group = 0; group < groups && has_memory; group++)
        for (int i = list->first[group] * CK_STRIPE; i < list->first[group + 1] * CK_STRIPE; i++)
            list->to[i] = (uint32_t)(group * CK_STRIPE + i % CK_STRIPE) * CK_POINT_BYTES;
    for (int i = 0; i < model->spring_count && has_memory; i++) {
        const int a = list->place[model->springs[i].a], b = list->place[model->springs[i].b];
        join(list, a, counts[a]++, &model->springs[i], b);
        join(list, b, counts[b]++, &model->springs[i], a);
    }
    free(counts);
    return has_memory;
}

// Chunks of whole groups.
static bool build(ck_SpringList *list, Order *order) {
    find_neighbours(order);
    const int reach = rank_particles(order),
              size = ((reach > LEAST_CHUNK ? reach : LEAST_CHUNK) + CK_STRIPE - 1) / CK_STRIPE * CK_STRIPE;
    list->chunks = (order->model->particle_count + size - 1) / size;
    return place_particles(list, order, size) && join_springs(list, order->model);
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
    free(list->place);
    free(list->particle);
    free(list->first);
    free(list->to);
    for (int value = 0; value < CK_SPRING_VALUES; value++) free(list->values[value].of);
    *list = (ck_SpringList){0};
}
