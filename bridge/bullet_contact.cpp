#include "bullet_contact.hpp"

#include "vector.h"

double ck_bullet_margin(const ck_Model *model) {
    double margin = btMin(0.01, 0.1 * model->spacing);
    for (int i = 0; i < model->collider_count; i++)
        if (model->colliders[i].shape == CK_SPHERE) margin = btMin(margin, 0.1 * model->colliders[i].radius);
    return margin;
}

// The farthest that the body can get from a point of a plane, m: what the box must reach.
static double reach_of(const ck_Model *model, const ck_Collider &collider) {
    double field[3], farthest = 0, fastest = 0, time = model->duration;
    ck_model_mean_field(model, field);
    for (int i = 0; i < model->particle_count; i++) {
        farthest = btMax(farthest, ck_distance(model->position + 3 * i, collider.point));
        fastest = btMax(fastest, ck_length(model->velocity + 3 * i));
    }
    return 2 * (farthest + model->size + fastest * time + 0.5 * ck_length(field) * time * time);
}

static btTransform place_plane(const ck_Collider &collider, double reach, double margin) {
    btVector3 normal(collider.normal[0], collider.normal[1], collider.normal[2]);
    btVector3 point(collider.point[0], collider.point[1], collider.point[2]);
    btTransform place(shortestArcQuat(btVector3(0, 1, 0), normal));
    place.setOrigin(point - normal * (reach + margin));
    return place;
}

void ck_BulletColliders::add(btDiscreteDynamicsWorld &world, const ck_BulletBody &body, btSoftBodyWorldInfo &info) {
    const ck_Model *model = body.model;
    if (!model->collider_count) return;
    double margin = ck_bullet_margin(model), voxel = 0.25;
    body.soft->getCollisionShape()->setMargin(margin);
    for (int i = 0; i < model->collider_count; i++) {
        const ck_Collider &collider = model->colliders[i];
        btTransform place(btQuaternion::getIdentity(),
                          btVector3(collider.point[0], collider.point[1], collider.point[2]));
        if (collider.shape == CK_PLANE) {
            double reach = reach_of(model, collider);
            shapes.push_back(std::make_unique<btBoxShape>(btVector3(reach, reach, reach)));
            place = place_plane(collider, reach, margin);
        } else {
            shapes.push_back(std::make_unique<btSphereShape>(collider.radius - margin));
            // a grid this fine is off by some 1e-4 of the radius
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

void ck_BulletColliders::remove(btDiscreteDynamicsWorld &world) {
    for (auto &body : bodies) world.removeRigidBody(body.get());
}

btVector3 ck_bullet_field(const ck_BulletBody &body, int particle) {
    double field[3];
    ck_model_field(body.model, particle, field);
    return btVector3(field[0], field[1], field[2]);
}
