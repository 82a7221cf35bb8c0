#include "ode_rigid.h"

#include "collider.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

ck_Status ck_ode_rigid_create(ck_OdeRigid **out, const ck_Model *model, double h, ck_Error *error) {
    *out = NULL;
    if (!model->rigid_count) return CK_OK;
    const size_t most = ck_rigid_most_touches(model);
    ck_OdeRigid *rigid = calloc(1, sizeof *rigid);
    if (rigid)
        *rigid = (ck_OdeRigid){.model = model,
                               .h = h,
                               .push_speed = ck_ode_push_speed(model),
                               .position = calloc(3 * (size_t)model->particle_count, sizeof *rigid->position),
                               .now = calloc((size_t)model->rigid_count, sizeof *rigid->now),
                               .touches = calloc(most, sizeof *rigid->touches),
                               .feedback = calloc(most, sizeof *rigid->feedback)};
    if (rigid && rigid->position && rigid->now && rigid->touches && rigid->feedback)
        rigid->joints = dJointGroupCreate(0);
    if (!rigid || !rigid->joints) {
        ck_ode_rigid_destroy(rigid);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    *out = rigid;
    return CK_OK;
}

void ck_ode_rigid_destroy(ck_OdeRigid *rigid) {
    if (!rigid) return;
    if (rigid->joints) dJointGroupDestroy(rigid->joints);
    free(rigid->position);
    free(rigid->now);
    free(rigid->touches);
    free(rigid->feedback);
    free(rigid);
}

void ck_ode_rigid_shape(const ck_Model *model, const dBodyID *bodies) {
    for (int i = 0; i < model->rigid_count; i++) {
        const ck_RigidBody *rigid = &model->rigid[i];
        const dBodyID body = bodies[rigid->particle];
        const double(*axes)[3] = rigid->shape.axes;
        dMatrix3 rotation = {0};
        dMass mass;
        dMassSetParameters(&mass, model->mass[rigid->particle], 0, 0, 0, rigid->inertia[0], rigid->inertia[1],
                           rigid->inertia[2], 0, 0, 0);
        dBodySetMass(body, &mass);
        for (int k = 0; k < 9; k++) rotation[4 * (k / 3) + k % 3] = axes[k % 3][k / 3];
        dBodySetRotation(body, rotation);
        dBodySetGyroscopicMode(body, 1);
        dBodySetAngularVel(body, rigid->spin[0], rigid->spin[1], rigid->spin[2]);
    }
}

static void read_axes(dBodyID body, double (*axes)[3]) {
    const dReal *rotation = dBodyGetRotation(body);
    for (int k = 0; k < 9; k++) axes[k % 3][k / 3] = rotation[4 * (k / 3) + k % 3];
}

void ck_ode_rigid_turns(const ck_Model *model, const dBodyID *bodies, ck_Turn *turn) {
    for (int i = 0; i < model->rigid_count; i++) {
        double axes[3][3];
        read_axes(bodies[model->rigid[i].particle], axes);
        ck_rigid_rotation(turn[i].rotation, &model->rigid[i], axes);
        memcpy(turn[i].spin, dBodyGetAngularVel(bodies[model->rigid[i].particle]), sizeof turn[i].spin);
    }
}

// m/s² of the one as the other falls with it; a collider does not fall.
static double pull_of(const ck_OdeRigid *rigid, const ck_Touch *touch) {
    double field[3], other[3] = {0, 0, 0};
    ck_model_field(rigid->model, touch->particle, field);
    if (touch->other >= 0) ck_model_field(rigid->model, rigid->model->rigid[touch->other].particle, other);
    ck_add_scaled(field, -1, other);
    return -ck_dot(field, touch->normal);
}

// Sets the speed that the joint asks for along the normal, and the direction of friction, as for particles.
//   velocity  [3] m/s, of a as b sees it
static void fill_surface(const ck_OdeRigid *rigid, const ck_Touch *touch, const double *velocity, double rest,
                         dContact *contact) {
    double field[3], slip[3];
    ck_model_field(rigid->model, touch->particle, field);
    if (touch->other >= 0) memset(field, 0, sizeof field);
    contact->surface = (dSurfaceParameters){
        .mode = dContactMotionN | dContactSoftERP | dContactApprox1 | dContactFDir1,
        .mu = touch->friction,
        .soft_erp = 0,
        .motionN = ck_ode_wanted_speed(touch->restitution, touch->gap, ck_dot(velocity, touch->normal), rest,
                                       pull_of(rigid, touch), rigid->h, rigid->push_speed)};
    ck_ode_slip_direction(slip, velocity, field, touch->normal, rigid->h);
    for (int axis = 0; axis < 3; axis++) {
        contact->geom.pos[axis] = touch->point[axis];
        contact->geom.normal[axis] = touch->normal[axis];
        contact->fdir1[axis] = slip[axis];
    }
}

static void add_touch(ck_OdeRigid *rigid, dWorldID world, const dBodyID *bodies, const ck_Touch *touch,
                      const double *carried) {
    const dBodyID one = bodies[touch->particle],
                  other = touch->other < 0 ? NULL : bodies[rigid->model->rigid[touch->other].particle];
    dVector3 velocity, of_other = {0};
    double field[3];
    const double *p = touch->point;
    dBodyGetPointVel(one, p[0], p[1], p[2], velocity);
    if (other) dBodyGetPointVel(other, p[0], p[1], p[2], of_other);
    if (!other && carried) memcpy(of_other, carried, 3 * sizeof(double));
    ck_add_scaled(velocity, -1, of_other);
    ck_model_field(rigid->model, touch->particle, field);
    const double speed = ck_dot(velocity, touch->normal), rest = 2 * ck_length(field) * rigid->h;
    // an impact with restitution is left to go in first; what does not get there in two steps is left alone
    if (touch->restitution > 0 && speed < -rest && touch->gap >= 0) return;
    if (touch->gap > fmax(rest * rigid->h, -2 * speed * rigid->h)) return;
    dContact contact = {0};
    fill_surface(rigid, touch, velocity, rest, &contact);
    if (carried && ck_dot(carried, carried) > 0) {
        double across[3];
        ck_cross(across, touch->normal, contact.fdir1);
        contact.surface.mode |= dContactMotion1 | dContactMotion2;
        contact.surface.motionN += ck_dot(carried, touch->normal);
        contact.surface.motion1 = ck_dot(carried, contact.fdir1);
        contact.surface.motion2 = ck_dot(carried, across);
    }
    const dJointID joint = dJointCreateContact(world, rigid->joints, &contact);
    dJointAttach(joint, one, other);
    if (!other) dJointSetFeedback(joint, &rigid->feedback[rigid->count++]);
}

void ck_ode_rigid_add(ck_OdeRigid *rigid, dWorldID world, const dBodyID *bodies, const ck_OdeContacts *contacts) {
    const ck_Model *model = rigid->model;
    double fastest = 0, axes[3][3];
    for (int i = 0; i < model->particle_count; i++) {
        memcpy(rigid->position + 3 * i, dBodyGetPosition(bodies[i]), 3 * sizeof(double));
        fastest = fmax(fastest, ck_length(dBodyGetLinearVel(bodies[i])));
    }
    for (int i = 0; i < model->rigid_count; i++) {
        const dBodyID body = bodies[model->rigid[i].particle];
        rigid->now[i] = model->rigid[i].shape;
        memcpy(rigid->now[i].point, dBodyGetPosition(body), sizeof rigid->now[i].point);
        read_axes(body, axes);
        memcpy(rigid->now[i].axes, axes, sizeof axes);
        fastest =
            fmax(fastest, ck_length(dBodyGetAngularVel(body)) * (rigid->now[i].radius + ck_length(rigid->now[i].half)));
    }
    for (int i = 0; i < model->collider_count; i++) fastest = fmax(fastest, ck_length(contacts->carried + 3 * i));
    const int count =
        ck_rigid_find_touches(model, rigid->position, rigid->now, contacts ? contacts->now : NULL,
                              (4 * fastest + ck_length(model->gravity) * rigid->h) * rigid->h, rigid->touches);
    rigid->count = 0;
    for (int i = 0; i < count; i++) {
        const ck_Touch *touch = &rigid->touches[i];
        // a pin pushes, and is not pushed: ODE knows that of a kinematic body
        add_touch(rigid, world, bodies, touch, touch->other < 0 ? contacts->carried + 3 * touch->collider : NULL);
    }
}

void ck_ode_rigid_remove(ck_OdeRigid *rigid, ck_OdeContacts *contacts) {
    for (int i = 0; i < rigid->count; i++) ck_add_scaled(contacts->impulse, rigid->h, rigid->feedback[i].f1);
    dJointGroupEmpty(rigid->joints);
}
