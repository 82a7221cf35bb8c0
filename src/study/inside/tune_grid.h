// The cheapest whole numbers of substeps and iterations that meet a tolerance, once some are known that do.
#ifndef CK_TUNE_GRID_H
#define CK_TUNE_GRID_H

#include <stdbool.h>
#include <stdint.h>

typedef struct ck_TunePair {
    uint32_t substeps, iterations;
} ck_TunePair;

typedef struct ck_TuneGrid {
    bool has_iterations; // of the solver; else substeps alone are searched
    int variant_count;   // of what else is tried at each pair
    double work;         // substeps·(1 + iterations) of the cheapest known to meet the tolerance
    uint32_t iterations; // of that one
    int tries, most_tries;
    // Runs one; true where it meets the tolerance.
    bool (*meets)(void *context, uint32_t substeps, uint32_t iterations, int variant);
    // Runs those that are soon asked for, side by side, batch of them at most; batch at most 1: never.
    void (*try_ahead)(void *context, const ck_TunePair *pairs, int count);
    int batch;
    void *context;
} ck_TuneGrid;

// From coarse to fine in iterations: for some counts of them the least substeps, by bisection, on the assumption that
// more substeps err less. Then their neighbours, until none is cheaper.
void ck_tune_grid_refine(ck_TuneGrid *grid);

// Every pair that would be cheaper, the cheapest first; nothing is assumed. False where they are more than most_tries.
bool ck_tune_grid_exhaust(ck_TuneGrid *grid);

#endif
