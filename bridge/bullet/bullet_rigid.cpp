#include "bullet_rigid.hpp"

#include "bullet_contact.hpp"
#include "vector.h"

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <cmath>

ck_Status ck_bullet_check_rigid(const ck_Model *model, ck_Error *error) {
    for (int i = 0; i < model->rigid_count; i++)
        if (model->rigid[i].hung_count)
            return ck_fail(
                error, CK_REFUSED,
                "the springs of Bullet's soft bodies join nodes, not rigid bodies, which it hangs by anchors "
                "without length");
    return CK_OK;
}

static btScalar larger_friction(const btCollisionObject *one, const btCollisionObject *other) {
    return btMax(one->getFriction(), other->getFriction());
}

static btScalar larger_restitution(const btCollisionObject *one, const btCollisionObject *other) {
    return btMax(one->getRestitution(), other->getRestitution());
}

void ck_BulletRigid::add(btDiscreteDynamicsWorld &world, const ck_Model *model, double margin, int first, double dt,
                         bool stock) {
    first_index = first;
    if (!model->rigid_count) return;
    gCalculateCombinedFrictionCallback = stock ? btManifoldResult::calculateCombinedFriction : larger_friction;
    gCalculateCombinedRestitutionCallback = stock ? btManifoldResult::calculateCombinedRestitution : larger_restitution;
    if (!stock) {
        // what pushes bodies apart gives them no speed, and what is slower than the field makes in two steps rests
        btContactSolverInfo &info = world.getSolverInfo();
        double field[3];
        ck_model_mean_field(model, field);
        info.m_splitImpulse = 1;
        info.m_splitImpulsePenetrationThreshold = BT_LARGE_FLOAT;
        info.m_restitutionVelocityThreshold = 2 * ck_length(field) * dt;
    }
    for (int i = 0; i < model->rigid_count; i++) {
        const ck_RigidBody &rigid = model->rigid[i];
        const double *speed = model->velocity + 3 * rigid.particle, *inertia = rigid.inertia;
        double field[3];
        shapes.push_back(ck_bullet_shape(rigid.shape, margin, 0));
        btRigidBody::btRigidBodyConstructionInfo construction(static_cast<btScalar>(model->mass[rigid.particle]),
                                                              nullptr, shapes.back().get(),
                                                              btVector3(inertia[0], inertia[1], inertia[2]));
        construction.m_startWorldTransform = ck_bullet_place(rigid.shape, btVector3(0, 0, 0), margin, 0);
        // as with colliders
        construction.m_friction = btMax(1e-12, rigid.shape.friction);
        construction.m_restitution = rigid.shape.restitution;
        construction.m_linearDamping = 1 - std::exp(-model->drag);
        construction.m_angularDamping = 0;
        bodies.push_back(std::make_unique<btRigidBody>(construction));
        btRigidBody &body = *bodies.back();
        body.setLinearVelocity(btVector3(speed[0], speed[1], speed[2]));
        body.setAngularVelocity(btVector3(rigid.spin[0], rigid.spin[1], rigid.spin[2]));
        body.setActivationState(DISABLE_DEACTIVATION);
        body.setUserIndex(first + i);
        if (stock)
            world.addRigidBody(&body);
        else
            world.addRigidBody(&body, ck_bullet_rigid_group,
                               btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter);
        ck_model_field(model, rigid.particle, field);
        body.setGravity(btVector3(field[0], field[1], field[2]));
    }
}

void ck_BulletRigid::remove(btDiscreteDynamicsWorld &world) {
    for (auto &body : bodies) world.removeRigidBody(body.get());
}

void ck_BulletRigid::push() {
    for (auto &body : bodies) {
        body->clearForces();
        body->applyGravity();
    }
}

static void read_axes(const btRigidBody &body, double (*axes)[3]) {
    const btMatrix3x3 &basis = body.getWorldTransform().getBasis();
    for (int k = 0; k < 9; k++) axes[k / 3][k % 3] = basis[k % 3][k / 3];
}

ck_Collider ck_BulletRigid::place(const ck_Model *model, size_t index) const {
    ck_Collider now = model->rigid[index].shape;
    for (int axis = 0; axis < 3; axis++) now.point[axis] = bodies[index]->getWorldTransform().getOrigin()[axis];
    read_axes(*bodies[index], now.axes);
    return now;
}

void ck_BulletRigid::read(const ck_Model *model, double unit, double *position, double *velocity) const {
    for (size_t i = 0; i < bodies.size(); i++)
        for (int axis = 0; axis < 3; axis++) {
            const int at = 3 * model->rigid[i].particle + axis;
            position[at] = unit * bodies[i]->getWorldTransform().getOrigin()[axis];
            velocity[at] = unit * bodies[i]->getLinearVelocity()[axis];
        }
}

void ck_BulletRigid::read_turns(const ck_RigidBody *start, ck_Turn *turn) const {
    for (size_t i = 0; i < bodies.size(); i++) {
        double axes[3][3];
        read_axes(*bodies[i], axes);
        ck_rigid_rotation(turn[i].rotation, &start[i], axes);
        for (int axis = 0; axis < 3; axis++) turn[i].spin[axis] = bodies[i]->getAngularVelocity()[axis];
    }
}

bool ck_BulletRigid::is_finite() const {
    bool is = true;
    for (auto &body : bodies) is &= std::isfinite(body->getWorldTransform().getOrigin().length2());
    return is;
}

btRigidBody *ck_BulletRigid::body_of(int index) const {
    return index < first_index ? nullptr : bodies[static_cast<size_t>(index - first_index)].get();
}
