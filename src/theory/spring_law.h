// One mass on one spring, as a method steps it: how stiff and how damped the spring acts.
#ifndef CK_SPRING_LAW_H
#define CK_SPRING_LAW_H

#include "engine.h"

typedef struct ck_SpringLaw {
    double at_rest; // N/m: what a weight hangs by; INFINITY: it does not move it
    double moving;  // N/m: of the damped oscillator that goes through the same positions; NaN: none does
    double damping; // N·s/m of that oscillator, negative where it gains energy; NaN as above
} ck_SpringLaw;

// The oscillator whose positions x at each time step obey x'' = a·x' + b·x.
//   dt  s
void ck_spring_law_of_recurrence(ck_SpringLaw *law, double a, double b, double mass, double dt);

// What theory says of an engine's method at the settings used. Members are NaN where it says nothing.
//   mass  kg;  stiffness, damping  of the scene's spring, N/m and N·s/m;  dt  s, a substep
void ck_spring_law_predict(ck_SpringLaw *law, const ck_Engine *engine, const ck_Settings *used, double mass,
                           double stiffness, double damping, double dt);

#endif
