#include "tune_grid.h"

#include <math.h>

// Most substeps with that many iterations that are still cheaper than the best known.
static uint32_t most_substeps(const ck_TuneGrid *grid, uint32_t iterations) {
    return (uint32_t)fmax(0, ceil(grid->work / (1.0 + iterations)) - 1);
}

static uint32_t most_iterations(const ck_TuneGrid *grid) {
    return grid->has_iterations ? (uint32_t)fmax(0, ceil(grid->work) - 2) : 1;
}

static bool try_pair(ck_TuneGrid *grid, uint32_t substeps, uint32_t iterations) {
    for (int variant = 0; variant < grid->variant_count && grid->tries < grid->most_tries; variant++) {
        grid->tries++;
        if (!grid->meets(grid->context, substeps, iterations, variant)) continue;
        grid->work = substeps * (1.0 + iterations);
        grid->iterations = iterations;
        return true;
    }
    return false;
}

static void refine_column(ck_TuneGrid *grid, uint32_t iterations) {
    uint32_t fails = 0, meets = iterations ? most_substeps(grid, iterations) : 0;
    if (!meets || iterations > most_iterations(grid) || !try_pair(grid, meets, iterations)) return;
    while (meets - fails > 1) {
        uint32_t middle = fails + (meets - fails) / 2;
        if (try_pair(grid, middle, iterations))
            meets = middle;
        else
            fails = middle;
    }
}

void ck_tune_grid_refine(ck_TuneGrid *grid) {
    double before;
    for (double column = 1; column <= most_iterations(grid); column = fmax(column + 1, column * M_SQRT2))
        refine_column(grid, (uint32_t)column);
    do {
        uint32_t around = grid->iterations;
        before = grid->work;
        refine_column(grid, around);
        refine_column(grid, around - 1);
        refine_column(grid, around + 1);
    } while (grid->work < before);
}

static double count_cheaper(const ck_TuneGrid *grid) {
    double count = 0;
    for (uint32_t iterations = 1; iterations <= most_iterations(grid) && count <= grid->most_tries; iterations++)
        count += most_substeps(grid, iterations);
    return count * grid->variant_count;
}

#define MOST_AHEAD 64

// Calls each pair of less work than best, the cheapest first, until one meets the tolerance.
static void exhaust(ck_TuneGrid *grid, double best) {
    ck_TunePair ahead[MOST_AHEAD];
    int most = grid->batch < MOST_AHEAD ? grid->batch : MOST_AHEAD, count = 0;
    if (most < 1) most = 1;
    for (uint32_t work = 2; work < best; work++)
        for (uint32_t iterations = 1; iterations < work && iterations <= most_iterations(grid); iterations++) {
            if (work % (iterations + 1)) continue;
            ahead[count++] = (ck_TunePair){work / (iterations + 1), iterations};
            if (count < most) continue;
            if (most > 1) grid->try_ahead(grid->context, ahead, count);
            for (int i = 0; i < count; i++)
                if (try_pair(grid, ahead[i].substeps, ahead[i].iterations)) return;
            count = 0;
        }
    for (int i = 0; i < count; i++)
        if (try_pair(grid, ahead[i].substeps, ahead[i].iterations)) return;
}

bool ck_tune_grid_exhaust(ck_TuneGrid *grid) {
    if (grid->tries + count_cheaper(grid) > grid->most_tries) return false;
    exhaust(grid, grid->work);
    return true;
}
