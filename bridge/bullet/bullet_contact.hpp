// Colliders as Bullet's static bodies, and the restitution and Coulomb friction that its soft bodies lack.
#ifndef CK_BULLET_CONTACT_HPP
#define CK_BULLET_CONTACT_HPP

#include "bullet_body.hpp"
#include "bullet_rigid.hpp"

#include <btBulletDynamicsCommon.h>

class ck_BulletColliders {
  public:
    // Adds a body for each collider to a world and sets the soft body's margin and the grid of its distances. A plane
    // is a box (Bullet's static plane lets soft bodies through), solids shrink and a plane sinks by the margin, at
    // which Bullet lets nodes rest.
    void add(btDiscreteDynamicsWorld &world, const ck_BulletBody &body, btSoftBodyWorldInfo &info);
    // Before a frame: what stands for planes and cylinders goes where the body is, along them.
    void follow(btDiscreteDynamicsWorld &world, const ck_BulletBody &body);
    // Before a step that starts at a time, s: colliders that move go where they are at its end, with the speed that
    // takes them there; and where rigid bodies are is noted.
    void move(btDiscreteDynamicsWorld &world, const ck_BulletBody &body, double start);
    // Takes them out again: the world owns nothing.
    void remove(btDiscreteDynamicsWorld &world);

    // Rigid bodies of the scene.
    ck_BulletRigid rigid;

    // The collider or rigid body that a contact is with, where it is at the start of the step and at its end, of which
    // a body's is not known; and its speed at a place.
    const ck_Collider &at_start(const btCollisionObject *object) const {
        return start_of[static_cast<size_t>(object->getUserIndex())];
    }
    const ck_Collider &at_end(const btCollisionObject *object) const {
        return end_of[static_cast<size_t>(object->getUserIndex())];
    }
    static btVector3 speed(const btCollisionObject *object, const btVector3 &at) {
        const auto *body = static_cast<const btRigidBody *>(object);
        return body->getVelocityInLocalPoint(at - body->getWorldTransform().getOrigin());
    }
    // Gives a rigid body, unless it is a collider, an impulse, N·s, at a place.
    void strike(const btCollisionObject *object, const btVector3 &impulse, const btVector3 &at) const;

  private:
    void add_collider(btDiscreteDynamicsWorld &world, const ck_BulletBody &body, int index, double margin, int group,
                      int mask);
    std::vector<ck_Collider> start_of, end_of;
    std::vector<std::unique_ptr<btCollisionShape>> shapes;
    std::vector<std::unique_ptr<btRigidBody>> bodies;
};

// How thick a soft body is to Bullet, m: a tenth of what it is made of and of what it touches, or, where
// there are rigid bodies, a hundredth.
double ck_bullet_margin(const ck_Model *model);

// Bullet's shape of a collider, less a margin: a plane is a box or, where the margin is below 0 as for rigid bodies,
// Bullet's own; a cylinder without end a capsule, that the body
// does not get off, half_side m to each side.
std::unique_ptr<btCollisionShape> ck_bullet_shape(const ck_Collider &collider, double margin, double half_side);

// Where such a shape is: planes and cylinders beside the middle of the body.
btTransform ck_bullet_place(const ck_Collider &collider, const btVector3 &middle, double margin, double half_side);

// What ck_bullet_check_reach throws says, and a run that it ends.
extern const char *const ck_bullet_too_far;

// Throws std::range_error where a node may get, within a step of dt s, so far from a collider or rigid body of the
// world that Bullet's field of distances, which counts its cells by int, would read beyond its memory. Cost: nodes.
void ck_bullet_check_reach(btCollisionWorld &world, btSoftBody &soft, double dt);

// ck_collider_gap of a point of Bullet's.
double ck_bullet_gap(const ck_Collider &collider, const btVector3 &point, double normal[3]);

// The field's acceleration of a node, m/s².
btVector3 ck_bullet_field(const ck_BulletBody &body, int particle);

#endif
