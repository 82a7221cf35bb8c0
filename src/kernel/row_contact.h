// Contact of particles in rows, for methods that correct positions: a projected cloth's rows, or any body's particles
// in rows of eight beside its list of springs, or beside its lines.
//
// A sweep pushes out of a surface whatever is inside of it, and takes from its way what friction holds: in all sweeps
// of a substep at most μ times what it was pushed out in all. Impacts are what the follower makes of them.
#ifndef CK_ROW_CONTACT_H
#define CK_ROW_CONTACT_H

#include "loops.h"
#include "model.h"
#include "rows.h"
#include "status.h"

// Places of a row of those beside something, in either precision.
#define CK_EIGHT 8

// As ck_tile_of, of eights.
CK_INLINE long ck_eight_tile(long place) {
    return place / CK_EIGHT * 3 * CK_EIGHT + place % CK_EIGHT;
}

typedef struct ck_RowContact {
    const ck_Loops *loops; // of doubles
    ck_Rows rows;
    ck_Touched touched;         // where surfaces are at the start of a substep
    const ck_NearSurface *ends; // and at its end
    ck_Follower follower;
    double *x;          // tiles, m: where all is; a projected cloth's own
    double *from;       // tiles, m: where a substep's way is measured from: its start, but for impacts
    double *way, *gain; // tiles, m, in rows of eight: speed at the start times dt, field times dt²
    double *held;       // tiles, m: what friction has taken of the way
    double *depth;      // m: how far each was pushed out
    double *mass;       // kg, 0 where it is not free
    double *impulse;    // [rows] tiles, N·s: a sum a lane, so that vectors of any width give the same
    bool *is_pressed;   // [rows] depth and held are not 0 all over
    double *state;
} ck_RowContact;

// Beside a list or lines of so many particles, in its order; mass, [n], is then set by the caller. Surfaces are copied.
// Errors: CK_NO_MEMORY. Free with ck_row_contact_destroy.
ck_Status ck_row_contact_create(ck_RowContact **contact, const ck_Loops *loops, const ck_Touched *touched,
                                const ck_Follower *follower, int particles, ck_Error *error);
// The same of a projected cloth, with the masses there; its places are then set by the caller.
ck_Status ck_row_contact_of_rows(ck_RowContact **contact, const ck_RowContact *beside, const ck_Rows *rows,
                                 ck_Error *error);
void ck_row_contact_destroy(ck_RowContact *contact);

// The surfaces where they move, [touched.count] to be set for each substep: at its start, and at its end.
ck_NearSurface *ck_row_contact_surfaces(ck_RowContact *contact, bool at_end);

// Nothing is pressed at the start of a substep.
void ck_row_contact_begin(ck_RowContact *contact, int row);

// Of those beside a list: to tiles from [3*n], and back a row's. Padding is left alone.
void ck_row_contact_take(double *tiles, const double *vectors, int particles);
void ck_row_contact_give(const ck_RowContact *contact, int row, double *position, int particles);

// N·s that surfaces have given since it was last forgotten, added to impulse, [3].
void ck_row_contact_forget_impulse(ck_RowContact *contact);
void ck_row_contact_impulse(const ck_RowContact *contact, double *impulse);

#endif
