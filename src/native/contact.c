#include "contact.h"

#include "collider.h"
#include "path.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

// What can happen to one particle in one substep; wedged between colliders, it could go on for ever. The rest of its
// time is lost.
#define MAX_EVENTS 200

ck_Status ck_contact_create(ck_Contact **contact, const ck_Model *model, double dt, ck_Error *error) {
    *contact = NULL;
    if (!model->collider_count) return CK_OK;
    // motion stands behind it, so that it is freed with it
    const bool moves = model->terms & CK_TERM_MOVING_COLLIDERS;
    *contact = calloc(1, sizeof **contact + (moves ? sizeof(ck_Motion) * (size_t)model->collider_count : 0));
    if (!*contact) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    **contact = (ck_Contact){.model = model, .dt = dt, .slack = 1e-9 * model->spacing};
    if (moves) (*contact)->motion = (ck_Motion *)(*contact + 1);
    if (moves) ck_contact_follow(*contact, 0);
    return CK_OK;
}

static double next_jump(const ck_Contact *contact, double time) {
    double next = INFINITY;
    for (int i = 0; i < contact->model->collider_count; i++)
        if (contact->model->colliders[i].path)
            next = fmin(next, ck_path_next_jump(contact->model->colliders[i].path, time));
    return next;
}

// From so much of the substep, s, to its end or the next jump.
static void follow_from(ck_Contact *contact, double from) {
    const double dt = contact->dt, start = contact->begun + from;
    double until = next_jump(contact, start) - contact->begun, none[3], other[3], end[3];
    if (until > dt * (1 - 1e-9)) until = dt;
    contact->from = from;
    contact->until = until;
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Path *path = contact->model->colliders[i].path;
        ck_Motion *motion = &contact->motion[i];
        if (!path) continue;
        ck_path_at(path, start, 1, motion->moved, motion->velocity, other);
        ck_path_at(path, contact->begun + until, -1, end, none, other);
        const double time = until - from;
        for (int axis = 0; axis < 3; axis++) {
            const double speed = motion->velocity[axis],
                         gain = 2 * (end[axis] - motion->moved[axis] - time * speed) / (time * time);
            motion->acceleration[axis] = gain;
            motion->velocity[axis] -= from * gain;
            motion->moved[axis] -= from * (speed - 0.5 * from * gain);
        }
    }
}

void ck_contact_follow(ck_Contact *contact, double time) {
    if (!contact->motion) return;
    memset(contact->motion, 0, sizeof *contact->motion * (size_t)contact->model->collider_count);
    contact->elapsed = 0;
    contact->begun = time;
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Path *path = contact->model->colliders[i].path;
        ck_Motion *motion = &contact->motion[i];
        double start[3], none[3], other[3];
        if (!path) continue;
        ck_path_at(path, time, 1, start, none, other);
        ck_path_at(path, time + contact->dt, -1, motion->end, none, other);
        ck_subtract(motion->way, motion->end, start);
    }
    follow_from(contact, 0);
}

// A place, a speed and an acceleration as a collider sees them: where all stay, those of the caller, and else own.
typedef struct Seen {
    double *x, *v;
    const double *a;
    double own[3][3];
} Seen;

static inline const ck_Motion *motion_of(const ck_Contact *contact, const ck_Collider *collider) {
    return &contact->motion[collider - contact->model->colliders];
}

// After so much of the substep, s.
//   moves  a constant of the caller: false costs nothing
static inline void see(Seen *seen, const ck_Contact *contact, const ck_Collider *collider, const double *x,
                       const double *v, const double *a, double elapsed, const bool moves) {
    // who only looks may be const
    seen->x = moves ? seen->own[0] : (double *)x;
    seen->v = moves ? seen->own[1] : (double *)v;
    seen->a = moves ? seen->own[2] : a;
    if (!moves) return;
    const ck_Motion *motion = motion_of(contact, collider);
    for (int axis = 0; axis < 3; axis++) {
        const double speed = motion->velocity[axis], gain = elapsed * motion->acceleration[axis];
        seen->own[0][axis] = x[axis] - motion->moved[axis] - elapsed * (speed + 0.5 * gain);
        seen->own[1][axis] = v[axis] - speed - gain;
        seen->own[2][axis] = a[axis] - motion->acceleration[axis];
    }
}

// What has become of place and speed there.
static inline void look_back(const Seen *seen, const ck_Contact *contact, const ck_Collider *collider, double elapsed,
                             const bool moves, double *x, double *v) {
    if (!moves) return;
    const ck_Motion *motion = motion_of(contact, collider);
    for (int axis = 0; axis < 3; axis++) {
        const double speed = motion->velocity[axis], gain = elapsed * motion->acceleration[axis];
        x[axis] = seen->x[axis] + motion->moved[axis] + elapsed * (speed + 0.5 * gain);
        v[axis] = seen->v[axis] + speed + gain;
    }
}

static void add_impulse(ck_Contact *contact, double mass, const double *before, const double *after) {
    ck_add_scaled(contact->impulse, mass, after);
    ck_add_scaled(contact->impulse, -mass, before);
}

// Reverses the speed into a surface that is touched: the impulse of an impact.
static void strike(const ck_Contact *contact, const ck_Collider *collider, const double *normal, double *v,
                   const double *a) {
    double speed = -ck_dot(v, normal), along[3];
    if (!(speed > 0)) return;
    bool rests = speed <= 2 * fabs(ck_dot(a, normal)) * contact->dt;
    double jump = (rests ? 1 : 1 + collider->restitution) * speed;
    ck_tangential(along, v, normal);
    double sliding = ck_length(along);
    ck_add_scaled(v, jump, normal);
    if (sliding > 0) ck_add_scaled(v, -fmin(1, collider->friction * jump / sliding), along);
}

// How hard a surface is pressed on, per mass: what bends the path inwards counts as not pressing. ≤ 0: not at all.
static double pressing(const ck_Collider *collider, const double *normal, const double *x, const double *v,
                       const double *a) {
    // planes and balls, which are most, have one part
    const double turn = collider->shape == CK_PLANE ? 0
                        : collider->shape == CK_SPHERE
                            ? ck_dot(v, v) / collider->radius
                            : ck_collider_turn(collider, ck_collider_part(collider, x, v), v);
    return -ck_dot(a, normal) - turn;
}

// m/s: what is slower than this lies still, but for the rounding of a collider's own speed.
static double still_speed(double friction, double dt) {
    return friction * dt * 1e-9;
}

// One collider's part of ck_contact_filter; false where it is not pressed on. Friction points against the way of half a
// substep: what has just begun to slide turns into its push much faster than that, and against its first direction it
// would be thrown to and fro. Against the push a slide keeps its direction until it stops.
static bool hold(const ck_Collider *collider, const double *normal, double dt, const double *x, const double *v,
                 double *a) {
    double press = pressing(collider, normal, x, v, a), along[3], drive[3];
    if (!(press > 0)) return false;
    ck_tangential(along, v, normal);
    ck_add_scaled(a, -ck_dot(a, normal), normal);
    memcpy(drive, a, sizeof drive);
    double sliding = ck_length(along), driving = ck_length(drive), friction = collider->friction * press;
    if (sliding > still_speed(friction, dt)) {
        if (ck_dot(along, drive) > 0) ck_add_scaled(along, 0.5 * dt, drive);
        ck_add_scaled(a, -friction / ck_length(along), along);
    } else if (driving > 0) {
        ck_add_scaled(a, -fmin(1, friction / driving), drive);
    }
    return true;
}

// The surfaces that hold a particle at once; of more than so many, the first.
#define MAX_NORMALS 8
typedef struct Hold {
    double normals[MAX_NORMALS][3];
    int count;
} Hold;

static void add_normal(Hold *hold, const double *normal) {
    if (hold->count < MAX_NORMALS) memcpy(hold->normals[hold->count++], normal, 3 * sizeof(double));
}

// What one surface turns away may run into another. What then still points into either is left along both, or nowhere.
static void squeeze(const Hold *hold, double *vector) {
    bool enters = false;
    for (int i = 0; i < hold->count; i++) enters |= ck_dot(vector, hold->normals[i]) < -1e-12 * ck_length(vector);
    if (!enters) return;
    const double *a = hold->normals[0], *b = hold->normals[1];
    double edge[3];
    ck_cross(edge, a, b);
    double along = hold->count == 2 ? ck_dot(vector, edge) : 0, squared = ck_dot(edge, edge);
    memset(vector, 0, 3 * sizeof(double));
    if (squared > 1e-12) ck_add_scaled(vector, along / squared, edge);
}

// The collider that carries the particle and the normal there; NULL where none does. left: the acceleration it leaves.
static inline __attribute__((always_inline)) const ck_Collider *support(const ck_Contact *contact, const double *x,
                                                                        const double *v, const double *a,
                                                                        double elapsed, const bool moves,
                                                                        double *normal, double *left) {
    const ck_Collider *carrier = NULL;
    Hold held = {.count = 0};
    memmove(left, a, 3 * sizeof(double));
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Collider *collider = &contact->model->colliders[i];
        Seen seen;
        see(&seen, contact, collider, x, v, left, elapsed, moves);
        double out[3];
        if (ck_collider_gap(collider, seen.x, out) > contact->slack) continue;
        // leaving, faster than rounding: that of the collider's own speed, too
        if (ck_dot(seen.v, out) > 1e-12 * (moves ? ck_length(seen.v) + ck_length(v) : ck_length(v))) continue;
        if (!hold(collider, out, contact->dt, seen.x, seen.v, moves ? seen.own[2] : left)) continue;
        if (moves) {
            memcpy(left, seen.a, 3 * sizeof(double));
            ck_add_scaled(left, 1, motion_of(contact, collider)->acceleration);
        }
        carrier = collider;
        memcpy(normal, out, sizeof out);
        add_normal(&held, out);
    }
    if (held.count > 1) squeeze(&held, left);
    return carrier;
}

void ck_contact_filter(const ck_Contact *contact, const double *x, const double *v, const double *a, double *left) {
    double normal[3];
    if (contact->motion)
        support(contact, x, v, a, contact->elapsed, true, normal, left);
    else
        support(contact, x, v, a, 0, false, normal, left);
}

static void fly(double *x, double *v, const double *a, double time) {
    ck_add_scaled(x, time, v);
    ck_add_scaled(x, 0.5 * time * time, a);
    ck_add_scaled(v, time, a);
}

// Puts a point onto a surface that it is as good as on.
static void place(const ck_Collider *collider, double *x, double *normal) {
    double gap = ck_collider_gap(collider, x, normal);
    ck_add_scaled(x, -gap, normal);
}

// How a slide goes on: friction takes all of a speed where it is stronger than what pushes along the surface, and else
// that along its own way, which the push turns.
typedef enum Ending { GOES_ON, STOPS, TURNS } Ending;

// When it stops or turns, s; INFINITY where it goes on. T = v·(q + f·cos θ)/(q² − f²) of a constant push f at an angle
// θ to v, by v' = f·cos θ − q and v·θ' = −f·sin θ: the way turns into the push while friction q slows it down.
//   push  [3] m/s², along the surface;  left  what friction leaves of it
static double stop_time(double friction, double dt, const double *v, const double *push, const double *left,
                        Ending *ending) {
    const double speed = ck_length(v), rate = ck_dot(v, left);
    *ending = GOES_ON;
    if (!(speed > still_speed(friction, dt))) return INFINITY;
    const double f = ck_length(push);
    *ending = friction > f ? STOPS : rate < 0 ? TURNS : GOES_ON;
    if (*ending == STOPS) return (speed * friction + ck_dot(v, push)) / ((friction - f) * (friction + f));
    return *ending == TURNS ? -speed * speed / rate : INFINITY;
}

// Takes the speed along a direction, which need not be of length 1.
static void stop_along(double *v, const double *way) {
    const double squared = ck_dot(way, way);
    if (squared > 0) ck_add_scaled(v, -ck_dot(v, way) / squared, way);
}

// What an acceleration, less friction, does on the way over a curved surface that begins by leading straight on by
// flat, m²/s²: the way turns by an angle whose tangent is flat's part across over the radius.
static double work_over(const ck_Collider *carrier, ck_Part part, const double *normal, const double *flat,
                        const double *a, double friction) {
    const double radius = carrier->radius;
    double across[3];
    ck_collider_across(carrier, part, flat, across);
    const double squared = ck_dot(across, across) / (radius * radius);
    const double cosine = 1 / sqrt(1 + squared), less = squared * cosine * cosine / (1 + cosine); // 1 − cosine
    const double length = ck_dot(flat, flat) - radius * radius * (squared - 2 * less);
    return ck_dot(a, flat) - less * (ck_dot(a, across) + radius * ck_dot(a, normal)) - friction * sqrt(fmax(0, length));
}

// True where a way is known from how it begins: on a ball, and where it is so short that nothing else is reached. From
// where it ends it is known to rounding, which of a creep of 1e-8 m/s would leave nothing.
static bool is_foreseen(const ck_Collider *carrier, const double *flat) {
    return carrier->shape == CK_SPHERE || ck_dot(flat, flat) < 1e-12 * carrier->radius * carrier->radius;
}

// Along a surface. On a ball the speed follows from the work done, which keeps its energy whatever the step.
static void slide(const ck_Collider *carrier, double *x, double *v, const double *a, const double *left, double time,
                  Ending ending) {
    double flat[3] = {0, 0, 0}, from[3], slid[3], normal[3], way[3], speed_squared = ck_dot(v, v);
    const ck_Part part = ck_collider_part(carrier, x, v);
    memcpy(from, x, sizeof from);
    memcpy(slid, v, sizeof slid);
    ck_collider_gap(carrier, x, normal);
    const double friction = carrier->friction * pressing(carrier, normal, x, v, a);
    ck_add_scaled(flat, time, v);
    ck_add_scaled(flat, 0.5 * time * time, left);
    ck_add_scaled(x, 1, flat);
    ck_add_scaled(v, time, left);
    if (ending == STOPS) memset(v, 0, 3 * sizeof(double));
    if (ending == TURNS) stop_along(v, slid);
    if (ck_collider_is_flat(carrier, part)) return;
    double worked = is_foreseen(carrier, flat) ? work_over(carrier, part, normal, flat, a, friction) : NAN;
    place(carrier, x, normal);
    ck_add_scaled(v, -ck_dot(v, normal), normal);
    if (ending != GOES_ON) return;
    ck_subtract(way, x, from);
    if (isnan(worked)) worked = ck_dot(a, way) - friction * ck_length(way);
    double speed = ck_length(v);
    double scale = speed > 0 ? sqrt(fmax(0, speed_squared + 2 * worked)) / speed : 0;
    for (int axis = 0; axis < 3; axis++) v[axis] *= scale;
}

// The first time after which c + v·t + a·t²/2 is above 0, from below it; INFINITY: never.
static double rise_time(double c, double v, double a) {
    const double root = v * v - 2 * a * c;
    if (root < 0) return INFINITY;
    const double time = v > 0 ? -2 * c / (v + sqrt(root)) : a > 0 ? (sqrt(root) - v) / a : INFINITY;
    return time > 0 ? time : INFINITY;
}

// When a slide leaves a face of a box, s, beyond which the surface turns away.
static double border_time(const ck_Collider *collider, const double *x, const double *v, const double *a) {
    if (collider->shape != CK_BOX) return INFINITY;
    const ck_Part part = ck_collider_part(collider, x, v);
    double first = INFINITY, from[3];
    ck_subtract(from, x, collider->point);
    for (int k = 0; k < 3; k++) {
        const double *axis = collider->axes[k], local = ck_dot(axis, from);
        if (part.beyond[k]) continue;
        for (int sign = -1; sign <= 1; sign += 2)
            first = fmin(first, rise_time(fmin(0, sign * local - collider->half[k]), sign * ck_dot(axis, v),
                                          sign * ck_dot(axis, a)));
    }
    return first;
}

static inline __attribute__((always_inline)) const ck_Collider *first_hit(const ck_Contact *contact, const double *x,
                                                                          const double *v, const double *a,
                                                                          double elapsed, const bool moves,
                                                                          double *time) {
    const ck_Collider *first = NULL;
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Collider *collider = &contact->model->colliders[i];
        Seen seen;
        see(&seen, contact, collider, x, v, a, elapsed, moves);
        double hit = ck_collider_hit(collider, seen.x, seen.v, seen.a, *time, contact->slack);
        if (hit <= *time) {
            *time = hit;
            first = collider;
        }
    }
    return first;
}

// Strikes every surface that is touched and moved into. Deeper than slack there is only what rounding and starts leave.
static inline __attribute__((always_inline)) void strike_touching(const ck_Contact *contact, double *x, double *v,
                                                                  const double *a, double elapsed, const bool moves) {
    Hold touched = {.count = 0};
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Collider *collider = &contact->model->colliders[i];
        Seen seen;
        see(&seen, contact, collider, x, v, a, elapsed, moves);
        double normal[3], gap = ck_collider_gap(collider, seen.x, normal);
        if (gap > contact->slack) continue;
        if (gap < 0) ck_add_scaled(seen.x, -gap, normal);
        strike(contact, collider, normal, seen.v, seen.a);
        look_back(&seen, contact, collider, elapsed, moves, x, v);
        add_normal(&touched, normal);
    }
    if (touched.count > 1) squeeze(&touched, v);
}

static inline __attribute__((always_inline)) void advance(ck_Contact *contact, double mass, double *x, double *v,
                                                          const double *a, const bool moves) {
    double left_time = contact->dt, free_flight[3];
    memcpy(free_flight, v, sizeof free_flight);
    ck_add_scaled(free_flight, contact->dt, a);
    if (moves && contact->from > 0) follow_from(contact, 0);
    for (int event = 0; left_time > 0 && event < MAX_EVENTS; event++) {
        double normal[3], left[3], time = left_time, elapsed = moves ? contact->dt - left_time : 0;
        if (moves && contact->until < contact->dt && elapsed >= contact->until * (1 - 1e-12))
            follow_from(contact, contact->until);
        if (moves && contact->until < contact->dt) time = contact->until - elapsed;
        strike_touching(contact, x, v, a, elapsed, moves);
        const ck_Collider *carrier = support(contact, x, v, a, elapsed, moves, normal, left);
        const ck_Collider *seer = carrier ? carrier : contact->model->colliders;
        Seen seen, rest;
        see(&seen, contact, seer, x, v, a, elapsed, moves);
        see(&rest, contact, seer, x, v, left, elapsed, moves);
        Ending ending = GOES_ON;
        double stop = INFINITY;
        if (carrier && carrier->friction > 0) {
            double push[3];
            ck_tangential(push, seen.a, normal);
            stop = stop_time(carrier->friction * pressing(carrier, normal, seen.x, seen.v, seen.a), contact->dt, seen.v,
                             push, rest.a, &ending);
        }
        const double border = carrier ? border_time(carrier, seen.x, seen.v, rest.a) : INFINITY;
        if (stop > fmin(time, border)) ending = GOES_ON;
        time = fmin(time, fmin(stop, border));
        const ck_Collider *hit = first_hit(contact, x, v, left, elapsed, moves, &time);
        if (carrier) {
            slide(carrier, seen.x, seen.v, seen.a, rest.a, time, hit ? GOES_ON : ending);
            look_back(&seen, contact, carrier, elapsed + time, moves, x, v);
        } else {
            fly(x, v, left, time);
        }
        if (hit) {
            see(&seen, contact, hit, x, v, a, elapsed + time, moves);
            place(hit, seen.x, normal);
            look_back(&seen, contact, hit, elapsed + time, moves, x, v);
        }
        left_time -= time;
    }
    add_impulse(contact, mass, free_flight, v);
}

// What lies still on one collider that stays and is held by friction goes nowhere in the substep: most of what has come
// to rest. Deeper than rounding it is not looked at here.
static bool rests(const ck_Contact *contact, const double *x, const double *v, const double *a) {
    const ck_Collider *carrier = NULL;
    double normal[3], out[3], pull = ck_dot(a, a);
    if (v[0] != 0 || v[1] != 0 || v[2] != 0) return false;
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Collider *collider = &contact->model->colliders[i];
        const double gap = ck_collider_gap(collider, x, out);
        if (gap > contact->slack && gap > 0.5 * contact->dt * contact->dt * sqrt(pull)) continue;
        if (carrier || gap > contact->slack || gap < -1e-3 * contact->slack) return false;
        carrier = collider;
        memcpy(normal, out, sizeof normal);
    }
    const double press = carrier ? -ck_dot(a, normal) : 0;
    return press > 0 && pull - press * press <= carrier->friction * carrier->friction * press * press;
}

void ck_contact_advance(ck_Contact *contact, double mass, double *x, double *v, const double *a) {
    if (contact->motion)
        advance(contact, mass, x, v, a, true);
    else if (rests(contact, x, v, a))
        ck_add_scaled(contact->impulse, -mass * contact->dt, a);
    else
        advance(contact, mass, x, v, a, false);
}

// True where the collider's speed jumps within the substep, and not its acceleration alone.
static bool jumps(const ck_Contact *contact, const ck_Collider *collider) {
    const double time = contact->begun + contact->until;
    double moved[3], before[3], after[3], none[3];
    if (!collider->path || contact->until >= contact->dt) return false;
    ck_path_at(collider->path, time, -1, moved, before, none);
    ck_path_at(collider->path, time, 1, moved, after, none);
    return ck_distance(before, after) > 1e-9 * (ck_length(before) + ck_length(after));
}

static inline __attribute__((always_inline)) bool impacts(const ck_Contact *contact, const double *x, const double *v,
                                                          const double *a, const bool moves) {
    double time = contact->dt, normal[3];
    const ck_Collider *hit = first_hit(contact, x, v, a, 0, moves, &time);
    if (!hit) {
        // one that touches already
        for (int i = 0; i < contact->model->collider_count; i++) {
            Seen seen;
            see(&seen, contact, &contact->model->colliders[i], x, v, a, 0, moves);
            double gap = ck_collider_gap(&contact->model->colliders[i], seen.x, normal);
            if (gap > contact->slack) continue;
            if (-ck_dot(seen.v, normal) > 2 * fabs(ck_dot(seen.a, normal)) * contact->dt) return true;
            if (moves && jumps(contact, &contact->model->colliders[i])) return true;
        }
        return false;
    }
    Seen seen;
    double at[3], speed[3];
    see(&seen, contact, hit, x, v, a, 0, moves);
    memcpy(at, seen.x, sizeof at);
    memcpy(speed, seen.v, sizeof speed);
    fly(at, speed, seen.a, time);
    ck_collider_gap(hit, at, normal);
    return -ck_dot(speed, normal) > 2 * fabs(ck_dot(seen.a, normal)) * contact->dt;
}

bool ck_contact_impacts(const ck_Contact *contact, const double *x, const double *v, const double *a) {
    return contact->motion ? impacts(contact, x, v, a, true) : impacts(contact, x, v, a, false);
}

// One round of ck_contact_project; false where nothing was inside.
static bool push_out(ck_Contact *contact, double mass, const double *start, double *x) {
    bool pushed = false;
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Collider *collider = &contact->model->colliders[i];
        const ck_Motion *motion = contact->motion ? motion_of(contact, collider) : NULL;
        double normal[3], along[3], way[3], before[3], seen[3] = {x[0], x[1], x[2]};
        if (motion) ck_add_scaled(seen, -1, motion->end);
        const double gap = ck_collider_gap(collider, seen, normal);
        if (!(gap < 0)) continue;
        pushed = true;
        memcpy(before, x, sizeof before);
        ck_add_scaled(x, -gap, normal);
        ck_subtract(way, x, start);
        if (motion) ck_add_scaled(way, -1, motion->way); // less the collider's own
        ck_tangential(along, way, normal);
        double sliding = ck_length(along);
        if (sliding > 0) ck_add_scaled(x, -fmin(1, collider->friction * -gap / sliding), along);
        ck_subtract(way, x, before);
        ck_add_scaled(contact->impulse, mass / contact->dt, way);
    }
    return pushed;
}

// Between several colliders, one pushes into another.
#define PUSH_ROUNDS 16

void ck_contact_project(ck_Contact *contact, double mass, const double *start, double *x) {
    int rounds = contact->model->collider_count > 1 ? PUSH_ROUNDS : 1;
    while (rounds-- && push_out(contact, mass, start, x))
        ;
}
