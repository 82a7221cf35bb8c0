// What the loops over a row of kernel_explicit work on.
#ifndef CK_LOOP_EXPLICIT_H
#define CK_LOOP_EXPLICIT_H

#include "loops.h"
#include "rows.h"

struct ck_ExplicitCloth {
    const ck_Loops *loops;
    ck_Rows rows;
    ck_RowSprings springs;
    double slack[CK_SPRING_KINDS];        // N: k·L
    double dt, drag, lightness, field[3]; // lightness: 1/kg; field: m/s², on every free particle
    int terms;
    uint32_t substeps; // of this call
    // tiles; v, between substeps of a call, is half a substep ahead
    double *x, *v, *predicted;
    double *a; // acceleration at the end of a call, else the springs' forces from above so far
    double *is_free, *paired, *far_paired;
    double *state, *pairs;
};

// What a scene does not have is not in its loop.
enum { CK_ROW_DAMPED = 1, CK_ROW_DRAGGED = 2, CK_ROW_SHEARED = 4, CK_ROW_BENT = 8 };

#endif
