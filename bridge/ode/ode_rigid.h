// Rigid bodies for ODE: its own, with contact joints to particles, colliders and one another.
#ifndef CK_ODE_RIGID_H
#define CK_ODE_RIGID_H

#include "ode_contact.h"
#include "rigid.h"

typedef struct ck_OdeRigid {
    const ck_Model *model;
    double h, push_speed; // s, one substep; m/s, the most with which what is inside is pushed out
    double *position;     // [3*n] m
    ck_Collider *now;     // [rigid_count] where they are
    ck_Touch *touches;
    dJointGroupID joints;     // of this substep
    dJointFeedback *feedback; // of touches with a collider
    int count;
} ck_OdeRigid;

// NULL in a scene without rigid bodies. Errors: CK_NO_MEMORY.
ck_Status ck_ode_rigid_create(ck_OdeRigid **rigid, const ck_Model *model, double h, ck_Error *error);
void ck_ode_rigid_destroy(ck_OdeRigid *rigid);

// Gives the bodies at their centres' particles their inertia, place and spin.
void ck_ode_rigid_shape(const ck_Model *model, const dBodyID *bodies);

// Before a step: a joint for each touch.
//   contacts  where colliders are; NULL: there are none
void ck_ode_rigid_add(ck_OdeRigid *rigid, dWorldID world, const dBodyID *bodies, const ck_OdeContacts *contacts);

// After it: adds what colliders pushed with to contacts, and removes the joints.
void ck_ode_rigid_remove(ck_OdeRigid *rigid, ck_OdeContacts *contacts);

void ck_ode_rigid_turns(const ck_Model *model, const dBodyID *bodies, ck_Turn *turn);

#endif
