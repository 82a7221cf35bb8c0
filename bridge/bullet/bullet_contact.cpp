#include "bullet_contact.hpp"

#include "collider.h"

#include <stdexcept>

double ck_bullet_margin(const ck_Model *model) {
    // a rigid body rolls and turns over at where its shape ends
    const double share = model->rigid_count ? 0.01 : 0.1;
    double margin = share * model->spacing;
    for (int i = 0; i < model->collider_count; i++)
        margin = btMin(margin, share * ck_collider_breadth(&model->colliders[i]));
    for (int i = 0; i < model->rigid_count; i++)
        margin = btMin(margin, share * ck_collider_breadth(&model->rigid[i].shape));
    return margin;
}

// Half the side of the box that stands for a plane, and half the length of a cylinder, in units of the model, of which
// the body is one or two long: it is there wherever the body is. Bullet's distance test fails in boxes of some
// thousands.
const double half_side = 16;
// That of a cylinder for rigid bodies, which may be anywhere.
const double far_side = 1000;
// How far the body may get from the middle of the box before it is moved.
const double half_side_left = 4;

static btVector3 vector_of(const double *from) {
    return btVector3(from[0], from[1], from[2]);
}

btTransform ck_bullet_place(const ck_Collider &collider, const btVector3 &middle, double margin, double side) {
    const btVector3 point = vector_of(collider.point), above = middle - point;
    const btVector3 x = vector_of(collider.axes[0]), y = vector_of(collider.axes[1]), z = vector_of(collider.axes[2]);
    if (collider.shape == CK_PLANE) {
        const btVector3 normal = vector_of(collider.normal);
        const btQuaternion up = shortestArcQuat(btVector3(0, 1, 0), normal);
        if (margin < 0) return btTransform(up, point - normal * margin);
        return btTransform(up, point + (above - normal * above.dot(normal)) - normal * (side + margin));
    }
    // a capsule of Bullet's stands along y
    if (collider.shape == CK_CAPSULE) return btTransform(shortestArcQuat(btVector3(0, 1, 0), x), point);
    if (collider.shape == CK_CYLINDER)
        return btTransform(shortestArcQuat(btVector3(0, 1, 0), x), point + x * above.dot(x));
    if (collider.shape == CK_SPHERE) return btTransform(btQuaternion::getIdentity(), point);
    return btTransform(btMatrix3x3(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]), point);
}

std::unique_ptr<btCollisionShape> ck_bullet_shape(const ck_Collider &collider, double margin, double side) {
    const double radius = collider.radius - margin;
    switch (collider.shape) {
    case CK_SPHERE: return std::make_unique<btSphereShape>(radius);
    case CK_CAPSULE: return std::make_unique<btCapsuleShape>(radius, 2 * collider.half[0]);
    case CK_CYLINDER: return std::make_unique<btCapsuleShape>(radius, 2 * side);
    case CK_BOX: {
        auto box = std::make_unique<btBoxShape>(vector_of(collider.half) + btVector3(radius, radius, radius));
        // its margin rounds a box's edges in Bullet; none at all is too little for its distances
        box->setMargin(btMax(radius, 1e-3 * ck_collider_breadth(&collider)));
        return box;
    }
    default:
        if (margin < 0) return std::make_unique<btStaticPlaneShape>(btVector3(0, 1, 0), btScalar(0));
        return std::make_unique<btBoxShape>(btVector3(side, side, side));
    }
}

// Those without end stay where the body is.
static bool is_endless(const ck_Collider &collider) {
    return collider.shape == CK_PLANE || collider.shape == CK_CYLINDER;
}

static btVector3 middle_of(const ck_BulletBody &body) {
    btVector3 low = body.soft->m_nodes[0].m_x, high = low;
    for (int i = 1; i < body.soft->m_nodes.size(); i++) {
        low.setMin(body.soft->m_nodes[i].m_x);
        high.setMax(body.soft->m_nodes[i].m_x);
    }
    return (low + high) * 0.5;
}

void ck_BulletColliders::add_collider(btDiscreteDynamicsWorld &world, const ck_BulletBody &body, int index,
                                      double margin, int group, int mask) {
    const ck_Collider &collider = body.model->colliders[index];
    shapes.push_back(ck_bullet_shape(collider, margin, margin < 0 ? far_side : half_side));
    btRigidBody::btRigidBodyConstructionInfo construction(0, nullptr, shapes.back().get());
    construction.m_startWorldTransform = ck_bullet_place(collider, middle_of(body), margin, half_side);
    // without any friction at all Bullet's projection divides by it
    construction.m_friction = btMax(1e-12, collider.friction);
    construction.m_restitution = collider.restitution;
    bodies.push_back(std::make_unique<btRigidBody>(construction));
    bodies.back()->setUserIndex(index);
    world.addRigidBody(bodies.back().get(), group, mask);
}

void ck_BulletColliders::add(btDiscreteDynamicsWorld &world, const ck_BulletBody &body, btSoftBodyWorldInfo &info) {
    const ck_Model *model = body.model;
    if (!model->collider_count && !model->rigid_count) return;
    double margin = ck_bullet_margin(model), voxel = 0.25;
    body.soft->getCollisionShape()->setMargin(margin);
    for (int i = 0; i < model->collider_count; i++) {
        const ck_Collider &collider = model->colliders[i];
        start_of.push_back(collider);
        end_of.push_back(collider);
        // a grid this fine is off by some 1e-4 of the radius; of a plane any is exact
        if (collider.shape != CK_PLANE) voxel = btMin(voxel, ck_collider_breadth(&collider) / 60);
        add_collider(world, body, i, margin, btBroadphaseProxy::StaticFilter,
                     btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter);
        if (model->rigid_count)
            add_collider(world, body, i, -margin, ck_bullet_surface_group, ck_bullet_rigid_group ^ 1);
    }
    for (int i = 0; i < model->rigid_count; i++) {
        start_of.push_back(model->rigid[i].shape);
        end_of.push_back(model->rigid[i].shape);
        voxel = btMin(voxel, ck_collider_breadth(&model->rigid[i].shape) / 60);
    }
    rigid.add(world, model, margin, model->collider_count, body.dt, false);
    info.m_sparsesdf.setDefaultVoxelsz(voxel);
    info.m_sparsesdf.Reset();
}

// The margin of a collider's first shape or, for rigid bodies, its second.
static double margin_of(const ck_BulletBody &body, const btRigidBody &object) {
    const bool is_second = object.getBroadphaseProxy()->m_collisionFilterGroup == ck_bullet_surface_group;
    return ck_bullet_margin(body.model) * (is_second ? -1 : 1);
}

const char *const ck_bullet_too_far = "a particle is too far from what it may touch: Bullet's field of distances, of "
                                      "cells of a sixtieth of the smallest collider, ends there";

// Cells that are counted without fear: an int has four times as many.
const double most_cells = 1 << 29;

void ck_bullet_check_reach(btCollisionWorld &world, btSoftBody &soft, double dt) {
    const btCollisionObjectArray &objects = world.getCollisionObjectArray();
    if (objects.size() < 2 || !soft.m_nodes.size()) return;
    btVector3 low = soft.m_nodes[0].m_x, high = low;
    for (int i = 0; i < soft.m_nodes.size(); i++) {
        const btVector3 next = soft.m_nodes[i].m_x + soft.m_nodes[i].m_v * dt;
        low.setMin(soft.m_nodes[i].m_x);
        low.setMin(next);
        high.setMax(soft.m_nodes[i].m_x);
        high.setMax(next);
    }
    const double voxel = soft.getWorldInfo()->m_sparsesdf.voxelsz;
    for (int i = 0; i < objects.size(); i++) {
        if (objects[i] == &soft) continue;
        const btVector3 place = objects[i]->getWorldTransform().getOrigin();
        const double far = (low - place).absolute().length() + (high - place).absolute().length();
        if (far > most_cells * voxel) throw std::range_error(ck_bullet_too_far);
    }
}

void ck_BulletColliders::follow(btDiscreteDynamicsWorld &world, const ck_BulletBody &body) {
    const btVector3 middle = middle_of(body);
    for (auto &object : bodies) {
        const ck_Collider &collider = at_start(object.get());
        if (!is_endless(collider) || collider.path) continue;
        btTransform place = ck_bullet_place(collider, middle, margin_of(body, *object), half_side);
        if (!((place.getOrigin() - object->getWorldTransform().getOrigin()).length() > half_side_left)) continue;
        object->setWorldTransform(place);
        object->setInterpolationWorldTransform(place);
        world.updateSingleAabb(object.get());
    }
}

void ck_BulletColliders::move(btDiscreteDynamicsWorld &world, const ck_BulletBody &body, double start) {
    for (auto &object : bodies) {
        const size_t index = static_cast<size_t>(object->getUserIndex());
        const ck_Collider &collider = body.model->colliders[index];
        double velocity[3], acceleration[3];
        if (!collider.path) continue;
        start_of[index] = ck_collider_at(&collider, start, 1, velocity, acceleration);
        end_of[index] = ck_collider_at(&collider, start + body.dt, -1, velocity, acceleration);
        const double *from = start_of[index].point, *to = end_of[index].point;
        const btTransform place = ck_bullet_place(end_of[index], middle_of(body), margin_of(body, *object), half_side);
        object->setWorldTransform(place);
        object->setInterpolationWorldTransform(place);
        object->setLinearVelocity(btVector3(to[0] - from[0], to[1] - from[1], to[2] - from[2]) / body.dt);
        world.updateSingleAabb(object.get());
    }
    for (size_t i = 0; i < static_cast<size_t>(body.model->rigid_count); i++)
        start_of[start_of.size() - body.model->rigid_count + i] = end_of[end_of.size() - body.model->rigid_count + i] =
            rigid.place(body.model, i);
}

void ck_BulletColliders::remove(btDiscreteDynamicsWorld &world) {
    for (auto &body : bodies) world.removeRigidBody(body.get());
    rigid.remove(world);
}

void ck_BulletColliders::strike(const btCollisionObject *object, const btVector3 &impulse, const btVector3 &at) const {
    if (btRigidBody *body = rigid.body_of(object->getUserIndex()))
        body->applyImpulse(impulse, at - body->getWorldTransform().getOrigin());
}

double ck_bullet_gap(const ck_Collider &collider, const btVector3 &point, double normal[3]) {
    const double at[3] = {point[0], point[1], point[2]};
    return ck_collider_gap(&collider, at, normal);
}

btVector3 ck_bullet_field(const ck_BulletBody &body, int particle) {
    double field[3];
    ck_model_field(body.model, particle, field);
    return btVector3(field[0], field[1], field[2]);
}
