// Compiled once for each kind of vectors; see loops.h.
#include "near.h"
#include "spring_loop.h"

CK_INLINE void look(const struct ck_ExplicitCloth *cloth, int row, const ck_LaneSurface *surface,
                    const ck_NearShape shape) {
    for (int i = 0; i < cloth->rows.span; i++) {
        const long tile = ck_rows_place(&cloth->rows, row, i).tile;
        unsigned bits = 0;
        for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES) {
            const ck_Real *x = cloth->x + tile + lane, *v = cloth->v + tile + lane, *a = cloth->a + tile + lane;
            bits |= ck_near_bits(ck_lanes3_load(x), ck_lanes3_load(v), ck_lanes3_load(a), cloth->dt, surface, shape)
                    << lane;
        }
        cloth->near[i] |= (ck_Marks)bits;
    }
}

// Into the cloth's marks, of each vector of a row: a bit for each particle that may come to touch one of its surfaces
// within the substep.
ck_NearRow CK_LOOP(ck_near_row);
void CK_LOOP(ck_near_row)(const struct ck_ExplicitCloth *cloth, int row, int count) {
    for (int i = 0; i < cloth->rows.span; i++) cloth->near[i] = 0;
    for (int k = 0; k < count; k++) switch (ck_near_shape(&cloth->surfaces[k])) {
        case CK_NEAR_PLANE: look(cloth, row, &cloth->surfaces[k], CK_NEAR_PLANE); break;
        case CK_NEAR_BALL: look(cloth, row, &cloth->surfaces[k], CK_NEAR_BALL); break;
        default: look(cloth, row, &cloth->surfaces[k], CK_NEAR_SOLID); break;
        }
}
