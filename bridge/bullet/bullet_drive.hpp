// Pins that move: Bullet moves a node without mass by the speed that it is given.
#ifndef CK_BULLET_DRIVE_HPP
#define CK_BULLET_DRIVE_HPP

#include "path.h"

#include <BulletSoftBody/btSoftBody.h>

// Before a step that ends at a time, s: gives the node of every pin that is moved then the speed that takes it there.
//   node  of a particle
template <class NodeOf> void ck_bullet_drive(const ck_Model *model, double end, double dt, NodeOf node) {
    for (int i = 0; i < model->driven_count; i++) {
        const ck_Driven &driven = model->driven[i];
        double at[3];
        if (!ck_driven_holds(model, &driven, end)) continue;
        ck_driven_at(&driven, end, at);
        btSoftBody::Node &pin = node(driven.particle);
        for (int axis = 0; axis < 3; axis++) pin.m_v[axis] = static_cast<btScalar>((at[axis] - pin.m_x[axis]) / dt);
        pin.m_vn = pin.m_v; // which the implicit world goes by
    }
}

#endif
