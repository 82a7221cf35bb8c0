// What particles touch, shared by touch.c and touch_event.c: where surfaces are at a time, and what pushes along them.
#ifndef CK_TOUCH_SURFACE_H
#define CK_TOUCH_SURFACE_H

#include "collider.h"
#include "touch.h"

// A particle that turns only begins a step there.
typedef enum ck_TouchEvent { CK_NO_EVENT, CK_IMPACT, CK_LIFT, CK_STOP, CK_SLIP, CK_TURN, CK_BORDER } ck_TouchEvent;

// What a particle touches.
typedef struct ck_TouchState {
    int collider;  // −1: nothing
    ck_Part part;  // of that
    bool sticks;   // held by friction
    double way[3]; // unit: the direction in which it slid at the start of the step; 0: it did not
    ck_TouchEvent event;
    int hit;               // of an impact the collider, of a border the axis
    double when;           // share of the step
    double from[3], clear; // m: a place, and how far from there all colliders are but one; 0: not known
    int but;               // that one; −1: none, but all
} ck_TouchState;

struct ck_Touches {
    const ck_Model *model;
    const bool *pinned;
    ck_TouchState *touch;                       // [n]
    double rest;                                // m/s: CK_TOUCH_REST
    double thin;                                // m: what coordinates resolve
    double time, dt;                            // s, of the start of a step, and its length
    double *position, *velocity, *acceleration; // [3*n] there
};

// Where a particle is to a collider at a time, which has moved so far by then.
typedef struct ck_TouchSurface {
    const ck_Collider *collider;
    ck_Part part; // of one that is touched, which goes on beyond its borders
    double moved[3], velocity[3], acceleration[3];
    double normal[3], gap;
} ck_TouchSurface;

// What pushes a particle along a surface, m/s², and what friction does at most.
typedef struct ck_TouchPush {
    double along[3], friction, press;
} ck_TouchPush;

// A collider at a time, before its gap.
//   seen  out: the particle's place, less how far the collider has moved
ck_TouchSurface ck_touch_look(const ck_Touches *touches, int collider, double time, int side, const double *point,
                              double *seen);
// With the gap and the normal there.
ck_TouchSurface ck_touch_surface_at(const ck_Touches *touches, int collider, double time, int side,
                                    const double *point);
// That which a particle touches.
ck_TouchSurface ck_touch_surface_of(const ck_Touches *touches, const ck_TouchState *touch, double time, int side,
                                    const double *point);

//   slip  out: its velocity to the surface's, tangential
ck_TouchPush ck_touch_push(const ck_TouchSurface *surface, const double *velocity, const double *acceleration,
                           double *slip);
// What friction can hold less what it must.
double ck_touch_margin(const ck_TouchPush *push);

#endif
