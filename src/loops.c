#include "loops.h"

#include <stddef.h>

ck_ExplicitRow ck_explicit_row_plain, ck_explicit_row_v3, ck_explicit_row_v4;
ck_ProjectionWave ck_projection_wave_plain, ck_projection_wave_v3, ck_projection_wave_v4;
ck_Peak ck_peak_plain, ck_peak_v3, ck_peak_v4;

#ifdef __FP_FAST_FMA
#define PLAIN_FUSES true
#else
#define PLAIN_FUSES false
#endif

// Each processor that has one kind has those below it.
static const ck_Loops all[] = {
#ifdef CK_HAS_X86_VECTORS
    {"x86-64-v4", 8, true, ck_explicit_row_v4, ck_projection_wave_v4, ck_peak_v4},
    {"x86-64-v3", 4, true, ck_explicit_row_v3, ck_projection_wave_v3, ck_peak_v3},
#endif
    {"plain", 2, PLAIN_FUSES, ck_explicit_row_plain, ck_projection_wave_plain, ck_peak_plain},
};

const ck_Loops *ck_loops_at(int index) {
#ifdef CK_HAS_X86_VECTORS
    if (!__builtin_cpu_supports("x86-64-v4")) index++;
    if (!__builtin_cpu_supports("x86-64-v3")) index++;
#endif
    return index < (int)(sizeof all / sizeof *all) ? &all[index] : NULL;
}

const ck_Loops *ck_loops_for(uint32_t lanes) {
    int index = 0;
    while (lanes && (uint32_t)ck_loops_at(index)->lanes > lanes && ck_loops_at(index + 1)) index++;
    return ck_loops_at(index);
}
