#include "loops.h"

#ifdef CK_HAS_v3
#include "processor.h"
#endif

#include <stddef.h>

extern const ck_Loops ck_loops_plain, ck_loops_v3, ck_loops_v4;
extern const ck_Loops ck_loops_single_plain, ck_loops_single_v3, ck_loops_single_v4;

// Each processor that has one kind has those below it.
static const ck_Loops *const all[] = {
#ifdef CK_HAS_v4
    &ck_loops_v4,
#endif
#ifdef CK_HAS_v3
    &ck_loops_v3,
#endif
    &ck_loops_plain,
};

const ck_Loops *ck_loops_at(int index) {
#ifdef CK_HAS_v4
    if (!ck_processor_has_v4()) index++;
#endif
#ifdef CK_HAS_v3
    if (!ck_processor_has_v3()) index++;
#endif
    return index < (int)(sizeof all / sizeof *all) ? all[index] : NULL;
}

const ck_Loops *ck_loops_for(uint32_t lanes) {
    int index = 0;
    while (lanes && (uint32_t)ck_loops_at(index)->lanes > lanes && ck_loops_at(index + 1)) index++;
    return ck_loops_at(index);
}

const ck_Loops *ck_loops_single(const ck_Loops *loops) {
#ifdef CK_HAS_v4
    if (loops == &ck_loops_v4) return &ck_loops_single_v4;
#endif
#ifdef CK_HAS_v3
    if (loops == &ck_loops_v3) return &ck_loops_single_v3;
#endif
    return &ck_loops_single_plain;
}
