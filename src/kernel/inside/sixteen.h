// Contact of what is in single precision: sixteen places, as two eights of doubles beside them. Single precision says
// which sixteens a surface may be in reach of; what happens to these is worked out in double precision, from where they
// start in the substep and the ways from there, which are known to 6e-8 of themselves. Included by files of single
// precision alone.
#ifndef CK_SIXTEEN_H
#define CK_SIXTEEN_H

#include "constraint_kind.h"
#include "near.h"
#include "row_contact.h"

// Where sixteen places stand: their first coordinates, the others so far apart.
typedef struct ck_Sixteen {
    const ck_ProjectionHead *head;
    const double *origin; // [3] m
    long place;           // of the first one; eights are numbered as places are
    const ck_Real *start; // m, from the origin; and m from there:
    ck_Real *x, *from;    // where they are, and where their way is measured from
    long apart;
} ck_Sixteen;

// As many doubles as a vector holds, and as many numbers of single precision.
#define CK_HALF (CK_LANES / 2)
typedef double ck_Doubles __attribute__((vector_size(CK_VECTOR_BYTES), aligned(sizeof(double)), may_alias));
typedef float ck_Singles __attribute__((vector_size(CK_VECTOR_BYTES / 2), aligned(sizeof(float)), may_alias));

CK_INLINE ck_Doubles ck_doubles_of(const float *singles) {
    return __builtin_convertvector(*(const ck_Singles *)singles, ck_Doubles);
}

// A bit for each lane that something may be in reach of.
//   x          m, from the origin
//   way, gain  m: of a way from there, speed at its start times dt, and field times dt²
CK_INLINE unsigned ck_lanes_meet(const ck_ProjectionHead *head, ck_Lanes3 x, ck_Lanes3 way, ck_Lanes3 gain) {
    unsigned bits = 0;
    const ck_Lanes most = ck_near_most(way, gain, 1);
    for (int k = 0; k < head->contact->touched.count; k++)
        bits |= ck_near_bits(ck_near_is_far(x, most, &head->seen[k]));
    return bits;
}

// Places that ways lead to, m, to the tiles of two eights.
CK_INLINE void ck_sixteen_tell(const ck_Sixteen *at, const ck_Real *ways, double *tiles) {
    for (int axis = 0; axis < 3; axis++)
        for (int lane = 0; lane < 2 * CK_EIGHT; lane += CK_HALF) {
            const long one = axis * at->apart + lane;
            *(ck_Doubles *)(tiles + ck_eight_tile(lane) + axis * CK_EIGHT) =
                at->origin[axis] + (ck_doubles_of(at->start + one) + ck_doubles_of(ways + one));
        }
}

// Their flight: nothing is pressed yet, and a bit for each that meets a surface on its way. From is where they start.
//   moved  [3*16] m, of the last substep, its coordinates 16 apart
//   push, carried, keep  as in constraint_loop.h
CK_INLINE unsigned ck_sixteen_aim(const ck_Sixteen *at, const ck_Real *moved, const ck_Real *push, double carried,
                                  double keep) {
    const ck_RowContact *contact = at->head->contact;
    const long tile = ck_eight_tile(at->place);
    const int eight = (int)(at->place / CK_EIGHT);
    ck_sixteen_tell(at, at->from, contact->x + tile);
    for (int axis = 0; axis < 3; axis++)
        for (int lane = 0; lane < 2 * CK_EIGHT; lane += CK_HALF) {
            const long one = tile + ck_eight_tile(lane) + axis * CK_EIGHT;
            const ck_Doubles last = ck_doubles_of(moved + axis * CK_STRIPE + lane),
                             way = (double)push[axis] + carried * last, gain = way - keep * last;
            *(ck_Doubles *)(contact->gain + one) = gain;
            *(ck_Doubles *)(contact->way + one) = way - 0.5 * gain;
        }
    return contact->loops->row_meets(contact, eight) | contact->loops->row_meets(contact, eight + 1) << CK_EIGHT;
}

// One of them by itself, over the impacts on its way. False where it meets none; else where it is then, and sets from.
//   to      [3] m, from start
//   before  [3] m, that it moved by before its flight
CK_INLINE bool ck_sixteen_meet(const ck_Sixteen *at, int lane, double keep, double *to, double *before) {
    const ck_RowContact *contact = at->head->contact;
    const long place = at->place + lane, tile = ck_eight_tile(place);
    const double dt = contact->touched.dt;
    double x[3], v[3], field[3], impulse[3] = {0, 0, 0};
    for (int axis = 0; axis < 3; axis++) {
        const long one = tile + axis * CK_EIGHT;
        x[axis] = contact->x[one];
        field[axis] = contact->gain[one] / (dt * dt);
        v[axis] = (contact->way[one] + 0.5 * contact->gain[one]) / dt;
    }
    if (!contact->follower.meet(contact->follower.state, (int)place, field, x, v, impulse)) return false;
    for (int axis = 0; axis < 3; axis++) {
        to[axis] = x[axis] - at->origin[axis] - at->start[axis * at->apart + lane];
        at->from[axis * at->apart + lane] = (ck_Real)(to[axis] - dt * v[axis]);
        before[axis] = (v[axis] - dt * field[axis]) * dt / keep;
        contact->impulse[tile + axis * CK_EIGHT] += impulse[axis];
    }
    return true;
}

// What surfaces push them by in a sweep, [3*16] m, coordinates 16 apart; false where nothing is touched.
CK_INLINE bool ck_sixteen_press(const ck_Sixteen *at, ck_Real *pushed) {
    const ck_RowContact *contact = at->head->contact;
    const long tile = ck_eight_tile(at->place);
    const int eight = (int)(at->place / CK_EIGHT);
    double before[6 * CK_EIGHT];
    ck_sixteen_tell(at, at->x, before);
    ck_sixteen_tell(at, at->from, contact->from + tile);
    for (int i = 0; i < 6 * CK_EIGHT; i++) contact->x[tile + i] = before[i];
    const bool first = contact->loops->row_press(contact, eight),
               second = contact->loops->row_press(contact, eight + 1);
    if (!first && !second) return false;
    for (int axis = 0; axis < 3; axis++)
        for (int lane = 0; lane < 2 * CK_EIGHT; lane += CK_HALF) {
            const long one = ck_eight_tile(lane) + axis * CK_EIGHT;
            const ck_Doubles by = *(const ck_Doubles *)(contact->x + tile + one) - *(const ck_Doubles *)(before + one);
            *(ck_Singles *)(pushed + axis * CK_STRIPE + lane) = __builtin_convertvector(by, ck_Singles);
        }
    return true;
}

#endif
