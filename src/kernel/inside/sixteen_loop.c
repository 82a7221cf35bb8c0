// Compiled once for each kind of vectors; see loops.h. Contact of rows and of lines in single precision, as
// row_contact_loop.c and line_contact_loop.c have it in double precision.
#include "constraint_loop.h"
#include "line_loop.h"
#include "sixteen.h"

static const ck_Lanes none;

static ck_Sixteen of_row(const ck_ProjectedCloth *cloth, ck_Place at) {
    return (ck_Sixteen){.head = &cloth->head,
                        .origin = cloth->origin,
                        .place = at.single,
                        .start = cloth->start + at.tile,
                        .x = cloth->x + at.tile,
                        .from = cloth->from + at.tile,
                        .apart = CK_STRIPE};
}

// As predict_way of constraint_loop.c. Returns which may meet a surface on their way.
CK_INLINE unsigned fly(const ck_ProjectedCloth *cloth, ck_Place at, bool is_last, ck_Real *moved_by) {
    const ck_Lanes free = ck_lanes_load(cloth->is_free + at.single), keep = ck_lanes_all((ck_Real)cloth->rule.keep);
    const ck_Lanes3 x = ck_lanes3_load(cloth->x + at.tile), start = ck_lanes3_load(cloth->start + at.tile);
    const ck_Lanes3 moved = ck_lanes3_subtract(x, ck_lanes3_load(cloth->from + at.tile));
    const ck_Lanes3 way = ck_lanes3_add_scaled(ck_lanes3_all(cloth->push), ck_lanes_all(cloth->carried), moved);
    const ck_Lanes3 gain = ck_lanes3_subtract_scaled(way, keep, moved);
    const ck_Lanes3 there = ck_lanes3_add(start, x);
    const ck_Lanes3 left = ck_lanes3_subtract(x, ck_lanes3_subtract(there, start));
    ck_lanes3_store(cloth->start + at.tile, there);
    ck_lanes3_store(cloth->kept + at.tile, left);
    ck_lanes3_store(cloth->from + at.tile, left);
    ck_lanes3_store(cloth->x + at.tile, ck_lanes3_add_scaled(left, free, way));
    ck_lanes3_store(moved_by, moved);
    if (is_last) ck_lanes3_store(cloth->before + at.tile, moved);
    return ck_lanes_meet(&cloth->head, there, ck_lanes3_subtract_scaled(way, ck_lanes_all((ck_Real)0.5), gain), gain);
}

static __attribute__((noinline)) void meet_row(const ck_ProjectedCloth *cloth, ck_Place place, bool is_last,
                                               const ck_Real *moved) {
    const ck_Sixteen at = of_row(cloth, place);
    for (unsigned bits = ck_sixteen_aim(&at, moved, cloth->push, cloth->carried, cloth->rule.keep); bits;
         bits &= bits - 1) {
        const int lane = __builtin_ctz(bits);
        double to[3], before[3];
        if (!ck_sixteen_meet(&at, lane, cloth->rule.keep, to, before)) continue;
        for (int axis = 0; axis < 3; axis++) {
            const long one = place.tile + lane + axis * CK_STRIPE;
            cloth->x[one] = (ck_Real)to[axis];
            if (is_last) cloth->before[one] = (ck_Real)before[axis];
        }
    }
}

ck_RowFly CK_LOOP(ck_row_fly);
void CK_LOOP(ck_row_fly)(const ck_ProjectedCloth *cloth, int row, bool is_last) {
    ck_Real moved[3 * CK_STRIPE];
    for (int i = 0; i < cloth->rows.span; i++) {
        const ck_Place at = ck_rows_place(&cloth->rows, row, i);
        unsigned bits = 0;
        for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES)
            bits |= fly(cloth, (ck_Place){at.single + lane, at.tile + lane}, is_last, moved + lane) << lane;
        for (int half = 0; half < 2; half++)
            ck_row_contact_begin(cloth->head.contact, (int)(at.single / CK_EIGHT) + half);
        if (__builtin_expect(bits != 0, 0)) meet_row(cloth, at, is_last, moved);
    }
}

// True where a surface may be in reach, or has pushed before.
CK_INLINE bool may_press(const ck_ProjectionHead *head, long place, unsigned bits) {
    const bool *is_pressed = head->contact->is_pressed + place / CK_EIGHT;
    return bits || is_pressed[0] || is_pressed[1];
}

static __attribute__((noinline)) void press_row(const ck_ProjectedCloth *cloth, ck_Place place) {
    const ck_Sixteen at = of_row(cloth, place);
    ck_Real pushed[3 * CK_STRIPE];
    if (!ck_sixteen_press(&at, pushed)) return;
    for (int i = 0; i < 3 * CK_STRIPE; i++) at.x[i] += pushed[i];
}

ck_ClothPress CK_LOOP(ck_cloth_press);
void CK_LOOP(ck_cloth_press)(const ck_ProjectedCloth *cloth, int row) {
    const ck_Lanes3 still = {none, none, none};
    for (int i = 0; i < cloth->rows.span; i++) {
        const ck_Place at = ck_rows_place(&cloth->rows, row, i);
        unsigned bits = 0;
        for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES) {
            const ck_Lanes3 x =
                ck_lanes3_add(ck_lanes3_load(cloth->start + at.tile + lane), ck_lanes3_load(cloth->x + at.tile + lane));
            bits |= ck_lanes_meet(&cloth->head, x, still, still);
        }
        if (may_press(&cloth->head, at.single, bits)) press_row(cloth, at);
    }
}

static ck_Sixteen of_lines(const struct ck_LinedCloth *cloth, int row, long column) {
    const long at = row * cloth->stride + column;
    return (ck_Sixteen){.head = &cloth->head,
                        .origin = cloth->origin,
                        .place = row * ck_line_places(cloth) + column,
                        .start = cloth->start + at,
                        .x = cloth->x + at,
                        .from = cloth->begun + at,
                        .apart = cloth->plane};
}

// As predict of line_loop.c, of a vector.
CK_INLINE unsigned fly_lines(const struct ck_LinedCloth *cloth, long at, bool is_last, ck_Real *moved_by) {
    const ck_LaneMask is_free = ck_lanes_less(none, ck_lanes_load(cloth->weight + at));
    const ck_Lanes half = ck_lanes_all((ck_Real)0.5), keep = ck_lanes_all((ck_Real)cloth->rule.keep);
    const ck_Real push[] = {(ck_Real)cloth->push[0], (ck_Real)cloth->push[1], (ck_Real)cloth->push[2]};
    const ck_Lanes3 now = ck_lanes3_load_apart(cloth->x + at, cloth->plane),
                    start = ck_lanes3_load_apart(cloth->start + at, cloth->plane),
                    pulled = ck_lanes3_subtract(now, ck_lanes3_load_apart(cloth->flown + at, cloth->plane)),
                    moved = ck_lanes3_subtract(now, ck_lanes3_load_apart(cloth->begun + at, cloth->plane));
    const ck_Lanes3 there = ck_lanes3_add(start, now);
    const ck_Lanes3 begins = ck_lanes3_subtract(now, ck_lanes3_subtract(there, start));
    const ck_Lanes3 way = ck_lanes3_add_scaled(ck_lanes3_all(push), ck_lanes_all((ck_Real)cloth->carried), moved);
    const ck_Lanes3 gain = ck_lanes3_subtract_scaled(way, keep, moved), flies = ck_lanes3_add(begins, way);
    const ck_Lanes3 x = ck_lanes3_add_scaled(flies, ck_lanes_all((ck_Real)CK_LINES_KEPT), pulled);
    ck_lanes3_store_apart(cloth->start + at, cloth->plane, there);
    ck_lanes3_store_apart(cloth->begun + at, cloth->plane, begins);
    ck_lanes3_store_apart(cloth->flown + at, cloth->plane, ck_lanes3_choose(is_free, flies, begins));
    ck_lanes3_store_apart(cloth->x + at, cloth->plane, ck_lanes3_choose(is_free, x, begins));
    ck_lanes3_store(moved_by, moved);
    if (is_last) ck_lanes3_store_apart(cloth->before + at, cloth->plane, moved);
    return ck_lanes_meet(&cloth->head, there, ck_lanes3_subtract_scaled(way, half, gain), gain);
}

static __attribute__((noinline)) void meet_lines(const struct ck_LinedCloth *cloth, int row, long column, bool is_last,
                                                 const ck_Real *moved) {
    const ck_Sixteen at = of_lines(cloth, row, column);
    const ck_Real push[] = {(ck_Real)cloth->push[0], (ck_Real)cloth->push[1], (ck_Real)cloth->push[2]};
    for (unsigned bits = ck_sixteen_aim(&at, moved, push, cloth->carried, cloth->rule.keep); bits; bits &= bits - 1) {
        const int lane = __builtin_ctz(bits);
        double to[3], before[3];
        if (!ck_sixteen_meet(&at, lane, cloth->rule.keep, to, before)) continue;
        for (int axis = 0; axis < 3; axis++) {
            const long one = row * cloth->stride + column + lane + axis * cloth->plane;
            cloth->x[one] += (ck_Real)(to[axis] - cloth->flown[one]);
            cloth->flown[one] = (ck_Real)to[axis];
            if (is_last) cloth->before[one] = (ck_Real)before[axis];
        }
    }
}

ck_LineFly CK_LOOP(ck_line_fly);
void CK_LOOP(ck_line_fly)(const struct ck_LinedCloth *cloth, int row, bool is_last) {
    ck_Real moved[3 * CK_STRIPE];
    for (long column = 0; column < cloth->columns; column += CK_STRIPE) {
        const long place = row * ck_line_places(cloth) + column;
        unsigned bits = 0;
        for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES)
            bits |= fly_lines(cloth, row * cloth->stride + column + lane, is_last, moved + lane) << lane;
        for (int half = 0; half < 2; half++) ck_row_contact_begin(cloth->head.contact, (int)(place / CK_EIGHT) + half);
        if (__builtin_expect(bits != 0, 0)) meet_lines(cloth, row, column, is_last, moved);
    }
}

// What surfaces push is no pull of springs: where the flight ended is pushed as far.
static __attribute__((noinline)) void press_lines(const struct ck_LinedCloth *cloth, int row, long column) {
    const ck_Sixteen at = of_lines(cloth, row, column);
    ck_Real pushed[3 * CK_STRIPE], *flown = cloth->flown + row * cloth->stride + column;
    if (!ck_sixteen_press(&at, pushed)) return;
    for (int axis = 0; axis < 3; axis++)
        for (int lane = 0; lane < CK_STRIPE; lane++) {
            at.x[axis * at.apart + lane] += pushed[axis * CK_STRIPE + lane];
            flown[axis * at.apart + lane] += pushed[axis * CK_STRIPE + lane];
        }
}

ck_LinePress CK_LOOP(ck_line_press);
void CK_LOOP(ck_line_press)(const struct ck_LinedCloth *cloth) {
    const ck_Lanes3 still = {none, none, none};
    for (int row = 0; row < cloth->rows; row++)
        for (long column = 0; column < cloth->columns; column += CK_STRIPE) {
            const long at = row * cloth->stride + column;
            unsigned bits = 0;
            for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES)
                bits |= ck_lanes_meet(&cloth->head,
                                      ck_lanes3_add(ck_lanes3_load_apart(cloth->start + at + lane, cloth->plane),
                                                    ck_lanes3_load_apart(cloth->x + at + lane, cloth->plane)),
                                      still, still);
            if (may_press(&cloth->head, row * ck_line_places(cloth) + column, bits)) press_lines(cloth, row, column);
        }
}
