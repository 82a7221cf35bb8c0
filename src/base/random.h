// A small seeded generator whose numbers are the same on every machine, which rand() does not promise.
#ifndef CK_RANDOM_H
#define CK_RANDOM_H

#include <stdint.h>

typedef struct ck_Random {
    uint64_t state;
} ck_Random;

static inline ck_Random ck_random_seed(uint64_t seed) {
    return (ck_Random){seed};
}

// Source: Steele, Lea, Flood 2014, SplitMix64.
static inline uint64_t ck_random_next(ck_Random *random) {
    uint64_t z = (random->state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

// Uniform in [0, 1).
static inline double ck_random_unit(ck_Random *random) {
    return (double)(ck_random_next(random) >> 11) * 0x1p-53;
}

#endif
