// Compiled once for each kind of vectors; see loops.h.
#include "list_loop.h"
#include "near.h"
#include "points.h"

enum { DAMPED = CK_LIST_DAMPED, HANGS = CK_LIST_HANGS };

// Vectors that go through the root together, and springs of them. A processor looks a few hundred instructions ahead:
// less than it would take to fill the wait for a root with the next springs.
enum { TOGETHER = CK_PACK / CK_LANES < CK_MOST_TOGETHER ? CK_PACK / CK_LANES : CK_MOST_TOGETHER };
enum { SPRINGS = TOGETHER * CK_LANES };

CK_INLINE const ck_Seat *seat_at(const struct ck_ExplicitList *list, uint32_t offset) {
    return (const ck_Seat *)((const char *)list->seats + offset);
}

// The ways of as many springs as there are lanes, from ends a to ends b; returns l², m², and where they are damped
// v·way, m²/s.
CK_INLINE ck_Lanes span(const struct ck_ExplicitList *list, const ck_Pack *pack, int first, ck_Point *way,
                        ck_Lanes *along, const int terms) {
    ck_Point speed[CK_LANES];
    for (int i = 0; i < CK_LANES; i++) {
        const ck_Seat *a = seat_at(list, pack->a[first + i]), *b = seat_at(list, pack->b[first + i]);
        way[i] = ck_point_subtract(ck_point_load(b->x), ck_point_load(a->x));
        if (terms & DAMPED) speed[i] = ck_point_subtract(ck_point_load(b->predicted), ck_point_load(a->predicted));
    }
    const ck_Lanes3 d = ck_points_across(way);
    if (terms & DAMPED) *along = ck_lanes3_dot(ck_points_across(speed), d);
    return ck_lanes3_dot(d, d);
}

CK_INLINE ck_Lanes value_of(const struct ck_ExplicitList *list, ck_SpringValue value, int pack, int lane) {
    return ck_lanes_load(list->springs.values[value].of + list->springs.values[value].step * pack + lane);
}

// Along a spring's way its force on a is scale·way, with k·(1 − L/l) + c·(v·way)/l² for the scale, N/m; see
// spring_loop.c.
CK_INLINE void pull_springs(const struct ck_ExplicitList *list, int pack, int first, const int terms) {
    double *force = list->force + CK_POINT * ((long)pack * CK_PACK + first);
    ck_Lanes squared[TOGETHER], along[TOGETHER], inverse[TOGETHER];
    ck_Point ways[SPRINGS];
    double scales[SPRINGS];
    for (int i = 0; i < TOGETHER; i++)
        squared[i] =
            span(list, &list->springs.packs[pack], first + i * CK_LANES, ways + i * CK_LANES, &along[i], terms);
    ck_lanes_inverse_root(inverse, squared, TOGETHER);
    for (int i = 0; i < TOGETHER; i++) {
        const int lane = first + i * CK_LANES;
        ck_Lanes slack = value_of(list, CK_OF_SLACK, pack, lane);
        if (terms & DAMPED)
            slack = ck_lanes_minus(slack, value_of(list, CK_OF_DAMPING, pack, lane) * along[i], inverse[i]);
        ck_Lanes scale = ck_lanes_minus(value_of(list, CK_OF_STIFFNESS, pack, lane), slack, inverse[i]);
        if (terms & HANGS)
            scale = ck_lanes_choose(ck_lanes_less(squared[i], value_of(list, CK_OF_HANGING, pack, lane)), (ck_Lanes){0},
                                    scale);
        ck_lanes_store(scales + i * CK_LANES, scale);
    }
    for (int i = 0; i < SPRINGS; i++) ck_point_store(force + i * CK_POINT, ck_point_scale(scales[i], ways[i]));
}

CK_INLINE void pull_packs(const struct ck_ExplicitList *list, int chunk, const int terms) {
    for (int i = list->springs.pack_start[chunk]; i < list->springs.pack_start[chunk + 1]; i++)
        for (int first = 0; first < CK_PACK; first += SPRINGS) pull_springs(list, i, first, terms);
}

// The copy is known to share no memory with the arrays: what stands in it need not be read again after each store.
static void pull_chunk(const struct ck_ExplicitList *shared, int chunk) {
    const struct ck_ExplicitList list = *shared;
    switch (list.terms) {
    case 0: pull_packs(&list, chunk, 0); break;
    case DAMPED: pull_packs(&list, chunk, DAMPED); break;
    case HANGS: pull_packs(&list, chunk, HANGS); break;
    default: pull_packs(&list, chunk, DAMPED | HANGS); break;
    }
}

CK_INLINE ck_Point force_of(const struct ck_ExplicitList *list, uint32_t offset) {
    return ck_point_load((const double *)((const char *)list->force + offset));
}

// N, of all that pulls at the places of a quad. Springs' forces are summed here and not where they are found: sums in
// memory that springs take turns at make each wait for the one before.
CK_INLINE void sum_forces(const struct ck_ExplicitList *list, long quad, ck_Point *sums) {
    const ck_Quad at = list->springs.quads[quad];
    const uint32_t *joined = list->springs.joined + at.first, *turned = joined + CK_QUAD * at.lower,
                   *end = turned + CK_QUAD * at.upper;
    for (int i = 0; i < CK_QUAD; i++) {
        const long place = CK_QUAD * quad + i;
        sums[i] = ck_point_add_scaled(ck_point_load(list->load + CK_POINT * place), -list->resistance[place],
                                      ck_point_load(list->seats[place].predicted));
    }
    for (; joined < turned; joined += CK_QUAD)
        for (int i = 0; i < CK_QUAD; i++) sums[i] = ck_point_add(sums[i], force_of(list, joined[i]));
    for (; joined < end; joined += CK_QUAD)
        for (int i = 0; i < CK_QUAD; i++) sums[i] = ck_point_subtract(sums[i], force_of(list, joined[i]));
}

// With another substep to come v ← v + a·dt, x ← x + v·dt, v* = v + a·dt/2: its start, too; else v ← v + a·dt/2.
CK_INLINE void finish(const struct ck_ExplicitList *list, long place, ck_Point force, bool advances) {
    const double gain = list->gain[place];
    const ck_Point v = ck_point_load(list->v + CK_POINT * place);
    if (!advances) {
        ck_point_store(list->v + CK_POINT * place, ck_point_add_scaled(v, 0.5 * gain, force));
        ck_point_store(list->a + CK_POINT * place, ck_point_scale(gain * (1 / list->dt), force));
        return;
    }
    ck_Seat *seat = &list->seats[place];
    const ck_Point faster = ck_point_add_scaled(v, gain, force);
    ck_point_store(list->v + CK_POINT * place, faster);
    ck_point_store(seat->x, ck_point_add_scaled(ck_point_load(seat->x), list->dt, faster));
    ck_point_store(seat->predicted, ck_point_add_scaled(faster, 0.5 * gain, force));
}

CK_INLINE void finish_chunk(const struct ck_ExplicitList *list, int chunk, bool advances) {
    const int *start = list->springs.chunk_start + chunk;
    for (long quad = start[0] / CK_QUAD; quad < start[1] / CK_QUAD; quad++) {
        ck_Point sums[CK_QUAD];
        sum_forces(list, quad, sums);
        for (int i = 0; i < CK_QUAD; i++) finish(list, CK_QUAD * quad + i, sums[i], advances);
    }
}

ck_ListChunk CK_LOOP(ck_list_chunk);
void CK_LOOP(ck_list_chunk)(const struct ck_ExplicitList *shared, int chunk, bool advances) {
    const struct ck_ExplicitList list = *shared;
    pull_chunk(shared, chunk);
    if (advances)
        finish_chunk(&list, chunk, true);
    else
        finish_chunk(&list, chunk, false);
}

// x ← x + v·dt + a·dt²/2;  v* = v + a·dt;  v ← v + a·dt/2
ck_ListStart CK_LOOP(ck_list_start);
void CK_LOOP(ck_list_start)(const struct ck_ExplicitList *list, int chunk) {
    const double dt = list->dt, half = 0.5 * dt;
    for (long i = list->springs.chunk_start[chunk]; i < list->springs.chunk_start[chunk + 1]; i++) {
        const long at = CK_POINT * i;
        ck_Seat *seat = &list->seats[i];
        const ck_Point a = ck_point_load(list->a + at), v = ck_point_add_scaled(ck_point_load(list->v + at), half, a);
        ck_point_store(seat->x, ck_point_add_scaled(ck_point_load(seat->x), dt, v));
        ck_point_store(seat->predicted, ck_point_add_scaled(v, half, a));
        ck_point_store(list->v + at, v);
    }
}

// Into near, of each four places of a chunk: a bit for each that may come to touch a surface within the substep.
ck_NearChunk CK_LOOP(ck_near_chunk);
void CK_LOOP(ck_near_chunk)(const struct ck_ExplicitList *list, int chunk, const ck_NearSurface *surfaces, int count,
                            uint8_t *near) {
    const int *start = list->springs.chunk_start + chunk;
    for (int quad = start[0] / CK_QUAD; quad < start[1] / CK_QUAD; quad++) near[quad] = 0;
    for (int place = start[0]; place < start[1]; place += CK_LANES) {
        ck_Point x[CK_LANES], v[CK_LANES], a[CK_LANES];
        unsigned bits = 0;
        for (int lane = 0; lane < CK_LANES; lane++) {
            const long at = place + lane < start[1] ? place + lane : place;
            x[lane] = ck_point_load(list->seats[at].x);
            v[lane] = ck_point_load(list->v + CK_POINT * at);
            a[lane] = ck_point_load(list->a + CK_POINT * at);
        }
        for (int k = 0; k < count; k++)
            bits |= ck_near_bits(ck_points_across(x), ck_points_across(v), ck_points_across(a), list->dt, &surfaces[k],
                                 surfaces[k].is_plane ? CK_NEAR_PLANE : CK_NEAR_SOLID);
        for (int lane = 0; lane < CK_LANES && place + lane < start[1]; lane++)
            near[(place + lane) / CK_QUAD] |= (uint8_t)((bits >> lane & 1) << (place + lane) % CK_QUAD);
    }
}
