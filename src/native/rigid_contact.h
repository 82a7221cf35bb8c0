// Rigid bodies for the native engines: how they turn, and the impulses between them, cloth and colliders.
//
// Before a substep's drift, impulses end the approach of whatever would be inside after it: an impact first, with
// restitution, pair by pair, then all together by Gauss–Seidel, with Coulomb friction, until nothing would be. Each
// acts on both at one place, so that momentum and angular momentum stay to rounding, and energy at e = 1. An approach
// slower than the field makes in two substeps cannot be told from rest and does not bounce.
#ifndef CK_RIGID_CONTACT_H
#define CK_RIGID_CONTACT_H

#include "model.h"
#include "rigid.h"

struct ck_Native;

// What has been given at a touch in this substep, N·s: along the normal, and friction.
typedef struct ck_Given {
    double push, drag[3];
} ck_Given;

typedef struct ck_RigidContact {
    const ck_Model *model;
    double dt, slack, rest; // s; m, closer than this is touching; m/s, an approach that is rest
    double *drift, *now;    // [3*n] m/s, set by the engine: what moves the substep, and the speed at its start

    double *held; // [3*n] m/s, what those impulses gave that are no impacts

    double (*rotation)[4]; // [rigid]
    double (*momentum)[3]; // [rigid] kg·m²/s
    double (*twist)[3];    // [rigid] rad, and kg·m²/s: what projections have turned in the substep
    double (*gained)[3];
    ck_Collider *bodies;    // [rigid] where they are
    ck_Collider *colliders; // [colliders] where they are
    double (*speed)[3];     // [colliders] m/s
    ck_Touch *touches;
    ck_Given *given; // [touches]
    int count;
} ck_RigidContact;

// NULL in a scene without rigid bodies. Errors: CK_NO_MEMORY.
ck_Status ck_rigid_contact_create(ck_RigidContact **contact, const ck_Model *model, double dt, ck_Error *error);
void ck_rigid_contact_destroy(ck_RigidContact *contact);

// Sets how long a substep is, s.
void ck_rigid_contact_pace(ck_RigidContact *contact, double dt);

// At a time, s, at which a substep starts: adds the impulses to drift, now and the native's velocity, and turns all
// bodies by the substep. Cost: one gap for each particle and body.
void ck_rigid_contact_meet(ck_RigidContact *contact, struct ck_Native *native, double time);

// At a time, s, at which a substep ends: takes from the native's velocity the approach of what touches.
void ck_rigid_contact_settle(ck_RigidContact *contact, struct ck_Native *native, double time);

// For methods that correct positions: moves apart, by their masses, what their sweeps have brought inside since the
// substep's start, with Coulomb friction.
void ck_rigid_contact_project(ck_RigidContact *contact, struct ck_Native *native);

// [rigid_count]
void ck_rigid_contact_turns(const ck_RigidContact *contact, ck_Turn *turn);

#endif
