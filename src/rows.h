// A regular cloth laid out for vector instructions: one array per coordinate, each row striped over eight lanes.
//
// A row's columns are dealt out in eight runs of span columns, one a lane: column c is lane c / span of the row's
// vector c % span. So neighbours stand in neighbouring vectors, aligned, and the springs of one vector share no
// particle. Only from the last vector to the first, where a lane's run goes on in the next lane, is one element
// shifted.
#ifndef CK_ROWS_H
#define CK_ROWS_H

#include "lanes.h"
#include "model.h"

#include <stddef.h>

typedef struct ck_RowSprings {
    double stiffness[CK_SPRING_KINDS], rest[CK_SPRING_KINDS]; // N/m, m; rest 0 where there are none
    double damping;                                           // N·s/m
} ck_RowSprings;

// True for a cloth with every spring of each of its kinds, all of a kind and all masses alike: what the row kernels are
// for. A cloth that misses one spring is not.
bool ck_rows_fit(const ck_Model *model, ck_RowSprings *springs);

typedef struct ck_Rows {
    int rows, columns;
    int span;    // vectors of a row, at least 2
    long stride; // doubles of a row
    size_t size; // doubles of one array of all rows, and some: equal places do not share a cache set
} ck_Rows;

ck_Rows ck_rows_of(const ck_Model *model);

CK_INLINE long ck_rows_at(const ck_Rows *rows, int row, int column) {
    return row * rows->stride + column % rows->span * CK_LANES + column / rows->span;
}

// count arrays of a whole cloth each, zeroed and aligned, in one block; NULL without memory. Free with free.
double *ck_rows_allocate(const ck_Rows *rows, int count);

// From [3*n] interleaved to three arrays, and back. Padding is left alone.
void ck_rows_load(const ck_Rows *rows, double *const out[3], const double *vectors);
void ck_rows_store(const ck_Rows *rows, double *vectors, double *const from[3]);

// Where the vector stands that is reach columns to the right of a row's vector.
CK_INLINE long ck_rows_right(const ck_Rows *rows, int vector, int reach) {
    int to = vector + reach;
    return to < rows->span ? (long)to * CK_LANES : (long)(to - rows->span) * CK_LANES + 1;
}

// [span*CK_LANES] 1 where a column has a neighbour reach columns to its right, else 0: springs from a row's end, its
// padding and the last lane's to a next one do nothing.
void ck_rows_mark_paired(const ck_Rows *rows, int reach, double *paired);

#endif
