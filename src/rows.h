// A regular cloth laid out for vector instructions: one array per coordinate, rows padded to whole vectors.
#ifndef CK_ROWS_H
#define CK_ROWS_H

#include "model.h"

#include <stddef.h>

// Doubles in a row's padding unit: one 64-byte vector.
#define CK_ROWS_LANES 8

typedef struct ck_RowSprings {
    double stiffness[CK_SPRING_KINDS], rest[CK_SPRING_KINDS]; // N/m, m; stiffness 0 where there are none
    double damping;                                           // N·s/m
} ck_RowSprings;

// True for a cloth with every spring of each of its kinds, all of a kind and all masses alike: what the row kernels are
// for. A cloth that misses one spring is not.
bool ck_rows_fit(const ck_Model *model, ck_RowSprings *springs);

typedef struct ck_Rows {
    int rows, columns, stride; // stride: columns padded, doubles from row to row
    size_t size;               // doubles of one array of all rows, and some: equal places do not share a cache set
} ck_Rows;

ck_Rows ck_rows_of(const ck_Model *model);

// count arrays of a whole cloth each, zeroed and aligned, in one block; NULL without memory. Free with free.
double *ck_rows_allocate(const ck_Rows *rows, int count);

// From [3*n] interleaved to three arrays, and back. Padding is left alone.
void ck_rows_load(const ck_Rows *rows, double *const out[3], const double *vectors);
void ck_rows_store(const ck_Rows *rows, double *vectors, double *const from[3]);

#endif
