#include "sweep_list.h"

#include "sweep_list_loop.h"

#include <stdlib.h>
#include <string.h>

// Rows, of fewer of which a second thread takes longer to hear of the first one's than it saves.
#define LEAST_SHARED_ROWS 24

// Springs of a pack, in the mean, at least.
#define LEAST_FILL (CK_PACK / 4)

// Springs, by their number in the order of sweeps, that wait for none before them, the lowest first: a heap; and what
// the others wait for.
typedef struct Waiting {
    int *order; // [springs] the model's
    int *heap, count;
    int *next;   // [2*springs] the next spring at each end, or -1
    int *before; // [springs] how many still come before it
} Waiting;

static void push(Waiting *waiting, int spring) {
    int at = waiting->count++;
    for (; at > 0 && waiting->heap[(at - 1) / 2] > spring; at = (at - 1) / 2)
        waiting->heap[at] = waiting->heap[(at - 1) / 2];
    waiting->heap[at] = spring;
}

static int pop(Waiting *waiting) {
    const int first = waiting->heap[0], last = waiting->heap[--waiting->count];
    int at = 0;
    for (int child; (child = 2 * at + 1) < waiting->count; at = child) {
        if (child + 1 < waiting->count && waiting->heap[child + 1] < waiting->heap[child]) child++;
        if (waiting->heap[child] >= last) break;
        waiting->heap[at] = waiting->heap[child];
    }
    waiting->heap[at] = last;
    return first;
}

static void link_springs(Waiting *waiting, const ck_Model *model, int *last) {
    for (int i = 0; i < model->particle_count; i++) last[i] = -1;
    for (int i = model->spring_count - 1; i >= 0; i--)
        for (int end = 0; end < 2; end++) {
            const ck_Spring *spring = &model->springs[waiting->order[i]];
            int *after = &last[end ? spring->b : spring->a];
            waiting->next[2 * i + end] = *after;
            if (*after >= 0) waiting->before[*after]++;
            *after = i;
        }
    for (int i = 0; i < model->spring_count; i++)
        if (!waiting->before[i]) push(waiting, i);
}

// Fills order, [spring_count*CK_PACK] at most, pack by pack with those that wait for none; returns how many packs.
static int fill_packs(Waiting *waiting, int *order) {
    int packs = 0;
    for (; waiting->count; packs++) {
        int *pack = order + (size_t)packs * CK_PACK, filled = 0;
        while (waiting->count && filled < CK_PACK) pack[filled++] = pop(waiting);
        for (int i = 0; i < filled; i++)
            for (int end = 0; end < 2; end++) {
                const int next = waiting->next[2 * pack[i] + end];
                if (next >= 0 && !--waiting->before[next]) push(waiting, next);
            }
        for (int i = 0; i < filled; i++) pack[i] = waiting->order[pack[i]];
        for (; filled < CK_PACK; filled++) pack[filled] = -1;
    }
    return packs;
}

// False without memory. No order, where packs are too empty to be worth it.
static bool schedule(ck_SweepList *list, const ck_Model *model, const ck_SweepRule *rule) {
    const size_t springs = (size_t)model->spring_count;
    int *order = malloc(sizeof *order * CK_PACK * springs),
        *last = malloc(sizeof *last * (size_t)model->particle_count);
    Waiting waiting = {.order = malloc(sizeof(int) * springs),
                       .heap = malloc(sizeof(int) * springs),
                       .next = malloc(2 * sizeof(int) * springs),
                       .before = calloc(springs, sizeof(int))};
    const bool has_memory = order && last && waiting.order && waiting.heap && waiting.next && waiting.before &&
                            !ck_sweep_order(model, rule->projection, rule->iterations, waiting.order);
    if (has_memory) {
        link_springs(&waiting, model, last);
        list->packs = fill_packs(&waiting, order);
        if ((long)list->packs * LEAST_FILL <= model->spring_count || ck_sweep_has_colours(model, rule->projection))
            list->order = realloc(order, sizeof *order * CK_PACK * (size_t)list->packs);
    }
    if (!list->order) free(order);
    free(last);
    free(waiting.order);
    free(waiting.heap);
    free(waiting.next);
    free(waiting.before);
    return has_memory;
}

// Each row has a spare of its own, so that threads do not store to one.
static void put_ends(ck_SweepList *list, const ck_Model *model) {
    const uint32_t bytes = CK_POINT_BYTES;
    for (int i = 0; i < list->packs * CK_PACK; i++) {
        const ck_Spring *spring = list->order[i] >= 0 ? &model->springs[list->order[i]] : NULL;
        const uint32_t spare = (uint32_t)(model->particle_count + i / CK_PACK / CK_ROW_PACKS) * bytes;
        list->ends[i / CK_PACK].a[i % CK_PACK] = spring ? (uint32_t)spring->a * bytes : spare;
        list->ends[i / CK_PACK].b[i % CK_PACK] = spring ? (uint32_t)spring->b * bytes : spare;
    }
}

static double value_of(const ck_Model *model, const ck_SweepRule *rule, int index, ck_SweepValue value) {
    const ck_Spring *spring = &model->springs[index];
    const double weight_a = rule->inverse_mass[spring->a], weight_b = rule->inverse_mass[spring->b],
                 weight = weight_a + weight_b;
    const bool are_bars = rule->projection == CK_PROJECT_BARS;
    switch (value) {
    case CK_SWEPT_WEIGHT_A: return weight_a;
    case CK_SWEPT_WEIGHT_B: return weight_b;
    case CK_SWEPT_REST: return spring->rest;
    case CK_SWEPT_COMPLIANCE: return are_bars ? 0 : rule->compliance[index];
    case CK_SWEPT_GAMMA: return are_bars ? 0 : rule->gamma[index];
    case CK_SWEPT_HANGS: return spring->pulls_only;
    default: break;
    }
    if (weight == 0) return 0;
    if (are_bars) return 0.5 * rule->relaxation / (spring->rest * spring->rest * weight);
    return rule->relaxation / ((1 + rule->gamma[index]) * weight + rule->compliance[index]);
}

static void put_values(ck_SweepList *list, const ck_Model *model, const ck_SweepRule *rule, ck_SweepValue value) {
    double *of = list->values[value].of;
    for (int i = 0; i < (list->values[value].step ? list->packs * CK_PACK : CK_PACK); i++)
        of[i] = !list->values[value].step ? value_of(model, rule, 0, value)
                : list->order[i] >= 0     ? value_of(model, rule, list->order[i], value)
                                          : 0;
}

// Whether one pack's worth says it of all. Weights and shares are 0 where there is no spring; others may change.
static bool is_alike(const ck_Model *model, const ck_SweepRule *rule, ck_SweepValue value) {
    if (value == CK_SWEPT_WEIGHT_A || value == CK_SWEPT_WEIGHT_B || value == CK_SWEPT_SHARE) return false;
    for (int i = 1; i < model->spring_count; i++)
        if (value_of(model, rule, i, value) != value_of(model, rule, 0, value)) return false;
    return true;
}

// How many rows, and the farthest apart that two are which share a particle; false without memory. Turned round, too:
// rows count from the other end then, and two packs may be in rows one further apart.
static bool put_in_rows(ck_SweepList *list, const ck_Model *model) {
    int *first = malloc(sizeof *first * (size_t)model->particle_count), farthest = 0;
    if (!first) return false;
    for (int i = 0; i < model->particle_count; i++) first[i] = -1;
    for (int i = 0; i < list->packs * CK_PACK; i++)
        for (int end = 0; end < 2 && list->order[i] >= 0; end++) {
            const ck_Spring *spring = &model->springs[list->order[i]];
            int *of = &first[end ? spring->b : spring->a];
            if (*of < 0) *of = i / CK_PACK;
            if (i / CK_PACK - *of > farthest) farthest = i / CK_PACK - *of;
        }
    free(first);
    list->rows = (list->packs + CK_ROW_PACKS - 1) / CK_ROW_PACKS;
    list->reach = (farthest + CK_ROW_PACKS - 1) / CK_ROW_PACKS;
    if (list->reach < 1) list->reach = 1;
    return true;
}

static bool allocate(ck_SweepList *list, const ck_Model *model, const ck_SweepRule *rule) {
    const size_t slots = (size_t)list->packs * CK_PACK, seats = CK_POINT * (size_t)(model->particle_count + list->rows);
    bool has_memory = true;
    for (int value = 0; value < CK_SWEPT_VALUES; value++) {
        const bool alike = is_alike(model, rule, value);
        list->values[value] =
            (ck_SpringValues){aligned_alloc(64, sizeof(double) * (alike ? CK_PACK : slots)), alike ? 0 : CK_PACK};
        has_memory &= list->values[value].of != NULL;
    }
    list->ends = aligned_alloc(64, sizeof *list->ends * (size_t)list->packs);
    const size_t bytes = (sizeof(double) * (slots + 2 * seats) + 63) / 64 * 64;
    list->state = aligned_alloc(64, bytes);
    if (!has_memory || !list->ends || !list->state) return false;
    memset(list->state, 0, bytes);
    list->multiplier = list->state;
    list->x = list->state + slots;
    list->start = list->x + seats;
    return true;
}

static int terms_of(const ck_Model *model, const ck_SweepRule *rule) {
    int terms = rule->iterations > 1 ? CK_SWEEP_LIST_REPEATED : 0;
    if (rule->projection == CK_PROJECT_BARS) return CK_SWEEP_LIST_BARS;
    for (int i = 0; i < model->spring_count; i++)
        terms |=
            (rule->gamma[i] > 0 ? CK_SWEEP_LIST_DAMPED : 0) | (model->springs[i].pulls_only ? CK_SWEEP_LIST_HANGS : 0);
    return terms;
}

void ck_sweep_list_destroy(ck_SweepList *list) {
    if (!list) return;
    for (int value = 0; value < CK_SWEPT_VALUES; value++) free(list->values[value].of);
    free(list->order);
    free(list->ends);
    free(list->state);
    free(list);
}

void ck_sweep_list_set(ck_SweepList *list, const ck_Model *model, const ck_SweepRule *rule) {
    for (int value = 0; value < CK_SWEPT_VALUES; value++) put_values(list, model, rule, value);
    list->terms = terms_of(model, rule);
}

ck_Status ck_sweep_list_create(ck_SweepList **out, const ck_Loops *loops, const ck_Model *model,
                               const ck_SweepRule *rule, ck_Error *error) {
    *out = NULL;
    if (!model->spring_count || model->particle_count > CK_MOST_LISTED || model->spring_count > CK_MOST_LISTED)
        return CK_OK;
    ck_SweepList *list = calloc(1, sizeof *list);
    bool has_memory = list && schedule(list, model, rule);
    if (has_memory && !list->order) {
        ck_sweep_list_destroy(list);
        return CK_OK;
    }
    if (!has_memory || !put_in_rows(list, model) || !allocate(list, model, rule)) {
        ck_sweep_list_destroy(list);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    list->loops = loops;
    list->particles = model->particle_count;
    put_ends(list, model);
    ck_sweep_list_set(list, model, rule);
    *out = list;
    return CK_OK;
}

static void seat(double *seats, const double *position, int particles) {
    for (int i = 0; i < particles; i++)
        for (int axis = 0; axis < 3; axis++) seats[CK_POINT * (long)i + axis] = position[3 * (long)i + axis];
}

void ck_sweep_list_begin(ck_SweepList *list, const double *position, const double *start) {
    seat(list->x, position, list->particles);
    seat(list->start, start, list->particles);
    if (list->terms & (CK_SWEEP_LIST_REPEATED | CK_SWEEP_LIST_HANGS))
        memset(list->multiplier, 0, sizeof(double) * CK_PACK * (size_t)list->packs);
}

typedef struct Sweeps {
    const ck_SweepList *list;
    bool are_turned;
} Sweeps;

static void sweep_row(void *state, long pass, int row) {
    const Sweeps *sweeps = state;
    const ck_SweepList *list = sweeps->list;
    const int first = row * CK_ROW_PACKS, end = first + CK_ROW_PACKS;
    (void)pass;
    list->loops->sweep_packs(list, first, end < list->packs ? end : list->packs, sweeps->are_turned);
}

// Ends, values and multipliers of a row; and what particles it has more than the rows before.
static size_t row_bytes(const ck_SweepList *list) {
    size_t doubles = 1;
    for (int value = 0; value < CK_SWEPT_VALUES; value++) doubles += list->values[value].step > 0;
    return CK_ROW_PACKS * (sizeof(ck_Pack) + doubles * CK_PACK * sizeof(double)) +
           2 * CK_POINT * sizeof(double) * (size_t)(list->particles / list->rows + 1);
}

void ck_sweep_list_sweep(const ck_SweepList *list, uint32_t count, bool are_turned, ck_Waves *waves) {
    Sweeps sweeps = {list, are_turned};
    const ck_Passes passes = {sweep_row, &sweeps, count, list->rows, list->reach, row_bytes(list)};
    ck_passes_run(list->rows < LEAST_SHARED_ROWS ? NULL : waves, &passes);
}

void ck_sweep_list_read(const ck_SweepList *list, double *position) {
    for (int i = 0; i < list->particles; i++)
        for (int axis = 0; axis < 3; axis++) position[3 * (long)i + axis] = list->x[CK_POINT * (long)i + axis];
}

void ck_sweep_list_take(ck_SweepList *list, const double *position) {
    seat(list->x, position, list->particles);
}
