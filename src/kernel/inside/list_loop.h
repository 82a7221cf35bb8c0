// What the loops over a chunk of explicit_list.c work on.
#ifndef CK_LIST_LOOP_H
#define CK_LIST_LOOP_H

#include "explicit_kind.h"
#include "spring_list.h"

_Static_assert(CK_POINT * sizeof(double) == CK_POINT_BYTES, "as lists count");

// Points as springs ask for them: two of each, as a pass reads what the one before has left while it writes its own.
// Vectors of eight places, tiles, where no spring asks.
typedef struct ck_ExplicitList {
    ck_Explicit base; // see explicit_kind.h
    const ck_Loops *loops;
    ck_SpringList springs;
    double dt; // s
    int terms;
    uint32_t substeps;           // of this call
    int now;                     // which of the two points are
    double *x[2], *predicted[2]; // points
    double *v;                   // tiles; between substeps of a call half a substep ahead
    double *a;                   // tiles, at the end of a call
    double *load;                // tiles: what pulls whatever happens, N
    double *gain;                // [places] m/s a substep for each N: dt/m where free, else 0
    double *resistance;          // [places] N·s/m of drag
    double *mass;                // [places] kg
    uint8_t *near, *found;       // [groups] a bit for each free place that is loose; that is new among them
    double *state;
} ck_ExplicitList;

// What a body does not have is not in its loop.
enum { CK_LIST_DAMPED = 1, CK_LIST_DRAGGED = 2, CK_LIST_HANGS = 4 };

#endif
