// Which case a worker takes next.
#ifndef CK_QUEUE_H
#define CK_QUEUE_H

#include "store.h"
#include "sweep.h"

#include <stdatomic.h>

// What all workers of a process have learned of what cases cost: of each engine, and of truths, the mean logarithm of
// cost over work.
typedef struct ck_Costs {
    atomic_long sums[CK_COMPARISON_MAX_ENGINES + 1]; // thousandths
    atomic_long counts[CK_COMPARISON_MAX_ENGINES + 1];
} ck_Costs;

// engine  −1: the truth
void ck_costs_learn(ck_Costs *costs, const ck_Sweep *sweep, int point, int engine, double cost);

// s that a case will take, by those of its kind; INFINITY where none is known: it is learned first.
double ck_costs_expect(const ck_Costs *costs, const ck_Sweep *sweep, int point, int engine);

typedef struct ck_Queue {
    const ck_Sweep *sweep;
    const ck_Board *board;
    const ck_Costs *costs;
    int *order;           // [points] by work, the most first
    int *truth_order;     // [truths]
    int *cursors;         // [engines + 1] in these: what is before is done; the last of truths
    unsigned char *done;  // [cases] known to be
    bool waits_for_truth; // of those that were tried last, one lacks a truth that another process is finding
} ck_Queue;

// Errors: CK_NO_MEMORY. Free with ck_queue_free in any case.
ck_Status ck_queue_create(ck_Queue *queue, const ck_Sweep *sweep, const ck_Board *board, const ck_Costs *costs,
                          ck_Error *error);
void ck_queue_free(ck_Queue *queue);

typedef enum ck_Next { CK_NEXT_CASE, CK_NEXT_WAIT, CK_NEXT_NONE, CK_NEXT_NO_LOCKS } ck_Next;
// Claims the case that is expected to take longest of those that can be run: WAIT where others have all that is left.
ck_Next ck_queue_next(ck_Queue *queue, int *index);

#endif
