// The springs of any body laid out for vectors: particles renumbered so that neighbours stand near, and taken eight at
// a time, a lane each.
//
// Particles have places in groups of eight, and groups make up chunks. A spring stands at both of its ends: the force
// on either is found there, and never goes through memory. It leads to a place of the same chunk, of the one before or
// of the next: chunks are to lists what rows are to regular cloths.
#ifndef CK_SPRING_LIST_H
#define CK_SPRING_LIST_H

#include "rows.h"
#include "status.h"

// Doubles of a point: three coordinates and a 0, so that it is a vector of its own.
#define CK_POINT 4
// Numbers of places are that many bytes apart, so that none is multiplied.
#define CK_POINT_BYTES 32u

// The most particles, and the most springs, whose places numbers of 32 bits reach.
#define CK_MOST_LISTED (1 << 25)

// One value a spring, a vector for each of those of a group or a pack; or, where all have the same, of one only.
typedef struct ck_SpringValues {
    double *of;
    long step; // doubles from a vector or pack to the next, or 0
} ck_SpringValues;

// N/m; N: k·L; N·s/m; m²: shorter than this it hangs slack, 0: it pushes.
typedef enum ck_SpringValue {
    CK_OF_STIFFNESS,
    CK_OF_SLACK,
    CK_OF_DAMPING,
    CK_OF_HANGING,
    CK_SPRING_VALUES
} ck_SpringValue;

// The springs of a group: the first of each of its places, then the second. Where a place has fewer they lead to
// itself.
typedef struct ck_SpringList {
    int chunks, places;
    int *chunk_start;      // [chunks + 1] groups
    int *place, *particle; // [n] of each particle; [places] of each place, −1: spare
    int *first;            // [groups + 1] vectors of springs
    uint32_t *to;          // [vectors*CK_STRIPE] the other ends' places, times CK_POINT_BYTES
    ck_SpringValues values[CK_SPRING_VALUES];
} ck_SpringList;

// Cost: linear in particles and springs. Errors: CK_NO_MEMORY, CK_REFUSED beyond CK_MOST_LISTED. Free with
// ck_spring_list_free in any case.
ck_Status ck_spring_list_build(ck_SpringList *list, const ck_Model *model, ck_Error *error);
void ck_spring_list_free(ck_SpringList *list);

#endif
