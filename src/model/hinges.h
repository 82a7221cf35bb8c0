// Bending: hinges that resist being turned, by their energy ½·s·(angle − rest)².
//
// A hinge joins three particles in a row, two faces at an edge, or the four corners of a square. Its vector Σ w·x, at
// rest lengths, is as long as 2·sin(angle/2); the square's is how far it is twisted. Lengths are those of the start, as
// of a body that bends and hardly stretches.
// Source: Bergou, Wardetzky, Harmon, Zorin, Grinspun 2006, A quadratic bending model for inextensible surfaces: its
// stencils; the angle's next term, r + r³/24, makes the moment right to the fourth order, and rest angles possible.
#ifndef CK_HINGES_H
#define CK_HINGES_H

#include "model.h"

#ifdef __cplusplus
extern "C" {
#endif

// The angle, rad, of a position [3*n] m; to 3/640 of its fifth power.
double ck_hinge_angle(const ck_Hinge *hinge, const double *position);

// A hinge's energy, and what it pulls its vector with: force on a particle is −w·pull·vector.
typedef struct ck_HingeState {
    double vector[3];
    double energy; // J
    double pull;   // J: dE/dr / r
    double turn;   // J: (d²E/dr² − dE/dr / r) / r², of the second derivative pull·I + turn·vector·vectorᵀ
} ck_HingeState;
ck_HingeState ck_hinge_state(const ck_Hinge *hinge, const double *position);

// The energy of all, J.
double ck_hinges_energy(const ck_Model *model, const double *position);

// Adds factor times their forces, N, each particle's times its own of by, [n]; NULL: 1. With 1/m it is an acceleration,
// with −1 the energy's slope.
//   position  [3*n] in, m;  out  [3*n] in-out
// Cost: one pass over hinges.
void ck_hinges_add_force(const ck_Model *model, const double *position, double factor, const double *by, double *out);

// A bound on the square of the highest frequency of bending about a flat body, rad²/s²: the largest sum of a row of the
// stiffness, scaled by masses; of a long even rope it is that frequency's. Source: Gershgorin 1931. Errors:
// CK_NO_MEMORY.
ck_Status ck_hinges_rate(const ck_Model *model, double *rate);

// The unit of model->bending: N*m of a sheet, N*m2 of a rope.
const char *ck_hinges_unit(const ck_Model *model);

#ifdef __cplusplus
}
#endif

#endif
