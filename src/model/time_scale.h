// What is known of a model's time scales before any engine runs.
#ifndef CK_TIME_SCALE_H
#define CK_TIME_SCALE_H

#include "model.h"

#ifdef __cplusplus
extern "C" {
#endif

// An upper bound of the highest angular frequency of the network at its start, in rad/s; 0 without springs.
// max_i √(2·w_i·λ_max(Σ k·n·nᵀ)) over a particle's springs: within 0.6 % for a cloth at rest.
// Cost: one pass over springs. Fails with CK_NO_MEMORY only.
ck_Status ck_stability_frequency(const ck_Model *model, double *frequency);
// The same where its particles are somewhere else, [3*n] m; hinges as at its start.
ck_Status ck_stability_frequency_at(const ck_Model *model, const double *position, double *frequency);

// The longest stable step of velocity Verlet with predicted velocity, in s: 2·(√(b² + ω²) − b)/ω². λ = −1 of one mode
// gives (ω·dt)² + 4·b·dt = 4.
//   damping  b, 1/s, of the mode: by springs (c/k)·ω², and drag
double ck_stability_verlet_limit(double frequency, double damping);

// An upper bound of the fastest rate at which spring damping takes a motion, in 1/s: the largest eigenvalue of M⁻¹·C by
// the rule of ck_stability_frequency. A damping force stepped explicitly is stable up to 2 over that.
double ck_stability_damping_rate(const ck_Model *model);

// The largest c/k of its springs, in s.
double ck_stability_damping_time(const ck_Model *model);

// The largest k·(w_a + w_b) of its springs, in 1/s²: a = that·dt² is what position-based methods scale with.
double ck_stability_stiffness_rate(const ck_Model *model);

// The sum of |gravity·m + force| over particles that are not pinned, in N; 0 without pins and colliders.
// No spring of a hanging body carries much more than this at rest.
double ck_stability_load(const ck_Model *model);

// The largest tension, in N, that a hanging body is likely to carry while it moves: the load, but for a rope on one pin
// that of a pendulum, as it swings through: load·(1 + 2·drop/depth + v²/(g·depth)), where drop is how far its centre of
// mass can fall from the start, depth how far below the pin it then is. A rope's end that cracks like a whip pulls
// more.
double ck_stability_swing_load(const ck_Model *model);

// The largest √(m·d/load): where a spring under full tension is stepped explicitly across its line, no longer step is
// stable. In s; INFINITY without load.
double ck_stability_transverse_time(const ck_Model *model);

// The largest 1/m of particles that are not pinned, in 1/kg.
double ck_stability_lightness(const ck_Model *model);

// The longest step, in s, at which bars held by position projection stretch by no more than 0.1 % under the whole load,
// load·w·dt²/iterations; at most 1/240 s. Substeps act squared where iterations act once.
double ck_stability_bar_time(const ck_Model *model, uint32_t iterations);

// How many sweeps rigid bars want in a substep: one, as substeps act squared where sweeps act once; but four where bars
// outnumber the freedoms they act on. One sweep leaves such a sheet shaking for ever: on a 24×24 curtain jitter falls
// from 1.4 to 0.005 g.
uint32_t ck_stability_sweeps(const ck_Model *model);

// The time in which the fastest bending turns by a radian, s: half of what an explicit step may take. INFINITY without
// hinges; 0 without memory.
double ck_stability_bending_time(const ck_Model *model);

// The longest step, in s, in which drag takes no more than share of a speed; INFINITY without drag.
double ck_stability_drag_time(const ck_Model *model, double share);

// How many equal substeps of at most limit seconds, that follow what moves, make one frame: at least 1, at most 100000.
uint32_t ck_stability_substeps(const ck_Model *model, double limit);

#ifdef __cplusplus
}
#endif

#endif
