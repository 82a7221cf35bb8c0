// A scene's cloth or rope with another number of particles.
#ifndef CK_RESIZE_H
#define CK_RESIZE_H

#include "scene.h"

typedef struct ck_SceneResized {
    ck_SceneFile file; // with the parts below in place of the scene's
    ck_SceneCloth cloth;
    ck_SceneRope rope;
    ck_SceneSprings springs;
    double force[3];
} ck_SceneResized;

// Why a scene cannot be had with share times as many segments a row: it is neither cloth nor rope, no whole numbers
// come out, or its pins are numbered and would be others. NULL: it can.
const char *ck_scene_resize_refusal(const ck_SceneFile *file, double share);

// The body keeps its size, its mass, its material and what pushes it. A rope's springs, more of them in a row, have k
// and c in proportion to their number; a sheet's, more in a row and side by side, keep them. from must outlive it.
void ck_scene_resize(ck_SceneResized *resized, const ck_SceneFile *from, double share);

#endif
