// The second origin: damped springs, forward Euler, a ball and a floor, as it was; each quirk can be mended by itself.
#ifndef CK_SEED_CLOTH_H
#define CK_SEED_CLOTH_H

#include "engine.h"

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
