// Compiled once for each kind of vectors; see loops.h.
#include "near.h"
#include "spring_loop.h"

// Starts the substep of some, as explicit_start has it, but of those near a surface, which stay. A bit for each of
// these that is free. The speed of what is loose is kept there, and what is made of the one here is overwritten.
CK_INLINE unsigned start(const ck_ExplicitCloth *cloth, ck_Place at, int count, bool predicts) {
    const long tile = at.tile;
    const ck_Lanes dt = ck_lanes_all(cloth->dt), half = ck_lanes_all((ck_Real)0.5 * cloth->dt);
    const ck_Lanes3 x = ck_lanes3_load(cloth->x + tile), v = ck_lanes3_load(cloth->v + tile),
                    a = ck_lanes3_load(cloth->a + tile);
    const ck_Lanes most = ck_near_most(v, a, cloth->dt);
    ck_Lanes3 faster = ck_lanes3_add_scaled(v, half, a), to = ck_lanes3_add_scaled(x, dt, faster);
    if (predicts) ck_lanes3_store(cloth->predicted + tile, ck_lanes3_add_scaled(faster, half, a));
    unsigned bits = 0;
    for (int k = 0; k < count; k++) {
        const ck_LaneMask is_far = ck_near_is_far(x, most, &cloth->surfaces[k]);
        faster = ck_lanes3_choose(is_far, faster, v);
        to = ck_lanes3_choose(is_far, to, x);
        bits |= ~ck_lanes_bits(is_far);
    }
    ck_lanes3_store(cloth->v + tile, faster);
    ck_lanes3_store(cloth->x + tile, to);
    // most vectors are near nothing
    return bits ? bits & ck_lanes_bits(ck_lanes_less((ck_Lanes){0}, ck_lanes_load(cloth->gain + at.single))) : 0;
}

// Marks, of each vector of a row, those that may touch a surface at a speed v and an acceleration a within the substep
// beside those that are marked; the others start it.
ck_NearRow CK_LOOP(ck_near_row);
bool CK_LOOP(ck_near_row)(const struct ck_ExplicitCloth *shared, int row, int count) {
    const struct ck_ExplicitCloth local = *shared, *cloth = &local;
    const bool predicts = cloth->terms & (CK_ROW_DAMPED | CK_ROW_DRAGGED);
    ck_Marks *near = cloth->near + (long)row * cloth->rows.span;
    unsigned any = 0;
    for (int i = 0; i < cloth->rows.span; i++) {
        const ck_Place at = ck_rows_place(&cloth->rows, row, i);
        unsigned bits = 0;
        for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES)
            bits |= start(cloth, (ck_Place){at.single + lane, at.tile + lane}, count, predicts) << lane;
        bits &= ~(unsigned)near[i];
        cloth->found[i] = (ck_Marks)bits;
        near[i] |= (ck_Marks)bits;
        any |= bits;
    }
    return any;
}
