#include "queue.h"

#include <math.h>
#include <stdlib.h>

void ck_costs_learn(ck_Costs *costs, const ck_Sweep *sweep, int point, int engine, double cost) {
    const int kind = engine < 0 ? CK_COMPARISON_MAX_ENGINES : engine;
    if (!(cost > 0)) return;
    atomic_fetch_add(&costs->sums[kind], (long)(1000 * log(cost / sweep->work[point])));
    atomic_fetch_add(&costs->counts[kind], 1);
}

double ck_costs_expect(const ck_Costs *costs, const ck_Sweep *sweep, int point, int engine) {
    const int kind = engine < 0 ? CK_COMPARISON_MAX_ENGINES : engine;
    const long count = atomic_load(&costs->counts[kind]);
    return count ? sweep->work[point] * exp(1e-3 * (double)atomic_load(&costs->sums[kind]) / (double)count) : INFINITY;
}

typedef struct Sorted {
    double work;
    int index;
} Sorted;

static int compare_work(const void *a, const void *b) {
    const Sorted *one = a, *other = b;
    if (one->work != other->work) return one->work > other->work ? -1 : 1;
    return one->index - other->index;
}

static int *sort_by_work(const ck_Sweep *sweep, const int *points, int count) {
    Sorted *sorted = malloc(((size_t)count + 1) * sizeof *sorted);
    int *order = malloc(((size_t)count + 1) * sizeof *order);
    for (int i = 0; i < count && sorted; i++) sorted[i] = (Sorted){sweep->work[points ? points[i] : i], i};
    if (sorted) qsort(sorted, (size_t)count, sizeof *sorted, compare_work);
    for (int i = 0; i < count && sorted && order; i++) order[i] = sorted[i].index;
    if (!sorted) free(order);
    int *found = sorted ? order : NULL;
    free(sorted);
    return found;
}

ck_Status ck_queue_create(ck_Queue *queue, const ck_Sweep *sweep, const ck_Board *board, const ck_Costs *costs,
                          ck_Error *error) {
    *queue = (ck_Queue){.sweep = sweep, .board = board, .costs = costs};
    queue->order = sort_by_work(sweep, NULL, sweep->point_count);
    queue->truth_order = sort_by_work(sweep, sweep->truth_at, sweep->truth_count);
    queue->cursors = calloc((size_t)sweep->engine_count + 1, sizeof *queue->cursors);
    queue->done = malloc((size_t)sweep->case_count + 1);
    if (!queue->order || !queue->truth_order || !queue->cursors || !queue->done)
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!ck_board_read(board, queue->done, sweep->case_count))
        return ck_fail(error, CK_IO, "%s: cannot be read", board->path);
    return CK_OK;
}

void ck_queue_free(ck_Queue *queue) {
    free(queue->order);
    free(queue->truth_order);
    free(queue->cursors);
    free(queue->done);
    *queue = (ck_Queue){0};
}

// A list is an engine's points, or the truths: its cases in order.
static int list_count(const ck_Queue *queue, int list) {
    return list == queue->sweep->engine_count ? queue->sweep->truth_count : queue->sweep->point_count;
}

static int case_of(const ck_Queue *queue, int list, int place) {
    const ck_Sweep *sweep = queue->sweep;
    return list == sweep->engine_count ? queue->truth_order[place]
                                       : sweep->truth_count + queue->order[place] * sweep->engine_count + list;
}

static bool is_mine(const ck_Queue *queue, int index) {
    const ck_SweepOptions *options = queue->sweep->options;
    // truths are everybody's: they are cases of others, too
    return options->shards <= 1 || index < queue->sweep->truth_count || index % options->shards == options->shard - 1;
}

// Passes what is done at the front of a list; false where nothing is left.
static bool move_cursor(ck_Queue *queue, int list) {
    int *cursor = &queue->cursors[list];
    while (*cursor < list_count(queue, list)) {
        const int index = case_of(queue, list, *cursor);
        if (!queue->done[index] && is_mine(queue, index)) return true;
        ++*cursor;
    }
    return false;
}

// Tries the cases of a list in order; WAIT: others have what is left of it.
static ck_Next try_list(ck_Queue *queue, int list, int *index) {
    const ck_Sweep *sweep = queue->sweep;
    for (int place = queue->cursors[list]; place < list_count(queue, list); place++) {
        const int wanted = case_of(queue, list, place);
        if (queue->done[wanted] || !is_mine(queue, wanted)) continue;
        int engine, point = ck_sweep_point(sweep, wanted, &engine);
        const int truth = engine < 0 ? -1 : sweep->truth_of[point];
        // first what it needs
        *index = truth >= 0 && !queue->done[truth] ? truth : wanted;
        ck_Claim claim = ck_board_claim(queue->board, *index);
        if (claim == CK_CLAIM_NO_LOCKS) return CK_NEXT_NO_LOCKS;
        if (claim == CK_CLAIM_DONE) queue->done[*index] = 1;
        if (claim == CK_CLAIM_DONE && *index == truth) {
            *index = wanted;
            claim = ck_board_claim(queue->board, wanted);
            if (claim == CK_CLAIM_DONE) queue->done[wanted] = 1;
        }
        if (claim == CK_CLAIM_MINE) return CK_NEXT_CASE;
        queue->waits_for_truth |= *index == truth;
    }
    return CK_NEXT_WAIT;
}

ck_Next ck_queue_next(ck_Queue *queue, int *index) {
    const ck_Sweep *sweep = queue->sweep;
    bool is_tried[CK_COMPARISON_MAX_ENGINES + 1] = {false}, is_left = false;
    queue->waits_for_truth = false;
    for (;;) {
        int best = -1;
        double most = -1;
        for (int list = 0; list <= sweep->engine_count; list++) {
            if (is_tried[list] || !move_cursor(queue, list)) continue;
            is_left = true;
            int engine, point = ck_sweep_point(sweep, case_of(queue, list, queue->cursors[list]), &engine);
            const double cost = ck_costs_expect(queue->costs, sweep, point, engine);
            if (cost > most) best = list, most = cost;
        }
        if (best < 0) return is_left ? CK_NEXT_WAIT : CK_NEXT_NONE;
        ck_Next next = try_list(queue, best, index);
        if (next != CK_NEXT_WAIT) return next;
        is_tried[best] = true;
    }
}
