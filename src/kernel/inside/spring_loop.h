// What the loops over a row of kernel_explicit work on.
#ifndef CK_SPRING_LOOP_H
#define CK_SPRING_LOOP_H

#include "explicit_kind.h"
#include "lane_surface.h"
#include "rows.h"

// A bit for each place of a vector. No char, stores to which might be to whatever there is.
typedef uint16_t ck_Marks;

typedef struct ck_ExplicitCloth {
    ck_Explicit base; // see explicit_kind.h
    const ck_Loops *loops;
    ck_Rows rows;
    ck_RowSprings springs;
    ck_Real slack[CK_SPRING_KINDS];    // N: k·L
    ck_Real dt, resistance, weight[3]; // s; N·s/m and N on each particle, of drag and of what pulls on all
    int terms;
    uint32_t substeps; // of this call
    // tiles; v, between substeps of a call, is half a substep ahead
    double size, origin[3]; // m, of the cloth; and, of x; 0 but in single precision
    double mass;            // kg
    ck_Real *x, *v, *predicted;
    ck_Real *a;    // acceleration at the end of a call, else the springs' forces from above so far
    ck_Real *gain; // m/s a substep for each N: dt/m where free, else 0
    ck_Real *paired, *far_paired;
    const ck_LaneSurface *surfaces; // of this substep
    ck_LaneSurface *seen;           // [colliders] room for them in single precision
    ck_Marks *near, *found;         // [rows*span] the free that are loose; [span] what is new among a row's
    ck_Real *x_left, *v_left;       // tiles, in single precision: of what was near, where x's and v's digits end
    ck_Real *state, *pairs, *left;
} ck_ExplicitCloth;

// What a scene does not have is not in its loop.
enum { CK_ROW_DAMPED = 1, CK_ROW_DRAGGED = 2, CK_ROW_SHEARED = 4, CK_ROW_BENT = 8 };

#endif
