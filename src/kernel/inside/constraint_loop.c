// Compiled once for each kind of vectors; see loops.h.
#include "constraint_loop.h"
#include "lanes.h"

#include <limits.h>
#include <string.h>

enum {
    DAMPED = CK_SWEEP_DAMPED,
    REPEATED = CK_SWEEP_REPEATED,
    BARS = CK_SWEEP_BARS,
    TURNED = CK_SWEEP_TURNED,
    HELD = CK_SWEEP_HELD,
    FAR = CK_SWEEP_FAR,
    A_IS_AROUND = CK_SWEEP_A_IS_AROUND,
    B_IS_AROUND = CK_SWEEP_B_IS_AROUND
};

// A vector of springs.
typedef struct Ends {
    ck_Place a, b;
    ck_SpringKind kind;
    ck_Real *multiplier;
} Ends;

// What a stripe says of them.
typedef struct Springs {
    ck_Lanes share, share_rest, softness, viscosity;
} Springs;

CK_INLINE Springs springs_of(const ck_Stripe *stripe, int lane) {
    return (Springs){ck_lanes_load(stripe->share + lane), ck_lanes_load(stripe->share_rest + lane),
                     ck_lanes_load(stripe->softness + lane), ck_lanes_load(stripe->viscosity + lane)};
}

// What stands at an end. One around the row's last vector is the first, one on. Where that is a whole vector, it is
// read as it stands and turned: what is read across two lines of the cache waits for all that was stored there.
CK_INLINE ck_Lanes end_of(const ck_Real *singles, ck_Place end, bool is_around) {
    return is_around ? ck_lanes_turn(ck_lanes_load(singles + end.single - 1)) : ck_lanes_load(singles + end.single);
}

CK_INLINE ck_Lanes3 end3_of(const ck_Real *tiles, ck_Place end, bool is_around) {
    return is_around ? ck_lanes3_turn(ck_lanes3_load(tiles + end.tile - 1)) : ck_lanes3_load(tiles + end.tile);
}

CK_INLINE void store_end(ck_Real *tiles, ck_Place end, ck_Lanes3 value, bool is_around) {
    if (is_around)
        ck_lanes3_store(tiles + end.tile - 1, ck_lanes3_next(value, value));
    else
        ck_lanes3_store(tiles + end.tile, value);
}

// 0 where one of two ends is free, 1 where both are or none: then none will move.
CK_INLINE ck_Lanes both_alike(const ck_ProjectedCloth *cloth, const Ends *ends, const int terms) {
    const ck_Lanes apart =
        end_of(cloth->is_free, ends->a, terms & A_IS_AROUND) - end_of(cloth->is_free, ends->b, terms & B_IS_AROUND);
    return 1 - apart * apart;
}

// x_a ← x_a + scale·way, x_b ← x_b − scale·way, where free. Where b is shifted, it may reach into a: a has the last
// word.
CK_INLINE void move(const ck_ProjectedCloth *cloth, const Ends *ends, ck_Lanes scale, ck_Lanes3 way, const int terms) {
    ck_Lanes scale_a = scale, scale_b = scale;
    if (terms & HELD) {
        scale_a *= end_of(cloth->is_free, ends->a, terms & A_IS_AROUND);
        scale_b *= end_of(cloth->is_free, ends->b, terms & B_IS_AROUND);
    }
    const ck_Lanes3 a = ck_lanes3_add_scaled(end3_of(cloth->x, ends->a, terms & A_IS_AROUND), scale_a, way);
    const ck_Lanes3 b = ck_lanes3_subtract_scaled(end3_of(cloth->x, ends->b, terms & B_IS_AROUND), scale_b, way);
    store_end(cloth->x, ends->b, b, terms & B_IS_AROUND);
    store_end(cloth->x, ends->a, a, terms & A_IS_AROUND);
}

CK_INLINE ck_Lanes3 span_of(const ck_Real *tiles, const Ends *ends, const int terms) {
    return ck_lanes3_subtract(end3_of(tiles, ends->b, terms & B_IS_AROUND),
                              end3_of(tiles, ends->a, terms & A_IS_AROUND));
}

// In single precision x is told from where the substep starts: places are rounded to 6e-8 of the cloth's size, and the
// ways of a substep to 6e-8 of themselves.
CK_INLINE ck_Lanes3 span_now(const ck_ProjectedCloth *cloth, const Ends *ends, const int terms) {
    const ck_Lanes3 x = span_of(cloth->x, ends, terms);
    return CK_IS_SINGLE ? ck_lanes3_add(span_of(cloth->start, ends, terms), x) : x;
}

// What ends have moved by against each other in this substep.
CK_INLINE ck_Lanes3 span_moved(const ck_ProjectedCloth *cloth, const Ends *ends, ck_Lanes3 now, const int terms) {
    if (CK_IS_SINGLE) return ck_lanes3_subtract(span_of(cloth->x, ends, terms), span_of(cloth->kept, ends, terms));
    return ck_lanes3_subtract(now, span_of(cloth->start, ends, terms));
}

// s·(l² − L²)/(4·L²) of bars.
CK_INLINE ck_Lanes scale_of(const Springs *springs, ck_Lanes squared) {
    return ck_lanes_plus(-springs->share_rest, springs->share, squared);
}

CK_INLINE void move_bars(const ck_ProjectedCloth *cloth, const Ends *ends, ck_Lanes scale, ck_Lanes3 way,
                         const int terms) {
    if (terms & HELD) scale += scale - scale * both_alike(cloth, ends, terms);
    move(cloth, ends, scale, way, terms);
}

// Each bar by itself: along itself by s·(l² − L²)/(4·l²) where it is long, and along itself where it turned by more
// than 66°, which is asked in rows that had a long bar. Seldom, and not in line, so that the others' registers are
// their own.
static __attribute__((noinline)) void project_far(const ck_ProjectedCloth *cloth, Ends ends, Springs springs, bool held,
                                                  bool asks_all) {
    const ck_Lanes3 now = span_now(cloth, &ends, 0), start = span_of(cloth->start, &ends, 0);
    const ck_Lanes square = ck_lanes_all(cloth->rest[ends.kind] * cloth->rest[ends.kind]);
    const ck_Lanes along = asks_all ? ck_lanes3_dot(now, start) : square, squared = ck_lanes3_dot(now, now);
    const ck_Lanes near = scale_of(&springs, squared);
    const ck_LaneMask is_long = ck_lanes_less(ck_lanes_all(cloth->long_scale), near);
    const ck_LaneMask leaves_start =
        ck_lanes_less(ck_lanes_choose(is_long, (ck_Lanes){0}, along), ck_lanes_all((ck_Real)CK_TURNED_BAR) * square);
    move_bars(cloth, &ends, ck_lanes_choose(is_long, near * square / squared, near),
              ck_lanes3_choose(leaves_start, now, start), held ? HELD : 0);
}

// Along d_start by s·(l² − L²)/(4·L²), where masses cancel and s is the relaxation: L² in the place of d·d_start, for a
// division takes as long as all the rest, and the next sweep mends what that leaves. Where a bar turned by so much that
// there is none of its length along d_start, that makes it long; so does the flight that turned it, mostly at once. A
// row with a long bar is looked at bar by bar in the substep's further sweeps.
CK_INLINE void project_bar(const ck_ProjectedCloth *cloth, const Ends *ends, const Springs *springs, const ck_Visit *at,
                           const int terms) {
    const ck_Lanes3 now = span_now(cloth, ends, terms);
    const ck_Lanes scale = scale_of(springs, ck_lanes3_dot(now, now));
    if (__builtin_expect(ck_lanes_any_beyond(scale, cloth->long_scale), 0)) {
        cloth->far_from[at->row] = at->sweep + 1;
        project_far(cloth, *ends, *springs, (terms & HELD) != 0, false);
    } else
        move_bars(cloth, ends, scale, span_of(cloth->start, ends, terms), terms);
}

// By the share of (1 − L'/l), along the spring, that is its own: L' is the length at which it would rest.
CK_INLINE void project_spring(const ck_ProjectedCloth *cloth, const Ends *ends, const Springs *springs,
                              const int terms) {
    const ck_Compliant *compliant = &cloth->compliant[ends->kind];
    ck_Lanes3 now = span_now(cloth, ends, terms);
    ck_Lanes squared = ck_lanes3_dot(now, now), inverse;
    ck_lanes_inverse_root(&inverse, &squared, 1);
    ck_Lanes share = springs->share, share_rest = springs->share_rest;
    if (terms & REPEATED) share_rest = ck_lanes_minus(share_rest, springs->softness, ck_lanes_load(ends->multiplier));
    if (terms & DAMPED) {
        ck_Lanes3 moved = span_moved(cloth, ends, now, terms);
        share_rest = ck_lanes_minus(share_rest, springs->viscosity * ck_lanes3_dot(moved, now), inverse);
    }
    ck_Lanes scale = ck_lanes_minus(share, share_rest, inverse);
    if (terms & HELD) scale *= compliant->alone + (1 - compliant->alone) * both_alike(cloth, ends, terms);
    if (terms & REPEATED)
        ck_lanes_store(ends->multiplier, ck_lanes_minus(ck_lanes_load(ends->multiplier), scale, squared * inverse));
    move(cloth, ends, scale, now, terms);
}

// A vector of a row whose numbers begin at first, as ck_rows_place and ck_rows_right have it; with the row's number and
// not its place in its hands, a compiler makes loops that take a tenth longer.
CK_INLINE Ends ends_of(const ck_ProjectedCloth *cloth, ck_Colour colour, long first, int vector, bool is_last) {
    const long here = first + (long)vector * CK_STRIPE, stride = cloth->rows.stride;
    const ck_Place at = ck_place_of(here), below = ck_place_of(here + stride), start = ck_place_of(first),
                   right = is_last ? (ck_Place){start.single + 1, start.tile + 1} : ck_place_of(here + CK_STRIPE),
                   below_right = {right.single + stride, right.tile + 3 * stride};
    ck_Real *multiplier = cloth->multiplier[colour] ? cloth->multiplier[colour] + here : NULL;
    switch (colour) {
    case CK_DOWN:
    case CK_DOWN_LATE: return (Ends){at, below, CK_STRUCTURAL, multiplier};
    case CK_DOWN_RIGHT: return (Ends){at, below_right, CK_SHEAR, multiplier};
    case CK_DOWN_LEFT: return (Ends){right, below, CK_SHEAR, multiplier};
    default: return (Ends){at, right, CK_STRUCTURAL, multiplier};
    }
}

CK_INLINE Ends ends_after(Ends ends, long singles, long tiles) {
    return (Ends){{ends.a.single + singles, ends.a.tile + tiles},
                  {ends.b.single + singles, ends.b.tile + tiles},
                  ends.kind,
                  ends.multiplier ? ends.multiplier + singles : NULL};
}

CK_INLINE ck_Direction direction_of(ck_Colour colour) {
    if (colour == CK_DOWN_RIGHT || colour == CK_DOWN_LEFT) return CK_IS_ACROSS;
    return colour == CK_DOWN || colour == CK_DOWN_LATE ? CK_IS_DOWN : CK_IS_ALONG;
}

CK_INLINE void project_stripe(const ck_ProjectedCloth *cloth, const Ends *ends, const ck_Stripe *stripe,
                              const ck_Visit *at, const int terms) {
    for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES) {
        const Ends part = ends_after(*ends, lane, lane);
        const Springs springs = springs_of(stripe, lane);
        if (terms & FAR)
            project_far(cloth, part, springs, true, true);
        else if (terms & BARS)
            project_bar(cloth, &part, &springs, at, terms);
        else
            project_spring(cloth, &part, &springs, terms);
    }
}

// Which end is around, where a vector is a stripe.
CK_INLINE int around_of(ck_Colour colour) {
    if (CK_LANES < CK_STRIPE || direction_of(colour) == CK_IS_DOWN) return 0;
    return colour == CK_DOWN_LEFT ? A_IS_AROUND : B_IS_AROUND;
}

// The last vector, whose right is the first, comes by itself. But for the row all is alike in every visit, so that
// compilers keep it at hand.
CK_INLINE void project_row(const ck_ProjectedCloth *cloth, ck_Colour colour, const ck_Visit *at, const int terms) {
    const ck_Stripe *stripes = cloth->stripes[direction_of(colour)];
    const int last = cloth->rows.span - 1, step = colour == CK_ALONG_EVEN || colour == CK_ALONG_ODD ? 2 : 1;
    const long first = at->row * cloth->rows.stride;
    Ends ends = ends_of(cloth, colour, first, colour == CK_ALONG_ODD, false);
    for (int i = colour == CK_ALONG_ODD; i < last && colour != CK_ALONG_LAST; i += step) {
        project_stripe(cloth, &ends, &stripes[i], at, terms);
        ends = ends_after(ends, step * CK_STRIPE, step * 3 * CK_STRIPE);
    }
    if (step == 2) return;
    ends = ends_of(cloth, colour, first, last, true);
    project_stripe(cloth, &ends, &stripes[last], at, terms | around_of(colour));
}

static __attribute__((noinline)) void project_far_row(const ck_ProjectedCloth *cloth, ck_Colour colour,
                                                      const ck_Visit *at) {
    project_row(cloth, colour, at, BARS | FAR);
}

#define COLOURS 6

// The order of a sweep at a row. Springs that come late do more than twice as much for a stretched cloth; bars where
// they are more than the freedoms they act on shake with it.
static const ck_Colour order_of_bars[COLOURS] = {CK_ALONG_EVEN, CK_ALONG_ODD,  CK_ALONG_LAST,
                                                 CK_DOWN,       CK_DOWN_RIGHT, CK_DOWN_LEFT};
static const ck_Colour order_of_springs[COLOURS] = {CK_ALONG_EVEN, CK_ALONG_ODD, CK_ALONG_LAST,
                                                    CK_DOWN_RIGHT, CK_DOWN_LEFT, CK_DOWN_LATE};

CK_INLINE ck_Colour colour_at(int turn, const int terms) {
    const int at = terms & TURNED ? COLOURS - 1 - turn : turn;
    return (terms & BARS ? order_of_bars : order_of_springs)[at];
}

CK_INLINE void project_colour(const ck_ProjectedCloth *cloth, const ck_Visit *visits, int count, ck_Colour colour,
                              const int terms) {
    if (direction_of(colour) == CK_IS_ACROSS && !(cloth->rest[CK_SHEAR] > 0)) return;
    for (int i = 0; i < count; i++) {
        ck_Visit here = visits[i];
        if (colour == CK_DOWN_LATE && --here.row < 0) continue;
        if (direction_of(colour) != CK_IS_ALONG && here.row + 1 >= cloth->rows.rows) continue;
        if ((terms & BARS) && cloth->far_from[here.row] <= here.sweep)
            project_far_row(cloth, colour, &here);
        else if (cloth->is_held[here.row])
            project_row(cloth, colour, &here, terms | HELD);
        else
            project_row(cloth, colour, &here, terms);
    }
}

// x ← x + carried·(x − x_start) + push;  x_start ← x as it was. Velocities are what positions have moved by.
CK_INLINE void predict_wide(const ck_ProjectedCloth *cloth, ck_Place at, bool is_last) {
    const ck_Lanes free = ck_lanes_load(cloth->is_free + at.single);
    const ck_Lanes3 x = ck_lanes3_load(cloth->x + at.tile);
    const ck_Lanes3 moved = ck_lanes3_subtract(x, ck_lanes3_load(cloth->from + at.tile));
    const ck_Lanes3 way = ck_lanes3_add_scaled(ck_lanes3_all(cloth->push), ck_lanes_all(cloth->carried), moved);
    ck_lanes3_store(cloth->start + at.tile, x);
    ck_lanes3_store(cloth->x + at.tile, ck_lanes3_add_scaled(x, free, way));
    if (is_last) ck_lanes3_store(cloth->before + at.tile, moved);
}

// The same of ways: x_start takes x up, as far as its digits reach; x begins at what is left, which is kept.
CK_INLINE void predict_way(const ck_ProjectedCloth *cloth, ck_Place at, bool is_last) {
    const ck_Lanes free = ck_lanes_load(cloth->is_free + at.single);
    const ck_Lanes3 x = ck_lanes3_load(cloth->x + at.tile), start = ck_lanes3_load(cloth->start + at.tile);
    const ck_Lanes3 moved = ck_lanes3_subtract(x, ck_lanes3_load(cloth->kept + at.tile));
    const ck_Lanes3 way = ck_lanes3_add_scaled(ck_lanes3_all(cloth->push), ck_lanes_all(cloth->carried), moved);
    const ck_Lanes3 there = ck_lanes3_add(start, x);
    const ck_Lanes3 left = ck_lanes3_subtract(x, ck_lanes3_subtract(there, start));
    ck_lanes3_store(cloth->start + at.tile, there);
    ck_lanes3_store(cloth->kept + at.tile, left);
    ck_lanes3_store(cloth->x + at.tile, ck_lanes3_add_scaled(left, free, way));
    if (is_last) ck_lanes3_store(cloth->before + at.tile, moved);
}

CK_INLINE void forget_multipliers(const ck_ProjectedCloth *cloth, int row) {
    const size_t bytes = sizeof(ck_Real) * (size_t)cloth->rows.stride;
    for (int colour = CK_ALONG_LAST; colour <= CK_DOWN_LEFT && cloth->multipliers; colour++)
        memset(cloth->multiplier[colour] + row * cloth->rows.stride, 0, bytes);
}

// What is seldom stands out of line, and with the structure that is shared: the copy's address is not to leave the
// loop.
static __attribute__((noinline)) void fly_row(const ck_ProjectedCloth *cloth, int row, bool is_last) {
    cloth->far_from[row] = LONG_MAX;
    cloth->loops->row_fly(cloth, row, is_last);
    forget_multipliers(cloth, row);
}

static __attribute__((noinline)) void press_rows(const ck_ProjectedCloth *cloth, const ck_Visits *visits) {
    for (int i = 0; i < visits->count; i++)
        for (int k = 0; k < 2; k++)
            if (visits->ends[i][k] >= 0) cloth->loops->cloth_press(cloth, visits->ends[i][k]);
}

CK_INLINE void predict_row(const ck_ProjectedCloth *cloth, int row, bool is_last) {
    cloth->far_from[row] = LONG_MAX;
    for (int i = 0; i < cloth->rows.span; i++)
        for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES) {
            const ck_Place at = ck_rows_place(&cloth->rows, row, i);
            const ck_Place part = {at.single + lane, at.tile + lane};
            if (CK_IS_SINGLE)
                predict_way(cloth, part, is_last);
            else
                predict_wide(cloth, part, is_last);
        }
    forget_multipliers(cloth, row);
}

CK_INLINE void begin_row(const ck_ProjectedCloth *cloth, const ck_ProjectedCloth *shared, int row, bool is_last) {
    if (__builtin_expect(cloth->head.contact != NULL, 0))
        fly_row(shared, row, is_last);
    else
        predict_row(cloth, row, is_last);
}

CK_INLINE void begin_rows(const ck_ProjectedCloth *cloth, const ck_ProjectedCloth *shared, const ck_Visit *visit) {
    const bool is_last = visit->sweep + cloth->rule.iterations >= cloth->sweeps;
    for (int k = 0; k < 2; k++)
        if (visit->begins[k] >= 0) begin_row(cloth, shared, visit->begins[k], is_last);
}

// Colour by colour, so that each sweep in flight has the others' work to wait with, and each in a loop of its own,
// which takes a seventh less time on a narrow cloth.
CK_INLINE void run_colours(const ck_ProjectedCloth *cloth, const ck_ProjectedCloth *shared, const ck_Visits *visits,
                           const int terms) {
    for (int i = 0; i < visits->count; i++) begin_rows(cloth, shared, &visits->at[i]);
    const int together = ck_rows_are_wide(&cloth->rows) ? 1 : visits->count;
    for (int first = 0; first < visits->count; first += together)
#pragma GCC unroll 6
        for (int turn = 0; turn < COLOURS; turn++)
            project_colour(cloth, visits->at + first, together, colour_at(turn, terms), terms);
    if (__builtin_expect(cloth->head.contact != NULL, 0)) press_rows(shared, visits);
}

// The copy is known to share no memory with the arrays: what stands in it need not be read again after each store.
ck_ProjectionVisits CK_LOOP(ck_projection_visits);
void CK_LOOP(ck_projection_visits)(const ck_ProjectedCloth *shared, const ck_Visits *visits) {
    const ck_ProjectedCloth cloth = *shared;
    switch (cloth.terms) {
    case BARS:
        if (visits->is_turned)
            run_colours(&cloth, shared, visits, BARS | TURNED);
        else
            run_colours(&cloth, shared, visits, BARS);
        break;
    case 0: run_colours(&cloth, shared, visits, 0); break;
    case DAMPED: run_colours(&cloth, shared, visits, DAMPED); break;
    case REPEATED: run_colours(&cloth, shared, visits, REPEATED); break;
    default: run_colours(&cloth, shared, visits, REPEATED | DAMPED); break;
    }
}
