// What the native engines share: the state of the particles, and the ledger's common rows.
#ifndef CK_NATIVE_H
#define CK_NATIVE_H

#include "contact.h"
#include "engine.h"
#include "own_ledger.h"
#include "rigid_contact.h"

struct ck_Chain;
struct ck_ProjectedCloth;
struct ck_RowContact;
struct ck_SweepList;
struct ck_Waves;

typedef struct ck_Native {
    const ck_Model *model;
    double dt;   // s, one substep
    double last; // s, the one before: another where steps are uneven
    ck_Settings used;
    uint32_t substeps, iterations;
    double begun;                    // s, since when substeps are of this dt
    uint64_t done;                   // substeps since then
    double *position, *velocity;     // [3*n]
    double *start;                   // [3*n] positions at the start of the substep
    double *origin;                  // [3*n] what a substep's velocity is measured from: start, but for impacts
    double *other_velocity;          // [3*n] predicted (Verlet), or of one substep earlier (bars)
    double *acceleration;            // [3*n]
    double *inverse_mass;            // [n]
    double *multiplier;              // [springs] of the constraints, kg·m (force·dt²)
    double *compliance, *gamma;      // [springs] XPBD's α̃ and γ̃, else NULL
    double *bending;                 // [3*hinges] XPBD's multipliers of hinges, N·s²; NULL without
    ck_Contact *contact;             // NULL without colliders
    struct ck_RowContact *beside;    // of a position-based method, for its list of springs; NULL without
    ck_RigidContact *rigid;          // NULL without rigid bodies
    struct ck_Waves *waves;          // NULL: one thread
    struct ck_ProjectedCloth *cloth; // NULL: the list of springs
    struct ck_SweepList *sweeps;     // over that list, in vectors; NULL: one by one
    struct ck_Explicit *springs;     // of native-verlet alone
    struct ck_Chain *chain;          // of native-lines alone; NULL: a cloth
} ck_Native;

// The numbers of the natives' own settings: the most doubles of an instruction; native-verlet's error a second that a
// substep may make, as a share of the size; and single precision.
#define CK_NATIVE_VECTORS 0
#define CK_NATIVE_TOLERANCE 1
#define CK_NATIVE_SINGLE 2

// Rows of their tables that are the same in all of them.
#define CK_NATIVE_VECTORS_ROW                                                                                          \
    {                                                                                                                  \
        .name = "vectors", .slot = CK_OWN + CK_NATIVE_VECTORS, .is_whole = true, .least = 2, .most = 64, .unit = "1",  \
        .rule = "the processor's widest", .help = "doubles of an instruction at most"                                  \
    }
#define CK_NATIVE_SINGLE_ROW                                                                                           \
    {                                                                                                                  \
        .name = "single", .slot = CK_OWN + CK_NATIVE_SINGLE, .is_whole = true, .least = 0, .most = 1, .unit = "1",     \
        .rule = "0: double precision",                                                                                 \
        .help = "1: single precision from an origin that moves with the cloth, on regular cloths",                     \
        .leaves_theory = true                                                                                          \
    }

// Terms that every native engine models.
#define CK_NATIVE_TERMS                                                                                                \
    (CK_TERM_SPRINGS | CK_TERM_DAMPING | CK_TERM_GRAVITY | CK_TERM_FORCE | CK_TERM_DRAG | CK_TERM_VELOCITY |           \
     CK_TERM_COLLIDERS | CK_TERM_RELEASE | CK_TERM_MOVES | CK_TERM_MOVING_COLLIDERS | CK_TERM_JITTER)

// Allocates and sets the start state. Errors: CK_NO_MEMORY.
ck_Status ck_native_create(ck_Native **native, const ck_Model *model, const ck_Settings *used, ck_Error *error);
void ck_native_destroy(void *state);

// Copies position and velocity out, for engines whose velocity stands at the time of their positions.
void ck_native_read(const void *state, double *position, double *velocity);

// Forgets the contact force of the frame before.
void ck_native_start_frame(ck_Native *native);

// The loops over rows of the vectors that are set, or of the widest, in the precision that is set; and those of
// doubles, in which contact is in either.
const struct ck_Loops *ck_native_loops(const ck_Native *native);
const struct ck_Loops *ck_native_doubles(const ck_Native *native);

// Refuses single precision where a model is not all in rows.
ck_Status ck_native_check_precision(const ck_Settings *used, bool is_in_rows, ck_Error *error);

// Notes the positions at the start of a substep.
void ck_native_start_substep(ck_Native *native);

// Puts the pins that move where they are at the end of the substep: once in each. Then gives them their velocity, and
// the other one.
void ck_native_drive(ck_Native *native);
void ck_native_drive_speed(ck_Native *native);

// s, of the scene: where its pins and colliders that move are.
double ck_native_time(const ck_Native *native);

// Sets how long the substeps of the next steps are, s, or how long the steps.
void ck_native_set_step(ck_Native *native, double dt);
void ck_native_pace(void *state, double duration);

// Lets a pinned particle go, with the speed it has.
void ck_native_release(void *state, int particle);

// The mean force of the colliders on the body over the last frame, [3] N.
void ck_native_contact(const void *state, double *force);

// For position-based methods where there are colliders: says that a particle is to move by one substep at the mean
// velocity next of that substep, [3] m/s, with field, [3] m/s², in between. Then moves all that were aimed; what meets
// a collider over its impacts, which also set its origin.
void ck_native_aim(ck_Native *native, int particle, const double *next, const double *field);
void ck_native_fly(ck_Native *native);

// Where there are rigid bodies: their impulses, with what is to move each particle in the substep, [3] m/s, and its
// speed at its start given by a function, and how bodies turn.
void ck_native_meet(ck_Native *native,
                    void (*speeds)(const ck_Native *native, int particle, double *drift, double *now));
void ck_native_turn(const void *state, ck_Turn *turn);

// Moves every particle that is inside a collider or a rigid body out of it, with friction.
void ck_native_project(ck_Native *native);

// False where any coordinate has left the finite numbers.
bool ck_native_is_finite(const ck_Native *native);

#endif
