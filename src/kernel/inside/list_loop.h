// What the loops over a chunk of explicit_list.c work on.
#ifndef CK_LIST_LOOP_H
#define CK_LIST_LOOP_H

#include "explicit_kind.h"
#include "spring_list.h"

// Where a place is and its predicted velocity, as its springs ask for them: one line of a cache.
typedef struct ck_Seat {
    double x[CK_POINT], predicted[CK_POINT];
} ck_Seat;
_Static_assert(sizeof(ck_Seat) == CK_SEAT_BYTES && CK_POINT * sizeof(double) == CK_FORCE_BYTES, "as lists count");

typedef struct ck_ExplicitList {
    ck_Explicit base; // see explicit_kind.h
    const ck_Loops *loops;
    ck_SpringList springs;
    double dt; // s
    int terms;
    uint32_t substeps;           // of this call
    ck_Seat *seats;              // [places]
    double *v;                   // points; between substeps of a call half a substep ahead
    double *a;                   // points, at the end of a call
    double *load;                // points: what pulls whatever happens, N
    double *force;               // a point a spring: on its end a
    double *gain;                // [places] m/s a substep for each N: dt/m where free, else 0
    double *resistance;          // [places] N·s/m of drag
    uint8_t *near, *near_before; // [places/4] a bit for each of a quad that may touch
    ck_NearPart *parts;          // [chunks]
    double *state;
} ck_ExplicitList;

// What a body does not have is not in its loop.
enum { CK_LIST_DAMPED = 1, CK_LIST_HANGS = 2 };

#endif
