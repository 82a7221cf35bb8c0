// Compiled once for each kind of vectors; see loops.h.
#include "near.h"
#include "spring_loop.h"

CK_INLINE ck_LaneMask is_far_from(const ck_LaneSurface *surface, ck_Lanes3 x, ck_Lanes most) {
    switch (ck_near_shape(surface)) {
    case CK_NEAR_PLANE: return ck_near_far(x, most, surface, CK_NEAR_PLANE);
    case CK_NEAR_BALL: return ck_near_far(x, most, surface, CK_NEAR_BALL);
    default: return ck_near_far(x, most, surface, CK_NEAR_SOLID);
    }
}

// Starts the substep of some, as explicit_start has it, but of those near a surface, which stay. A bit for each of
// these.
CK_INLINE unsigned start(const ck_ExplicitCloth *cloth, long tile, int count, bool predicts) {
    const ck_Lanes dt = ck_lanes_all(cloth->dt), half = ck_lanes_all((ck_Real)0.5 * cloth->dt);
    const ck_Lanes3 x = ck_lanes3_load(cloth->x + tile), v = ck_lanes3_load(cloth->v + tile),
                    a = ck_lanes3_load(cloth->a + tile);
    const ck_Lanes most = ck_near_most(v, a, cloth->dt);
    ck_Lanes3 faster = ck_lanes3_add_scaled(v, half, a), to = ck_lanes3_add_scaled(x, dt, faster);
    if (predicts) ck_lanes3_store(cloth->predicted + tile, ck_lanes3_add_scaled(faster, half, a));
    unsigned bits = 0;
    for (int k = 0; k < count; k++) {
        const ck_LaneMask is_far = is_far_from(&cloth->surfaces[k], x, most);
        faster = ck_lanes3_choose(is_far, faster, v);
        to = ck_lanes3_choose(is_far, to, x);
        bits |= ~ck_lanes_bits(is_far);
    }
    ck_lanes3_store(cloth->v + tile, faster);
    ck_lanes3_store(cloth->x + tile, to);
    return bits & ((1u << CK_LANES) - 1);
}

// Marks, of each vector of a row, those that may touch a surface at a speed v and an acceleration a within the substep;
// the others start it.
ck_NearRow CK_LOOP(ck_near_row);
void CK_LOOP(ck_near_row)(const struct ck_ExplicitCloth *shared, int row, int count) {
    const struct ck_ExplicitCloth local = *shared, *cloth = &local;
    const bool predicts = cloth->terms & (CK_ROW_DAMPED | CK_ROW_DRAGGED);
    for (int i = 0; i < cloth->rows.span; i++) {
        const long tile = ck_rows_place(&cloth->rows, row, i).tile;
        unsigned bits = 0;
        for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES)
            bits |= start(cloth, tile + lane, count, predicts) << lane;
        cloth->near[i] = (ck_Marks)bits;
    }
}
