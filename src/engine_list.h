// Every engine that is linked in.
#ifndef CK_ENGINE_LIST_H
#define CK_ENGINE_LIST_H

#include "engine.h"

#ifdef __cplusplus
extern "C" {
#endif

extern const ck_Engine ck_native_verlet, ck_native_narrow, ck_native_bars, ck_native_xpbd, ck_native_rope;
extern const ck_Engine ck_seed_tecido, ck_seed_cloth;
extern const ck_Engine ck_bullet_pbd, ck_bullet_implicit, ck_bullet_explicit;
extern const ck_Engine ck_ode_quick, ck_ode_direct;
extern const ck_Engine ck_still;

#ifdef __cplusplus
}
#endif

#endif
