// The part of lanes.h that is doubles' own; included by it.

#if CK_LANES == 8
typedef __mmask8 ck_LaneMask;

CK_INLINE ck_Lanes ck_lanes_plus(ck_Lanes c, ck_Lanes a, ck_Lanes b) {
    return (ck_Lanes)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
}

CK_INLINE ck_Lanes ck_lanes_minus(ck_Lanes c, ck_Lanes a, ck_Lanes b) {
    return (ck_Lanes)_mm512_fnmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
}

CK_INLINE ck_LaneMask ck_lanes_less(ck_Lanes a, ck_Lanes b) {
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
}

CK_INLINE ck_Lanes ck_lanes_choose(ck_LaneMask mask, ck_Lanes yes, ck_Lanes no) {
    return (ck_Lanes)_mm512_mask_blend_pd(mask, (__m512d)no, (__m512d)yes);
}

CK_INLINE bool ck_lanes_any_beyond(ck_Lanes a, double limit) {
    return _mm512_cmp_pd_mask((__m512d)a, _mm512_set1_pd(limit), _CMP_NLE_UQ) != 0;
}

CK_INLINE unsigned ck_lanes_bits(ck_LaneMask mask) {
    return mask;
}

CK_INLINE ck_Lanes ck_lanes_next(ck_Lanes before, ck_Lanes value) {
    return __builtin_shufflevector(before, value, 7, 8, 9, 10, 11, 12, 13, 14);
}

CK_INLINE ck_Lanes ck_lanes_turn(ck_Lanes value) {
    return __builtin_shufflevector(value, value, 1, 2, 3, 4, 5, 6, 7, 0);
}
#elif CK_LANES == 4
typedef __m256d ck_LaneMask;

CK_INLINE ck_Lanes ck_lanes_plus(ck_Lanes c, ck_Lanes a, ck_Lanes b) {
    return (ck_Lanes)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
}

CK_INLINE ck_Lanes ck_lanes_minus(ck_Lanes c, ck_Lanes a, ck_Lanes b) {
    return (ck_Lanes)_mm256_fnmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
}

CK_INLINE ck_LaneMask ck_lanes_less(ck_Lanes a, ck_Lanes b) {
    return _mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_LT_OQ);
}

CK_INLINE ck_Lanes ck_lanes_choose(ck_LaneMask mask, ck_Lanes yes, ck_Lanes no) {
    return (ck_Lanes)_mm256_blendv_pd((__m256d)no, (__m256d)yes, mask);
}

CK_INLINE bool ck_lanes_any_beyond(ck_Lanes a, double limit) {
    return _mm256_movemask_pd(_mm256_cmp_pd((__m256d)a, _mm256_set1_pd(limit), _CMP_NLE_UQ)) != 0;
}

CK_INLINE unsigned ck_lanes_bits(ck_LaneMask mask) {
    return (unsigned)_mm256_movemask_pd(mask);
}

CK_INLINE ck_Lanes ck_lanes_next(ck_Lanes before, ck_Lanes value) {
    return __builtin_shufflevector(before, value, 3, 4, 5, 6);
}

CK_INLINE ck_Lanes ck_lanes_turn(ck_Lanes value) {
    return __builtin_shufflevector(value, value, 1, 2, 3, 0);
}
#else
typedef ck_LaneBits ck_LaneMask;

CK_INLINE ck_Lanes ck_lanes_plus(ck_Lanes c, ck_Lanes a, ck_Lanes b) {
#ifdef __FP_FAST_FMA
    return (ck_Lanes){__builtin_fma(a[0], b[0], c[0]), __builtin_fma(a[1], b[1], c[1])};
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

CK_INLINE bool ck_lanes_any_beyond(ck_Lanes a, double limit) {
    return !(a[0] <= limit && a[1] <= limit);
}

CK_INLINE unsigned ck_lanes_bits(ck_LaneMask mask) {
    return (unsigned)((mask[0] & 1) | (mask[1] & 2));
}

CK_INLINE ck_Lanes ck_lanes_next(ck_Lanes before, ck_Lanes value) {
    return __builtin_shufflevector(before, value, 1, 2);
}

CK_INLINE ck_Lanes ck_lanes_turn(ck_Lanes value) {
    return __builtin_shufflevector(value, value, 1, 0);
}
#endif

// 1/√x, good to 4e-14 and the same for the same x, in products and sums only: a vector's square root and division take
// four times as long. The guess is off by at most 3.5 % (Lomont 2003, Fast inverse square root, with the constant for
// doubles); the parabola in x·y² that is off least over such guesses leaves 2.5e-5, and a step of third order turns an
// error e into 2.5·e³: to a spring the same as a rest length off by that. Of 0 it makes a number.
CK_INLINE void ck_lanes_inverse_root(ck_Lanes *y, const ck_Lanes *x, const int count) {
    static const double c[] = {1.8765983439634224, 1.252100341927225, 0.37550221129439404};
    ck_Lanes t[CK_MOST_TOGETHER], p[CK_MOST_TOGETHER];
    for (int i = 0; i < count; i++) y[i] = (ck_Lanes)(0x5fe6eb50c7b537a9 - ((ck_LaneBits)x[i] >> 1));
    for (int i = 0; i < count; i++) t[i] = x[i] * y[i] * y[i];
    for (int i = 0; i < count; i++) p[i] = ck_lanes_minus(ck_lanes_all(c[1]), ck_lanes_all(c[2]), t[i]);
    for (int i = 0; i < count; i++) p[i] = ck_lanes_minus(ck_lanes_all(c[0]), p[i], t[i]);
    for (int i = 0; i < count; i++) y[i] *= p[i];
    for (int i = 0; i < count; i++) t[i] = ck_lanes_minus(ck_lanes_all(1), x[i] * y[i], y[i]);
    for (int i = 0; i < count; i++) p[i] = ck_lanes_plus(ck_lanes_all(0.5), ck_lanes_all(0.375), t[i]);
    for (int i = 0; i < count; i++) y[i] = ck_lanes_plus(y[i], y[i] * t[i], p[i]);
}
