// A place of a list, three coordinates and a 0, as one vector, and several of them as vectors of lanes. Included by the
// files that are compiled once for each kind of vectors.
#ifndef CK_POINTS_H
#define CK_POINTS_H

#include "lanes.h"
#include "spring_list.h"

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

CK_INLINE ck_Point ck_point_subtract(ck_Point a, ck_Point b) {
    return (ck_Point){a.xy - b.xy, a.z - b.z};
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

CK_INLINE void ck_points_back(ck_Point *points, ck_Lanes3 value) {
    const ck_Lanes none = {0};
    points[0] =
        (ck_Point){__builtin_shufflevector(value.x, value.y, 0, 2), __builtin_shufflevector(value.z, none, 0, 2)};
    points[1] =
        (ck_Point){__builtin_shufflevector(value.x, value.y, 1, 3), __builtin_shufflevector(value.z, none, 1, 3)};
}
#else
typedef double ck_Point __attribute__((vector_size(32), aligned(32), may_alias));

CK_INLINE ck_Point ck_point_load(const double *from) {
    return *(const ck_Point *)from;
}

CK_INLINE void ck_point_store(double *to, ck_Point value) {
    *(ck_Point *)to = value;
}

CK_INLINE ck_Point ck_point_subtract(ck_Point a, ck_Point b) {
    return a - b;
}

CK_INLINE ck_Point ck_point_add_scaled(ck_Point a, double scale, ck_Point b) {
    return (ck_Point)_mm256_fmadd_pd(_mm256_set1_pd(scale), (__m256d)b, (__m256d)a);
}

#if CK_LANES == 4
CK_INLINE ck_Lanes3 ck_points_across(const ck_Point *points) {
    const ck_Point xz = __builtin_shufflevector(points[0], points[1], 0, 4, 2, 6),
                   xz2 = __builtin_shufflevector(points[2], points[3], 0, 4, 2, 6);
    const ck_Point y = __builtin_shufflevector(points[0], points[1], 1, 5, 3, 7),
                   y2 = __builtin_shufflevector(points[2], points[3], 1, 5, 3, 7);
    return (ck_Lanes3){(ck_Lanes)__builtin_shufflevector(xz, xz2, 0, 1, 4, 5),
                       (ck_Lanes)__builtin_shufflevector(y, y2, 0, 1, 4, 5),
                       (ck_Lanes)__builtin_shufflevector(xz, xz2, 2, 3, 6, 7)};
}

CK_INLINE void ck_points_back(ck_Point *points, ck_Lanes3 value) {
    const ck_Lanes none = {0};
    const ck_Lanes xy = __builtin_shufflevector(value.x, value.y, 0, 4, 2, 6),
                   xy2 = __builtin_shufflevector(value.x, value.y, 1, 5, 3, 7),
                   z = __builtin_shufflevector(value.z, none, 0, 4, 2, 6),
                   z2 = __builtin_shufflevector(value.z, none, 1, 5, 3, 7);
    points[0] = (ck_Point)__builtin_shufflevector(xy, z, 0, 1, 4, 5);
    points[1] = (ck_Point)__builtin_shufflevector(xy2, z2, 0, 1, 4, 5);
    points[2] = (ck_Point)__builtin_shufflevector(xy, z, 2, 3, 6, 7);
    points[3] = (ck_Point)__builtin_shufflevector(xy2, z2, 2, 3, 6, 7);
}
#else
// Four pairs are turned at once, each in its halves: the first point and the fifth, and so on.
CK_INLINE ck_Lanes3 ck_points_across(const ck_Point *points) {
    ck_Lanes pairs[4];
    for (int i = 0; i < 4; i++)
        pairs[i] = (ck_Lanes)_mm512_insertf64x4(_mm512_castpd256_pd512((__m256d)points[i]), (__m256d)points[i + 4], 1);
    const ck_Lanes xz = __builtin_shufflevector(pairs[0], pairs[1], 0, 8, 2, 10, 4, 12, 6, 14),
                   xz2 = __builtin_shufflevector(pairs[2], pairs[3], 0, 8, 2, 10, 4, 12, 6, 14),
                   y = __builtin_shufflevector(pairs[0], pairs[1], 1, 9, 3, 11, 5, 13, 7, 15),
                   y2 = __builtin_shufflevector(pairs[2], pairs[3], 1, 9, 3, 11, 5, 13, 7, 15);
    return (ck_Lanes3){__builtin_shufflevector(xz, xz2, 0, 1, 8, 9, 4, 5, 12, 13),
                       __builtin_shufflevector(y, y2, 0, 1, 8, 9, 4, 5, 12, 13),
                       __builtin_shufflevector(xz, xz2, 2, 3, 10, 11, 6, 7, 14, 15)};
}

CK_INLINE void ck_points_back(ck_Point *points, ck_Lanes3 value) {
    const ck_Lanes none = {0};
    const ck_Lanes xy = __builtin_shufflevector(value.x, value.y, 0, 8, 2, 10, 4, 12, 6, 14),
                   xy2 = __builtin_shufflevector(value.x, value.y, 1, 9, 3, 11, 5, 13, 7, 15),
                   z = __builtin_shufflevector(value.z, none, 0, 8, 2, 10, 4, 12, 6, 14),
                   z2 = __builtin_shufflevector(value.z, none, 1, 9, 3, 11, 5, 13, 7, 15);
    const ck_Lanes pairs[] = {__builtin_shufflevector(xy, z, 0, 1, 8, 9, 4, 5, 12, 13),
                              __builtin_shufflevector(xy2, z2, 0, 1, 8, 9, 4, 5, 12, 13),
                              __builtin_shufflevector(xy, z, 2, 3, 10, 11, 6, 7, 14, 15),
                              __builtin_shufflevector(xy2, z2, 2, 3, 10, 11, 6, 7, 14, 15)};
    for (int i = 0; i < 4; i++) {
        points[i] = (ck_Point)_mm512_castpd512_pd256((__m512d)pairs[i]);
        points[i + 4] = (ck_Point)_mm512_extractf64x4_pd((__m512d)pairs[i], 1);
    }
}
#endif
#endif

// As many points as there are lanes, that stand one behind the other.
CK_INLINE ck_Lanes3 ck_points_get(const double *from) {
    ck_Point points[CK_LANES];
    for (int i = 0; i < CK_LANES; i++) points[i] = ck_point_load(from + CK_POINT * i);
    return ck_points_across(points);
}

CK_INLINE void ck_points_put(double *to, ck_Lanes3 value) {
    ck_Point points[CK_LANES];
    ck_points_back(points, value);
    for (int i = 0; i < CK_LANES; i++) ck_point_store(to + CK_POINT * i, points[i]);
}

#endif
