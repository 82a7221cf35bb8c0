#include "ode_contact.h"

#include "collider.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

// Share of a depth that is pushed out in a step, and the most speed that this may give, as a share of √(field·size):
// more would bounce.
#define PUSH_SHARE 0.2
#define PUSH_SPEED 0.03
// The most of a ball's radius that a step may go for the ball to be as good as a plane.
#define SMALL_STEP 0.05

double ck_ode_push_speed(const ck_Model *model) {
    double field[3];
    ck_model_mean_field(model, field);
    return ck_length(field) > 0 ? PUSH_SPEED * sqrt(ck_length(field) * model->size) : INFINITY;
}

ck_Status ck_ode_contacts_create(ck_OdeContacts **contacts, const ck_Model *model, double h, ck_Error *error) {
    *contacts = NULL;
    if (!model->collider_count) return CK_OK;
    ck_OdeContacts *made = calloc(1, sizeof *made);
    size_t most = (size_t)model->particle_count * (size_t)model->collider_count;
    if (made)
        *made = (ck_OdeContacts){.model = model,
                                 .h = h,
                                 .push_speed = ck_ode_push_speed(model),
                                 .now = malloc(sizeof(ck_Collider) * (size_t)model->collider_count),
                                 .carried = calloc(3 * (size_t)model->collider_count, sizeof(double)),
                                 .feedback = calloc(most, sizeof *made->feedback)};
    const bool has_room = made && made->feedback && made->now && made->carried;
    if (has_room) memcpy(made->now, model->colliders, sizeof(ck_Collider) * (size_t)model->collider_count);
    if (has_room) made->joints = dJointGroupCreate(0);
    if (!made || !made->joints) {
        ck_ode_contacts_destroy(made);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    *contacts = made;
    return CK_OK;
}

void ck_ode_contacts_destroy(ck_OdeContacts *contacts) {
    if (!contacts) return;
    if (contacts->joints) dJointGroupDestroy(contacts->joints);
    free(contacts->feedback);
    free(contacts->now);
    free(contacts->carried);
    free(contacts);
}

double ck_ode_wanted_speed(double restitution, double gap, double speed, double rest, double pull, double h,
                           double push_speed) {
    if (gap >= 0) return -gap / h;
    if (speed < -rest && restitution > 0) return ck_collider_rebound(restitution, -gap, -speed, pull, h);
    return fmin(PUSH_SHARE * -gap / h, push_speed);
}

void ck_ode_slip_direction(double *slip, const double *velocity, const double *field, const double *normal, double h) {
    memcpy(slip, velocity, 3 * sizeof(double));
    ck_add_scaled(slip, h, field);
    ck_add_scaled(slip, -ck_dot(slip, normal), normal);
    double length = ck_length(slip);
    if (!(length > 1e-12 * (ck_length(velocity) + h * ck_length(field)))) {
        int least = fabs(normal[0]) <= fabs(normal[1]) ? 0 : 1;
        if (fabs(normal[2]) < fabs(normal[least])) least = 2;
        memset(slip, 0, 3 * sizeof(double));
        slip[least] = 1;
        ck_add_scaled(slip, -normal[least], normal);
        length = ck_length(slip);
    }
    for (int axis = 0; axis < 3; axis++) slip[axis] /= length;
}

//   carried  [3] m/s, of the collider, which is where it is at the start of the step
static void add_contact(ck_OdeContacts *contacts, dWorldID world, dBodyID body, int particle,
                        const ck_Collider *collider, const double *carried) {
    const double *position = dBodyGetPosition(body);
    double normal[3], field[3], slip[3], across[3], velocity[3], h = contacts->h;
    ck_subtract(velocity, dBodyGetLinearVel(body), carried);
    double gap = ck_collider_gap(collider, position, normal), speed = ck_dot(velocity, normal);
    ck_model_field(contacts->model, particle, field);
    double rest = 2 * ck_length(field) * h;
    // an impact with restitution is left to go in first; one without is met before
    bool rebounds = collider->restitution > 0 && speed < -rest;
    if (rebounds && gap >= 0) return;
    // in small steps, what comes near within two: springs may push it in faster than it falls. A long step past a ball
    // is another matter: only where it hits, and there
    bool is_small = ck_length(velocity) * h < SMALL_STEP * ck_collider_breadth(collider);
    if (gap > fmax(rest * h, is_small ? -2 * speed * h : 0)) {
        double hit = ck_collider_hit(collider, position, velocity, field, h, 0), met[3];
        if (is_small || !(hit <= h)) return;
        memcpy(met, position, sizeof met);
        ck_add_scaled(met, hit, velocity);
        ck_collider_gap(collider, met, normal);
        ck_subtract(met, position, met);
        gap = ck_dot(met, normal);
        speed = ck_dot(velocity, normal);
    }
    dContact contact = {.surface = {.mode = dContactMotionN | dContactSoftERP | dContactApprox1 | dContactFDir1,
                                    .mu = collider->friction,
                                    .soft_erp = 0,
                                    .motionN = ck_ode_wanted_speed(collider->restitution, gap, speed, rest,
                                                                   -ck_dot(field, normal), h, contacts->push_speed)}};
    ck_ode_slip_direction(slip, velocity, field, normal, h);
    if (ck_dot(carried, carried) > 0) {
        ck_cross(across, normal, slip);
        contact.surface.mode |= dContactMotion1 | dContactMotion2;
        contact.surface.motionN += ck_dot(carried, normal);
        contact.surface.motion1 = ck_dot(carried, slip);
        contact.surface.motion2 = ck_dot(carried, across);
    }
    for (int axis = 0; axis < 3; axis++) {
        contact.geom.pos[axis] = position[axis]; // at the centre: nothing turns
        contact.geom.normal[axis] = normal[axis];
        contact.fdir1[axis] = slip[axis];
    }
    dJointID joint = dJointCreateContact(world, contacts->joints, &contact);
    dJointAttach(joint, body, NULL);
    dJointSetFeedback(joint, &contacts->feedback[contacts->count++]);
}

// Colliders that move: where they are at a time, s, and how fast they go in the step from then.
static void follow(ck_OdeContacts *contacts, double time) {
    for (int i = 0; i < contacts->model->collider_count; i++) {
        const ck_Collider *collider = &contacts->model->colliders[i];
        double none[3], other[3], *carried = contacts->carried + 3 * i;
        if (!collider->path) continue;
        contacts->now[i] = ck_collider_at(collider, time, 1, none, other);
        const ck_Collider end = ck_collider_at(collider, time + contacts->h, -1, none, other);
        ck_subtract(carried, end.point, contacts->now[i].point);
        for (int axis = 0; axis < 3; axis++) carried[axis] /= contacts->h;
    }
}

void ck_ode_contacts_add(ck_OdeContacts *contacts, dWorldID world, const dBodyID *bodies, double time) {
    if (contacts->model->terms & CK_TERM_MOVING_COLLIDERS) follow(contacts, time);
    for (int i = 0; i < ck_model_cloth_count(contacts->model); i++)
        for (int j = 0; j < contacts->model->collider_count && !dBodyIsKinematic(bodies[i]); j++)
            add_contact(contacts, world, bodies[i], i, &contacts->now[j], contacts->carried + 3 * j);
}

void ck_ode_contacts_remove(ck_OdeContacts *contacts) {
    for (int i = 0; i < contacts->count; i++) ck_add_scaled(contacts->impulse, contacts->h, contacts->feedback[i].f1);
    dJointGroupEmpty(contacts->joints);
    contacts->count = 0;
}
