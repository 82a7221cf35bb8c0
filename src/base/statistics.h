// Order statistics, straight lines and random numbers, by one rule each.
#ifndef CK_STATISTICS_H
#define CK_STATISTICS_H

#include <stdint.h>

// The share-quantile of so many values, by linear interpolation between order statistics; sorts them. NaN without any.
// Source: Hyndman and Fan 1996, type 7, which is R's default.
double ck_quantile(double *values, int count, double share);

// ck_quantile at one half.
double ck_median(double *values, int count);

// The slope of the line of least squares through points; NaN with fewer than two different x.
double ck_slope(const double *x, const double *y, int count);

// Two of the values between which the median of what they are drawn from lies with 95 %, whatever its distribution: the
// least and the most where there are fewer than six. Sorts them; NaN where there are fewer than two, as one says
// nothing of the others.
void ck_median_interval(double *values, int count, double *low, double *high);

// A small seeded generator whose numbers are the same on every machine, which rand() does not promise.

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
