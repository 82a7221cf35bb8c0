// Compiled once for each kind of vectors; see loops.h. The formulas are those of native/contact.c.
#include "constraint_loop.h"
#include "near.h"
#include "row_contact.h"

#include <math.h>

static const ck_Lanes none;

// Those particles of a vector that stand at an index of arrays of one number, and of tiles.
typedef struct Group {
    int row, vector, lane;
    ck_Place at;
} Group;

CK_INLINE Group group_at(const ck_Rows *rows, int row, int vector, int lane) {
    const ck_Place at = ck_rows_place(rows, row, vector);
    return (Group){row, vector, lane, {at.single + lane, at.tile + lane}};
}

// The number of the particle in a lane.
CK_INLINE int particle_of(const ck_Rows *rows, const Group *group, int k) {
    return group->row * rows->columns + (group->lane + k) * rows->span + group->vector;
}

static void take(double *one, const double *tiles) {
    for (int axis = 0; axis < 3; axis++) one[axis] = tiles[axis * CK_STRIPE];
}

static void put(double *tiles, const double *one) {
    for (int axis = 0; axis < 3; axis++) tiles[axis * CK_STRIPE] = one[axis];
}

// A bit for each lane that is free.
CK_INLINE unsigned free_bits(const ck_RowContact *contact, const Group *group) {
    return ck_lanes_bits(ck_lanes_less(none, ck_lanes_load(contact->mass + group->at.single)));
}

// Of a solid with sharp edges, the way out is a matter of cases.
CK_INLINE bool is_sharp(const ck_NearSurface *surface) {
    return surface->axis_count && !(surface->radius > 0);
}

CK_INLINE ck_Lanes larger(ck_Lanes a, ck_Lanes b) {
    return ck_lanes_choose(ck_lanes_less(a, b), b, a);
}

// A bit for each that may hit a surface on its way faster than what counts as rest, 2·|a·n|·dt. Beyond reach none does.
// Else its speed inwards is there at most what it is here, what the field gives, and what the normal turns by on the
// way: by at most reach/R, which counts for the field, too. Ways are in metres a substep, speed·dt at the start and
// field·dt².
CK_INLINE unsigned may_hit(const ck_Touched *touch, const ck_NearSurface *surface, ck_Lanes3 x, ck_Lanes3 way,
                           ck_Lanes3 gain, const ck_NearShape shape) {
    if (surface->moves) {
        way = ck_lanes3_subtract_scaled(way, ck_lanes_all(touch->dt), ck_lanes3_all(surface->velocity));
        gain =
            ck_lanes3_subtract_scaled(gain, ck_lanes_all(touch->dt * touch->dt), ck_lanes3_all(surface->acceleration));
    }
    const unsigned near = ck_near_bits(ck_near_far(x, ck_near_most(way, gain, 1), surface, shape));
    // whose speed jumps, anything may meet
    if (!near || is_sharp(surface) || surface->margin == INFINITY) return near;
    ck_Lanes3 normal = ck_lanes3_all(surface->normal);
    ck_Lanes turned = none, gap;
    if (shape == CK_NEAR_PLANE) {
        gap = ck_near_gap(surface, x);
    } else {
        gap = ck_near_round_gap(ck_near_out(surface, x), ck_lanes_all(surface->radius), &normal);
        turned = ck_near_most(way, gain, 1) * (1 / surface->radius) * (ck_near_sum(way) + ck_near_sum(gain));
    }
    const ck_Lanes inwards = turned - ck_lanes3_dot(way, normal),
                   rest = ck_lanes_absolute(ck_lanes3_dot(gain, normal)) * (1 - 1e-9);
    const unsigned strikes = ck_lanes_bits(ck_lanes_less(rest, inwards)),
                   is_deep = ck_lanes_bits(ck_lanes_less(gap, ck_lanes_all(-touch->slack)));
    return near & (strikes | is_deep);
}

CK_INLINE unsigned may_hit_any(const ck_Touched *touch, ck_Lanes3 x, ck_Lanes3 way, ck_Lanes3 gain) {
    unsigned bits = 0;
    for (int k = 0; k < touch->count; k++) {
        const ck_NearSurface *surface = &touch->surfaces[k];
        switch (ck_near_shape(surface)) {
        case CK_NEAR_PLANE: bits |= may_hit(touch, surface, x, way, gain, CK_NEAR_PLANE); break;
        case CK_NEAR_BALL: bits |= may_hit(touch, surface, x, way, gain, CK_NEAR_BALL); break;
        default: bits |= may_hit(touch, surface, x, way, gain, CK_NEAR_SOLID); break;
        }
    }
    return bits;
}

// The particle of one lane by itself, over the impacts on its way.
//   mean, gain  [3] m: its mean speed times dt, and the field times dt²
static __attribute__((noinline)) void meet(const ck_ProjectedCloth *cloth, const Group *group, int k,
                                           const double *mean, const double *gain, bool is_last) {
    const ck_RowContact *contact = cloth->head.contact;
    const double dt = contact->touched.dt;
    const long tile = group->at.tile + k;
    double x[3], v[3], field[3], from[3], before[3], impulse[3] = {0, 0, 0};
    double *sum = contact->impulse + 3L * CK_STRIPE * group->row + group->lane + k;
    take(x, cloth->start + tile);
    for (int axis = 0; axis < 3; axis++) {
        v[axis] = mean[axis] / dt;
        field[axis] = gain[axis] / (dt * dt);
    }
    const ck_Follower *follower = &contact->follower;
    if (!follower->meet(follower->state, particle_of(&cloth->rows, group, k), field, x, v, impulse)) return;
    for (int axis = 0; axis < 3; axis++) {
        from[axis] = x[axis] - dt * v[axis];
        before[axis] = (v[axis] - dt * field[axis]) * dt / cloth->rule.keep;
        sum[axis * CK_STRIPE] += impulse[axis];
    }
    put(cloth->x + tile, x);
    put(cloth->from + tile, from);
    if (is_last) put(cloth->before + tile, before);
}

// As predict_vector of constraint_loop.c; a way is carried·(x − from) + push, and what speed it had at its start stands
// half way between that and keep·(x − from).
CK_INLINE void fly(const ck_ProjectedCloth *cloth, const Group *group, bool is_last) {
    const ck_Place at = group->at;
    const ck_Lanes free = ck_lanes_load(cloth->is_free + at.single), keep = ck_lanes_all(cloth->rule.keep);
    const ck_Lanes3 x = ck_lanes3_load(cloth->x + at.tile),
                    moved = ck_lanes3_subtract(x, ck_lanes3_load(cloth->from + at.tile));
    const ck_Lanes3 way = ck_lanes3_add_scaled(ck_lanes3_all(cloth->push), ck_lanes_all(cloth->carried), moved);
    const ck_Lanes3 gain = ck_lanes3_subtract_scaled(way, keep, moved);
    const ck_Lanes3 first = ck_lanes3_subtract_scaled(way, ck_lanes_all(0.5), gain);
    ck_lanes3_store(cloth->start + at.tile, x);
    ck_lanes3_store(cloth->from + at.tile, x);
    ck_lanes3_store(cloth->x + at.tile, ck_lanes3_add_scaled(x, free, way));
    if (is_last) ck_lanes3_store(cloth->before + at.tile, moved);
    unsigned bits = may_hit_any(&cloth->head.contact->touched, x, first, gain) & free_bits(cloth->head.contact, group);
    if (__builtin_expect(!bits, 1)) return;
    double ways[3 * CK_STRIPE], gains[3 * CK_STRIPE];
    ck_lanes3_store(ways, way);
    ck_lanes3_store(gains, gain);
    for (; bits; bits &= bits - 1) {
        const int k = __builtin_ctz(bits);
        double way_of[3], gain_of[3];
        take(way_of, ways + k);
        take(gain_of, gains + k);
        meet(cloth, group, k, way_of, gain_of, is_last);
    }
}

ck_RowFly CK_LOOP(ck_row_fly);
void CK_LOOP(ck_row_fly)(const ck_ProjectedCloth *cloth, int row, bool is_last) {
    const ck_Rows *rows = &cloth->rows;
    ck_row_contact_begin(cloth->head.contact, row);
    for (int i = 0; i < rows->span; i++)
        for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES) {
            const Group group = group_at(rows, row, i, lane);
            fly(cloth, &group, is_last);
        }
}

// What is pressed, as ck_contact_project has it.
typedef struct Pressed {
    ck_Lanes3 x, from, held, gained; // gained: m, of the ways that it was pushed
    ck_Lanes depth;
} Pressed;

// What friction takes of a way along a surface: in all at most so many m.
CK_INLINE ck_Lanes3 hold(ck_Lanes3 held, ck_Lanes3 along, ck_Lanes3 normal, ck_Lanes most) {
    const ck_Lanes3 wanted = ck_lanes3_subtract(held, along);
    const ck_Lanes squared = ck_lanes3_dot(wanted, wanted);
    ck_Lanes inverse;
    ck_lanes_inverse_root(&inverse, &squared, 1);
    const ck_Lanes share = ck_lanes_choose(ck_lanes_less(most * most, squared), most * inverse, ck_lanes_all(1));
    return ck_near_along(ck_lanes3_subtract(ck_lanes3_scale(share, wanted), held), normal);
}

// Pushes out those of asked, 1 or 0, that are inside of a surface without sharp edges. Returns by how much, m.
CK_INLINE ck_Lanes push_out(const ck_NearSurface *surface, ck_Lanes asked, Pressed *pressed) {
    const ck_Lanes3 before = pressed->x;
    ck_Lanes3 normal = ck_lanes3_all(surface->normal);
    const ck_Lanes gap = surface->is_plane
                             ? ck_near_gap(surface, before)
                             : ck_near_round_gap(ck_near_out(surface, before), ck_lanes_all(surface->radius), &normal);
    // what was pushed out by as much may still be held where it was lifted a little
    const ck_LaneMask is_held = ck_lanes_less(none, ck_lanes_choose(ck_lanes_less(gap, pressed->depth), asked, none));
    const ck_Lanes inside = ck_lanes_choose(is_held, larger(-gap, none), none);
    const ck_Lanes3 out = ck_lanes3_add_scaled(before, inside, normal);
    const ck_Lanes depth = pressed->depth + inside;
    ck_Lanes3 way = ck_lanes3_subtract(out, pressed->from);
    if (surface->moves) way = ck_lanes3_subtract(way, ck_lanes3_all(surface->way));
    const ck_Lanes3 along = ck_near_along(way, normal);
    const ck_Lanes3 taken = hold(pressed->held, along, normal, surface->friction * depth);
    pressed->depth = depth;
    pressed->x = ck_lanes3_choose(is_held, ck_lanes3_add(out, taken), before);
    pressed->held = ck_lanes3_choose(is_held, ck_lanes3_add(pressed->held, taken), pressed->held);
    pressed->gained = ck_lanes3_add(pressed->gained, ck_lanes3_subtract(pressed->x, before));
    return inside;
}

// 1 for each that is nearer to a surface's radius, or a share of it, than some reach. What is no number is not.
CK_INLINE ck_Lanes close_to(const ck_NearSurface *surface, double share, ck_Lanes3 x, ck_Lanes most) {
    const ck_Lanes reach = most + (surface->margin + share * surface->radius);
    const ck_Lanes3 out = ck_near_out(surface, x);
    const ck_LaneMask is_close = surface->is_plane
                                     ? ck_lanes_less(ck_lanes3_dot(out, ck_lanes3_all(surface->normal)), reach)
                                     : ck_lanes_less(ck_lanes3_dot(out, out), reach * reach);
    return ck_lanes_choose(is_close, ck_lanes_all(1), none);
}

// The particle of one lane by itself.
static __attribute__((noinline)) void press_alone(const ck_RowContact *contact, const Group *group, int k) {
    const ck_Follower *follower = &contact->follower;
    const long tile = group->at.tile + k;
    double x[3], from[3], held[3], impulse[3] = {0, 0, 0};
    double *sum = contact->impulse + 3L * CK_STRIPE * group->row + group->lane + k;
    take(x, contact->x + tile);
    take(from, contact->from + tile);
    take(held, contact->held + tile);
    follower->press(follower->state, particle_of(&contact->rows, group, k), from, contact->depth + group->at.single + k,
                    held, x, impulse);
    put(contact->x + tile, x);
    put(contact->held + tile, held);
    for (int axis = 0; axis < 3; axis++) sum[axis * CK_STRIPE] += impulse[axis];
}

// Those of asked, 1 or 0, by what has no sharp edges.
static __attribute__((noinline)) void press(const ck_RowContact *contact, const Group *group, ck_Lanes asked) {
    const ck_Touched *touch = &contact->touched;
    const ck_Place at = group->at;
    double *sum = contact->impulse + 3L * CK_STRIPE * group->row + group->lane;
    Pressed pressed = {.x = ck_lanes3_load(contact->x + at.tile),
                       .from = ck_lanes3_load(contact->from + at.tile),
                       .held = ck_lanes3_load(contact->held + at.tile),
                       .depth = ck_lanes_load(contact->depth + at.single)};
    for (int round = 0; round < (touch->count > 1 ? CK_PUSH_ROUNDS : 1) && ck_lanes_any_beyond(asked, 0); round++) {
        ck_Lanes pushed = none;
        for (int k = 0; k < touch->count; k++)
            if (!is_sharp(&contact->ends[k])) pushed = larger(pushed, push_out(&contact->ends[k], asked, &pressed));
        // by rounding alone, nothing is pushed into another
        asked = ck_lanes_choose(ck_lanes_less(ck_lanes_all(1e-3 * touch->slack), pushed), asked, none);
    }
    ck_lanes3_store(contact->x + at.tile, pressed.x);
    ck_lanes3_store(contact->held + at.tile, pressed.held);
    ck_lanes_store(contact->depth + at.single, pressed.depth);
    const ck_Lanes rate = ck_lanes_load(contact->mass + at.single) * (1 / touch->dt);
    ck_lanes3_store(sum, ck_lanes3_add_scaled(ck_lanes3_load(sum), rate, pressed.gained));
}

// As far as what has no sharp edges may push, m: by what is inside of it, some more where one pushes into another, and
// by what friction then takes of the way and gives back.
static __attribute__((noinline)) ck_Lanes most_pushed(const ck_RowContact *contact, const Group *group, ck_Lanes3 x) {
    ck_Lanes inside = none;
    for (int k = 0; k < contact->touched.count; k++) {
        const ck_NearSurface *surface = &contact->ends[k];
        const ck_Lanes3 out = ck_near_out(surface, x);
        if (surface->is_plane)
            inside += larger(-ck_lanes3_dot(out, ck_lanes3_all(surface->normal)), none);
        else if (!is_sharp(surface))
            inside += larger(surface->radius - ck_lanes3_dot(out, out) * (1 / surface->radius), none);
    }
    const ck_Lanes3 way = ck_lanes3_subtract(x, ck_lanes3_load(contact->from + group->at.tile));
    return 2 * inside + ck_near_sum(way) + ck_near_sum(ck_lanes3_load(contact->held + group->at.tile));
}

// Of those that are close to something, 1 for each that goes alone: what may come to sharp edges, or half way to the
// core of a solid, out of which there is no one way.
static __attribute__((noinline)) ck_Lanes find_alone(const ck_RowContact *contact, const Group *group, ck_Lanes3 x,
                                                     ck_Lanes depth, ck_Lanes asked) {
    ck_Lanes alone = none, reach = none;
    if (contact->touched.count > 1 && ck_lanes_any_beyond(asked, 0)) reach = asked * most_pushed(contact, group, x);
    for (int k = 0; k < contact->touched.count; k++) {
        const ck_NearSurface *surface = &contact->ends[k];
        if (is_sharp(surface))
            alone = larger(alone, close_to(surface, 1, x, depth + reach));
        else if (surface->axis_count)
            alone = larger(alone, close_to(surface, 0.5, x, reach));
    }
    return alone;
}

CK_INLINE bool press_group(const ck_RowContact *contact, const Group *group) {
    const ck_Lanes3 x = ck_lanes3_load(contact->x + group->at.tile);
    const ck_Lanes depth = ck_lanes_load(contact->depth + group->at.single);
    ck_Lanes asked = none, alone = none, close = none;
    bool has_solids = false;
    for (int k = 0; k < contact->touched.count; k++) {
        const ck_NearSurface *surface = &contact->ends[k];
        const ck_Lanes is_close = close_to(surface, 1, x, depth);
        has_solids |= surface->axis_count > 0;
        close = larger(close, is_close);
        if (!is_sharp(surface)) asked = larger(asked, is_close);
    }
    if (!ck_lanes_any_beyond(close, 0)) return false;
    const ck_LaneMask is_free = ck_lanes_less(none, ck_lanes_load(contact->mass + group->at.single));
    if (has_solids) alone = ck_lanes_choose(is_free, find_alone(contact, group, x, depth, asked), none);
    asked = ck_lanes_choose(is_free, asked * (1 - alone), none);
    if (ck_lanes_any_beyond(asked, 0)) {
        press(contact, group, asked);
        // several may have pushed it farther than was thought
        if (has_solids)
            alone = larger(alone, asked * find_alone(contact, group, ck_lanes3_load(contact->x + group->at.tile),
                                                     ck_lanes_load(contact->depth + group->at.single), none));
    }
    for (unsigned left = ck_lanes_bits(ck_lanes_less(none, alone)); left; left &= left - 1)
        press_alone(contact, group, __builtin_ctz(left));
    return true;
}

ck_RowPress CK_LOOP(ck_row_press);
bool CK_LOOP(ck_row_press)(const ck_RowContact *contact, int row) {
    bool is_pressed = false;
    for (int i = 0; i < contact->rows.span; i++)
        for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES) {
            const Group group = group_at(&contact->rows, row, i, lane);
            is_pressed |= press_group(contact, &group);
        }
    contact->is_pressed[row] |= is_pressed;
    return is_pressed;
}

ck_ClothPress CK_LOOP(ck_cloth_press);
void CK_LOOP(ck_cloth_press)(const ck_ProjectedCloth *cloth, int row) {
    CK_LOOP(ck_row_press)(cloth->head.contact, row);
}

ck_RowMeets CK_LOOP(ck_row_meets);
unsigned CK_LOOP(ck_row_meets)(const ck_RowContact *contact, int row) {
    unsigned bits = 0;
    for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES) {
        const Group group = group_at(&contact->rows, row, 0, lane);
        const ck_Lanes3 x = ck_lanes3_load(contact->x + group.at.tile),
                        way = ck_lanes3_load(contact->way + group.at.tile),
                        gain = ck_lanes3_load(contact->gain + group.at.tile);
        bits |= (may_hit_any(&contact->touched, x, way, gain) & free_bits(contact, &group)) << lane;
    }
    return bits;
}
