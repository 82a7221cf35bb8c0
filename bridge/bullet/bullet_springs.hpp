// Springs and drag for Bullet's deformable world.
//
// Bullet's own spring force has one stiffness per world, and its Hessian is indefinite under compression, which makes a
// cloth with a little noise explode. This one has k and c per link, and clamps (1 − L/l) at 0 in the differential.
#ifndef CK_BULLET_SPRINGS_HPP
#define CK_BULLET_SPRINGS_HPP

#include "bullet_body.hpp"

#include <BulletSoftBody/btDeformableLagrangianForce.h>

class ck_BulletSprings : public btDeformableLagrangianForce {
  public:
    ck_BulletSprings(ck_BulletBody &owner, bool is_implicit);

    void addScaledForces(btScalar scale, TVStack &force) override;
    void addScaledExplicitForce(btScalar scale, TVStack &force) override;
    void addScaledDampingForce(btScalar scale, TVStack &force) override;
    void addScaledElasticForceDifferential(btScalar scale, const TVStack &dx, TVStack &df) override;
    void addScaledDampingForceDifferential(btScalar scale, const TVStack &dv, TVStack &df) override;
    void buildDampingForceDifferentialDiagonal(btScalar scale, TVStack &diagonal) override;
    btDeformableLagrangianForceType getForceType() override {
        return BT_MASSSPRING_FORCE;
    }

  private:
    void add_forces(btScalar elastic_scale, btScalar damping_scale, TVStack &force);
    void multiply(btScalar elastic_scale, btScalar damping_scale, const TVStack &d, TVStack &result);

    ck_BulletBody &body;
    const ck_BulletLoops *loops;
    ck_BulletOuter outer;
    bool is_implicit, is_damped, has_force;
    // what multiply answers with, of each link and node, for the scales it was made for; stale once normals are new
    std::vector<btScalar> along, across, own;
    btScalar made_for[2];
    bool is_stale;
    btScalar damping_scale_before; // of the first of two calls that are answered together
};

#endif
