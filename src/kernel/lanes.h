// As many numbers at a time as the processor's vectors hold, in C but for a product and a choice. Included by the files
// that are compiled once for each kind of vectors (see loops.h), and by their test.
#ifndef CK_LANES_H
#define CK_LANES_H

#include "rows.h"

#include <stdint.h>
#ifdef __FMA__
#include <immintrin.h>
#endif

// Passed between functions of one file, so that the calling convention of vectors does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"

// Wider than the processor's, the compiler would take vectors apart through memory, ten times slower than narrow ones.
#if defined(__AVX512F__) && defined(__FMA__)
#define CK_VECTOR_BYTES 64
#elif defined(__AVX2__) && defined(__FMA__)
#define CK_VECTOR_BYTES 32
#else
#define CK_VECTOR_BYTES 16
#endif

// Products and sums are rounded once.
#if CK_VECTOR_BYTES > 16 || defined(__FP_FAST_FMA)
#define CK_FUSES true
#else
#define CK_FUSES false
#endif

// The name of a loop in this compilation: CK_VECTORS says for which vectors it is.
#define CK_LOOP(name) CK_LOOP_OF(name, CK_VECTORS)
#define CK_LOOP_OF(name, vectors) CK_LOOP_JOIN(name, vectors)
#define CK_LOOP_JOIN(name, vectors) name##_##vectors

// Springs that go through each operation of a root together, at most.
#define CK_MOST_TOGETHER 4

// These may stand at any number and share memory with it.
#ifdef CK_SINGLE
#define CK_LANES (CK_VECTOR_BYTES / 4)
#define CK_LANE_BITS_BUT_SIGN INT32_MAX
typedef int32_t ck_LaneBit;
#else
#define CK_LANES (CK_VECTOR_BYTES / 8)
#define CK_LANE_BITS_BUT_SIGN INT64_MAX
typedef int64_t ck_LaneBit;
#endif
typedef ck_Real ck_Lanes __attribute__((vector_size(CK_VECTOR_BYTES), aligned(sizeof(ck_Real)), may_alias));
typedef ck_LaneBit ck_LaneBits __attribute__((vector_size(CK_VECTOR_BYTES), aligned(sizeof(ck_Real)), may_alias));

typedef struct ck_Lanes3 {
    ck_Lanes x, y, z;
} ck_Lanes3;

CK_INLINE ck_Lanes ck_lanes_load(const ck_Real *from) {
    return *(const ck_Lanes *)from;
}

CK_INLINE void ck_lanes_store(ck_Real *to, ck_Lanes value) {
    *(ck_Lanes *)to = value;
}

CK_INLINE ck_Lanes ck_lanes_all(ck_Real value) {
    return value - (ck_Lanes){0};
}

// What C has no words for. c + a·b and c − a·b are rounded once where the processor can: named outright and not left to
// the compiler (-ffp-contract=off), whose choice depends on what else uses a product. So all that fuse give the same
// bits. A mask is what a comparison leaves for a choice; its bits, the first lane's lowest. What is no number is beyond
// any limit. Where each lane goes to the next, the first comes from the vector before; turned, each has what the next
// had, and the last one the first's.
#ifdef CK_SINGLE
#include "lanes_single.h"
#else
#include "lanes_double.h"
#endif

CK_INLINE ck_Lanes ck_lanes_absolute(ck_Lanes a) {
    return (ck_Lanes)((ck_LaneBits)a & CK_LANE_BITS_BUT_SIGN);
}

// Three coordinates that stand so far apart.
CK_INLINE ck_Lanes3 ck_lanes3_load_apart(const ck_Real *from, long apart) {
    return (ck_Lanes3){ck_lanes_load(from), ck_lanes_load(from + apart), ck_lanes_load(from + 2 * apart)};
}

CK_INLINE void ck_lanes3_store_apart(ck_Real *to, long apart, ck_Lanes3 value) {
    ck_lanes_store(to, value.x);
    ck_lanes_store(to + apart, value.y);
    ck_lanes_store(to + 2 * apart, value.z);
}

// A vector of a tile, whose coordinates stand a stripe apart.
CK_INLINE ck_Lanes3 ck_lanes3_load(const ck_Real *from) {
    return ck_lanes3_load_apart(from, CK_STRIPE);
}

CK_INLINE void ck_lanes3_store(ck_Real *to, ck_Lanes3 value) {
    ck_lanes3_store_apart(to, CK_STRIPE, value);
}

CK_INLINE ck_Lanes3 ck_lanes3_all(const ck_Real value[3]) {
    return (ck_Lanes3){ck_lanes_all(value[0]), ck_lanes_all(value[1]), ck_lanes_all(value[2])};
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

// a + scale·b
CK_INLINE ck_Lanes3 ck_lanes3_add_scaled(ck_Lanes3 a, ck_Lanes scale, ck_Lanes3 b) {
    return (ck_Lanes3){ck_lanes_plus(a.x, scale, b.x), ck_lanes_plus(a.y, scale, b.y), ck_lanes_plus(a.z, scale, b.z)};
}

// a − scale·b
CK_INLINE ck_Lanes3 ck_lanes3_subtract_scaled(ck_Lanes3 a, ck_Lanes scale, ck_Lanes3 b) {
    return (ck_Lanes3){ck_lanes_minus(a.x, scale, b.x), ck_lanes_minus(a.y, scale, b.y),
                       ck_lanes_minus(a.z, scale, b.z)};
}

CK_INLINE ck_Lanes ck_lanes3_dot(ck_Lanes3 a, ck_Lanes3 b) {
    return ck_lanes_plus(ck_lanes_plus(a.x * b.x, a.y, b.y), a.z, b.z);
}

CK_INLINE ck_Lanes3 ck_lanes3_next(ck_Lanes3 before, ck_Lanes3 a) {
    return (ck_Lanes3){ck_lanes_next(before.x, a.x), ck_lanes_next(before.y, a.y), ck_lanes_next(before.z, a.z)};
}

CK_INLINE ck_Lanes3 ck_lanes3_turn(ck_Lanes3 a) {
    return (ck_Lanes3){ck_lanes_turn(a.x), ck_lanes_turn(a.y), ck_lanes_turn(a.z)};
}

CK_INLINE ck_Lanes3 ck_lanes3_choose(ck_LaneMask mask, ck_Lanes3 yes, ck_Lanes3 no) {
    return (ck_Lanes3){ck_lanes_choose(mask, yes.x, no.x), ck_lanes_choose(mask, yes.y, no.y),
                       ck_lanes_choose(mask, yes.z, no.z)};
}

#endif
