#include "contact.h"

#include "collider.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

// What can happen to one particle in one substep; wedged between colliders, it could go on for ever. The rest of its
// time is lost.
#define MAX_EVENTS 200

ck_Status ck_contact_create(ck_Contact **contact, const ck_Model *model, double dt, ck_Error *error) {
    *contact = NULL;
    if (!model->collider_count) return CK_OK;
    *contact = calloc(1, sizeof **contact);
    if (!*contact) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    **contact = (ck_Contact){.model = model, .dt = dt, .slack = 1e-9 * model->spacing};
    return CK_OK;
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
static const ck_Collider *support(const ck_Contact *contact, const double *x, const double *v, const double *a,
                                  double *normal, double *left) {
    const ck_Collider *carrier = NULL;
    Hold held = {.count = 0};
    memmove(left, a, 3 * sizeof(double));
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Collider *collider = &contact->model->colliders[i];
        double out[3];
        if (ck_collider_gap(collider, x, out) > contact->slack) continue;
        // leaving, faster than rounding
        if (ck_dot(v, out) > 1e-12 * ck_length(v)) continue;
        if (!hold(collider, out, contact->dt, v, left)) continue;
        carrier = collider;
        memcpy(normal, out, sizeof out);
        add_normal(&held, out);
    }
    if (held.count > 1) squeeze(&held, left);
    return carrier;
}

void ck_contact_filter(const ck_Contact *contact, const double *x, const double *v, const double *a, double *left) {
    double normal[3];
    support(contact, x, v, a, normal, left);
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

static const ck_Collider *first_hit(const ck_Contact *contact, const double *x, const double *v, const double *a,
                                    double *time) {
    const ck_Collider *first = NULL;
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Collider *collider = &contact->model->colliders[i];
        double hit = ck_collider_hit(collider, x, v, a, *time, contact->slack);
        if (hit <= *time) {
            *time = hit;
            first = collider;
        }
    }
    return first;
}

// Strikes every surface that is touched and moved into. Deeper than slack there is only what rounding and starts leave.
static void strike_touching(const ck_Contact *contact, double *x, double *v, const double *a) {
    Hold touched = {.count = 0};
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Collider *collider = &contact->model->colliders[i];
        double normal[3], gap = ck_collider_gap(collider, x, normal);
        if (gap > contact->slack) continue;
        if (gap < 0) ck_add_scaled(x, -gap, normal);
        strike(contact, collider, normal, v, a);
        add_normal(&touched, normal);
    }
    if (touched.count > 1) squeeze(&touched, v);
}

void ck_contact_advance(ck_Contact *contact, double mass, double *x, double *v, const double *a) {
    double left_time = contact->dt, free_flight[3];
    memcpy(free_flight, v, sizeof free_flight);
    ck_add_scaled(free_flight, contact->dt, a);
    for (int event = 0; left_time > 0 && event < MAX_EVENTS; event++) {
        double normal[3], left[3], time = left_time;
        strike_touching(contact, x, v, a);
        const ck_Collider *carrier = support(contact, x, v, a, normal, left);
        double stop = carrier && carrier->friction > 0 ? stop_time(v, left) : INFINITY;
        time = fmin(time, stop);
        const ck_Collider *hit = first_hit(contact, x, v, left, &time);
        if (carrier)
            slide(carrier, x, v, a, left, time, !hit && time == stop);
        else
            fly(x, v, left, time);
        if (hit) place(hit, x, normal);
        left_time -= time;
    }
    add_impulse(contact, mass, free_flight, v);
}

bool ck_contact_impacts(const ck_Contact *contact, const double *x, const double *v, const double *a) {
    double time = contact->dt, normal[3], at[3], speed[3];
    const ck_Collider *hit = first_hit(contact, x, v, a, &time);
    if (!hit) {
        // one that touches already
        for (int i = 0; i < contact->model->collider_count; i++) {
            double gap = ck_collider_gap(&contact->model->colliders[i], x, normal);
            if (gap <= contact->slack && -ck_dot(v, normal) > 2 * fabs(ck_dot(a, normal)) * contact->dt) return true;
        }
        return false;
    }
    memcpy(at, x, sizeof at);
    memcpy(speed, v, sizeof speed);
    fly(at, speed, a, time);
    ck_collider_gap(hit, at, normal);
    return -ck_dot(speed, normal) > 2 * fabs(ck_dot(a, normal)) * contact->dt;
}

// One round of ck_contact_project; false where nothing was inside.
static bool push_out(ck_Contact *contact, double mass, const double *start, double *x) {
    bool pushed = false;
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Collider *collider = &contact->model->colliders[i];
        double normal[3], along[3], way[3], before[3], gap = ck_collider_gap(collider, x, normal);
        if (!(gap < 0)) continue;
        pushed = true;
        memcpy(before, x, sizeof before);
        ck_add_scaled(x, -gap, normal);
        ck_subtract(way, x, start);
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
