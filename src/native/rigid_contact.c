#include "rigid_contact.h"

#include "collider.h"
#include "native.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

// Rounds of impacts in a substep, each over all touches, and of sweeps; and the speed that counts as none, of the
// fastest approach.
#define IMPACT_ROUNDS 50
#define SWEEPS 200
#define STILL 1e-13

ck_Status ck_rigid_contact_create(ck_RigidContact **out, const ck_Model *model, double dt, ck_Error *error) {
    const size_t bodies = (size_t)model->rigid_count, colliders = (size_t)model->collider_count + 1,
                 most = ck_rigid_most_touches(model);
    *out = NULL;
    if (!bodies) return CK_OK;
    ck_RigidContact *contact = calloc(1, sizeof *contact);
    if (!contact) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    *contact = (ck_RigidContact){
        .model = model,
        .slack = 1e-9 * model->spacing,
        .rotation = calloc(bodies, sizeof *contact->rotation),
        .momentum = calloc(bodies, sizeof *contact->momentum),
        .twist = calloc(bodies, sizeof *contact->twist),
        .gained = calloc(bodies, sizeof *contact->gained),
        .bodies = calloc(bodies, sizeof *contact->bodies),
        .colliders = calloc(colliders, sizeof *contact->colliders),
        .speed = calloc(colliders, sizeof *contact->speed),
        .touches = calloc(most, sizeof *contact->touches),
        .given = calloc(most, sizeof *contact->given),
        .drift = calloc(3 * (size_t)model->particle_count, sizeof *contact->drift),
        .now = calloc(3 * (size_t)model->particle_count, sizeof *contact->now),
        .held = calloc(3 * (size_t)model->particle_count, sizeof *contact->held),
    };
    if (!contact->rotation || !contact->momentum || !contact->bodies || !contact->colliders || !contact->speed ||
        !contact->touches || !contact->given || !contact->drift || !contact->now || !contact->held || !contact->twist ||
        !contact->gained) {
        ck_rigid_contact_destroy(contact);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    ck_rigid_contact_pace(contact, dt);
    for (int i = 0; i < model->rigid_count; i++) {
        contact->rotation[i][0] = 1;
        ck_rigid_momentum(contact->momentum[i], &model->rigid[i], &model->rigid[i].shape, model->rigid[i].spin);
        contact->bodies[i] = model->rigid[i].shape;
    }
    *out = contact;
    return CK_OK;
}

void ck_rigid_contact_pace(ck_RigidContact *contact, double dt) {
    double field[3];
    ck_model_mean_field(contact->model, field);
    contact->dt = dt;
    contact->rest = 2 * ck_length(field) * dt;
}

void ck_rigid_contact_destroy(ck_RigidContact *contact) {
    if (!contact) return;
    free(contact->rotation);
    free(contact->momentum);
    free(contact->bodies);
    free(contact->colliders);
    free(contact->speed);
    free(contact->touches);
    free(contact->given);
    free(contact->drift);
    free(contact->now);
    free(contact->held);
    free(contact->twist);
    free(contact->gained);
    free(contact);
}

void ck_rigid_contact_turns(const ck_RigidContact *contact, ck_Turn *turn) {
    for (int i = 0; i < contact->model->rigid_count; i++) {
        double momentum[3] = {contact->gained[i][0], contact->gained[i][1], contact->gained[i][2]};
        memcpy(turn[i].rotation, contact->rotation[i], sizeof turn[i].rotation);
        ck_add_scaled(momentum, 1, contact->momentum[i]);
        const ck_Collider now = ck_rigid_place(&contact->model->rigid[i], contact->bodies[i].point, turn[i].rotation);
        ck_rigid_spin(turn[i].spin, &contact->model->rigid[i], &now, momentum);
    }
}

// Where all is at the start of the substep.
static void place(ck_RigidContact *contact, const double *position, double time) {
    const ck_Model *model = contact->model;
    double gain[3];
    for (int i = 0; i < model->rigid_count; i++)
        contact->bodies[i] =
            ck_rigid_place(&model->rigid[i], position + 3 * model->rigid[i].particle, contact->rotation[i]);
    for (int i = 0; i < model->collider_count; i++)
        contact->colliders[i] = ck_collider_at(&model->colliders[i], time, 1, contact->speed[i], gain);
}

// m: farther apart than this, nothing meets in the substep.
static double reach_of(const ck_RigidContact *contact) {
    const ck_Model *model = contact->model;
    double fastest = 0, turning = 0, spin[3];
    for (int i = 0; i < model->particle_count; i++) fastest = fmax(fastest, ck_length(contact->drift + 3 * i));
    for (int i = 0; i < model->collider_count; i++) fastest = fmax(fastest, ck_length(contact->speed[i]));
    for (int i = 0; i < model->rigid_count; i++) {
        const ck_Collider *body = &contact->bodies[i];
        ck_rigid_spin(spin, &model->rigid[i], body, contact->momentum[i]);
        turning = fmax(turning, ck_length(spin) * (body->radius + ck_length(body->half)));
    }
    return contact->slack + 2 * contact->dt * (fastest + turning);
}

// One of the two at a touch: a particle, which is a body's centre where rigid ≥ 0; a collider has none.
typedef struct Side {
    int particle, rigid;
} Side;

static Side side_of(const ck_RigidContact *contact, const ck_Touch *touch, bool other) {
    if (!other) return (Side){touch->particle, touch->rigid};
    return (Side){touch->other < 0 ? -1 : contact->model->rigid[touch->other].particle, touch->other};
}

static void add_speed(const ck_RigidContact *contact, const ck_Touch *touch, Side side, const double *velocity,
                      double sign, double *speed) {
    double spin[3], arm[3], turning[3];
    if (side.particle < 0) {
        ck_add_scaled(speed, sign, contact->speed[touch->collider]);
        return;
    }
    ck_add_scaled(speed, sign, velocity + 3 * side.particle);
    if (side.rigid < 0) return;
    ck_rigid_spin(spin, &contact->model->rigid[side.rigid], &contact->bodies[side.rigid],
                  contact->momentum[side.rigid]);
    ck_subtract(arm, touch->point, contact->bodies[side.rigid].point);
    ck_cross(turning, spin, arm);
    ck_add_scaled(speed, sign, turning);
}

// Of a at the touch, as b sees it.
static void relative_speed(const ck_RigidContact *contact, const ck_Touch *touch, const double *velocity,
                           double *speed) {
    memset(speed, 0, 3 * sizeof *speed);
    add_speed(contact, touch, side_of(contact, touch, false), velocity, 1, speed);
    add_speed(contact, touch, side_of(contact, touch, true), velocity, -1, speed);
}

// 1/kg: what a unit impulse along a direction makes of the speed along it.
static double lightness(const ck_RigidContact *contact, const ck_Native *native, const ck_Touch *touch,
                        const double *along) {
    double sum = 0;
    for (int k = 0; k < 2; k++) {
        const Side side = side_of(contact, touch, k);
        double arm[3], turn[3], spin[3];
        if (side.particle < 0) continue;
        sum += native->inverse_mass[side.particle];
        if (side.rigid < 0) continue;
        ck_subtract(arm, touch->point, contact->bodies[side.rigid].point);
        ck_cross(turn, arm, along);
        ck_rigid_spin(spin, &contact->model->rigid[side.rigid], &contact->bodies[side.rigid], turn);
        sum += ck_dot(turn, spin);
    }
    return sum;
}

// What a substep's impulses act on.
typedef struct Meeting {
    ck_RigidContact *contact;
    ck_Native *native;
} Meeting;

// Gives a an impulse, N·s, and b its opposite.
static void give(const Meeting *meeting, const ck_Touch *touch, const double *impulse) {
    ck_RigidContact *contact = meeting->contact;
    for (int k = 0; k < 2; k++) {
        const Side side = side_of(contact, touch, k);
        const double sign = k ? -1 : 1;
        double arm[3], turn[3];
        if (side.particle < 0) {
            ck_add_scaled(meeting->native->contact->impulse, 1, impulse);
            continue;
        }
        const double light = sign * meeting->native->inverse_mass[side.particle];
        double *const speeds[3] = {contact->drift, contact->now, meeting->native->velocity};
        for (int s = 0; s < 3; s++) ck_add_scaled(speeds[s] + 3 * side.particle, light, impulse);
        if (side.rigid < 0) continue;
        ck_subtract(arm, touch->point, contact->bodies[side.rigid].point);
        ck_cross(turn, arm, impulse);
        ck_add_scaled(contact->momentum[side.rigid], sign, turn);
    }
}

// Friction takes the speed along the surface, as far as the push allows.
static double rub(const Meeting *meeting, const ck_Touch *touch, const double *velocity, ck_Given *given) {
    double speed[3], along[3], direction[3], wanted[3];
    if (!(touch->friction > 0)) return 0;
    relative_speed(meeting->contact, touch, velocity, speed);
    ck_tangential(along, speed, touch->normal);
    const double sliding = ck_length(along);
    if (!(sliding > 0)) return 0;
    for (int axis = 0; axis < 3; axis++) direction[axis] = along[axis] / sliding;
    const double weight = lightness(meeting->contact, meeting->native, touch, direction);
    if (!(weight > 0)) return 0;
    memcpy(wanted, given->drag, sizeof wanted);
    ck_add_scaled(wanted, -sliding / weight, direction);
    const double most = touch->friction * given->push, length = ck_length(wanted);
    for (int axis = 0; axis < 3 && length > most; axis++) wanted[axis] *= most / length;
    ck_subtract(along, wanted, given->drag);
    memcpy(given->drag, wanted, sizeof wanted);
    give(meeting, touch, along);
    return weight * ck_length(along);
}

// How fast a approaches b at a touch, m/s.
static double approach_of(const ck_RigidContact *contact, const ck_Touch *touch, const double *velocity) {
    double speed[3];
    relative_speed(contact, touch, velocity, speed);
    return -ck_dot(speed, touch->normal);
}

static void push(const Meeting *meeting, const ck_Touch *touch, ck_Given *given, double amount) {
    const double impulse[3] = {amount * touch->normal[0], amount * touch->normal[1], amount * touch->normal[2]};
    given->push += amount;
    give(meeting, touch, impulse);
}

// Impacts with restitution, one pair after the other, until none is left that is faster than rest.
static void strike_all(const Meeting *meeting) {
    const ck_RigidContact *contact = meeting->contact;
    bool any = true;
    for (int round = 0; round < IMPACT_ROUNDS && any; round++) {
        any = false;
        for (int i = 0; i < contact->count; i++) {
            const ck_Touch *touch = &contact->touches[i];
            if (!(touch->restitution > 0)) continue;
            const double approach = approach_of(contact, touch, contact->now),
                         weight = lightness(contact, meeting->native, touch, touch->normal);
            if (!(approach > fmax(contact->rest, 0)) || !(weight > 0) ||
                !(touch->gap < contact->dt * approach_of(contact, touch, contact->drift)))
                continue;
            ck_Given now = {0, {0, 0, 0}};
            push(meeting, touch, &now, (1 + touch->restitution) * approach / weight);
            rub(meeting, touch, contact->now, &now);
            any = true;
        }
    }
}

// The speed that is to be ended at a touch, m/s.
//   is_drift  what would be inside after the drift is, and what is inside already brought to the surface; else what
//             approaches while it touches
static double excess_of(const ck_RigidContact *contact, const ck_Touch *touch, bool is_drift) {
    const double approach = approach_of(contact, touch, contact->drift);
    if (is_drift) return approach - touch->gap / contact->dt;
    return touch->restitution > 0 && approach > contact->rest ? 0 : approach;
}

// Projected Gauss–Seidel, whose pushes may be taken back but do not pull.
static void hold_all(const Meeting *meeting, bool is_drift) {
    ck_RigidContact *contact = meeting->contact;
    double first = 0;
    memset(contact->given, 0, sizeof *contact->given * (size_t)contact->count);
    for (int round = 0; round < SWEEPS; round++) {
        double change = 0;
        for (int i = 0; i < contact->count; i++) {
            const ck_Touch *touch = &contact->touches[i];
            ck_Given *given = &contact->given[i];
            const double excess = excess_of(contact, touch, is_drift);
            if (!(excess > 0) && !(given->push > 0)) continue;
            const double weight = lightness(contact, meeting->native, touch, touch->normal);
            if (!(weight > 0)) continue;
            const double amount = fmax(-given->push, excess / weight);
            push(meeting, touch, given, amount);
            change = fmax(change, fmax(weight * fabs(amount), rub(meeting, touch, contact->drift, given)));
        }
        first = fmax(first, change);
        if (change <= STILL * first) break;
    }
}

void ck_rigid_contact_meet(ck_RigidContact *contact, ck_Native *native, double time) {
    const Meeting meeting = {contact, native};
    for (int i = 0; i < contact->model->rigid_count; i++) ck_add_scaled(contact->momentum[i], 1, contact->gained[i]);
    memset(contact->gained, 0, sizeof *contact->gained * (size_t)contact->model->rigid_count);
    memset(contact->twist, 0, sizeof *contact->twist * (size_t)contact->model->rigid_count);
    place(contact, native->position, time);
    contact->count = ck_rigid_find_touches(contact->model, native->position, contact->bodies, contact->colliders,
                                           reach_of(contact), contact->touches);
    if (contact->count) strike_all(&meeting);
    memcpy(contact->held, contact->now, 3 * sizeof(double) * (size_t)contact->model->particle_count);
    if (contact->count) hold_all(&meeting, true);
    for (int i = 0; i < 3 * contact->model->particle_count; i++) contact->held[i] = contact->now[i] - contact->held[i];
    for (int i = 0; i < contact->model->rigid_count; i++)
        ck_rigid_turn(contact->rotation[i], &contact->model->rigid[i], contact->momentum[i], contact->dt);
}

void ck_rigid_contact_settle(ck_RigidContact *contact, ck_Native *native, double time) {
    const Meeting meeting = {contact, native};
    const size_t bytes = 3 * sizeof(double) * (size_t)contact->model->particle_count;
    place(contact, native->position, time);
    contact->count = ck_rigid_find_touches(contact->model, native->position, contact->bodies, contact->colliders,
                                           contact->slack, contact->touches);
    memcpy(contact->drift, native->velocity, bytes);
    if (contact->count) hold_all(&meeting, false);
}

// m: how far the place of a touch has come on one side since the start of the substep, added to way.
static void add_way(const ck_RigidContact *contact, const ck_Native *native, const ck_Touch *touch, Side side,
                    double sign, double *way) {
    double moved[3], speed[3] = {0, 0, 0}, arm[3], turned[3];
    if (side.particle < 0) {
        ck_add_scaled(way, sign * contact->dt, contact->speed[touch->collider]);
        return;
    }
    ck_subtract(moved, native->position + 3 * side.particle, native->start + 3 * side.particle);
    ck_add_scaled(way, sign, moved);
    if (side.rigid < 0) return;
    // how it turns was decided by its spin at the start, and is changed by twists
    add_speed(contact, touch, side, contact->drift, 1, speed);
    ck_add_scaled(speed, -1, contact->drift + 3 * side.particle);
    ck_add_scaled(way, sign * contact->dt, speed);
    ck_subtract(arm, touch->point, contact->bodies[side.rigid].point);
    ck_cross(turned, contact->twist[side.rigid], arm);
    ck_add_scaled(way, sign, turned);
}

// Moves a by an impulse times the substep, kg·m, at the place of a touch, and b by its opposite; bodies turn, too.
static void shift(ck_RigidContact *contact, ck_Native *native, const ck_Touch *touch, const double *amount) {
    for (int k = 0; k < 2; k++) {
        const Side side = side_of(contact, touch, k);
        const double sign = k ? -1 : 1;
        double arm[3], turn[3] = {0, 0, 0}, twist[3], across[3];
        if (side.particle < 0) continue;
        ck_add_scaled(native->position + 3 * side.particle, sign * native->inverse_mass[side.particle], amount);
        if (side.rigid < 0) continue;
        const ck_RigidBody *rigid = &contact->model->rigid[side.rigid];
        ck_subtract(arm, touch->point, contact->bodies[side.rigid].point);
        ck_cross(across, arm, amount);
        ck_add_scaled(turn, sign, across);
        ck_rigid_spin(twist, rigid, &contact->bodies[side.rigid], turn);
        ck_add_scaled(contact->twist[side.rigid], 1, twist);
        ck_add_scaled(contact->gained[side.rigid], 1 / contact->dt, turn);
        ck_rigid_turn(contact->rotation[side.rigid], rigid, turn, 1);
    }
}

static void way_at(const ck_RigidContact *contact, const ck_Native *native, const ck_Touch *touch, double *way) {
    memset(way, 0, 3 * sizeof *way);
    add_way(contact, native, touch, side_of(contact, touch, false), 1, way);
    add_way(contact, native, touch, side_of(contact, touch, true), -1, way);
}

void ck_rigid_contact_project(ck_RigidContact *contact, ck_Native *native) {
    for (int i = 0; i < contact->count; i++) {
        const ck_Touch *touch = &contact->touches[i];
        double way[3], along[3], amount[3] = {0, 0, 0};
        way_at(contact, native, touch, way);
        const double gap = touch->gap + ck_dot(way, touch->normal),
                     weight = lightness(contact, native, touch, touch->normal);
        if (!(gap < 0) || !(weight > 0)) continue;
        ck_add_scaled(amount, -gap / weight, touch->normal);
        shift(contact, native, touch, amount);
        way_at(contact, native, touch, way);
        ck_tangential(along, way, touch->normal);
        const double slid = ck_length(along);
        if (!(touch->friction > 0) || !(slid > 0)) continue;
        for (int axis = 0; axis < 3; axis++) along[axis] /= slid;
        const double hold = fmin(slid / lightness(contact, native, touch, along), touch->friction * -gap / weight);
        for (int axis = 0; axis < 3; axis++) amount[axis] = -hold * along[axis];
        shift(contact, native, touch, amount);
    }
}
