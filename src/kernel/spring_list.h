// The springs of any body laid out for vectors: particles renumbered so that neighbours stand near, and springs in
// packs.
//
// Particles have places in chunks of a multiple of four, the last of them spare. A chunk's springs are those whose
// lower end it has; their other end is in it or in the next chunk. So chunks are to lists what rows are to regular
// cloths.
#ifndef CK_SPRING_LIST_H
#define CK_SPRING_LIST_H

#include "rows.h"
#include "status.h"

// Doubles of a point: three coordinates and a 0, so that it is a vector of its own.
#define CK_POINT 4

// Springs that are worked on together.
#define CK_PACK 16
// What stands at a place and for a spring, in bytes: numbers of theirs are as far apart, so that none is multiplied.
#define CK_SEAT_BYTES 64u
#define CK_FORCE_BYTES 32u
// The most particles, and the most springs, whose places, some of them spare, numbers of 32 bits reach.
#define CK_MOST_LISTED (1 << 25)

// The ends of a pack's springs. Where there are fewer, both ends are the chunk's spare place.
typedef struct ck_Pack {
    uint32_t a[CK_PACK], b[CK_PACK]; // places, times CK_SEAT_BYTES
} ck_Pack;

// One value a spring; or, where all have the same, of one pack only.
typedef struct ck_SpringValues {
    double *of; // [packs*CK_PACK] or [CK_PACK]
    long step;  // doubles from a pack to the next: CK_PACK, or 0
} ck_SpringValues;

// N/m; N: k·L; N·s/m; m²: shorter than this it hangs slack, 0: it pushes.
typedef enum ck_SpringValue {
    CK_OF_STIFFNESS,
    CK_OF_SLACK,
    CK_OF_DAMPING,
    CK_OF_HANGING,
    CK_SPRING_VALUES
} ck_SpringValue;

// Places whose springs are summed together.
#define CK_QUAD 4

// The springs of four places: so many of which they are the end a, and then so many of which they are b; place by place
// the first of each, then the second. Where a place has fewer there are some without force.
typedef struct ck_Quad {
    int first, lower, upper; // of joined
} ck_Quad;

typedef struct ck_SpringList {
    int chunks, places;
    int *chunk_start;      // [chunks + 1] places
    int *pack_start;       // [chunks + 1] packs
    int *place, *particle; // [n] of each particle; [places] of each place, −1: spare
    ck_Pack *packs;
    ck_SpringValues values[CK_SPRING_VALUES];
    ck_Quad *quads;   // [places/4]; in a chunk places with as many springs stand together
    uint32_t *joined; // CK_PACK times the pack, and the lane, times CK_FORCE_BYTES; without force: beyond all packs
} ck_SpringList;

// Cost: linear in particles and springs. Errors: CK_NO_MEMORY, CK_REFUSED beyond CK_MOST_LISTED. Free with
// ck_spring_list_free in any case.
ck_Status ck_spring_list_build(ck_SpringList *list, const ck_Model *model, ck_Error *error);
void ck_spring_list_free(ck_SpringList *list);

#endif
