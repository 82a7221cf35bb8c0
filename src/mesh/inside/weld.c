#include "weld.h"

#include "vector.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

// A hash table of the vertices that stand for places, by the cell of the grid that each is in.
typedef struct Grid {
    int *first, *next; // of a bucket; after a vertex; −1: none
    size_t mask;
    double cell; // m; 0: a cell is one place
} Grid;

static size_t bucket_of(const Grid *grid, const int64_t *cell) {
    uint64_t hash = 0;
    for (int axis = 0; axis < 3; axis++) hash = (hash ^ (uint64_t)cell[axis]) * 0x9e3779b97f4a7c15u;
    return (size_t)(hash >> 20) & grid->mask;
}

static void cell_of(int64_t *cell, const Grid *grid, const double *position) {
    for (int axis = 0; axis < 3; axis++) {
        const double place = position[axis] + 0.0; // −0 is at 0
        if (grid->cell > 0)
            cell[axis] = (int64_t)floor(place / grid->cell);
        else
            memcpy(&cell[axis], &place, sizeof place);
    }
}

// The vertex that stands for a place within the distance; −1: none.
static int find(const Grid *grid, const double *position, int vertex) {
    const int reach = grid->cell > 0;
    int64_t middle[3], cell[3];
    cell_of(middle, grid, position + 3 * vertex);
    for (int around = 0; around < (reach ? 27 : 1); around++) {
        const int64_t off[3] = {around % 3 - 1, around / 3 % 3 - 1, around / 9 - 1};
        for (int axis = 0; axis < 3; axis++) cell[axis] = middle[axis] + (reach ? off[axis] : 0);
        for (int at = grid->first[bucket_of(grid, cell)]; at >= 0; at = grid->next[at])
            if (ck_distance(position + 3 * at, position + 3 * vertex) <= grid->cell) return at;
    }
    return -1;
}

int ck_weld(int *place, const double *position, int count, double distance) {
    size_t buckets = 16;
    while (buckets < (size_t)count) buckets *= 2;
    double largest = 0;
    for (int i = 0; i < 3 * count; i++) largest = fmax(largest, fabs(position[i]));
    Grid grid = {.first = malloc(buckets * sizeof(int)),
                 .next = malloc(((size_t)count + 1) * sizeof(int)),
                 .mask = buckets - 1,
                 // what coordinates cannot tell from none is none: its cells could not be numbered
                 .cell = distance > DBL_EPSILON * largest ? distance : 0};
    int places = grid.first && grid.next ? 0 : -1;
    for (size_t i = 0; i < buckets && !places; i++) grid.first[i] = -1;
    for (int i = 0; i < count && places >= 0; i++) {
        const int same = find(&grid, position, i);
        place[i] = same < 0 ? places++ : place[same];
        if (same >= 0) continue;
        int64_t cell[3];
        cell_of(cell, &grid, position + 3 * i);
        int *first = &grid.first[bucket_of(&grid, cell)];
        grid.next[i] = *first;
        *first = i;
    }
    free(grid.first);
    free(grid.next);
    return places;
}
