#include "contact.h"

#include "collider.h"
#include "loops.h"
#include "path.h"
#include "slide.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

// What can happen to one particle in one substep; wedged between colliders, it could go on for ever. The rest of its
// time is lost.
#define MAX_EVENTS 200

ck_Status ck_contact_create(ck_Contact **contact, const ck_Model *model, double dt, ck_Error *error) {
    *contact = NULL;
    if (!model->collider_count) return CK_OK;
    // sizes and motion stand behind it, so that they are freed with it
    const bool moves = model->terms & CK_TERM_MOVING_COLLIDERS;
    *contact = calloc(1, sizeof **contact + (sizeof(double) + sizeof(ck_Motion)) * (size_t)model->collider_count);
    if (!*contact) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    **contact =
        (ck_Contact){.model = model, .dt = dt, .slack = 1e-9 * model->spacing, .sizes = (double *)(*contact + 1)};
    for (int i = 0; i < model->collider_count; i++)
        if (model->colliders[i].shape != CK_PLANE)
            (*contact)->sizes[i] = model->colliders[i].radius + ck_length(model->colliders[i].half);
    if (moves) (*contact)->motion = (ck_Motion *)((*contact)->sizes + model->collider_count);
    if (moves) ck_contact_follow(*contact, 0);
    return CK_OK;
}

// True where all colliders are farther from x than so many m, and this is told without a root; never where they move.
static inline bool is_far(const ck_Contact *contact, const double *x, double reach) {
    if (contact->motion) return false;
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Collider *collider = &contact->model->colliders[i];
        const double most = (reach + contact->sizes[i]) * (1 + 1e-9) + contact->slack;
        double from[3];
        ck_subtract(from, x, collider->point);
        const bool is_beyond =
            collider->shape == CK_PLANE ? ck_dot(from, collider->normal) > most : ck_dot(from, from) > most * most;
        if (!is_beyond) return false;
    }
    return true;
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
        if (!ck_slide_hold(collider, out, contact->dt, seen.x, seen.v, moves ? seen.own[2] : left)) continue;
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

// What carries is not hit: a way along it that rounding leads 1e-17 m/s out would fall back at once, and begin anew.
//   carrier  NULL: nothing does
static inline __attribute__((always_inline)) const ck_Collider *first_hit(const ck_Contact *contact, const double *x,
                                                                          const double *v, const double *a,
                                                                          double elapsed, const bool moves,
                                                                          double *time, const ck_Collider *carrier) {
    const ck_Collider *first = NULL;
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Collider *collider = &contact->model->colliders[i];
        if (collider == carrier) continue;
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
        ck_Ending ending = CK_GOES_ON;
        double stop = INFINITY;
        if (carrier && carrier->friction > 0) {
            double push[3];
            ck_tangential(push, seen.a, normal);
            stop = ck_slide_stop_time(carrier->friction * ck_slide_press(carrier, normal, seen.x, seen.v, seen.a),
                                      contact->dt, seen.v, push, rest.a, &ending);
        }
        const double border = carrier ? ck_slide_border_time(carrier, seen.x, seen.v, rest.a) : INFINITY;
        if (stop > fmin(time, border)) ending = CK_GOES_ON;
        time = fmin(time, fmin(stop, border));
        const ck_Collider *hit = first_hit(contact, x, v, left, elapsed, moves, &time, carrier);
        if (carrier) {
            ck_slide(carrier, seen.x, seen.v, seen.a, rest.a, time, hit ? CK_GOES_ON : ending);
            look_back(&seen, contact, carrier, elapsed + time, moves, x, v);
        } else {
            fly(x, v, left, time);
        }
        if (hit) {
            see(&seen, contact, hit, x, v, a, elapsed + time, moves);
            ck_slide_place(hit, seen.x, normal);
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
    const ck_Collider *hit = first_hit(contact, x, v, a, 0, moves, &time, NULL);
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

static bool hits(const ck_Contact *contact, const double *x, const double *v, const double *a) {
    double way = 0;
    for (int axis = 0; axis < 3; axis++) way += contact->dt * (fabs(v[axis]) + 0.5 * contact->dt * fabs(a[axis]));
    if (is_far(contact, x, way)) return false;
    return contact->motion ? impacts(contact, x, v, a, true) : impacts(contact, x, v, a, false);
}

bool ck_contact_meet(ck_Contact *contact, double mass, const double *field, double *x, double *v) {
    // the mean velocity stands in the middle of the substep: half of it earlier is the start
    double speed[3] = {v[0], v[1], v[2]};
    ck_add_scaled(speed, -0.5 * contact->dt, field);
    // the one before may have gone on beyond a jump of a collider's speed
    if (contact->motion && contact->from > 0) follow_from(contact, 0);
    if (!hits(contact, x, speed, field)) return false;
    ck_contact_advance(contact, mass, x, speed, field);
    // and the next one's mean velocity is this one's end velocity and half a substep more
    memcpy(v, speed, sizeof speed);
    ck_add_scaled(v, -0.5 * contact->dt, field);
    return true;
}

// Takes of a way along a surface what friction holds. Along where it is now: what was held before, elsewhere on a ball,
// does not lead into it.
static void hold(ck_Pressed *pressed, double friction, const double *along, const double *normal, double *x) {
    double total[3], change[3], sliding[3];
    ck_subtract(total, pressed->held, along);
    const double wanted = ck_length(total), most = friction * pressed->depth;
    for (int axis = 0; axis < 3; axis++)
        change[axis] = total[axis] * (wanted > most ? most / wanted : 1) - pressed->held[axis];
    ck_tangential(sliding, change, normal);
    ck_add_scaled(x, 1, sliding);
    ck_add_scaled(pressed->held, 1, sliding);
}

// One round of ck_contact_project; false where nothing was inside, but for rounding.
static bool push_out(ck_Contact *contact, double mass, const double *start, ck_Pressed *pressed, double *x) {
    bool pushed = false;
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Collider *collider = &contact->model->colliders[i];
        const ck_Motion *motion = contact->motion ? motion_of(contact, collider) : NULL;
        double normal[3], along[3], way[3], before[3], seen[3] = {x[0], x[1], x[2]};
        if (motion) ck_add_scaled(seen, -1, motion->end);
        const double gap = ck_collider_gap(collider, seen, normal);
        // what was pushed out by as much may still be held where it was lifted a little
        if (!(gap < pressed->depth)) continue;
        memcpy(before, x, sizeof before);
        if (gap < 0) {
            // by rounding alone, nothing is pushed into another
            pushed |= gap < -1e-3 * contact->slack;
            pressed->depth -= gap;
            ck_add_scaled(x, -gap, normal);
        }
        ck_subtract(way, x, start);
        if (motion) ck_add_scaled(way, -1, motion->way); // less the collider's own
        ck_tangential(along, way, normal);
        hold(pressed, collider->friction, along, normal, x);
        ck_subtract(way, x, before);
        ck_add_scaled(contact->impulse, mass / contact->dt, way);
    }
    return pushed;
}

void ck_contact_project(ck_Contact *contact, double mass, const double *start, ck_Pressed *pressed, double *x) {
    int rounds = contact->model->collider_count > 1 ? CK_PUSH_ROUNDS : 1;
    if (is_far(contact, x, pressed->depth)) return;
    while (rounds-- && push_out(contact, mass, start, pressed, x))
        ;
}
