// Compiled once for each kind of vectors; see loops.h.
#include "lanes.h"
#include "spring_loop.h"

// How far particles go in a substep at most, |v|·dt + |a|·dt²/2, and some rounding.
CK_INLINE ck_Lanes way_of(const struct ck_ExplicitCloth *cloth, long tile) {
    const ck_Lanes3 v = ck_lanes3_load(cloth->v + tile), a = ck_lanes3_load(cloth->a + tile);
    const ck_Lanes squared[] = {ck_lanes3_dot(v, v), ck_lanes3_dot(a, a)};
    ck_Lanes inverse[2];
    ck_lanes_inverse_root(inverse, squared, 2);
    const double dt = cloth->dt * (1 + 1e-9);
    return dt * (squared[0] * inverse[0]) + 0.5 * dt * dt * (squared[1] * inverse[1]);
}

CK_INLINE ck_Lanes gap_to(const ck_NearSurface *surface, ck_Lanes3 x) {
    ck_Lanes3 from = ck_lanes3_subtract(x, ck_lanes3_all(surface->point)), out = from;
    if (surface->is_plane) return ck_lanes3_dot(from, ck_lanes3_all(surface->normal));
    for (int k = 0; k < surface->axis_count; k++) {
        const ck_Lanes half = ck_lanes_all(surface->half[k]);
        const ck_Lanes3 axis = ck_lanes3_all(surface->axes[k]);
        const ck_Lanes along = ck_lanes3_dot(from, axis);
        const ck_Lanes low = ck_lanes_choose(ck_lanes_less(along, -half), -half, along);
        out = ck_lanes3_subtract_scaled(out, ck_lanes_choose(ck_lanes_less(half, low), half, low), axis);
    }
    const ck_Lanes squared = ck_lanes3_dot(out, out);
    ck_Lanes inverse;
    ck_lanes_inverse_root(&inverse, &squared, 1);
    return squared * inverse - surface->radius;
}

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
            const ck_Lanes way = way_of(cloth, tile + lane);
            const ck_Lanes3 x = ck_lanes3_load(cloth->x + tile + lane);
            ck_Lanes is_near = ck_lanes_all(0);
            // what is no number is near
            for (int k = 0; k < count; k++)
                is_near = ck_lanes_choose(ck_lanes_less(way + surfaces[k].margin, gap_to(&surfaces[k], x)), is_near,
                                          ck_lanes_all(1));
            ck_lanes_store(near + i * CK_STRIPE + lane, is_near);
            is_any |= ck_lanes_any_beyond(is_near, 0.5);
        }
        if (is_any) vectors[found++] = i;
    }
    return found;
}
