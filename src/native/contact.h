// Native contact: particles against half-spaces and balls, with restitution and Coulomb friction.
//
// An impact is an impulse: the normal speed is reversed and scaled by e, the tangential speed loses at most
// μ·(1 + e)·|v_n|. An impact slower than the contact-free acceleration makes in two substeps, 2·|a_n|·dt, cannot be
// told from rest: it does not bounce. A body at rest or sliding is pushed with what it presses with, never pulled.
#ifndef CK_CONTACT_H
#define CK_CONTACT_H

#include "model.h"

// Of a collider that moves, from one jump of any collider's speed to the next: how far it has come, m, its speed, m/s,
// and the acceleration that takes it to where it is then, m/s², all as it would have been at the start of the substep.
typedef struct ck_Motion {
    double moved[3], velocity[3], acceleration[3];
    double end[3], way[3]; // m: how far it has come at the end of the substep, and that less where it began
} ck_Motion;

typedef struct ck_Contact {
    const ck_Model *model;
    double dt;          // s, one substep
    double slack;       // m: closer than this is touching
    double impulse[3];  // N·s, of all colliders on the body since it was last cleared
    double *sizes;      // [colliders] m: all of a solid is nearer to its point; of a plane 0
    ck_Motion *motion;  // [colliders]; NULL: all stay, and what follows is not read
    double elapsed;     // s of the substep, at which ck_contact_filter is asked
    double begun;       // s, of the substep
    double from, until; // s of the substep, between which motion holds
} ck_Contact;

// Where colliders move: sets their motion in the substep that starts at a time, s. Contact is that of one at rest, seen
// from it: with its acceleration taken from the particle's. Were it to change its speed between substeps, friction
// would let go of what it carries too early or too late.
void ck_contact_follow(ck_Contact *contact, double time);

// NULL in a scene without colliders, which costs it one comparison a substep. *contact is freed with free.
// Errors: CK_NO_MEMORY.
ck_Status ck_contact_create(ck_Contact **contact, const ck_Model *model, double dt, ck_Error *error);

// Moves a particle by one substep under a constant acceleration a, m/s², with every impact, slide, stop and lift-off on
// the way at its time: in a uniform field a body bounces, and slides along a straight line, without a step error; where
// friction turns a path, its direction is that of the start of the substep.
//   x, v  in-out, m and m/s, at the start and at the end of the substep
// Cost: one crossing test a collider, one more for each event.
void ck_contact_advance(ck_Contact *contact, double mass, double *x, double *v, const double *a);

// What acceleration is left of a, m/s², for a particle at x with speed v: that of a body which rests, slides or is not
// in contact.
void ck_contact_filter(const ck_Contact *contact, const double *x, const double *v, const double *a, double *left);

// How far a particle was pushed out of colliders in a substep so far, m, and what friction has taken of its way.
typedef struct ck_Pressed {
    double depth, held[3];
} ck_Pressed;

// For methods that correct positions, once a sweep. Moves a particle that is inside a collider out of it, and takes
// from its way since start along the surface what friction holds: in all sweeps at most μ times what it was pushed out
// in all; a sweep that is held to its own push alone lets creep what others pull. Cost: one gap a collider.
void ck_contact_project(ck_Contact *contact, double mass, const double *start, ck_Pressed *pressed, double *x);

// For those methods, over a substep's way at a mean velocity v, m/s, under a field, m/s²: where a particle hits a
// collider faster than what counts as rest, moves x over all impacts on the way, and gives the mean velocity with which
// it goes on. Else false, and all is as it was.
bool ck_contact_meet(ck_Contact *contact, double mass, const double *field, double *x, double *v);

#endif
