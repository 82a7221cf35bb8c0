#include "sweep_order.h"

#include "constraint_kernel.h"
#include "constraint_loop.h"

#include <stdlib.h>

typedef struct Visit {
    long when;
    int spring;
} Visit;

static int compare_visits(const void *a, const void *b) {
    long x = ((const Visit *)a)->when, y = ((const Visit *)b)->when;
    return (x > y) - (x < y);
}

// When a sweep comes to a spring: by the row it is at, colour, vector and lane.
static long when_visited(const ck_Rows *rows, ck_Projection projection, const ck_Spring *spring) {
    int row = spring->a / rows->columns, right = spring->b % rows->columns - spring->a % rows->columns;
    int column = spring->a % rows->columns - (right < 0), vector = column % rows->span;
    bool is_late = projection == CK_PROJECT_SPRINGS;
    ck_Colour colour = is_late ? CK_DOWN_LATE : CK_DOWN;
    if (spring->kind == CK_SHEAR) colour = right > 0 ? CK_DOWN_RIGHT : CK_DOWN_LEFT;
    if (spring->b / rows->columns == row) colour = vector + 1 == rows->span ? CK_ALONG_LAST : vector % 2;
    // the colours' numbers have the order of either sweep
    return ((row + (colour == CK_DOWN_LATE)) * CK_COLOUR_COUNT + colour) * rows->stride +
           ck_rows_at(rows, 0, column).single;
}

ck_Status ck_sweep_order(const ck_Model *model, ck_Projection projection, int *order) {
    ck_RowSprings springs;
    for (int i = 0; i < model->spring_count; i++) order[i] = i;
    if (!ck_projection_fits(model, &springs)) return CK_OK;
    const ck_Rows rows = ck_rows_of(model);
    Visit *visits = malloc(sizeof *visits * (size_t)model->spring_count);
    if (!visits) return CK_NO_MEMORY;
    for (int i = 0; i < model->spring_count; i++)
        visits[i] = (Visit){when_visited(&rows, projection, &model->springs[i]), i};
    qsort(visits, (size_t)model->spring_count, sizeof *visits, compare_visits);
    for (int i = 0; i < model->spring_count; i++) order[i] = visits[i].spring;
    free(visits);
    return CK_OK;
}
