// The words for what a scene may have, in the order of ck_Term.
#ifndef CK_OUTSIDE_WORDS_H
#define CK_OUTSIDE_WORDS_H

#include "model.h"

static const char *const ck_term_words[CK_TERM_COUNT] = {
    "springs", "rigid",   "damping", "gravity", "force", "drag",  "velocity",         "plane",
    "sphere",  "release", "bending", "wind",    "slack", "moves", "moving_colliders", "solids",
    "bodies",  "uneven",  "changes"};

#endif
