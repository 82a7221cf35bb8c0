// Contact for ODE: joints straight from the exact surface, in place of ODE's geometry, which has neither points nor
// restitution without gain.
#ifndef CK_ODE_CONTACT_H
#define CK_ODE_CONTACT_H

#include "model.h"

#include <ode/ode.h>

typedef struct ck_OdeContacts {
    const ck_Model *model;
    ck_Collider *now;         // [colliders] where they are
    double *carried;          // [3*colliders] m/s, of those that move
    double h;                 // s, one substep
    double push_speed;        // m/s, the most with which what is inside is pushed out
    dJointGroupID joints;     // of this substep
    dJointFeedback *feedback; // [particle_count * collider_count]
    int count;                // of this substep
    double impulse[3];        // N·s on the body since it was last cleared
} ck_OdeContacts;

// The most speed, m/s, that pushing a particle out of a surface gives it.
double ck_ode_push_speed(const ck_Model *model);

// The speed along the normal that the joint asks for. ODE's own bounce adds what it corrects of the depth, and gains
// energy by it. An impact is answered once it is inside; without restitution it stops at the surface. What cannot be
// told from rest, 2·g·h, rests.
double ck_ode_wanted_speed(double restitution, double gap, double speed, double rest, double pull, double h,
                           double push_speed);

// The direction along the surface in which the particle slides, or would: along any other, friction is a pyramid.
void ck_ode_slip_direction(double *slip, const double *velocity, const double *field, const double *normal, double h);

// NULL in a scene without colliders. Errors: CK_NO_MEMORY.
ck_Status ck_ode_contacts_create(ck_OdeContacts **contacts, const ck_Model *model, double h, ck_Error *error);
void ck_ode_contacts_destroy(ck_OdeContacts *contacts);

// Before a step that starts at a time, s: a joint for each particle that touches, or is about to.
//   bodies  [particle_count]
void ck_ode_contacts_add(ck_OdeContacts *contacts, dWorldID world, const dBodyID *bodies, double time);

// After it: notes what the joints pushed with, and removes them.
void ck_ode_contacts_remove(ck_OdeContacts *contacts);

#endif
