// A scene's colliders as the kernels' loops want them.
#ifndef CK_NEAR_SURFACES_H
#define CK_NEAR_SURFACES_H

#include "contact.h"
#include "loops.h"

// Where the colliders are at the start of the substep, [colliders]; how far they move in it counts as nearness.
void ck_near_surfaces(ck_NearSurface *surfaces, const ck_Contact *contact);
// Where they are at its end.
void ck_near_surfaces_at_end(ck_NearSurface *surfaces, const ck_Contact *contact);

#endif
