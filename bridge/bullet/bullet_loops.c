#include "bullet_loops.h"

#include "processor.h"

extern const ck_BulletLoops ck_bullet_loops_plain, ck_bullet_loops_v3;

const ck_BulletLoops *ck_bullet_loops(void) {
#ifdef CK_HAS_v3
    if (ck_processor_has_v3()) return &ck_bullet_loops_v3;
#endif
    return &ck_bullet_loops_plain;
}
