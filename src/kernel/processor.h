// The kinds of vectors that this processor has, by the features that tell x86-64-v3 and v4 from what is below them.
// Not by those names, which Clang knows only from version 18 on.
#ifndef CK_PROCESSOR_H
#define CK_PROCESSOR_H

#include <stdbool.h>

static inline bool ck_processor_has_v3(void) {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
}

static inline bool ck_processor_has_v4(void) {
    return ck_processor_has_v3() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
}

#endif
