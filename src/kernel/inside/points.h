// A place of a list, three coordinates and a 0, as one vector, and several of them as vectors of lanes. Included by the
// files that are compiled once for each kind of vectors.
#ifndef CK_POINTS_H
#define CK_POINTS_H

#include "lanes.h"

#if CK_LANES == 2
typedef struct ck_Point {
    ck_Lanes xy, z;
} ck_Point;

CK_INLINE ck_Point ck_point_load(const double *from) {
    return (ck_Point){ck_lanes_load(from), ck_lanes_load(from + 2)};
}

CK_INLINE void ck_point_store(double *to, ck_Point value) {
    ck_lanes_store(to, value.xy);
    ck_lanes_store(to + 2, value.z);
}

CK_INLINE ck_Point ck_point_add(ck_Point a, ck_Point b) {
    return (ck_Point){a.xy + b.xy, a.z + b.z};
}

CK_INLINE ck_Point ck_point_subtract(ck_Point a, ck_Point b) {
    return (ck_Point){a.xy - b.xy, a.z - b.z};
}

CK_INLINE ck_Point ck_point_scale(double scale, ck_Point a) {
    return (ck_Point){scale * a.xy, scale * a.z};
}

// a + scale·b
CK_INLINE ck_Point ck_point_add_scaled(ck_Point a, double scale, ck_Point b) {
    const ck_Lanes all = ck_lanes_all(scale);
    return (ck_Point){ck_lanes_plus(a.xy, all, b.xy), ck_lanes_plus(a.z, all, b.z)};
}

// As many points as there are lanes.
CK_INLINE ck_Lanes3 ck_points_across(const ck_Point *points) {
    return (ck_Lanes3){__builtin_shufflevector(points[0].xy, points[1].xy, 0, 2),
                       __builtin_shufflevector(points[0].xy, points[1].xy, 1, 3),
                       __builtin_shufflevector(points[0].z, points[1].z, 0, 2)};
}
#else
typedef double ck_Point __attribute__((vector_size(32), aligned(32), may_alias));

CK_INLINE ck_Point ck_point_load(const double *from) {
    return *(const ck_Point *)from;
}

CK_INLINE void ck_point_store(double *to, ck_Point value) {
    *(ck_Point *)to = value;
}

CK_INLINE ck_Point ck_point_add(ck_Point a, ck_Point b) {
    return a + b;
}

CK_INLINE ck_Point ck_point_subtract(ck_Point a, ck_Point b) {
    return a - b;
}

CK_INLINE ck_Point ck_point_scale(double scale, ck_Point a) {
    return scale * a;
}

CK_INLINE ck_Point ck_point_add_scaled(ck_Point a, double scale, ck_Point b) {
    return (ck_Point)_mm256_fmadd_pd(_mm256_set1_pd(scale), (__m256d)b, (__m256d)a);
}

typedef struct ck_Points3 {
    ck_Point x, y, z;
} ck_Points3;

// Four points as three vectors.
CK_INLINE ck_Points3 ck_points_turn(const ck_Point *points) {
    const ck_Point xz = __builtin_shufflevector(points[0], points[1], 0, 4, 2, 6),
                   xz2 = __builtin_shufflevector(points[2], points[3], 0, 4, 2, 6);
    const ck_Point y = __builtin_shufflevector(points[0], points[1], 1, 5, 3, 7),
                   y2 = __builtin_shufflevector(points[2], points[3], 1, 5, 3, 7);
    return (ck_Points3){__builtin_shufflevector(xz, xz2, 0, 1, 4, 5), __builtin_shufflevector(y, y2, 0, 1, 4, 5),
                        __builtin_shufflevector(xz, xz2, 2, 3, 6, 7)};
}

#if CK_LANES == 4
CK_INLINE ck_Lanes3 ck_points_across(const ck_Point *points) {
    const ck_Points3 turned = ck_points_turn(points);
    return (ck_Lanes3){(ck_Lanes)turned.x, (ck_Lanes)turned.y, (ck_Lanes)turned.z};
}
#else
CK_INLINE ck_Lanes ck_points_join(ck_Point low, ck_Point high) {
    return (ck_Lanes)_mm512_insertf64x4(_mm512_castpd256_pd512((__m256d)low), (__m256d)high, 1);
}

CK_INLINE ck_Lanes3 ck_points_across(const ck_Point *points) {
    const ck_Points3 low = ck_points_turn(points), high = ck_points_turn(points + 4);
    return (ck_Lanes3){ck_points_join(low.x, high.x), ck_points_join(low.y, high.y), ck_points_join(low.z, high.z)};
}
#endif
#endif

#endif
