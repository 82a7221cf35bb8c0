// Compiled once for each kind of vectors; see loops.h.
#include "sweep_list_loop.h"
#include "constraint_kernel.h"
#include "points.h"

enum {
    DAMPED = CK_SWEEP_LIST_DAMPED,
    REPEATED = CK_SWEEP_LIST_REPEATED,
    HANGS = CK_SWEEP_LIST_HANGS,
    BARS = CK_SWEEP_LIST_BARS
};

// Vectors that go through the root together, and springs of them; see list_loop.c.
enum { TOGETHER = CK_PACK / CK_LANES < CK_MOST_TOGETHER ? CK_PACK / CK_LANES : CK_MOST_TOGETHER };
enum { SPRINGS = TOGETHER * CK_LANES };

// Springs of a pack, from a lane on, and their ways from ends a to ends b.
typedef struct Springs {
    int pack, first;
    ck_Point ways[SPRINGS];
    double scale_a[SPRINGS], scale_b[SPRINGS];
} Springs;

CK_INLINE double *seat_at(double *seats, uint32_t offset) {
    return (double *)((char *)seats + offset);
}

CK_INLINE ck_Lanes value_of(const ck_SweepList *list, ck_SweepValue value, const Springs *springs, int i) {
    const ck_SpringValues *values = &list->values[value];
    return ck_lanes_load(values->of + values->step * springs->pack + springs->first + i * CK_LANES);
}

// The ways of a vector of springs, of one of the two arrays.
CK_INLINE void find_ways(const ck_SweepList *list, const Springs *springs, int i, double *seats, ck_Point *ways) {
    const ck_Pack *ends = &list->ends[springs->pack];
    for (int k = 0; k < CK_LANES; k++) {
        const int lane = springs->first + i * CK_LANES + k;
        ways[k] = ck_point_subtract(ck_point_load(seat_at(seats, ends->b[lane])),
                                    ck_point_load(seat_at(seats, ends->a[lane])));
    }
}

// x_a += scale_a·way, x_b += scale_b·way
CK_INLINE void move(const ck_SweepList *list, const Springs *springs) {
    const ck_Pack *ends = &list->ends[springs->pack];
    for (int k = 0; k < SPRINGS; k++) {
        double *a = seat_at(list->x, ends->a[springs->first + k]), *b = seat_at(list->x, ends->b[springs->first + k]);
        const ck_Point moved_a = ck_point_add_scaled(ck_point_load(a), springs->scale_a[k], springs->ways[k]),
                       moved_b = ck_point_add_scaled(ck_point_load(b), springs->scale_b[k], springs->ways[k]);
        ck_point_store(a, moved_a);
        ck_point_store(b, moved_b);
    }
}

// Pushed by scale times their ways, ends move by their weights.
CK_INLINE void set_scales(const ck_SweepList *list, Springs *springs, int i, ck_Lanes scale) {
    ck_lanes_store(springs->scale_a + i * CK_LANES, -(scale * value_of(list, CK_SWEPT_WEIGHT_A, springs, i)));
    ck_lanes_store(springs->scale_b + i * CK_LANES, scale * value_of(list, CK_SWEPT_WEIGHT_B, springs, i));
}

// A pull may be taken back, but no more; one that is short and does not pull is slack.
CK_INLINE ck_Lanes hang(const ck_SweepList *list, const Springs *springs, int i, ck_Lanes change, ck_Lanes length,
                        ck_Lanes multiplier) {
    const ck_Lanes zero = {0}, hangs = value_of(list, CK_SWEPT_HANGS, springs, i),
                   most = ck_lanes_choose(ck_lanes_less(-multiplier, change), -multiplier, change);
    const ck_Lanes pulls =
        ck_lanes_choose(ck_lanes_less(multiplier, zero), most,
                        ck_lanes_choose(ck_lanes_less(length, value_of(list, CK_SWEPT_REST, springs, i)), zero, most));
    return ck_lanes_choose(ck_lanes_less(zero, hangs), pulls, change);
}

// Δλ = −share·(l − L + α̃·λ + γ̃·∇C·(x − x_start)) along the spring now; nothing where it has no length.
CK_INLINE void project_springs(const ck_SweepList *list, Springs *springs, const int terms) {
    ck_Lanes squared[TOGETHER], inverse[TOGETHER], moved[TOGETHER];
    for (int i = 0; i < TOGETHER; i++) {
        ck_Point *ways = springs->ways + i * CK_LANES, before[CK_LANES];
        find_ways(list, springs, i, list->x, ways);
        const ck_Lanes3 d = ck_points_across(ways);
        squared[i] = ck_lanes3_dot(d, d);
        if (!(terms & DAMPED)) continue;
        find_ways(list, springs, i, list->start, before);
        moved[i] = squared[i] - ck_lanes3_dot(ck_points_across(before), d);
    }
    ck_lanes_inverse_root(inverse, squared, TOGETHER);
    for (int i = 0; i < TOGETHER; i++) {
        double *multipliers = list->multiplier + (long)CK_PACK * springs->pack + springs->first + i * CK_LANES;
        const ck_Lanes length = squared[i] * inverse[i], multiplier = ck_lanes_load(multipliers);
        ck_Lanes residual = length - value_of(list, CK_SWEPT_REST, springs, i);
        if (terms & REPEATED)
            residual = ck_lanes_plus(residual, value_of(list, CK_SWEPT_COMPLIANCE, springs, i), multiplier);
        if (terms & DAMPED)
            residual = ck_lanes_plus(residual, value_of(list, CK_SWEPT_GAMMA, springs, i) * moved[i], inverse[i]);
        ck_Lanes change = -(value_of(list, CK_SWEPT_SHARE, springs, i) * residual);
        if (terms & HANGS) change = hang(list, springs, i, change, length, multiplier);
        change = ck_lanes_choose(ck_lanes_less((ck_Lanes){0}, squared[i]), change, (ck_Lanes){0});
        if (terms & (REPEATED | HANGS)) ck_lanes_store(multipliers, multiplier + change);
        set_scales(list, springs, i, change * inverse[i]);
    }
    move(list, springs);
}

// By share·(l² − L²) along the direction at the start of the substep; see native_bars.c for those that are long, and
// those that have turned.
CK_INLINE void project_bars(const ck_SweepList *list, Springs *springs) {
    for (int i = 0; i < TOGETHER; i++) {
        ck_Point *ways = springs->ways + i * CK_LANES, now[CK_LANES];
        find_ways(list, springs, i, list->start, ways);
        find_ways(list, springs, i, list->x, now);
        const ck_Lanes3 d = ck_points_across(now);
        const ck_Lanes squared = ck_lanes3_dot(d, d), along = ck_lanes3_dot(ck_points_across(ways), d),
                       rest = value_of(list, CK_SWEPT_REST, springs, i), square = rest * rest;
        ck_Lanes scale = value_of(list, CK_SWEPT_SHARE, springs, i) * (squared - square);
        const ck_LaneMask is_long = ck_lanes_less(CK_LONG_BAR * square, squared);
        const unsigned leave_start =
            ck_lanes_bits(ck_lanes_less(ck_lanes_choose(is_long, (ck_Lanes){0}, along), CK_TURNED_BAR * square));
        if (__builtin_expect(leave_start, 0)) {
            scale = ck_lanes_choose(is_long, scale * square / squared, scale);
            for (int k = 0; k < CK_LANES; k++)
                if (leave_start >> k & 1) ways[k] = now[k];
        }
        set_scales(list, springs, i, -scale);
    }
    move(list, springs);
}

CK_INLINE void sweep_packs(const ck_SweepList *list, int first, int end, bool is_turned, const int terms) {
    for (int i = first; i < end; i++)
        for (int lane = 0; lane < CK_PACK; lane += SPRINGS) {
            Springs springs = {.pack = is_turned ? list->packs - 1 - i : i, .first = lane};
            if (terms & BARS)
                project_bars(list, &springs);
            else
                project_springs(list, &springs, terms);
        }
}

// The copy is known to share no memory with the arrays: what stands in it need not be read again after each store.
ck_SweepPacks CK_LOOP(ck_sweep_packs);
void CK_LOOP(ck_sweep_packs)(const ck_SweepList *shared, int first, int end, bool is_turned) {
    const ck_SweepList list = *shared;
    switch (list.terms) {
    case BARS: sweep_packs(&list, first, end, is_turned, BARS); break;
    case 0: sweep_packs(&list, first, end, is_turned, 0); break;
    case DAMPED: sweep_packs(&list, first, end, is_turned, DAMPED); break;
    case REPEATED: sweep_packs(&list, first, end, is_turned, REPEATED); break;
    case REPEATED | DAMPED: sweep_packs(&list, first, end, is_turned, REPEATED | DAMPED); break;
    default: sweep_packs(&list, first, end, is_turned, REPEATED | DAMPED | HANGS); break;
    }
}
