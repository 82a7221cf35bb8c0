// Contact of the reference: which particles touch which collider, sliding or held by friction, and the events at which
// that changes, located in time.
#ifndef CK_TOUCH_H
#define CK_TOUCH_H

#include "model.h"
#include "status.h"

// A particle that touches a collider is a constraint of its acceleration; friction is Coulomb's. An impact is e times
// the speed back and friction's share of the impulse; below CK_TOUCH_REST it rests. Events: an impact, by the cubic
// between two ends of a step; a particle that lifts off, stops sliding or begins to, by the line between them.
typedef struct ck_Touches ck_Touches;

// Speeds, in √(field·size), that an impact with restitution no longer leaves with.
#define CK_TOUCH_REST 1e-6

// pinned, [n], is the caller's. NULL in touches where the model has no colliders. Errors: CK_NO_MEMORY.
ck_Status ck_touches_create(ck_Touches **touches, const ck_Model *model, const bool *pinned, ck_Error *error);
// Accepts NULL.
void ck_touches_destroy(ck_Touches *touches);

// Takes what touching particles may not do from accelerations, m/s², which hold those of everything else. Arrays [3*n].
void ck_touches_accelerate(ck_Touches *touches, double time, int side, const double *position, const double *velocity,
                           double *acceleration);

// Notes the state at the start of a step of dt s, with the accelerations that ck_touches_accelerate was given there.
void ck_touches_start(ck_Touches *touches, double time, double dt, const double *position, const double *velocity,
                      const double *acceleration);

// Of a step of dt s to a state, whose accelerations without contact are given: the share of it after which the first
// event comes; above 1: there is none. Notes which particles it is of.
double ck_touches_first_event(ck_Touches *touches, double dt, const double *position, const double *velocity,
                              const double *acceleration);

// Puts touching particles onto their surfaces, and takes their speeds into these.
void ck_touches_project(ck_Touches *touches, double time, double *position, double *velocity);

// What the events noted last do at their time: speeds and touches change. False where a particle comes between two
// colliders, which this knows nothing of.
bool ck_touches_change(ck_Touches *touches, double time, double *position, double *velocity);

// The same at the start, or once a pin is let go or a collider's speed jumps, of all that is on a surface.
bool ck_touches_begin(ck_Touches *touches, double time, double *position, double *velocity);

// After either, with the accelerations without contact then: whether what has come to rest is held by friction, slides
// or is off again.
void ck_touches_settle(ck_Touches *touches, double time, const double *position, double *velocity,
                       const double *acceleration);

#endif
