// Contact of single particles, for loops over rows that leave them alone.
#ifndef CK_FOLLOWER_H
#define CK_FOLLOWER_H

#include "loops.h"
#include "native.h"

// Of native's own contact. Several threads may call it where no collider moves: then it is only read.
ck_Follower ck_native_follower(ck_Native *native);

#endif
