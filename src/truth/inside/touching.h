// Contact without friction as an energy that is least where nothing is inside: an augmented Lagrangian.
//
// Each pair of a particle and a surface has a force λ ≥ 0, N, and the energy (max(0, λ − κ·gap)² − λ²)/(2κ). With the
// energy of springs at its least, λ is set to max(0, λ − κ·gap), again and again, until gaps and forces fit: then the
// energy of contact is none. Source: Hestenes 1969, Powell 1969; for inequalities Rockafellar 1973.
#ifndef CK_TOUCHING_H
#define CK_TOUCHING_H

#include "model.h"

typedef struct ck_TouchingPair {
    int particle, other; // other: a rigid body's particle; −1: a collider
    int collider;        // −1: a rigid body
    double apart;        // m, of the two where they touch: radii of bodies
    double force;        // N, λ
} ck_TouchingPair;

typedef struct ck_Touching {
    ck_Collider *colliders;
    ck_TouchingPair *pairs;
    int count;
    double stiffness; // N/m, κ
} ck_Touching;

// What can rest on what in a model; NULL: nothing. Rigid bodies are spheres, with their centres for particles.
//   origin     [3] m: positions are from there
//   stiffness  N/m
// Errors: CK_NO_MEMORY. Free with ck_touching_free.
ck_Status ck_touching_create(ck_Touching **touching, const ck_Model *model, const double *origin, double stiffness);
void ck_touching_free(ck_Touching *touching);

// The energy, J; gradient: [3*n] N, to which its own is added, or NULL.
double ck_touching_energy(const ck_Touching *touching, const double *position, double *gradient);

// Writes the second derivative of a pair by its particle's place, [9] N/m; by the other's it is the same, and by both
// its opposite. False where it is 0.
bool ck_touching_block(const ck_Touching *touching, const ck_TouchingPair *pair, const double *position, double *block);

// Takes from a gradient, [3*n] N, what surfaces that are touched can hold: of each particle no further away than near,
// m, the part that presses on it, which the other of the two gets. False where one is deeper inside than near.
bool ck_touching_hold(const ck_Touching *touching, const double *position, double near, double *gradient);

// Sets the forces anew. Returns how far gaps and forces do not fit, m.
double ck_touching_update(ck_Touching *touching, const double *position);

#endif
