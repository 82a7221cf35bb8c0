// Rigid bodies of a scene as Bullet's own.
#ifndef CK_BULLET_RIGID_HPP
#define CK_BULLET_RIGID_HPP

#include "engine.h"
#include "rigid.h"

#include <btBulletDynamicsCommon.h>
#include <memory>
#include <vector>

// Whom Bullet lets meet: soft bodies meet shapes that are smaller by their margin, and rigid bodies, which are smaller
// by it, too, meet a second shape of each collider that is larger by it.
const int ck_bullet_rigid_group = 9, ck_bullet_surface_group = 4;

class ck_BulletRigid {
  public:
    // Adds a body for each of the model's.
    //   margin  m, by which shapes are smaller
    //   first   the number of the first, as its user index
    //   dt      s, a step
    //   stock   as Bullet's users do: all meets all, and friction and restitution are products
    void add(btDiscreteDynamicsWorld &world, const ck_Model *model, double margin, int first, double dt, bool stock);
    void remove(btDiscreteDynamicsWorld &world);
    // Before a step of the classic world that no stepSimulation wraps: what the field pushes with.
    void push();
    // A body's shape where it is.
    ck_Collider place(const ck_Model *model, size_t index) const;
    // Into the places of their centres in [3*n], times a unit, m.
    void read(const ck_Model *model, double unit, double *position, double *velocity) const;
    //   start  of the scene, as they were at its start
    void read_turns(const ck_RigidBody *start, ck_Turn *turn) const;
    bool is_finite() const;
    // The body of a user index; NULL: it is a collider.
    btRigidBody *body_of(int index) const;

  private:
    int first_index = 0;
    std::vector<std::unique_ptr<btCollisionShape>> shapes;
    std::vector<std::unique_ptr<btRigidBody>> bodies;
};

// Errors: CK_REFUSED where a body hangs on springs, which act on nodes alone in Bullet.
ck_Status ck_bullet_check_rigid(const ck_Model *model, ck_Error *error);

#endif
