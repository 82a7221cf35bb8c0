// The part of lanes.h that is single precision's own; included by it.

#if CK_LANES == 16
typedef __mmask16 ck_LaneMask;

CK_INLINE ck_Lanes ck_lanes_plus(ck_Lanes c, ck_Lanes a, ck_Lanes b) {
    return (ck_Lanes)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c);
}

CK_INLINE ck_Lanes ck_lanes_minus(ck_Lanes c, ck_Lanes a, ck_Lanes b) {
    return (ck_Lanes)_mm512_fnmadd_ps((__m512)a, (__m512)b, (__m512)c);
}

CK_INLINE ck_LaneMask ck_lanes_less(ck_Lanes a, ck_Lanes b) {
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
}

CK_INLINE ck_Lanes ck_lanes_choose(ck_LaneMask mask, ck_Lanes yes, ck_Lanes no) {
    return (ck_Lanes)_mm512_mask_blend_ps(mask, (__m512)no, (__m512)yes);
}

CK_INLINE bool ck_lanes_any_beyond(ck_Lanes a, float limit) {
    return _mm512_cmp_ps_mask((__m512)a, _mm512_set1_ps(limit), _CMP_NLE_UQ) != 0;
}

CK_INLINE unsigned ck_lanes_bits(ck_LaneMask mask) {
    return mask;
}

CK_INLINE ck_Lanes ck_lanes_next(ck_Lanes before, ck_Lanes value) {
    return __builtin_shufflevector(before, value, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30);
}

CK_INLINE ck_Lanes ck_lanes_turn(ck_Lanes value) {
    return __builtin_shufflevector(value, value, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 0);
}
#elif CK_LANES == 8
typedef __m256 ck_LaneMask;

CK_INLINE ck_Lanes ck_lanes_plus(ck_Lanes c, ck_Lanes a, ck_Lanes b) {
    return (ck_Lanes)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c);
}

CK_INLINE ck_Lanes ck_lanes_minus(ck_Lanes c, ck_Lanes a, ck_Lanes b) {
    return (ck_Lanes)_mm256_fnmadd_ps((__m256)a, (__m256)b, (__m256)c);
}

CK_INLINE ck_LaneMask ck_lanes_less(ck_Lanes a, ck_Lanes b) {
    return _mm256_cmp_ps((__m256)a, (__m256)b, _CMP_LT_OQ);
}

CK_INLINE ck_Lanes ck_lanes_choose(ck_LaneMask mask, ck_Lanes yes, ck_Lanes no) {
    return (ck_Lanes)_mm256_blendv_ps((__m256)no, (__m256)yes, mask);
}

CK_INLINE bool ck_lanes_any_beyond(ck_Lanes a, float limit) {
    return _mm256_movemask_ps(_mm256_cmp_ps((__m256)a, _mm256_set1_ps(limit), _CMP_NLE_UQ)) != 0;
}

CK_INLINE unsigned ck_lanes_bits(ck_LaneMask mask) {
    return (unsigned)_mm256_movemask_ps(mask);
}

CK_INLINE ck_Lanes ck_lanes_next(ck_Lanes before, ck_Lanes value) {
    return __builtin_shufflevector(before, value, 7, 8, 9, 10, 11, 12, 13, 14);
}

CK_INLINE ck_Lanes ck_lanes_turn(ck_Lanes value) {
    return __builtin_shufflevector(value, value, 1, 2, 3, 4, 5, 6, 7, 0);
}
#else
typedef ck_LaneBits ck_LaneMask;

CK_INLINE ck_Lanes ck_lanes_plus(ck_Lanes c, ck_Lanes a, ck_Lanes b) {
#ifdef __FP_FAST_FMA
    return (ck_Lanes){__builtin_fmaf(a[0], b[0], c[0]), __builtin_fmaf(a[1], b[1], c[1]),
                      __builtin_fmaf(a[2], b[2], c[2]), __builtin_fmaf(a[3], b[3], c[3])};
#else
    return c + a * b;
#endif
}

CK_INLINE ck_Lanes ck_lanes_minus(ck_Lanes c, ck_Lanes a, ck_Lanes b) {
    return ck_lanes_plus(c, -a, b);
}

CK_INLINE ck_LaneMask ck_lanes_less(ck_Lanes a, ck_Lanes b) {
    return a < b;
}

CK_INLINE ck_Lanes ck_lanes_choose(ck_LaneMask mask, ck_Lanes yes, ck_Lanes no) {
    return (ck_Lanes)(((ck_LaneBits)yes & mask) | ((ck_LaneBits)no & ~mask));
}

CK_INLINE bool ck_lanes_any_beyond(ck_Lanes a, float limit) {
    return !(a[0] <= limit && a[1] <= limit && a[2] <= limit && a[3] <= limit);
}

CK_INLINE unsigned ck_lanes_bits(ck_LaneMask mask) {
    return (unsigned)((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
}

CK_INLINE ck_Lanes ck_lanes_next(ck_Lanes before, ck_Lanes value) {
    return __builtin_shufflevector(before, value, 3, 4, 5, 6);
}

CK_INLINE ck_Lanes ck_lanes_turn(ck_Lanes value) {
    return __builtin_shufflevector(value, value, 1, 2, 3, 0);
}
#endif

// 1/√x, good to two units in the last place or so and the same for the same x, as that of doubles: a guess by Lomont,
// the parabola, and a step of second order.
CK_INLINE void ck_lanes_inverse_root(ck_Lanes *y, const ck_Lanes *x, const int count) {
    static const float c[] = {1.8765983439634224f, 1.252100341927225f, 0.37550221129439404f};
    ck_Lanes t[CK_MOST_TOGETHER], p[CK_MOST_TOGETHER];
    for (int i = 0; i < count; i++) y[i] = (ck_Lanes)(0x5f375a86 - ((ck_LaneBits)x[i] >> 1));
    for (int i = 0; i < count; i++) t[i] = x[i] * y[i] * y[i];
    for (int i = 0; i < count; i++) p[i] = ck_lanes_minus(ck_lanes_all(c[1]), ck_lanes_all(c[2]), t[i]);
    for (int i = 0; i < count; i++) p[i] = ck_lanes_minus(ck_lanes_all(c[0]), p[i], t[i]);
    for (int i = 0; i < count; i++) y[i] *= p[i];
    for (int i = 0; i < count; i++) t[i] = ck_lanes_minus(ck_lanes_all(1), x[i] * y[i], y[i]);
    for (int i = 0; i < count; i++) y[i] = ck_lanes_plus(y[i], y[i] * t[i], ck_lanes_all(0.5f));
}
