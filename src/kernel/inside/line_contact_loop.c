// Compiled once for each kind of vectors; see loops.h. Contact of lines: places of a row stand in tiles beside the
// planes, eight a row of its own, as those beside a list do.
#include "lanes.h"
#include "line_loop.h"
#include "row_contact.h"

// Where a vector stands in planes, and in tiles.
typedef struct Group {
    long plane, tile, single;
} Group;

CK_INLINE Group group_at(const struct ck_LinedCloth *cloth, int row, long column) {
    const long place = row * ck_line_places(cloth) + column;
    return (Group){row * cloth->stride + column, ck_tile_of(place), place};
}

// As predict of line_loop.c; a way is carried·(x − from) + push, and what speed it had at its start stands half way
// between that and keep·(x − from).
CK_INLINE void fly(const struct ck_LinedCloth *cloth, const Group *at, bool is_last) {
    const ck_RowContact *contact = cloth->head.contact;
    const ck_Lanes none = {0}, keep = ck_lanes_all(cloth->rule.keep);
    const ck_LaneMask is_free = ck_lanes_less(none, ck_lanes_load(contact->mass + at->single));
    const ck_Lanes3 x = ck_lanes3_load_apart(cloth->x + at->plane, cloth->plane),
                    moved = ck_lanes3_subtract(x, ck_lanes3_load(contact->from + at->tile)),
                    pulled = ck_lanes3_subtract(x, ck_lanes3_load_apart(cloth->flown + at->plane, cloth->plane));
    const ck_Lanes3 way = ck_lanes3_add_scaled(ck_lanes3_all(cloth->push), ck_lanes_all(cloth->carried), moved),
                    gain = ck_lanes3_subtract_scaled(way, keep, moved);
    const ck_Lanes3 flown = ck_lanes3_choose(is_free, ck_lanes3_add(x, way), x);
    ck_lanes3_store_apart(cloth->start + at->plane, cloth->plane, x);
    ck_lanes3_store_apart(cloth->flown + at->plane, cloth->plane, flown);
    ck_lanes3_store_apart(cloth->x + at->plane, cloth->plane,
                          ck_lanes3_add_scaled(flown, ck_lanes_all(CK_LINES_KEPT), pulled));
    if (is_last) ck_lanes3_store_apart(cloth->before + at->plane, cloth->plane, moved);
    ck_lanes3_store(contact->x + at->tile, x);
    ck_lanes3_store(contact->from + at->tile, x);
    ck_lanes3_store(contact->way + at->tile, ck_lanes3_subtract_scaled(way, ck_lanes_all(0.5), gain));
    ck_lanes3_store(contact->gain + at->tile, gain);
}

// One particle by itself, over the impacts on its way.
static __attribute__((noinline)) void meet(const struct ck_LinedCloth *cloth, const Group *at, bool is_last) {
    const ck_RowContact *contact = cloth->head.contact;
    const double dt = contact->touched.dt;
    double x[3], v[3], field[3], impulse[3] = {0, 0, 0};
    double *sum = contact->impulse + at->single / CK_STRIPE * 3 * CK_STRIPE + at->single % CK_STRIPE;
    for (int axis = 0; axis < 3; axis++) {
        const long tile = at->tile + axis * CK_STRIPE;
        x[axis] = contact->x[tile];
        field[axis] = contact->gain[tile] / (dt * dt);
        v[axis] = (contact->way[tile] + 0.5 * contact->gain[tile]) / dt;
    }
    if (!contact->follower.meet(contact->follower.state, (int)at->single, field, x, v, impulse)) return;
    for (int axis = 0; axis < 3; axis++) {
        const long plane = at->plane + axis * cloth->plane;
        cloth->x[plane] += x[axis] - cloth->flown[plane];
        cloth->flown[plane] = x[axis];
        contact->from[at->tile + axis * CK_STRIPE] = x[axis] - dt * v[axis];
        if (is_last) cloth->before[plane] = (v[axis] - dt * field[axis]) * dt / cloth->rule.keep;
        sum[axis * CK_STRIPE] += impulse[axis];
    }
}

ck_LineFly CK_LOOP(ck_line_fly);
void CK_LOOP(ck_line_fly)(const struct ck_LinedCloth *cloth, int row, bool is_last) {
    for (long column = 0; column < cloth->columns; column += CK_STRIPE) {
        const Group first = group_at(cloth, row, column);
        const int eight = (int)(first.single / CK_STRIPE);
        for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES) {
            const Group group = group_at(cloth, row, column + lane);
            fly(cloth, &group, is_last);
        }
        ck_row_contact_begin(cloth->head.contact, eight);
        for (unsigned bits = cloth->loops->row_meets(cloth->head.contact, eight); bits; bits &= bits - 1) {
            const Group alone = group_at(cloth, row, column + __builtin_ctz(bits));
            meet(cloth, &alone, is_last);
        }
    }
}

// What surfaces push is no pull of springs: where the flight ended is pushed as far.
CK_INLINE void give(const struct ck_LinedCloth *cloth, const Group *at) {
    const ck_Lanes3 x = ck_lanes3_load(cloth->head.contact->x + at->tile),
                    pushed = ck_lanes3_subtract(x, ck_lanes3_load_apart(cloth->x + at->plane, cloth->plane));
    ck_lanes3_store_apart(cloth->x + at->plane, cloth->plane, x);
    ck_lanes3_store_apart(cloth->flown + at->plane, cloth->plane,
                          ck_lanes3_add(ck_lanes3_load_apart(cloth->flown + at->plane, cloth->plane), pushed));
}

ck_LinePress CK_LOOP(ck_line_press);
void CK_LOOP(ck_line_press)(const struct ck_LinedCloth *cloth) {
    for (int row = 0; row < cloth->rows; row++)
        for (long column = 0; column < cloth->columns; column += CK_STRIPE) {
            Group groups[CK_STRIPE / CK_LANES];
            for (int i = 0; i < CK_STRIPE / CK_LANES; i++) {
                groups[i] = group_at(cloth, row, column + (long)i * CK_LANES);
                ck_lanes3_store(cloth->head.contact->x + groups[i].tile,
                                ck_lanes3_load_apart(cloth->x + groups[i].plane, cloth->plane));
            }
            if (!cloth->loops->row_press(cloth->head.contact, (int)(groups[0].single / CK_STRIPE))) continue;
            for (int i = 0; i < CK_STRIPE / CK_LANES; i++) give(cloth, &groups[i]);
        }
}
