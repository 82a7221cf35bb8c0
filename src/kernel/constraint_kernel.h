// Position constraints on a regular cloth, Gauss–Seidel over rows: rigid bars and compliant springs (XPBD).
//
// A substep: x ← x + (carry·v + push)·dt; sweeps; v ← keep·(x − x_start)/dt. Where there are surfaces, impacts come in
// the flight, from which the speed is then measured, and each sweep ends with what surfaces push out; see
// row_contact.h. In each sweep the springs of a row are corrected vector by vector of eight, however wide the
// processor's are: those along it from even columns of a run, then from odd ones; then of bars those to the next row,
// straight down, down right and down left, of springs those down right and down left, and straight down from the row
// above. Sweeps go down the rows; but of several over bars one half goes from the first and the last row to the middle,
// the other half the same way back. That is the order of ck_sweep_order and ck_sweep_is_turned.
//
// Lines: a sweep solves all springs of a line together, (∇C·M⁻¹·∇Cᵀ + 2·α̃/(1 + γ̃))·Δλ = (−C − 2·α̃·λ − γ̃·∇C·(x −
// x_start))/(1 + γ̃), which is tridiagonal, the 2 being of CK_LINES_KEPT: first each row, then each diagonal down right
// and down left, then each column. So what pulls at a line's end is felt at its other end at once. One thread alone
// does that, sweep by sweep: a second one would find half of each kind's particles in the other processor's cache, and
// at 64×64 both took twice as long as one. Source of the rule: Macklin, Müller, Chentanez 2016, eq. 18 and 26; of the
// elimination: Thomas 1949.
#ifndef CK_CONSTRAINT_KERNEL_H
#define CK_CONSTRAINT_KERNEL_H

#include "loops.h"
#include "rows.h"
#include "status.h"
#include "sweep_order.h"
#include "waves.h"

// From that l²/L² on a bar is long, and below that d·d_start/L² it has turned (by 66° where its length is kept). Others
// are corrected with L² in the place of d·d_start, by one and a half times their strain too much: with 1.4 a sheet of
// 20×20 rigid bars at 2 ms and 20 sweeps shook to pieces, with 1.2 it held.
#define CK_LONG_BAR 1.2
#define CK_TURNED_BAR 0.4

// The share of what the last substep's constraints moved particles by that lines begin a substep with, and leave to it.
// Its multipliers are then those of the last one, halved, and what it finds; with α̃/(1 − kept) for these, a spring
// obeys C_next = −α̃·(2·λ − λ_last), its force carried on to the substep's end: of second order in dt, where XPBD's
// C_next = −α̃·λ is of first; dampers stay of first order, as a line sees rates before the other kinds' lines. What is
// pulled has on average the direction that it has at the substep's start. A sweep that leaves a share 1 − δ of an error
// swings it by √(δ/(1 − kept)) a substep, twice as much as without; that grows where kept is above a half, and decays
// below.
#define CK_LINES_KEPT 0.5

// The rate at a substep's end is this times its mean in the substep, less 0.5 times its mean in the last one. So
// dampers of a chain, whose rates one line finds all of, are of the second order, too.
#define CK_LINES_RATE 1.5

typedef struct ck_ProjectionRule {
    ck_Projection projection;
    double dt;
    uint32_t iterations;
    double carry, push[3]; // 1 and m/s
    double keep;
    double compliance; // m/N of every spring; 0: 1/k of each
    double relaxation; // times which each correction is made: 1, or up to 2 for fewer sweeps; lines know 1 alone
} ck_ProjectionRule;

typedef struct ck_ProjectedCloth ck_ProjectedCloth;

// True where the kernel takes a model: a regular cloth without bending springs, and colliders that stay.
bool ck_projection_fits(const ck_Model *model, ck_RowSprings *springs);

// Where a cloth is at the start of a substep.
//   position, velocity, before  [3*n] m, m/s, and m/s a substep earlier
//   inverse_mass                [n] 1/kg, 0 where pinned
//   beside                      what its particles may touch, in their order; NULL: nothing
//   last                        the same cloth as it was laid out before, from which it goes on; NULL: it starts
typedef struct ck_ProjectionSetup {
    const ck_Loops *loops;
    const ck_Model *model;
    const ck_RowSprings *springs;
    const ck_ProjectionRule *rule;
    const double *position, *velocity, *before, *inverse_mass;
    const struct ck_RowContact *beside;
    const ck_ProjectedCloth *last;
} ck_ProjectionSetup;

// In the precision of the loops: in single precision, places are told from an origin that moves with the cloth, and
// what a substep moves them by from where it starts, so that short steps cost no digits. Surfaces are copied. Memory:
// 10 numbers a particle, 3 more in single precision, 8 doubles more where there are surfaces (20 for lines and in
// single precision, and there 3 numbers more for rows), four more for lines, and one a spring for XPBD and lines with
// several sweeps. Errors: CK_NO_MEMORY. Free with ck_projection_destroy.
ck_Status ck_projection_create(ck_ProjectedCloth **cloth, const ck_ProjectionSetup *setup, ck_Error *error);
void ck_projection_destroy(ck_ProjectedCloth *cloth);

// As many substeps, without allocation; sweeps run interleaved, a row or more apart, which changes no result.
// The same bits however many threads share the waves, of which two find work where bars are swept several times; on
// which processors, loops.h says.
void ck_projection_step(ck_ProjectedCloth *cloth, uint32_t substeps, ck_Waves *waves);

// [3*n] m, m/s, m/s: before is the velocity of the last substep but one.
void ck_projection_read(const ck_ProjectedCloth *cloth, double *position, double *velocity, double *before);

// What surfaces have given the cloth in the last call of ck_projection_step, [3] N·s.
void ck_projection_impulse(const ck_ProjectedCloth *cloth, double *impulse);

#endif
