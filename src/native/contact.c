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

void ck_contact_follow(ck_Contact *contact, double time) {
    contact->elapsed = 0;
    for (int i = 0; i < contact->model->collider_count && contact->motion; i++) {
        const ck_Path *path = contact->model->colliders[i].path;
        ck_Motion *motion = &contact->motion[i];
        double end[3], none[3], other[3];
        memset(motion, 0, sizeof *motion);
        if (!path) continue;
        ck_path_at(path, time, -1, motion->moved, none, other);
        ck_path_at(path, time + contact->dt, -1, end, none, other);
        ck_subtract(motion->velocity, end, motion->moved);
        for (int axis = 0; axis < 3; axis++) motion->velocity[axis] /= contact->dt;
    }
}

// A place and a speed as a collider sees them: where all stay, those of the caller, and else own.
typedef struct Seen {
    double *x, *v;
    double own[2][3];
} Seen;

// After so much of the substep, s.
//   moves  a constant of the caller: false costs nothing
static inline void see(Seen *seen, const ck_Contact *contact, const ck_Collider *collider, const double *x,
                       const double *v, double elapsed, const bool moves) {
    // who only looks may be const
    seen->x = moves ? seen->own[0] : (double *)x;
    seen->v = moves ? seen->own[1] : (double *)v;
    if (!moves) return;
    const ck_Motion *motion = &contact->motion[collider - contact->model->colliders];
    memcpy(seen->x, x, 3 * sizeof(double));
    memcpy(seen->v, v, 3 * sizeof(double));
    ck_add_scaled(seen->x, -1, motion->moved);
    ck_add_scaled(seen->x, -elapsed, motion->velocity);
    ck_add_scaled(seen->v, -1, motion->velocity);
}

// What has become of them there.
static inline void look_back(const Seen *seen, const ck_Contact *contact, const ck_Collider *collider, double elapsed,
                             const bool moves, double *x, double *v) {
    if (!moves) return;
    const ck_Motion *motion = &contact->motion[collider - contact->model->colliders];
    memcpy(x, seen->x, 3 * sizeof(double));
    memcpy(v, seen->v, 3 * sizeof(double));
    ck_add_scaled(x, 1, motion->moved);
    ck_add_scaled(x, elapsed, motion->velocity);
    ck_add_scaled(v, 1, motion->velocity);
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
static double pressing(const ck_Collider *collider, const double *normal, const double *v, const double *a) {
    double turn = collider->shape == CK_SPHERE ? ck_dot(v, v) / collider->radius : 0;
    return -ck_dot(a, normal) - turn;
}

// One collider's part of ck_contact_filter; false where it is not pressed on.
static bool hold(const ck_Collider *collider, const double *normal, double dt, const double *v, double *a) {
    double press = pressing(collider, normal, v, a), along[3], drive[3];
    if (!(press > 0)) return false;
    ck_tangential(along, v, normal);
    ck_add_scaled(a, -ck_dot(a, normal), normal);
    memcpy(drive, a, sizeof drive);
    double sliding = ck_length(along), driving = ck_length(drive), friction = collider->friction * press;
    if (sliding > friction * dt * 1e-9)
        ck_add_scaled(a, -friction / sliding, along);
    else if (driving > 0)
        ck_add_scaled(a, -fmin(1, friction / driving), drive);
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
        see(&seen, contact, collider, x, v, elapsed, moves);
        double out[3];
        if (ck_collider_gap(collider, seen.x, out) > contact->slack) continue;
        // leaving, faster than rounding
        if (ck_dot(seen.v, out) > 1e-12 * ck_length(seen.v)) continue;
        if (!hold(collider, out, contact->dt, seen.v, left)) continue;
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

// The time after which friction has taken the speed along its direction.
static double stop_time(const double *v, const double *a) {
    double speed_squared = ck_dot(v, v), rate = ck_dot(v, a);
    return rate < 0 ? -speed_squared / rate : INFINITY;
}

// Along a surface. On a ball the speed follows from the work done, which keeps its energy whatever the step.
static void slide(const ck_Collider *carrier, double *x, double *v, const double *a, const double *left, double time,
                  bool stops) {
    double from[3], way[3], normal[3], speed_squared = ck_dot(v, v), press;
    memcpy(from, x, sizeof from);
    ck_collider_gap(carrier, x, normal);
    press = pressing(carrier, normal, v, a);
    fly(x, v, left, time);
    if (carrier->shape == CK_PLANE) {
        if (stops) memset(v, 0, 3 * sizeof(double));
        return;
    }
    place(carrier, x, normal);
    ck_add_scaled(v, -ck_dot(v, normal), normal);
    ck_subtract(way, x, from);
    speed_squared += 2 * ck_dot(a, way) - 2 * carrier->friction * press * ck_length(way);
    double speed = ck_length(v);
    double scale = stops || !(speed > 0) ? 0 : sqrt(fmax(0, speed_squared)) / speed;
    for (int axis = 0; axis < 3; axis++) v[axis] *= scale;
}

static inline __attribute__((always_inline)) const ck_Collider *first_hit(const ck_Contact *contact, const double *x,
                                                                          const double *v, const double *a,
                                                                          double elapsed, const bool moves,
                                                                          double *time) {
    const ck_Collider *first = NULL;
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Collider *collider = &contact->model->colliders[i];
        Seen seen;
        see(&seen, contact, collider, x, v, elapsed, moves);
        double hit = ck_collider_hit(collider, seen.x, seen.v, a, *time, contact->slack);
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
        see(&seen, contact, collider, x, v, elapsed, moves);
        double normal[3], gap = ck_collider_gap(collider, seen.x, normal);
        if (gap > contact->slack) continue;
        if (gap < 0) ck_add_scaled(seen.x, -gap, normal);
        strike(contact, collider, normal, seen.v, a);
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
    for (int event = 0; left_time > 0 && event < MAX_EVENTS; event++) {
        double normal[3], left[3], time = left_time, elapsed = moves ? contact->dt - left_time : 0;
        strike_touching(contact, x, v, a, elapsed, moves);
        const ck_Collider *carrier = support(contact, x, v, a, elapsed, moves, normal, left);
        Seen seen;
        see(&seen, contact, carrier ? carrier : contact->model->colliders, x, v, elapsed, moves);
        double stop = carrier && carrier->friction > 0 ? stop_time(seen.v, left) : INFINITY;
        time = fmin(time, stop);
        const ck_Collider *hit = first_hit(contact, x, v, left, elapsed, moves, &time);
        if (carrier) {
            slide(carrier, seen.x, seen.v, a, left, time, !hit && time == stop);
            look_back(&seen, contact, carrier, elapsed + time, moves, x, v);
        } else {
            fly(x, v, left, time);
        }
        if (hit) {
            see(&seen, contact, hit, x, v, elapsed + time, moves);
            place(hit, seen.x, normal);
            look_back(&seen, contact, hit, elapsed + time, moves, x, v);
        }
        left_time -= time;
    }
    add_impulse(contact, mass, free_flight, v);
}

void ck_contact_advance(ck_Contact *contact, double mass, double *x, double *v, const double *a) {
    if (contact->motion)
        advance(contact, mass, x, v, a, true);
    else
        advance(contact, mass, x, v, a, false);
}

static inline __attribute__((always_inline)) bool impacts(const ck_Contact *contact, const double *x, const double *v,
                                                          const double *a, const bool moves) {
    double time = contact->dt, normal[3];
    const ck_Collider *hit = first_hit(contact, x, v, a, 0, moves, &time);
    if (!hit) {
        // one that touches already
        for (int i = 0; i < contact->model->collider_count; i++) {
            Seen seen;
            see(&seen, contact, &contact->model->colliders[i], x, v, 0, moves);
            double gap = ck_collider_gap(&contact->model->colliders[i], seen.x, normal);
            if (gap <= contact->slack && -ck_dot(seen.v, normal) > 2 * fabs(ck_dot(a, normal)) * contact->dt)
                return true;
        }
        return false;
    }
    Seen seen;
    double at[3], speed[3];
    see(&seen, contact, hit, x, v, 0, moves);
    memcpy(at, seen.x, sizeof at);
    memcpy(speed, seen.v, sizeof speed);
    fly(at, speed, a, time);
    ck_collider_gap(hit, at, normal);
    return -ck_dot(speed, normal) > 2 * fabs(ck_dot(a, normal)) * contact->dt;
}

bool ck_contact_impacts(const ck_Contact *contact, const double *x, const double *v, const double *a) {
    return contact->motion ? impacts(contact, x, v, a, true) : impacts(contact, x, v, a, false);
}

// One round of ck_contact_project; false where nothing was inside.
static bool push_out(ck_Contact *contact, double mass, const double *start, double *x) {
    bool pushed = false;
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Collider *collider = &contact->model->colliders[i];
        const double none[3] = {0};
        Seen seen;
        see(&seen, contact, collider, x, none, contact->dt, contact->motion != NULL);
        double normal[3], along[3], way[3], before[3], gap = ck_collider_gap(collider, seen.x, normal);
        if (!(gap < 0)) continue;
        pushed = true;
        memcpy(before, x, sizeof before);
        ck_add_scaled(x, -gap, normal);
        ck_subtract(way, x, start);
        if (contact->motion) ck_add_scaled(way, contact->dt, seen.v); // less the collider's own
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
