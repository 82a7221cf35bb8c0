// The two origins as they were, quirks and all; each quirk can be mended by itself. The first: Verlet particles and
// rigid bars.
#ifndef CK_SEED_H
#define CK_SEED_H

#include "engine.h"

// The number of its own setting.
#define CK_TECIDO_MENDED 0

// What the original does otherwise than physics; bits of its own setting CK_TECIDO_MENDED.
typedef enum ck_TecidoQuirk {
    CK_TECIDO_HALF_CORRECTION = 1 << 0, // of a bar with one locked end, the free end gets half
    CK_TECIDO_MASSLESS_BARS = 1 << 1,   // both ends of a bar move alike, whatever their masses
    CK_TECIDO_UNSCALED_STEP = 1 << 2,   // the way of the last step is repeated, however long that step was
    CK_TECIDO_STALE_VELOCITY = 1 << 3,  // a particle that is unlocked flies on as when it was locked
    CK_TECIDO_NEW_DIRECTION = 1 << 4,   // bars are corrected along their new direction, which takes energy
    CK_TECIDO_INTERLEAVED = 1 << 5,     // bars of all kinds mixed: one sweep shakes itself to pieces
    CK_TECIDO_ONE_WAY = 1 << 6,         // every sweep runs the same way, and pulls the cloth to one side
    CK_TECIDO_QUIRK_COUNT = 7,
} ck_TecidoQuirk;

extern const char *const ck_tecido_quirk_names[CK_TECIDO_QUIRK_COUNT];

typedef struct ck_Tecido ck_Tecido;

// The engine's own state, for steps that are not all alike and locks that come and go.
// Errors: CK_NO_MEMORY. Free with ck_tecido_destroy.
ck_Status ck_tecido_create(ck_Tecido **tecido, const ck_Model *model, const ck_Settings *used, ck_Error *error);
void ck_tecido_destroy(ck_Tecido *tecido);

// One step of h seconds.
void ck_tecido_step(ck_Tecido *tecido, double h);

// Locks a particle where it is, or lets it go.
void ck_tecido_lock(ck_Tecido *tecido, int particle, bool locked);

// [3*n] m; and m/s, the way of the last step by its length.
const double *ck_tecido_position(const ck_Tecido *tecido);
void ck_tecido_velocity(const ck_Tecido *tecido, double *velocity);

// The second origin: damped springs, forward Euler, a ball and a floor, as it was; each quirk can be mended by itself.

// The number of its own setting.
#define CK_CLOTH_MENDED 0

// What the original does otherwise than physics; bits of its own setting CK_CLOTH_MENDED.
typedef enum ck_ClothQuirk {
    CK_CLOTH_FORWARD_EULER = 1 << 0,    // moves by the speed before this step's forces
    CK_CLOTH_FORCE_FRICTION = 1 << 1,   // friction of what presses, where an impact's impulse is wanted
    CK_CLOTH_RUBBED_REBOUND = 1 << 2,   // friction also takes from the speed of the rebound
    CK_CLOTH_PULLING_NORMAL = 1 << 3,   // a force away from the surface makes friction push
    CK_CLOTH_ONE_TOLERANCE = 1 << 4,    // the same number for a length and a speed
    CK_CLOTH_GLUE = 1 << 5,             // what is near is put on the surface even where it leaves
    CK_CLOTH_SMOOTH_FLOOR = 1 << 6,     // planes have no friction
    CK_CLOTH_COINCIDENT_NODES = 1 << 7, // two nodes at one place make not a number
    CK_CLOTH_QUIRK_COUNT = 8,
} ck_ClothQuirk;

extern const char *const ck_cloth_quirk_names[CK_CLOTH_QUIRK_COUNT];

// One particle against one collider, once it has moved: what the substep does with it.
//   x, v   in-out, m and m/s;  force  on it, N;  dt  s, one substep
void ck_seed_cloth_collide(const ck_Collider *collider, uint32_t mended, double dt, double mass, const double *force,
                           double *x, double *v);

#endif
