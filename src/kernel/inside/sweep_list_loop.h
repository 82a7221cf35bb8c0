// What the loop over packs of sweep_list.c works on.
#ifndef CK_SWEEP_LIST_LOOP_H
#define CK_SWEEP_LIST_LOOP_H

#include "spring_list.h"
#include "sweep_list.h"

// Springs that are worked on together.
#define CK_PACK 16

// Packs of a row: what a thread sweeps before it tells so.
#define CK_ROW_PACKS 16

// The ends of a pack's springs. Where there are fewer, both ends are its row's spare particle.
typedef struct ck_Pack {
    uint32_t a[CK_PACK], b[CK_PACK]; // particles, times CK_POINT_BYTES
} ck_Pack;

// Of each spring: 1/kg of its ends; m; of springs relaxation/((1 + γ̃)·W + α̃), kg, of bars relaxation/(2·L²·W); α̃;
// γ̃; 1 where it hangs slack when it is short. 0 where there is none: that moves nothing.
typedef enum ck_SweepValue {
    CK_SWEPT_WEIGHT_A,
    CK_SWEPT_WEIGHT_B,
    CK_SWEPT_REST,
    CK_SWEPT_SHARE,
    CK_SWEPT_COMPLIANCE,
    CK_SWEPT_GAMMA,
    CK_SWEPT_HANGS,
    CK_SWEPT_VALUES
} ck_SweepValue;

struct ck_SweepList {
    const ck_Loops *loops;
    int particles, packs, terms;
    int rows, reach;                         // of packs, and how many further on one may share a particle with its own
    int *order;                              // [packs*CK_PACK] springs, -1 where there is none
    ck_Pack *ends;                           // [packs] bytes into x and start
    ck_SpringValues values[CK_SWEPT_VALUES]; // one for all where all are alike, or none has any
    double *multiplier;                      // [packs*CK_PACK] kg·m
    double *x, *start;                       // [(particles + rows)*CK_POINT] m, the last ones spare
    double *state;
};

// What a body does not have is not in its loop.
enum { CK_SWEEP_LIST_DAMPED = 1, CK_SWEEP_LIST_REPEATED = 2, CK_SWEEP_LIST_HANGS = 4, CK_SWEEP_LIST_BARS = 8 };

#endif
