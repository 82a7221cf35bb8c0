// What a model's body is made of, as far as truths, rules and metrics ask.
#ifndef CK_SHAPE_H
#define CK_SHAPE_H

#include "model.h"

#ifdef __cplusplus
extern "C" {
#endif

// True for particles joined one after the other by one spring each, no others, and no hinges: a rope, or a
// network of such bars.
bool ck_shape_is_chain(const ck_Model *model);

// True for a chain whose springs are alike and start in one straight line.
bool ck_shape_is_even_chain(const ck_Model *model);

// True without pins and colliders, and with springs that start at rest: nothing but field and drag moves it.
bool ck_shape_is_falling(const ck_Model *model);

// A rope over a ball or across a cylinder: where it lies, and the law by which it slides.

// A chain over the upper half of either. Angles run from the tangent point of its first side over the top.
typedef struct ck_Capstan {
    double center[3];       // m
    double up[3], level[3]; // unit; level points to the last particle's side
    double g, radius, friction;
    double hang[2], weight[2]; // m of rope below the tangent points and kg at their ends, first side and last
    double density;            // kg/m
} ck_Capstan;

// False where the model is none: a chain of equal nodes but for its end weights, over the upper half of one ball
// or across one cylinder, and
// hanging down on both sides to the end, the last side heavier, in gravity alone.
bool ck_capstan_read(ck_Capstan *capstan, const ck_Model *model);

// Where a point of the rope is that lies arc metres after the first tangent point, and which way it moves: [3] m, unit.
void ck_capstan_place(const ck_Capstan *capstan, double arc, double *position, double *direction);

// The arc, m, at which a particle lies at the start: its chords are taken for arcs.
double ck_capstan_arc(const ck_Capstan *capstan, const ck_Model *model, int particle);

// The coefficient of friction with which a rope that has slid so far, m, goes on at speed v while its first end
// accelerates by a up and its last one by b down, by dT/dθ = μ·(T + λ·R·g·sin θ − λ·v²) + λ·R·((a + b)/2 + g·cos θ); 0
// where none is needed. NaN: no such rope. Light, T_2 = T_1·e^(μ·π).
double ck_capstan_friction(const ck_Model *model, double slid, double v, double a, double b);

#ifdef __cplusplus
}
#endif

#endif
