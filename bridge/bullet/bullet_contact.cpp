#include "bullet_contact.hpp"

#include "collider.h"

double ck_bullet_margin(const ck_Model *model) {
    double margin = 0.1 * model->spacing;
    for (int i = 0; i < model->collider_count; i++)
        if (model->colliders[i].shape == CK_SPHERE) margin = btMin(margin, 0.1 * model->colliders[i].radius);
    return margin;
}

// Half the side of the box that stands for a plane, in units of the model, of which the body is one or two long: it is
// there wherever the body is. Bullet's distance test fails in boxes of some thousands.
const double half_side = 16;
// How far the body may get from the middle of the box before it is moved.
const double half_side_left = 4;

static btTransform place_plane(const ck_Collider &collider, const btVector3 &middle, double margin) {
    btVector3 normal(collider.normal[0], collider.normal[1], collider.normal[2]);
    btVector3 point(collider.point[0], collider.point[1], collider.point[2]);
    btTransform place(shortestArcQuat(btVector3(0, 1, 0), normal));
    btVector3 above = middle - point;
    place.setOrigin(point + (above - normal * above.dot(normal)) - normal * (half_side + margin));
    return place;
}

static btVector3 middle_of(const ck_BulletBody &body) {
    btVector3 low = body.soft->m_nodes[0].m_x, high = low;
    for (int i = 1; i < body.soft->m_nodes.size(); i++) {
        low.setMin(body.soft->m_nodes[i].m_x);
        high.setMax(body.soft->m_nodes[i].m_x);
    }
    return (low + high) * 0.5;
}

void ck_BulletColliders::add(btDiscreteDynamicsWorld &world, const ck_BulletBody &body, btSoftBodyWorldInfo &info) {
    const ck_Model *model = body.model;
    if (!model->collider_count) return;
    double margin = ck_bullet_margin(model), voxel = 0.25;
    body.soft->getCollisionShape()->setMargin(margin);
    for (int i = 0; i < model->collider_count; i++) {
        const ck_Collider &collider = model->colliders[i];
        start_of.push_back(collider);
        end_of.push_back(collider);
        btTransform place(btQuaternion::getIdentity(),
                          btVector3(collider.point[0], collider.point[1], collider.point[2]));
        if (collider.shape == CK_PLANE) {
            shapes.push_back(std::make_unique<btBoxShape>(btVector3(half_side, half_side, half_side)));
            place = place_plane(collider, middle_of(body), margin);
        } else {
            shapes.push_back(std::make_unique<btSphereShape>(collider.radius - margin));
            // a grid this fine is off by some 1e-4 of the radius; of a box any is exact
            voxel = btMin(voxel, collider.radius / 60);
        }
        btRigidBody::btRigidBodyConstructionInfo construction(0, nullptr, shapes.back().get());
        construction.m_startWorldTransform = place;
        // without any friction at all Bullet's projection divides by it
        construction.m_friction = btMax(1e-12, collider.friction);
        bodies.push_back(std::make_unique<btRigidBody>(construction));
        bodies.back()->setUserIndex(i);
        world.addRigidBody(bodies.back().get());
    }
    info.m_sparsesdf.setDefaultVoxelsz(voxel);
    info.m_sparsesdf.Reset();
}

void ck_BulletColliders::follow(btDiscreteDynamicsWorld &world, const ck_BulletBody &body) {
    const btVector3 middle = middle_of(body);
    for (auto &plane : bodies) {
        const ck_Collider &collider = at_start(plane.get());
        if (collider.shape != CK_PLANE || collider.path) continue;
        btTransform place = place_plane(collider, middle, ck_bullet_margin(body.model));
        if (!((place.getOrigin() - plane->getWorldTransform().getOrigin()).length() > half_side_left)) continue;
        plane->setWorldTransform(place);
        plane->setInterpolationWorldTransform(place);
        world.updateSingleAabb(plane.get());
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
        btTransform place(btQuaternion::getIdentity(), btVector3(to[0], to[1], to[2]));
        if (collider.shape == CK_PLANE)
            place = place_plane(end_of[index], middle_of(body), ck_bullet_margin(body.model));
        object->setWorldTransform(place);
        object->setInterpolationWorldTransform(place);
        object->setLinearVelocity(btVector3(to[0] - from[0], to[1] - from[1], to[2] - from[2]) / body.dt);
        world.updateSingleAabb(object.get());
    }
}

void ck_BulletColliders::remove(btDiscreteDynamicsWorld &world) {
    for (auto &body : bodies) world.removeRigidBody(body.get());
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
