// Contact of single particles, for loops over rows that leave them alone.
#ifndef CK_FOLLOWER_H
#define CK_FOLLOWER_H

#include "loops.h"
#include "native.h"

// Of native's own contact, which it only reads, so that several threads may call it.
ck_Follower ck_native_follower(ck_Native *native);

#endif
