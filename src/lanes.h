// Eight doubles at a time, in plain C: the compiler makes of them what vectors the processor has.
#ifndef CK_LANES_H
#define CK_LANES_H

#include <stdint.h>
#include <string.h>

// Passed between functions that are all inlined, so that the calling convention of vectors does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"

#define CK_LANES 8
#define CK_INLINE static inline __attribute__((always_inline))

// How the innermost loops are compiled: once for each kind of vectors, chosen when the program is loaded.
// Without fused multiply-add (-ffp-contract=off) every clone rounds alike, so that they give the same bits.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(CK_ONE_CLONE)
#define CK_KERNEL __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define CK_KERNEL
#endif

// These may stand at any double and share memory with it.
typedef double ck_Lanes __attribute__((vector_size(64), aligned(8), may_alias));
typedef int64_t ck_LaneMask __attribute__((vector_size(64), aligned(8), may_alias)); // all bits of a lane, or none

typedef struct ck_Lanes3 {
    ck_Lanes x, y, z;
} ck_Lanes3;

CK_INLINE ck_Lanes ck_lanes_load(const double *from) {
    return *(const ck_Lanes *)from;
}

CK_INLINE void ck_lanes_store(double *to, ck_Lanes value) {
    *(ck_Lanes *)to = value;
}

// value where the mask is set, else 0, even where value is not a number.
CK_INLINE ck_Lanes ck_lanes_where(ck_LaneMask mask, ck_Lanes value) {
    return (ck_Lanes)((ck_LaneMask)value & mask);
}

CK_INLINE ck_Lanes ck_lanes_choose(ck_LaneMask mask, ck_Lanes yes, ck_Lanes no) {
    return (ck_Lanes)(((ck_LaneMask)yes & mask) | ((ck_LaneMask)no & ~mask));
}

// Each lane's value goes to the next; the first becomes 0.
CK_INLINE ck_Lanes ck_lanes_next(ck_Lanes value) {
    return __builtin_shuffle((ck_Lanes){0}, value, (ck_LaneMask){0, 8, 9, 10, 11, 12, 13, 14});
}

// 1/√x to some two units in the last place, in products only: a vector's square root and division take four times as
// long. The guess is off by at most 3.5 %; each of four Newton steps turns an error e into 1.5·e².
// Source: Lomont 2003, Fast inverse square root, with the constant for doubles.
CK_INLINE void ck_lanes_inverse_root(ck_Lanes *y, const ck_Lanes *x, const int count) {
    for (int i = 0; i < count; i++) y[i] = (ck_Lanes)(0x5fe6eb50c7b537a9 - ((ck_LaneMask)x[i] >> 1));
    for (int step = 0; step < 4; step++)
        for (int i = 0; i < count; i++) y[i] *= 1.5 - 0.5 * x[i] * y[i] * y[i];
}

CK_INLINE ck_Lanes3 ck_lanes3_load(double *const from[3], long at) {
    return (ck_Lanes3){ck_lanes_load(from[0] + at), ck_lanes_load(from[1] + at), ck_lanes_load(from[2] + at)};
}

CK_INLINE void ck_lanes3_store(double *const to[3], long at, ck_Lanes3 value) {
    ck_lanes_store(to[0] + at, value.x);
    ck_lanes_store(to[1] + at, value.y);
    ck_lanes_store(to[2] + at, value.z);
}

CK_INLINE ck_Lanes3 ck_lanes3_add(ck_Lanes3 a, ck_Lanes3 b) {
    return (ck_Lanes3){a.x + b.x, a.y + b.y, a.z + b.z};
}

CK_INLINE ck_Lanes3 ck_lanes3_subtract(ck_Lanes3 a, ck_Lanes3 b) {
    return (ck_Lanes3){a.x - b.x, a.y - b.y, a.z - b.z};
}

CK_INLINE ck_Lanes3 ck_lanes3_scale(ck_Lanes scale, ck_Lanes3 a) {
    return (ck_Lanes3){scale * a.x, scale * a.y, scale * a.z};
}

CK_INLINE ck_Lanes ck_lanes3_dot(ck_Lanes3 a, ck_Lanes3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

CK_INLINE ck_Lanes3 ck_lanes3_choose(ck_LaneMask mask, ck_Lanes3 yes, ck_Lanes3 no) {
    return (ck_Lanes3){ck_lanes_choose(mask, yes.x, no.x), ck_lanes_choose(mask, yes.y, no.y),
                       ck_lanes_choose(mask, yes.z, no.z)};
}

CK_INLINE ck_Lanes3 ck_lanes3_next(ck_Lanes3 a) {
    return (ck_Lanes3){ck_lanes_next(a.x), ck_lanes_next(a.y), ck_lanes_next(a.z)};
}

#endif
