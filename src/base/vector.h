// Three-component vectors on plain double arrays, xyz.
#ifndef CK_VECTOR_H
#define CK_VECTOR_H

#include <math.h>

static inline double ck_dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double ck_length(const double *a) {
    return sqrt(ck_dot(a, a));
}

// out = a − b
static inline void ck_subtract(double *out, const double *a, const double *b) {
    for (int axis = 0; axis < 3; axis++) out[axis] = a[axis] - b[axis];
}

// out += scale·a
static inline void ck_add_scaled(double *out, double scale, const double *a) {
    for (int axis = 0; axis < 3; axis++) out[axis] += scale * a[axis];
}

// out = a without its part along the unit vector n
static inline void ck_tangential(double *out, const double *a, const double *n) {
    double along = ck_dot(a, n);
    for (int axis = 0; axis < 3; axis++) out[axis] = a[axis] - along * n[axis];
}

// out = a × b; out is neither of them
static inline void ck_cross(double *out, const double *a, const double *b) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

// out = (b − a) × (c − a): across the triangle of three points, twice as long as its area is large
static inline void ck_triangle_normal(double *out, const double *a, const double *b, const double *c) {
    double one[3], other[3];
    ck_subtract(one, b, a);
    ck_subtract(other, c, a);
    ck_cross(out, one, other);
}

static inline double ck_distance(const double *a, const double *b) {
    double difference[3];
    ck_subtract(difference, a, b);
    return ck_length(difference);
}

#endif
