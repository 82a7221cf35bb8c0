// Compiled once for each kind of vectors; see loops.h.
#include "near.h"
#include "spring_loop.h"

// Into near, of each particle of a row: 1 where it may come to touch a surface within the substep, else 0. Returns how
// many vectors of a stripe have such; their numbers in the row go to vectors.
ck_NearRow CK_LOOP(ck_near_row);
int CK_LOOP(ck_near_row)(const struct ck_ExplicitCloth *cloth, int row, const ck_NearSurface *surfaces, int count,
                         double *near, int *vectors) {
    int found = 0;
    for (int i = 0; i < cloth->rows.span; i++) {
        const long tile = ck_rows_place(&cloth->rows, row, i).tile;
        bool is_any = false;
        for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES) {
            const ck_Lanes way =
                ck_near_way(ck_lanes3_load(cloth->v + tile + lane), ck_lanes3_load(cloth->a + tile + lane), cloth->dt);
            const ck_Lanes is_near = ck_near_any(ck_lanes3_load(cloth->x + tile + lane), way, surfaces, count);
            ck_lanes_store(near + i * CK_STRIPE + lane, is_near);
            is_any |= ck_lanes_any_beyond(is_near, 0.5);
        }
        if (is_any) vectors[found++] = i;
    }
    return found;
}
