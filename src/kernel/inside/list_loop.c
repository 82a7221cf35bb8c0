// Compiled once for each kind of vectors; see loops.h.
#include "list_loop.h"
#include "near.h"
#include "points.h"

enum { DAMPED = CK_LIST_DAMPED, DRAGGED = CK_LIST_DRAGGED, HANGS = CK_LIST_HANGS };

// Springs of each place that go through the root together: one by one takes a tenth longer, four are more than
// registers hold.
enum { TOGETHER = 2 };

// As many places of a group as there are lanes, and the force on each so far.
typedef struct Places {
    int lane;
    ck_Lanes3 x, predicted, force;
} Places;

CK_INLINE ck_Lanes3 points_at(const double *points, const uint32_t *to) {
    ck_Point loaded[CK_LANES];
    for (int i = 0; i < CK_LANES; i++) loaded[i] = ck_point_load((const double *)((const char *)points + to[i]));
    return ck_points_across(loaded);
}

CK_INLINE ck_Lanes value_of(const struct ck_ExplicitList *list, ck_SpringValue value, long spring, int lane) {
    return ck_lanes_load(list->springs.values[value].of + list->springs.values[value].step * spring + lane);
}

// Along a spring's way to its other end its force is scale·way, with k·(1 − L/l) + c·(v·way)/l² for the scale, N/m; see
// spring_loop.c. Springs from a place to itself have no way to pull along.
CK_INLINE void pull(const struct ck_ExplicitList *list, int from, long spring, Places *places, const int count,
                    const int terms) {
    const int lane = places->lane;
    ck_Lanes3 way[TOGETHER];
    ck_Lanes squared[TOGETHER], along[TOGETHER], inverse[TOGETHER];
    for (int i = 0; i < count; i++) {
        const uint32_t *to = list->springs.to + CK_STRIPE * (spring + i) + lane;
        way[i] = ck_lanes3_subtract(points_at(list->x[from], to), places->x);
        squared[i] = ck_lanes3_dot(way[i], way[i]);
        if (terms & DAMPED)
            along[i] =
                ck_lanes3_dot(ck_lanes3_subtract(points_at(list->predicted[from], to), places->predicted), way[i]);
    }
    ck_lanes_inverse_root(inverse, squared, count);
    for (int i = 0; i < count; i++) {
        ck_Lanes slack = value_of(list, CK_OF_SLACK, spring + i, lane);
        if (terms & DAMPED)
            slack = ck_lanes_minus(slack, value_of(list, CK_OF_DAMPING, spring + i, lane) * along[i], inverse[i]);
        ck_Lanes scale = ck_lanes_minus(value_of(list, CK_OF_STIFFNESS, spring + i, lane), slack, inverse[i]);
        if (terms & HANGS)
            scale = ck_lanes_choose(ck_lanes_less(squared[i], value_of(list, CK_OF_HANGING, spring + i, lane)),
                                    (ck_Lanes){0}, scale);
        places->force = ck_lanes3_add_scaled(places->force, scale, way[i]);
    }
}

// With another substep to come v ← v + a·dt, x ← x + v·dt, v* = v + a·dt/2: its start, too; else v ← v + a·dt/2.
CK_INLINE void finish(const struct ck_ExplicitList *list, long group, int to, const Places *places, bool advances,
                      const int terms) {
    const long place = CK_STRIPE * group + places->lane, tile = ck_tile_of(place);
    const ck_Lanes gain = ck_lanes_load(list->gain + place);
    const ck_Lanes3 v = ck_lanes3_load(list->v + tile);
    if (!advances) {
        ck_lanes3_store(list->v + tile, ck_lanes3_add_scaled(v, 0.5 * gain, places->force));
        ck_lanes3_store(list->a + tile, ck_lanes3_scale(gain * (1 / list->dt), places->force));
        return;
    }
    const ck_Lanes3 faster = ck_lanes3_add_scaled(v, gain, places->force);
    ck_lanes3_store(list->v + tile, faster);
    ck_points_put(list->x[to] + CK_POINT * place, ck_lanes3_add_scaled(places->x, ck_lanes_all(list->dt), faster));
    if (terms & (DAMPED | DRAGGED))
        ck_points_put(list->predicted[to] + CK_POINT * place, ck_lanes3_add_scaled(faster, 0.5 * gain, places->force));
}

CK_INLINE void pass(const struct ck_ExplicitList *list, int chunk, int from, bool advances, const int terms) {
    const int *first = list->springs.first;
    for (long group = list->springs.chunk_start[chunk]; group < list->springs.chunk_start[chunk + 1]; group++)
        for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES) {
            const long place = CK_STRIPE * group + lane;
            Places places = {lane,
                             ck_points_get(list->x[from] + CK_POINT * place),
                             {{0}, {0}, {0}},
                             ck_lanes3_load(list->load + ck_tile_of(place))};
            if (terms & (DAMPED | DRAGGED)) places.predicted = ck_points_get(list->predicted[from] + CK_POINT * place);
            if (terms & DRAGGED)
                places.force =
                    ck_lanes3_subtract_scaled(places.force, ck_lanes_load(list->resistance + place), places.predicted);
            int spring = first[group];
            for (; spring + TOGETHER <= first[group + 1]; spring += TOGETHER)
                pull(list, from, spring, &places, TOGETHER, terms);
            for (; spring < first[group + 1]; spring++) pull(list, from, spring, &places, 1, terms);
            finish(list, group, !from, &places, advances, terms);
        }
}

// The copy is known to share no memory with the arrays: what stands in it need not be read again after each store.
ck_ListChunk CK_LOOP(ck_list_chunk);
void CK_LOOP(ck_list_chunk)(const struct ck_ExplicitList *shared, int chunk, int from, bool advances) {
    const struct ck_ExplicitList local = *shared, *list = &local;
    switch (local.terms) {
    case 0: pass(list, chunk, from, advances, 0); break;
    case DAMPED: pass(list, chunk, from, advances, DAMPED); break;
    case DRAGGED: pass(list, chunk, from, advances, DRAGGED); break;
    case DAMPED | DRAGGED: pass(list, chunk, from, advances, DAMPED | DRAGGED); break;
    default: pass(list, chunk, from, advances, DAMPED | DRAGGED | HANGS); break;
    }
}

// x ← x + v·dt + a·dt²/2;  v* = v + a·dt;  v ← v + a·dt/2
ck_ListStart CK_LOOP(ck_list_start);
void CK_LOOP(ck_list_start)(const struct ck_ExplicitList *list, int chunk, int now) {
    const ck_Lanes dt = ck_lanes_all(list->dt), half = ck_lanes_all(0.5 * list->dt);
    for (long group = list->springs.chunk_start[chunk]; group < list->springs.chunk_start[chunk + 1]; group++)
        for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES) {
            const long place = CK_STRIPE * group + lane, tile = ck_tile_of(place), point = CK_POINT * place;
            const ck_Lanes3 a = ck_lanes3_load(list->a + tile),
                            v = ck_lanes3_add_scaled(ck_lanes3_load(list->v + tile), half, a);
            double *x = list->x[now] + point;
            ck_points_put(x, ck_lanes3_add_scaled(ck_points_get(x), dt, v));
            ck_points_put(list->predicted[now] + point, ck_lanes3_add_scaled(v, half, a));
            ck_lanes3_store(list->v + tile, v);
        }
}

// Marks, of each group of a chunk, the free places that may come to touch a surface within the substep beside those
// that are marked. True where there are any.
ck_NearChunk CK_LOOP(ck_near_chunk);
bool CK_LOOP(ck_near_chunk)(const struct ck_ExplicitList *list, int chunk, const ck_NearSurface *surfaces, int count) {
    unsigned any = 0;
    for (long group = list->springs.chunk_start[chunk]; group < list->springs.chunk_start[chunk + 1]; group++) {
        unsigned bits = 0;
        for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES) {
            const long place = CK_STRIPE * group + lane, tile = ck_tile_of(place);
            const ck_Lanes3 x = ck_points_get(list->x[list->now] + CK_POINT * place),
                            v = ck_lanes3_load(list->v + tile), a = ck_lanes3_load(list->a + tile);
            const ck_LaneMask is_free = ck_lanes_less((ck_Lanes){0}, ck_lanes_load(list->gain + place));
            const ck_Lanes most = ck_near_most(v, a, list->dt);
            unsigned met = 0;
            for (int k = 0; k < count; k++) met |= ck_near_bits(ck_near_is_far(x, most, &surfaces[k]));
            bits |= (met & ck_lanes_bits(is_free)) << lane;
        }
        bits &= ~(unsigned)list->near[group];
        list->found[group] = (uint8_t)bits;
        list->near[group] |= (uint8_t)bits;
        any |= bits;
    }
    return any;
}
