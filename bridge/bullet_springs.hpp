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
    explicit ck_BulletSprings(const ck_BulletBody &owner) : body(owner) {}

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
    const ck_BulletBody &body;
};

#endif
