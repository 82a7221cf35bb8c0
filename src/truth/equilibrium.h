// The rest position of a network as the minimum of its energy, found without any engine's stepping deciding its
// accuracy.
#ifndef CK_EQUILIBRIUM_H
#define CK_EQUILIBRIUM_H

#include "model.h"
#include "status.h"

// The largest residual, as a share of the total weight, that counts as equilibrium.
#define CK_EQUILIBRIUM_RESIDUAL 1e-10

// The residual that a model's positions can come to: that share, or where springs are so stiff that doubles cannot tell
// their lengths that well, the rounding of coordinates times the stiffest spring: ε·k·size·√(3n) / load.
double ck_equilibrium_tolerance(const ck_Model *model);

typedef struct ck_Equilibrium {
    double *position; // [3*n] m
    double residual;  // |Σ force| over free particles / total load
    double energy;    // J, elastic and of the field
    int iterations;   // of Newton
    double gap;       // how far contact is off: gaps that are not there or forces that are, / size
    bool is_minimum;  // the Hessian at position is positive definite
} ck_Equilibrium;

// Minimises ½k(l − L)² + ½s(angle − rest)² − (m·g + F)·x from a start by Newton with a sparse Cholesky factorisation.
// Contact without friction is added as an augmented Lagrangian.
// The full Hessian, with μ·I added only where it is not positive definite (slack springs make it so); line search on
// the energy.
//   start  [3*n] m
// Errors: CK_NO_MEMORY; CK_REFUSED where the model has rigid bars, friction, wind or no pins, or Newton does not get
// there. Free with ck_equilibrium_free in any case.
ck_Status ck_equilibrium_solve(ck_Equilibrium *equilibrium, const ck_Model *model, const double *start,
                               ck_Error *error);

// Where the scene's own release comes to rest: damped dynamics into the basin, then Newton. Minima are not unique, and
// a planar start may sit on a saddle: nudge moves the start of every free coordinate by up to that much, by seed.
//   nudge  m
// Errors: as ck_equilibrium_solve.
ck_Status ck_equilibrium_release(ck_Equilibrium *equilibrium, const ck_Model *model, double nudge, uint64_t seed,
                                 ck_Error *error);

// The energy of any position, J.
double ck_equilibrium_energy(const ck_Model *model, const double *position);

// |Σ force| / total load of any position, but for what the surfaces that it touches can hold: how far from equilibrium
// it is. Infinite where something is inside a surface. Negative: out of memory.
double ck_equilibrium_residual(const ck_Model *model, const double *position);

// The stiffness K of a network about a place, factorised.
typedef struct ck_Stiffness ck_Stiffness;

// Errors: CK_NO_MEMORY; CK_REFUSED where K is not positive definite. The model must outlive it.
ck_Status ck_stiffness_create(ck_Stiffness **stiffness, const ck_Model *model, const double *position);
// By how much it gives under small forces, N: moved, [3*n] m, with K·moved = force; 0 where pinned. Errors:
// CK_NO_MEMORY.
ck_Status ck_stiffness_solve(ck_Stiffness *stiffness, const double *force, double *moved);
// Accepts NULL.
void ck_stiffness_destroy(ck_Stiffness *stiffness);

void ck_equilibrium_free(ck_Equilibrium *equilibrium);

#endif
