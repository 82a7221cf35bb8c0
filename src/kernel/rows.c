// Compiled for either precision; see single.h.
#include "rows.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

ck_Rows ck_rows_of(const ck_Model *model) {
    int span = (model->columns + CK_STRIPE - 1) / CK_STRIPE, rows = model->particle_count / model->columns;
    if (span < 2) span = 2; // so that the right of a vector is another
    long stride = (long)span * CK_STRIPE;
    // arrays a multiple of 4 KiB apart would fall on the same lines of the first cache
    return (ck_Rows){rows, model->columns, span, stride, (size_t)(rows * stride) + 3 * CK_STRIPE};
}

ck_Real *ck_rows_allocate(const ck_Rows *rows, int count) {
    size_t bytes = sizeof(ck_Real) * rows->size * (size_t)count;
    ck_Real *block = aligned_alloc(sizeof(ck_Real) * CK_STRIPE, bytes);
    if (block) memset(block, 0, bytes);
    return block;
}

void ck_rows_load(const ck_Rows *rows, ck_Real *tiles, const double *vectors, const double origin[3]) {
    for (int i = 0; i < rows->rows * rows->columns; i++)
        for (int axis = 0; axis < 3; axis++)
            tiles[ck_rows_at(rows, i / rows->columns, i % rows->columns).tile + axis * CK_STRIPE] =
                (ck_Real)(vectors[3 * i + axis] - origin[axis]);
}

// Without an origin adds to what is there.
CK_INLINE void store(const ck_Rows *rows, double *vectors, const ck_Real *tiles, const double *origin) {
    for (int row = 0; row < rows->rows; row++, vectors += 3 * rows->columns)
        for (int lane = 0; lane * rows->span < rows->columns; lane++) {
            double *to = vectors + 3 * lane * rows->span;
            const ck_Real *from = tiles + ck_rows_place(rows, row, 0).tile + lane;
            for (int i = 0; i < rows->span && lane * rows->span + i < rows->columns; i++, from += 3 * CK_STRIPE)
                for (int axis = 0; axis < 3; axis++)
                    to[3 * i + axis] = from[axis * CK_STRIPE] + (origin ? origin[axis] : to[3 * i + axis]);
        }
}

void ck_rows_store(const ck_Rows *rows, double *vectors, const ck_Real *tiles, const double origin[3]) {
    store(rows, vectors, tiles, origin);
}

void ck_rows_add(const ck_Rows *rows, double *vectors, const ck_Real *tiles) {
    store(rows, vectors, tiles, NULL);
}

void ck_rows_mark_paired(const ck_Rows *rows, int reach, ck_Real *paired) {
    for (int column = 0; column < rows->span * CK_STRIPE; column++)
        paired[ck_rows_at(rows, 0, column).single] = column + reach < rows->columns;
}

bool ck_origin_follows(double origin[3], const ck_Real shift[3], double size) {
    if (!(ck_length((const double[]){shift[0], shift[1], shift[2]}) > size)) return false;
    for (int axis = 0; axis < 3; axis++) origin[axis] += shift[axis];
    return true;
}

void ck_rows_shift(const ck_Rows *rows, ck_Real *tiles, const ck_Real shift[3]) {
    for (long i = 0; i < 3 * rows->rows * rows->stride; i++) tiles[i] -= shift[i / CK_STRIPE % 3];
}
