// A regular cloth laid out for vector instructions: each row striped over eight lanes, the widest vectors there are, or
// over sixteen of single precision.
//
// A row's columns are dealt out in as many runs of span columns, one a lane: column c is lane c / span of the row's
// vector c % span. So neighbours stand in neighbouring vectors, aligned, and the springs of one vector share no
// particle. Only from the last vector to the first, where a lane's run goes on in the next lane, is one element
// shifted. A vector's three coordinates stand side by side, a tile: one address serves them all.
#ifndef CK_ROWS_H
#define CK_ROWS_H

#include "model.h"

#include <stddef.h>

// Files that are compiled a second time, with CK_SINGLE, are for numbers of single precision then, of which twice as
// many are a stripe. What they define has another name there: see single.h.
#ifdef CK_SINGLE
#include "single.h"
typedef float ck_Real;
#define CK_STRIPE 16
#define CK_IS_SINGLE true
#else
typedef double ck_Real;
#define CK_STRIPE 8
#define CK_IS_SINGLE false
#endif

#define CK_INLINE static inline __attribute__((always_inline))

typedef struct ck_RowSprings {
    double stiffness[CK_SPRING_KINDS], rest[CK_SPRING_KINDS]; // N/m, m; rest 0 where there are none
    double damping;                                           // N·s/m
} ck_RowSprings;

// Where the first coordinate of a place stands among tiles, vectors of CK_STRIPE places whose three coordinates stand
// side by side; the others stand CK_STRIPE and twice that behind.
CK_INLINE long ck_tile_of(long place) {
    return place / CK_STRIPE * 3 * CK_STRIPE + place % CK_STRIPE;
}

// True where springs, a uniform field, drag and colliders are all that moves a model's particles, at even steps.
bool ck_only_springs_act(const ck_Model *model);

// True for a cloth with every spring of each of its kinds, all of a kind and all masses alike: what the row kernels are
// for. A cloth that misses one spring is not.
bool ck_rows_fit(const ck_Model *model, ck_RowSprings *springs);

typedef struct ck_Rows {
    int rows, columns;
    int span;    // vectors of a row, at least 2
    long stride; // numbers of a row of singles
    size_t size; // numbers of an array of singles, and some: equal places do not share a cache set
} ck_Rows;

ck_Rows ck_rows_of(const ck_Model *model);

// True where a row alone has work enough for a processor, and several would not stay in the first cache.
CK_INLINE bool ck_rows_are_wide(const ck_Rows *rows) {
    return rows->span > 10;
}

// True where a second thread is worth it: a pass over fewer particles takes 2 µs, and to hear of another thread
// takes up to 0.3 µs each way, and as long for each line of the cache that it has.
CK_INLINE bool ck_rows_are_shared(const ck_Rows *rows) {
    return rows->rows * rows->stride >= 600;
}

// Where a vector stands in arrays of one number a particle, and of three, tiles. Shifted by one, its last lane is what
// stands behind it: nothing that is paired, so that what is stored there is what was read. With a reach of two and rows
// of two vectors that is the next row's first, or after the last row the array's end, which is there for this, too.
typedef struct ck_Place {
    long single, tile;
} ck_Place;

CK_INLINE ck_Place ck_place_of(long single) {
    return (ck_Place){single, 3 * single};
}

CK_INLINE ck_Place ck_rows_place(const ck_Rows *rows, int row, int vector) {
    return ck_place_of(row * rows->stride + (long)vector * CK_STRIPE);
}

// The vector that is reach columns to the right of a row's vector.
CK_INLINE ck_Place ck_rows_right(const ck_Rows *rows, int row, int vector, int reach) {
    const int to = vector + reach;
    ck_Place place = ck_rows_place(rows, row, to < rows->span ? to : to - rows->span);
    const int shift = to >= rows->span;
    return (ck_Place){place.single + shift, place.tile + shift};
}

// A particle's place; its further coordinates stand CK_STRIPE and twice that behind.
CK_INLINE ck_Place ck_rows_at(const ck_Rows *rows, int row, int column) {
    const ck_Place place = ck_rows_place(rows, row, column % rows->span);
    return (ck_Place){place.single + column / rows->span, place.tile + column / rows->span};
}

// Arrays for that many numbers a particle each, zeroed and aligned, in one block; NULL without memory. Free with free.
ck_Real *ck_rows_allocate(const ck_Rows *rows, int count);

// From [3*n] interleaved, less an origin, to tiles, and back. Padding is left alone.
void ck_rows_load(const ck_Rows *rows, ck_Real *tiles, const double *vectors, const double origin[3]);
void ck_rows_store(const ck_Rows *rows, double *vectors, const ck_Real *tiles, const double origin[3]);

// Adds what tiles hold to [3*n] interleaved.
void ck_rows_add(const ck_Rows *rows, double *vectors, const ck_Real *tiles);

// The origin of what is told in single precision follows a cloth that has gone farther than it is wide. True where it
// moves, by a shift that what is told from it is to lose.
//   shift  [3] m: where the first particle is
bool ck_origin_follows(double origin[3], const ck_Real shift[3], double size);

// Tells tiles from another origin, by a shift, m, from theirs.
void ck_rows_shift(const ck_Rows *rows, ck_Real *tiles, const ck_Real shift[3]);

// [span*CK_STRIPE] 1 where a column has a neighbour reach columns to its right, else 0: springs from a row's end, its
// padding and the last lane's to a next one do nothing.
void ck_rows_mark_paired(const ck_Rows *rows, int reach, ck_Real *paired);

#endif
