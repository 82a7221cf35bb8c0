// Air on faces: drag along the wind that a face feels, and lift across it.
#ifndef CK_WIND_H
#define CK_WIND_H

#include "model.h"

#ifdef __cplusplus
extern "C" {
#endif

// The force on a face, [3] N, of which each corner takes a third. With u the air's velocity as the face's middle feels
// it, A its area and s = |n·u|/|u|: drag ½·ρ·C_d·A·s·|u|²  along u, lift ½·ρ·C_l·A·s·|u|² times the normal's part
// across u. Face on, C_d is the usual coefficient of a plate.
//   position, velocity  [3*n] in, m and m/s
// Source: Keckeisen, Kimmerle, Thomaszewski, Wacker 2004, Modelling effects of wind fields in cloth animations.
void ck_wind_face_force(const ck_Model *model, int face, const double *position, const double *velocity, double *force);

// Adds the force on every face to its corners, N, each particle's times its own of by, [n]; NULL: 1.
//   out  [3*n] in-out
// Cost: one pass over faces.
void ck_wind_add_force(const ck_Model *model, const double *position, const double *velocity, const double *by,
                       double *out);

// Adds each particle's third of the area of the faces around it, m², to share [n]. Returns the sum.
double ck_wind_share_area(const ck_Model *model, double *share);

// A bound on the rate, 1/s, at which air takes a particle's speed: ρ·(C_d + C_l)·A·|u|/m of the one with the most area
// for its mass, at the fastest that it blows or the body falls. INFINITY without memory.
double ck_wind_rate(const ck_Model *model);

// True where the air itself moves, and so gives energy.
bool ck_wind_blows(const ck_Model *model);

#ifdef __cplusplus
}
#endif

#endif
