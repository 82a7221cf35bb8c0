// Compiled once for each kind of vectors; see loops.h. The formulas are those of native/contact.c, for what is most of
// contact: particles that touch one plane or ball that stays, with nothing else in reach, and rest or slide on it from
// start to end of a substep; and those that touch nothing and come to nothing. All others are left to be followed one
// by one.
#include "near.h"

// The surface that each lane touches; of a plane the curvature is 0.
typedef struct Surface {
    ck_Lanes3 point, normal;
    ck_Lanes radius, curvature, friction, gap;
} Surface;

CK_INLINE ck_Lanes inverse_length(ck_Lanes squared) {
    ck_Lanes inverse;
    ck_lanes_inverse_root(&inverse, &squared, 1);
    return inverse;
}

CK_INLINE Surface choose(ck_LaneMask mask, const Surface *yes, const Surface *no) {
    return (Surface){
        ck_lanes3_choose(mask, yes->point, no->point),      ck_lanes3_choose(mask, yes->normal, no->normal),
        ck_lanes_choose(mask, yes->radius, no->radius),     ck_lanes_choose(mask, yes->curvature, no->curvature),
        ck_lanes_choose(mask, yes->friction, no->friction), ck_lanes_choose(mask, yes->gap, no->gap)};
}

// The one that is touched at x. Into alone: not 0 where none or several are within a way, or it moves or is another
// shape.
CK_INLINE Surface find_surface(const ck_Touched *touch, ck_Lanes3 x, ck_Lanes way, ck_Lanes *alone) {
    const ck_Lanes none = {0}, one = ck_lanes_all(1), slack = ck_lanes_all(touch->slack);
    Surface found = {.gap = one};
    ck_Lanes in_reach = none, touched = none;
    for (int k = 0; k < touch->count; k++) {
        const ck_NearSurface *surface = &touch->surfaces[k];
        Surface each = {.point = ck_lanes3_all(surface->point),
                        .radius = ck_lanes_all(surface->radius),
                        .friction = ck_lanes_all(surface->friction)};
        if (surface->axis_count) {
            each.gap = ck_near_gap(surface, x);
        } else if (surface->is_plane) {
            each.normal = ck_lanes3_all(surface->normal);
            each.gap = ck_lanes3_dot(ck_lanes3_subtract(x, each.point), each.normal);
        } else {
            each.curvature = ck_lanes_all(1 / surface->radius);
            each.gap = ck_near_round_gap(ck_lanes3_subtract(x, each.point), each.radius, &each.normal);
        }
        const ck_LaneMask is_near = ck_lanes_less(each.gap, way + surface->margin);
        const ck_LaneMask is_touched = ck_lanes_less(each.gap, slack);
        in_reach += ck_lanes_choose(is_near, ck_lanes_all(surface->moves ? 2 : 1), none);
        touched += ck_lanes_choose(is_touched, surface->axis_count ? none : one, none);
        found = choose(is_touched, &each, &found);
    }
    *alone = (in_reach - 1) * (in_reach - 1) + (touched - 1) * (touched - 1);
    return found;
}

// 1 for each that touches a plane or a ball that stays, and goes from it faster than rounding and out of its reach.
//   way, end, least  m out of it in the substep, by the speed at the start and in all, and rounding
CK_INLINE ck_Lanes find_leaving(const ck_Touched *touch, const ck_NearSurface *surface, ck_Lanes gap, ck_Lanes way,
                                ck_Lanes end, ck_Lanes least) {
    const ck_Lanes none = {0}, one = ck_lanes_all(1);
    if (surface->axis_count || surface->moves) return none;
    const ck_Lanes goes = ck_lanes_choose(ck_lanes_less(least, way), one, none);
    const ck_Lanes is_out = ck_lanes_choose(ck_lanes_less(least + surface->margin, end), one, none);
    return ck_lanes_choose(ck_lanes_less(gap, ck_lanes_all(-1e-3 * touch->slack)), none, goes * is_out);
}

// 1 for each that touches nothing in all of the substep, or leaves it at once and for all of that. A surface lies
// behind the plane through its next point, across the way to there: what does not come to that plane comes to nothing.
// Of an edge the plane's direction is known to a place's rounding over the way to there.
CK_INLINE ck_Lanes find_flying(const ck_Touched *touch, ck_Lanes3 x, ck_Lanes3 v, ck_Lanes3 a) {
    const ck_Lanes none = {0}, dt = ck_lanes_all(touch->dt), most = ck_near_most(v, a, touch->dt);
    ck_Lanes flying = ck_lanes_all(1);
    for (int k = 0; k < touch->count; k++) {
        const ck_NearSurface *surface = &touch->surfaces[k];
        const ck_Lanes radius = ck_lanes_all(surface->radius);
        const ck_Lanes place = ck_near_sum(ck_lanes3_subtract(x, ck_lanes3_all(surface->point)));
        ck_Lanes3 normal = ck_lanes3_all(surface->normal);
        const ck_Lanes3 out = ck_near_out(surface, x);
        const ck_Lanes gap = surface->is_plane ? ck_lanes3_dot(out, normal) : ck_near_round_gap(out, radius, &normal);
        const ck_Lanes way = dt * ck_lanes3_dot(v, normal), gain = 0.5 * dt * dt * ck_lanes3_dot(a, normal);
        const ck_Lanes end = way + gain, low = ck_lanes_choose(ck_lanes_less(gain, none), end, way);
        const ck_Lanes inwards = ck_lanes_choose(ck_lanes_less(low, none), low, none);
        ck_Lanes spare = gap + inwards - 1e-9 * most - surface->margin;
        if (!surface->is_plane) spare = spare * (gap + radius) - 1e-15 * most * place;
        const ck_Lanes leaving = find_leaving(touch, surface, gap, way, end, 1e-9 * most);
        flying = ck_lanes_choose(ck_lanes_less(none, spare), flying, flying * leaving);
    }
    return flying;
}

// Faster than rounding, of what friction, m/s², takes within a substep; squared, which needs no root.
CK_INLINE ck_LaneMask slides_along(ck_Lanes friction, ck_Lanes3 along, double dt) {
    const ck_Lanes least = friction * (dt * 1e-9);
    return ck_lanes_less(least * least, ck_lanes3_dot(along, along));
}

// What a surface leaves of an acceleration.
typedef struct Held {
    ck_Lanes3 left, push; // m/s²; push: along the surface, without friction
    ck_Lanes press;       // how hard it is pressed on, per mass: above 0 where it is
    ck_LaneMask holds;    // all of the push
} Held;

CK_INLINE Held hold(const Surface *surface, ck_Lanes3 normal, ck_Lanes3 v, ck_Lanes3 a, double dt) {
    const ck_Lanes none = {0};
    const ck_Lanes3 along = ck_near_along(v, normal), push = ck_near_along(a, normal);
    const ck_Lanes press = -ck_lanes3_dot(a, normal) - surface->curvature * ck_lanes3_dot(v, v);
    const ck_Lanes friction = surface->friction * press;
    const ck_LaneMask agrees = ck_lanes_less(none, ck_lanes3_dot(along, push));
    const ck_Lanes3 way = ck_lanes3_add_scaled(along, ck_lanes_choose(agrees, ck_lanes_all(0.5 * dt), none), push);
    const ck_Lanes pushed = ck_lanes3_dot(push, push);
    // without friction a push is never held
    const ck_LaneMask holds = ck_lanes_less(pushed, friction * friction);
    const ck_LaneMask slides = slides_along(friction, along, dt);
    const ck_Lanes3 rubbed = ck_lanes3_subtract_scaled(push, friction * inverse_length(ck_lanes3_dot(way, way)), way);
    Held held = {ck_lanes3_choose(slides, rubbed, (ck_Lanes3){none, none, none}), push, press, holds};
    // what is only now pushed loose is rare: another root that most do without
    const ck_Lanes starts = ck_lanes_choose(slides, none, ck_lanes_choose(holds, none, ck_lanes_all(1)));
    if (!ck_lanes_any_beyond(starts, 0)) return held;
    const ck_Lanes3 loose = ck_lanes3_subtract_scaled(push, friction * inverse_length(pushed), push);
    held.left = ck_lanes3_choose(ck_lanes_less(none, starts), loose, held.left);
    return held;
}

CK_INLINE ck_LaneMask leaves_fast(ck_Lanes3 v, ck_Lanes3 normal) {
    const ck_Lanes out = ck_lanes3_dot(v, normal);
    return ck_lanes_less(1e-24 * ck_lanes3_dot(v, v),
                         ck_lanes_choose(ck_lanes_less(out, (ck_Lanes){0}), (ck_Lanes){0}, out * out));
}

// As hold, where the surface is not left, faster than rounding; else all of it.
CK_INLINE ck_Lanes3 filter(const Surface *surface, ck_Lanes3 normal, ck_Lanes3 v, ck_Lanes3 a, double dt) {
    const Held held = hold(surface, normal, v, a, dt);
    const ck_LaneMask leaves = leaves_fast(v, normal), is_pressed = ck_lanes_less((ck_Lanes){0}, held.press);
    return ck_lanes3_choose(leaves, a, ck_lanes3_choose(is_pressed, held.left, a));
}

// Not 0 where friction stops or turns a slide within a time; see ck_slide_stop_time.
CK_INLINE ck_Lanes ends_within(ck_Lanes friction, ck_Lanes3 v, const Held *held, ck_Lanes time, double dt) {
    const ck_Lanes none = {0}, one = ck_lanes_all(1);
    const ck_Lanes squared = ck_lanes3_dot(v, v), pushed = ck_lanes3_dot(held->push, held->push);
    // friction·|v| below that
    const ck_Lanes most = time * (friction * friction - pushed) - ck_lanes3_dot(v, held->push);
    const ck_Lanes below = ck_lanes_choose(ck_lanes_less(friction * friction * squared, most * most), one, none);
    const ck_Lanes stops = ck_lanes_choose(ck_lanes_less(none, most), below, none);
    const ck_Lanes turns = ck_lanes_choose(ck_lanes_less(squared, -time * ck_lanes3_dot(v, held->left)), one, none);
    const ck_Lanes rubs = ck_lanes_choose(ck_lanes_less(none, friction), one, none);
    const ck_Lanes ends = rubs * ck_lanes_choose(ck_lanes_less(pushed, friction * friction), stops, turns);
    return ck_lanes_choose(slides_along(friction, v, dt), ends, none);
}

// When it does, s, of what ends.
CK_INLINE ck_Lanes ending_time(ck_Lanes friction, ck_Lanes3 v, const Held *held) {
    const ck_Lanes squared = ck_lanes3_dot(v, v), pushed = ck_lanes3_dot(held->push, held->push);
    const ck_Lanes speed = squared * inverse_length(squared), f = pushed * inverse_length(pushed);
    const ck_Lanes stop = (speed * friction + ck_lanes3_dot(v, held->push)) / ((friction - f) * (friction + f));
    return ck_lanes_choose(held->holds, stop, -squared / ck_lanes3_dot(v, held->left));
}

// Where a slide is after a time; on a ball its speed follows from the work done, as work_over has it.
CK_INLINE void slide(const Surface *surface, ck_Lanes3 *x, ck_Lanes3 *v, ck_Lanes3 a, ck_Lanes3 left, ck_Lanes press,
                     ck_Lanes time, ck_Lanes3 *normal) {
    const ck_Lanes none = {0}, one = ck_lanes_all(1);
    const ck_LaneMask is_curved = ck_lanes_less(none, surface->curvature);
    const ck_Lanes3 flat = ck_lanes3_scale(time, ck_lanes3_add_scaled(*v, 0.5 * time, left));
    const ck_Lanes3 to = ck_lanes3_add(*x, flat), faster = ck_lanes3_add_scaled(*v, time, left);
    ck_Lanes3 out;
    const ck_Lanes gap = ck_near_round_gap(ck_lanes3_subtract(to, surface->point), surface->radius, &out);
    const ck_Lanes3 turned = ck_near_along(faster, out);
    const ck_Lanes flat_squared = ck_lanes3_dot(flat, flat), turned_squared = ck_lanes3_dot(turned, turned);
    const ck_Lanes squared = flat_squared * surface->curvature * surface->curvature;
    const ck_Lanes cosine = inverse_length(one + squared), less = squared * cosine * cosine / (one + cosine);
    const ck_Lanes length_squared = 2 * surface->radius * surface->radius * less;
    const ck_Lanes pulled =
        cosine * ck_lanes3_dot(a, flat) - less * surface->radius * ck_lanes3_dot(a, surface->normal);
    const ck_Lanes rubbed = surface->friction * press * (length_squared * inverse_length(length_squared));
    const ck_Lanes worked = ck_lanes3_dot(*v, *v) + 2 * (pulled - rubbed);
    const ck_Lanes kept = ck_lanes_choose(ck_lanes_less(none, worked), worked, none);
    const ck_Lanes scale = kept * inverse_length(kept * turned_squared); // √kept / |turned|
    *x = ck_lanes3_choose(is_curved, ck_lanes3_subtract_scaled(to, gap, out), to);
    *v = ck_lanes3_choose(is_curved, ck_lanes3_scale(scale, turned), faster);
    *normal = ck_lanes3_choose(is_curved, out, surface->normal);
}

// Speed into the surface that is no impact is taken, and friction's share of what is along it. Not 0 into alone: an
// impact, or it leaves.
CK_INLINE ck_Lanes3 press_in(const Surface *surface, ck_Lanes3 v, ck_Lanes3 a, double dt, ck_Lanes *alone) {
    const ck_Lanes none = {0}, one = ck_lanes_all(1);
    const ck_Lanes inwards = -ck_lanes3_dot(v, surface->normal), pull = ck_lanes3_dot(a, surface->normal);
    const ck_Lanes jump = ck_lanes_choose(ck_lanes_less(none, inwards), inwards, none);
    const ck_Lanes rest = 2 * dt * ck_lanes_choose(ck_lanes_less(pull, none), -pull, pull);
    const ck_Lanes3 along = ck_near_along(v, surface->normal);
    const ck_Lanes squared = ck_lanes3_dot(along, along);
    const ck_Lanes loss = surface->friction * jump * inverse_length(squared);
    const ck_Lanes share = ck_lanes_choose(ck_lanes_less(loss, one), loss, one);
    const ck_Lanes3 left = ck_lanes3_subtract_scaled(ck_lanes3_add_scaled(v, jump, surface->normal), share, along);
    *alone += ck_lanes_choose(ck_lanes_less(rest, jump), one, none);
    *alone += ck_lanes_choose(leaves_fast(left, surface->normal), one, none);
    return left;
}

// Some particles, a lane each. Where a store crosses a line of the cache, and then a page, it costs as much as a root.
typedef struct Group {
    _Alignas(CK_VECTOR_BYTES) ck_Lanes3 x0; // where they start
    ck_Lanes3 v0, a;
    ck_Lanes3 x, v;   // where they are, and at last the end
    ck_Lanes3 change; // what acceleration is left at the end
    ck_Lanes3 normal; // of the surface there
    ck_Lanes alone;   // not 0: not done here
    ck_Lanes ends;    // not 0: a slide ends before the substep does
    Surface surface;  // at the start
    Held held;
    ck_LaneMask goes;
    bool rests; // all of them
} Group;

// True where all lie still and are held: they stay to the bit. Deeper than rounding they do not lie still.
CK_INLINE bool all_rest(const ck_Touched *touch, const Group *group) {
    const ck_Lanes none = {0}, one = ck_lanes_all(1);
    if (ck_lanes_any_beyond(ck_lanes3_dot(group->v0, group->v0), 0)) return false;
    const Surface *surface = &group->surface;
    const Held held = hold(surface, surface->normal, group->v0, group->a, touch->dt);
    const ck_Lanes deep = ck_lanes_choose(ck_lanes_less(surface->gap, ck_lanes_all(-1e-3 * touch->slack)), one, none);
    const ck_Lanes loose = ck_lanes_choose(ck_lanes_less(none, held.press), none, one);
    return !ck_lanes_any_beyond(group->alone + deep + loose + ck_lanes_choose(held.holds, none, one), 0);
}

CK_INLINE void meet(const ck_Touched *touch, const ck_Loose *loose, int at, Group *group) {
    const ck_Lanes none = {0};
    group->x = group->x0 = ck_lanes3_load_apart(loose->x + at, loose->stride);
    group->v = group->v0 = ck_lanes3_load_apart(loose->v + at, loose->stride);
    group->a = ck_lanes3_load_apart(loose->a + at, loose->stride);
    group->change = (ck_Lanes3){none, none, none};
    group->alone = none;
    group->surface = find_surface(touch, group->x0, ck_near_most(group->v0, group->a, touch->dt), &group->alone);
    group->normal = group->surface.normal;
    group->rests = all_rest(touch, group);
}

CK_INLINE ck_Lanes depth_of(const Surface *surface) {
    const ck_Lanes none = {0};
    return ck_lanes_choose(ck_lanes_less(surface->gap, none), surface->gap, none);
}

CK_INLINE void press(const ck_Touched *touch, Group *group) {
    const Surface *surface = &group->surface;
    group->x = ck_lanes3_subtract_scaled(group->x0, depth_of(surface), surface->normal);
    group->v = press_in(surface, group->v0, group->a, touch->dt, &group->alone);
}

CK_INLINE void rub(const ck_Touched *touch, Group *group) {
    const ck_Lanes none = {0}, one = ck_lanes_all(1);
    const Surface *surface = &group->surface;
    const Held held = group->held = hold(surface, surface->normal, group->v, group->a, touch->dt);
    group->alone += ck_lanes_choose(ck_lanes_less(none, held.press), none, one);
    const ck_Lanes ends =
        ends_within(surface->friction * held.press, group->v, &held, ck_lanes_all(touch->dt), touch->dt);
    group->ends = ck_lanes_choose(ck_lanes_less(none, group->alone), none, ends);
    const ck_LaneMask is_deep = ck_lanes_less(depth_of(surface), ck_lanes_all(-1e-3 * touch->slack));
    const ck_Lanes moves =
        ck_lanes_choose(held.holds, ck_lanes3_dot(group->v0, group->v0), one) + ck_lanes_choose(is_deep, one, none);
    group->goes = ck_lanes_less(none, moves);
}

// On from where friction has ended a slide, to the end of the substep.
//   from  m/s, at the start of the slide
static __attribute__((noinline)) void go_on(const ck_Touched *touch, Group *group, ck_Lanes time, ck_Lanes3 from) {
    const ck_Lanes none = {0}, one = ck_lanes_all(1);
    const ck_LaneMask ends = ck_lanes_less(none, group->ends);
    const ck_Lanes3 faster = ck_lanes3_add_scaled(from, time, group->held.left);
    const ck_Lanes share = ck_lanes3_dot(faster, from) / ck_lanes3_dot(from, from);
    const ck_Lanes3 turned = ck_near_along(ck_lanes3_subtract_scaled(faster, share, from), group->normal);
    const ck_Lanes3 ended = ck_lanes3_choose(group->held.holds, (ck_Lanes3){none, none, none}, turned);
    const ck_Lanes left_time = touch->dt - time;
    Surface surface = group->surface;
    surface.normal = group->normal;
    group->v = ck_lanes3_choose(ends, ended, group->v);
    const Held held = hold(&surface, surface.normal, group->v, group->a, touch->dt);
    const ck_Lanes lifts = ck_lanes_choose(ck_lanes_less(none, held.press), none, one);
    const ck_Lanes again = ends_within(surface.friction * held.press, group->v, &held, left_time, touch->dt);
    const ck_LaneMask goes =
        ck_lanes_less(none, group->ends * ck_lanes_choose(held.holds, ck_lanes3_dot(group->v, group->v), one));
    group->alone += group->ends * (lifts + again);
    ck_Lanes3 x = group->x, v = group->v, normal;
    slide(&surface, &x, &v, group->a, held.left, held.press, left_time, &normal);
    group->x = ck_lanes3_choose(goes, x, group->x);
    group->v = ck_lanes3_choose(goes, v, group->v);
    group->normal = ck_lanes3_choose(goes, normal, group->normal);
}

CK_INLINE void go(const ck_Touched *touch, Group *group) {
    const Held *held = &group->held;
    const ck_Lanes3 from = group->v;
    const bool any_ends = ck_lanes_any_beyond(group->ends, 0);
    ck_Lanes time = ck_lanes_all(touch->dt);
    if (any_ends) {
        const ck_Lanes end = ending_time(group->surface.friction * held->press, from, held);
        const ck_LaneMask ends = ck_lanes_less((ck_Lanes){0}, group->ends);
        time = ck_lanes_choose(ends, ck_lanes_choose(ck_lanes_less(end, time), end, time), time);
    }
    slide(&group->surface, &group->x, &group->v, group->a, held->left, held->press, time, &group->normal);
    if (any_ends) go_on(touch, group, time, from);
    group->x = ck_lanes3_choose(group->goes, group->x, group->x0);
    group->v = ck_lanes3_choose(group->goes, group->v, group->v0);
    group->normal = ck_lanes3_choose(group->goes, group->normal, group->surface.normal);
}

CK_INLINE void end(const ck_Touched *touch, Group *group) {
    group->change = filter(&group->surface, group->normal, group->v, group->a, touch->dt);
}

// Their impulses are added up lane by lane of a stripe, so that vectors of any width give the same sums.
//   sums  [3*CK_STRIPE] N·s
CK_INLINE void put_group(const ck_Touched *touch, const ck_Loose *loose, int at, const Group *group, double *sums) {
    const ck_Lanes none = {0}, one = ck_lanes_all(1), half = ck_lanes_all(0.5 * touch->dt);
    const ck_LaneMask is_done = ck_lanes_less(group->alone, 0.5 * one); // what is no number is alone, too
    const ck_Lanes3 kept = ck_lanes3_subtract_scaled(group->v, half, group->change);
    ck_lanes_store(loose->is_alone + at, ck_lanes_choose(is_done, none, one));
    ck_lanes3_store_apart(loose->x + at, loose->stride, ck_lanes3_choose(is_done, group->x, group->x0));
    ck_lanes3_store_apart(loose->v + at, loose->stride, ck_lanes3_choose(is_done, kept, group->v0));
    ck_lanes3_store_apart(loose->predicted + at, loose->stride, group->v);
    ck_lanes3_store_apart(loose->normal + at, loose->stride, group->normal);
    ck_lanes_store(loose->curvature + at, group->surface.curvature);
    ck_lanes_store(loose->friction + at, group->surface.friction);
    const ck_Lanes3 free = ck_lanes3_add_scaled(group->v0, ck_lanes_all(touch->dt), group->a);
    const ck_Lanes3 gained = ck_lanes3_scale(ck_lanes_load(loose->mass + at), ck_lanes3_subtract(group->v, free));
    double *sum = sums + at % CK_STRIPE;
    ck_lanes3_store(
        sum, ck_lanes3_add(ck_lanes3_load(sum), ck_lanes3_choose(is_done, gained, (ck_Lanes3){none, none, none})));
}

// 1 for each that no surface is in reach of.
CK_INLINE ck_Lanes find_far(const ck_Touched *touch, ck_Lanes3 x, ck_Lanes3 v, ck_Lanes3 a) {
    const ck_Lanes none = {0}, most = ck_near_most(v, a, touch->dt);
    ck_Lanes far = ck_lanes_all(1);
    for (int k = 0; k < touch->count; k++)
        far = ck_lanes_choose(ck_near_is_far(x, most, &touch->surfaces[k]), far, none);
    return far;
}

// Of those left alone, the ones that fly by the acceleration that they have.
static __attribute__((noinline)) unsigned fly_alone(const ck_Touched *touch, const ck_Loose *loose) {
    const ck_Lanes none = {0}, dt = ck_lanes_all(touch->dt);
    ck_Lanes left = none, leaving = none;
    for (int at = 0; at < loose->count; at += CK_LANES) {
        const ck_Lanes alone = ck_lanes_load(loose->is_alone + at);
        if (!ck_lanes_any_beyond(alone, 0)) continue;
        const ck_Lanes3 x = ck_lanes3_load_apart(loose->x + at, loose->stride),
                        v = ck_lanes3_load_apart(loose->v + at, loose->stride),
                        a = ck_lanes3_load_apart(loose->a + at, loose->stride),
                        predicted = ck_lanes3_load_apart(loose->predicted + at, loose->stride);
        const ck_Lanes flying = alone * find_flying(touch, x, v, a), far = flying * find_far(touch, x, v, a);
        const ck_LaneMask flies = ck_lanes_less(none, flying);
        const ck_Lanes3 half = ck_lanes3_add_scaled(v, 0.5 * dt, a), faster = ck_lanes3_add_scaled(half, 0.5 * dt, a);
        ck_lanes_store(loose->is_alone + at, alone - flying - far);
        ck_lanes3_store_apart(loose->x + at, loose->stride,
                              ck_lanes3_choose(flies, ck_lanes3_add_scaled(x, dt, half), x));
        ck_lanes3_store_apart(loose->v + at, loose->stride, ck_lanes3_choose(flies, half, v));
        ck_lanes3_store_apart(loose->predicted + at, loose->stride, ck_lanes3_choose(flies, faster, predicted));
        // nothing is touched at the end, which a last kick asks for
        for (int axis = 0; axis < 3; axis++) {
            double *normal = loose->normal + at + axis * loose->stride;
            ck_lanes_store(normal, ck_lanes_choose(flies, none, ck_lanes_load(normal)));
        }
        ck_lanes_store(loose->curvature + at, ck_lanes_choose(flies, none, ck_lanes_load(loose->curvature + at)));
        // what fills the last vector up weighs nothing
        const ck_LaneMask is_there = ck_lanes_less(none, ck_lanes_load(loose->mass + at));
        left += ck_lanes_choose(is_there, alone - flying, none);
        leaving += ck_lanes_choose(is_there, far, none);
    }
    return (ck_lanes_any_beyond(left, 0) ? CK_SOME_ALONE : 0) | (ck_lanes_any_beyond(leaving, 0) ? CK_SOME_LEAVE : 0);
}

enum { TOGETHER = 4 };

// A particle's way through a substep is one long chain of roots: groups go through each part of it together, or a
// processor would not look far enough ahead to fill the wait for one's with another's.
CK_INLINE void pass(const ck_Touched *touch, Group *groups, int count) {
    for (int i = 0; i < count; i++)
        if (!groups[i].rests) press(touch, &groups[i]);
    for (int i = 0; i < count; i++)
        if (!groups[i].rests) rub(touch, &groups[i]);
    for (int i = 0; i < count; i++)
        if (!groups[i].rests) go(touch, &groups[i]);
    for (int i = 0; i < count; i++)
        if (!groups[i].rests) end(touch, &groups[i]);
}

ck_TouchSlide CK_LOOP(ck_touch_slide);
unsigned CK_LOOP(ck_touch_slide)(const ck_Touched *touch, const ck_Loose *all, double *impulse) {
    const ck_Loose local = *all, *loose = &local;
    const ck_Lanes none = {0};
    double sums[3 * CK_STRIPE] = {0};
    ck_Lanes alone = none;
    for (int first = 0; first < loose->count; first += TOGETHER * CK_LANES) {
        Group groups[TOGETHER];
        int count = 0;
        for (int at = first; count < TOGETHER && at < loose->count; at += CK_LANES)
            meet(touch, loose, at, &groups[count++]);
        pass(touch, groups, count);
        for (int i = 0; i < count; i++) {
            const int at = first + i * CK_LANES;
            put_group(touch, loose, at, &groups[i], sums);
            // what fills the last vector up weighs nothing
            alone += ck_lanes_choose(ck_lanes_less(none, ck_lanes_load(loose->mass + at)), groups[i].alone, none);
        }
    }
    for (int axis = 0; axis < 3; axis++)
        for (int lane = 0; lane < CK_STRIPE; lane++) impulse[axis] += sums[axis * CK_STRIPE + lane];
    // what is no number is alone, too
    const bool any_alone = ck_lanes_bits(ck_lanes_less(alone, 0.5 * ck_lanes_all(1))) != (1u << CK_LANES) - 1;
    return any_alone ? fly_alone(touch, loose) : 0;
}

ck_TouchHold CK_LOOP(ck_touch_hold);
void CK_LOOP(ck_touch_hold)(double dt, const ck_Loose *all) {
    const ck_Loose local = *all, *loose = &local;
    const ck_Lanes none = {0}, half = ck_lanes_all(0.5 * dt);
    for (int at = 0; at < loose->count; at += CK_LANES) {
        const Surface surface = {.curvature = ck_lanes_load(loose->curvature + at),
                                 .friction = ck_lanes_load(loose->friction + at)};
        const ck_Lanes3 v = ck_lanes3_load_apart(loose->v + at, loose->stride);
        const ck_Lanes3 change = filter(&surface, ck_lanes3_load_apart(loose->normal + at, loose->stride),
                                        ck_lanes3_load_apart(loose->predicted + at, loose->stride),
                                        ck_lanes3_load_apart(loose->a + at, loose->stride), dt);
        const ck_LaneMask is_alone = ck_lanes_less(none, ck_lanes_load(loose->is_alone + at));
        ck_lanes3_store_apart(loose->v + at, loose->stride,
                              ck_lanes3_choose(is_alone, v, ck_lanes3_add_scaled(v, half, change)));
    }
}
