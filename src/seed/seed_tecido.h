// The first origin: Verlet particles and rigid bars, as it was, quirks and all; each quirk can be mended by itself.
#ifndef CK_SEED_TECIDO_H
#define CK_SEED_TECIDO_H

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

#endif
