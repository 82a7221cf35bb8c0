// What the sweeps over rows of constraint_kernel.h work on.
#ifndef CK_CONSTRAINT_LOOP_H
#define CK_CONSTRAINT_LOOP_H

#include "constraint_kind.h"
#include "loops.h"

// One colour of a row's springs: no two of a colour share a particle. DOWN_LATE is the DOWN of the row above.
typedef enum ck_Colour {
    CK_ALONG_EVEN,
    CK_ALONG_ODD,
    CK_ALONG_LAST,
    CK_DOWN,
    CK_DOWN_RIGHT,
    CK_DOWN_LEFT,
    CK_DOWN_LATE,
    CK_COLOUR_COUNT
} ck_Colour;

// What a correction needs of a kind of springs.
typedef struct ck_Compliant {
    ck_Real compliance, gamma; // α̃ and γ̃
    ck_Real share;             // w/((1 + γ̃)·W + α̃), both ends free
    ck_Real alone;             // times which one end moves where the other is held
} ck_Compliant;

// Eight springs of one kind, a lane each; 0 where there is none: that moves nothing.
typedef struct ck_Stripe {
    ck_Real share[CK_STRIPE];      // of springs relaxation·w/((1 + γ̃)·W + α̃), of bars relaxation/(4·L²)
    ck_Real share_rest[CK_STRIPE]; // that times L, of bars times L²
    ck_Real softness[CK_STRIPE];   // of springs share·α̃·m
    ck_Real viscosity[CK_STRIPE];  // of springs share·γ̃
} ck_Stripe;

// A row's springs: those down, along it and across. All rows are alike.
typedef enum ck_Direction { CK_IS_DOWN, CK_IS_ALONG, CK_IS_ACROSS, CK_DIRECTIONS } ck_Direction;

struct ck_ProjectedCloth {
    ck_ProjectionHead head;
    const ck_Loops *loops;
    ck_Rows rows;
    ck_ProjectionRule rule;
    ck_Real carried, push[3];            // what a substep moves of what the last one moved, and m on top of that
    ck_Real mass, rest[CK_SPRING_KINDS]; // kg, m
    ck_Compliant compliant[CK_SPRING_KINDS];
    ck_Stripe *stripes[CK_DIRECTIONS]; // [span]
    ck_Real long_scale;                // of bars: the correction beyond which they are long
    int terms;
    long sweeps;            // of this call
    int depth;              // of those down, so many run interleaved
    double size, origin[3]; // m, of the cloth; and, of both; 0 but in single precision
    ck_Real *x, *start;     // tiles, m; start: before the last substep; in single precision x is told from there
    ck_Real *from;          // m: where a way is measured from: start, but for impacts; told as x is
    ck_Real *kept;          // m, in single precision: where x began, as start's digits end; else not there
    ck_Real *before;        // m moved in the substep before the last one
    ck_Real *is_free;
    ck_Real *multiplier[CK_COLOUR_COUNT]; // over m; NULL: one sweep starts from 0 and needs none
    bool *is_held;                        // [rows] a pin in the row or the one below
    long *far_from;                       // [rows] sweep from which on bars are looked at one by one
    ck_Real *state, *springs, *multipliers, *met_from;
};

// What a cloth does not have is not in its loop; TURNED is a sweep's, HELD and FAR a row's.
enum {
    CK_SWEEP_DAMPED = 1,
    CK_SWEEP_REPEATED = 2,
    CK_SWEEP_BARS = 4,
    CK_SWEEP_TURNED = 8, // colours come in the reverse order
    CK_SWEEP_HELD = 16,
    CK_SWEEP_FAR = 32,
    CK_SWEEP_A_IS_AROUND = 64, // an end of a row's last vector is the first vector, one lane on
    CK_SWEEP_B_IS_AROUND = 128
};

// A sweep at a row; and the rows, or -1, that are to begin the substep before it.
typedef struct ck_Visit {
    long sweep;
    int row, begins[2];
} ck_Visit;

// The most that are in flight together: of one sweep each, or of both halves.
#define CK_MOST_VISITS 64

// Visits that touch no particle of each other's, or, of wide cloths, are done one by one in their order.
//   ends  the rows, or -1, that each then is done with; set where there is contact, which comes after that
typedef struct ck_Visits {
    int count;
    bool is_turned;
    ck_Visit at[CK_MOST_VISITS];
    int ends[CK_MOST_VISITS][2];
} ck_Visits;

#endif
