// Compiled once for each kind of vectors; see loops.h.
#include "near.h"
#include "spring_loop.h"

CK_INLINE void look(const struct ck_ExplicitCloth *cloth, int row, const ck_NearSurface *surface, uint8_t *near,
                    const ck_NearShape shape) {
    for (int i = 0; i < cloth->rows.span; i++) {
        const long tile = ck_rows_place(&cloth->rows, row, i).tile;
        unsigned bits = 0;
        for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES) {
            const double *x = cloth->x + tile + lane, *v = cloth->v + tile + lane, *a = cloth->a + tile + lane;
            bits |= ck_near_bits(ck_lanes3_load(x), ck_lanes3_load(v), ck_lanes3_load(a), cloth->dt, surface, shape)
                    << lane;
        }
        near[i] |= (uint8_t)bits;
    }
}

// Into near, of each vector of a row: a bit for each particle that may come to touch a surface within the substep.
ck_NearRow CK_LOOP(ck_near_row);
void CK_LOOP(ck_near_row)(const struct ck_ExplicitCloth *cloth, int row, const ck_NearSurface *surfaces, int count,
                          uint8_t *near) {
    for (int i = 0; i < cloth->rows.span; i++) near[i] = 0;
    for (int k = 0; k < count; k++) switch (ck_near_shape(&surfaces[k])) {
        case CK_NEAR_PLANE: look(cloth, row, &surfaces[k], near, CK_NEAR_PLANE); break;
        case CK_NEAR_BALL: look(cloth, row, &surfaces[k], near, CK_NEAR_BALL); break;
        default: look(cloth, row, &surfaces[k], near, CK_NEAR_SOLID); break;
        }
}
