// The longest stable step that theory gives a method about a rest.
#ifndef CK_STABILITY_LIMIT_H
#define CK_STABILITY_LIMIT_H

#include "engine.h"

// A small motion about a rest.
typedef struct ck_Vibration {
    double frequency; // rad/s
    double damping;   // 1/s, by springs and drag
} ck_Vibration;

// The longest stable step of a method about a rest, s; NaN: it has none, or none is known. It is the least that the
// fastest motion and that across springs ask for: strong damping along springs, taken implicitly, lengthens the one and
// does not reach the other.
double ck_stability_limit(ck_Method method, ck_Vibration fastest, ck_Vibration across);

#endif
