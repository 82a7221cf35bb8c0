// What the loop of line_kernel.c works on.
#ifndef CK_LINE_LOOP_H
#define CK_LINE_LOOP_H

#include "constraint_kind.h"

// Columns of nothing at either side of a cloth: diagonals that begin or end beside it are read there.
#define CK_MARGIN CK_STRIPE

// What a line's springs have in common: α̃/(1 + γ̃), 1/kg; α̃; γ̃; 1/(1 + γ̃); m.
typedef struct ck_LineSprings {
    ck_Real softness, compliance, gamma, share, rest;
} ck_LineSprings;

// Lines go along rows, or down, or by a column aside in each row.
typedef enum ck_LineKind {
    CK_LINES_ALONG,
    CK_LINES_DOWN,
    CK_LINES_DOWN_RIGHT,
    CK_LINES_DOWN_LEFT,
    CK_LINE_KINDS
} ck_LineKind;

// Particles row by row, each coordinate in a plane of its own.
struct ck_LinedCloth {
    ck_ProjectionHead head; // its contact of the rows with what is beside them, eight places a row of its own
    const ck_Loops *loops;
    ck_ProjectionRule rule;
    double carried, push[3]; // as in constraint_loop.h
    double size, origin[3];  // m, of the cloth; and, of its places; 0 but in single precision
    int terms, rows, columns;
    long stride, plane;                    // numbers from a row to the next, and from a coordinate to the next
    ck_Real *x, *start;                    // planes, m, from the first particle on; start: before the last substep; in
                                           // single precision x is told from there
    ck_Real *flown;                        // planes, m: where the last substep's flight ended, and surfaces pushed that
    bool *is_fresh;                        // [rows*columns] has just begun to move; NULL: none has
    ck_Real *begun;                        // planes, m, in single precision: where x began, as start's digits end
    ck_Real *before;                       // planes: m moved in the substep before the last one
    ck_Real *weight;                       // 1/kg; 0 where pinned, and beside
    ck_Real *there;                        // [columns] 1, and 0 beside
    ck_Real *turned_weight;                // weight, column by column
    long turned_stride;                    // numbers from a column to the next
    ck_Real *multiplier[CK_LINE_KINDS];    // kg·m, at a spring's first end, as weight or as turned; see terms
    long multipliers;                      // numbers of each
    ck_LineSprings springs[CK_LINE_KINDS]; // rest 0: there are none
    ck_Real *tiles, *start_tiles;          // [padded columns*3*CK_STRIPE] of the rows at work
    ck_Real *scratch;                      // [the larger of rows and columns*CK_LINE_SCRATCH]
    ck_Real *state;
};

// Places of a row, with those beside it.
CK_INLINE long ck_line_places(const struct ck_LinedCloth *cloth) {
    return cloth->stride - CK_MARGIN;
}

// What elimination leaves of each spring: its direction; its Δλ as long as the one after it moves nothing; and the
// share that its own Δλ then takes from that of the one before.
#define CK_LINE_SCRATCH (5 * CK_STRIPE)

// What a cloth does not have is not in its loop.
enum { CK_LINE_DAMPED = 1, CK_LINE_REPEATED = 2 };

#endif
