// The first message to a viewer: the scene, its engines, and how they are drawn, as JSON.
#ifndef CK_INTRO_H
#define CK_INTRO_H

#include "live.h"

// Places that a frame has of each engine. Bodies have the tips of two axes behind all particles, as in a replay.
size_t ck_intro_shown_count(const ck_Model *model);

// Heap; NULL without memory.
char *ck_intro_make(const ck_Live *live);

#endif
