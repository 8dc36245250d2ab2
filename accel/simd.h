// Vectors of 8 and 16 floats and 8 doubles for whatever instruction set this file is compiled for. Every operation rounds as
// the scalar one does, but for mul_sub and neg_mul_add, which may fuse and so serve conservative tests only.
// Knows no rays. Invariant: everything lives in a namespace of its instruction set, so that no two builds of it can be merged by
// the linker; nothing here may call an inline function of another library.
#pragma once

#include <immintrin.h>

#include <cstdint>

#if defined(__AVX512VL__)
#define GLINT_ISA isa_avx512
#elif defined(__AVX2__)
#define GLINT_ISA isa_avx2
#else
#define GLINT_ISA isa_baseline
#endif

namespace glint::GLINT_ISA {

#if defined(__FMA__)
constexpr bool kFused = true;
#else
constexpr bool kFused = false;
#endif

#if defined(__AVX512VL__)

// One bit per lane, as the compare instructions deliver them.
template <unsigned kLanes>
struct BitMask {
    unsigned m;
    static BitMask from_bits(unsigned b) { return {b}; }
    [[nodiscard]] unsigned bits() const { return m; }
    friend BitMask operator&(BitMask a, BitMask b) { return {a.m & b.m}; }
    friend BitMask operator|(BitMask a, BitMask b) { return {a.m | b.m}; }
    // a without b
    friend BitMask operator-(BitMask a, BitMask b) { return {a.m & ~b.m}; }
};

#define GLINT_MASKED_VECTOR(Vector, Register, Scalar, kWidth, P, T, Cmp)                                \
    struct Vector {                                                                                     \
        static constexpr int kLanes = kWidth;                                                           \
        using Mask = BitMask<kWidth>;                                                                   \
        Register v;                                                                                     \
        static Vector load(const Scalar* p) { return {P##load_p##T(p)}; }                               \
        static Vector set(Scalar x) { return {P##set1_p##T(x)}; }                                       \
        void store(Scalar* p) const { P##storeu_p##T(p, v); }                                           \
    };                                                                                                  \
    inline Vector operator+(Vector a, Vector b) { return {P##add_p##T(a.v, b.v)}; }                     \
    inline Vector operator-(Vector a, Vector b) { return {P##sub_p##T(a.v, b.v)}; }                     \
    inline Vector operator*(Vector a, Vector b) { return {P##mul_p##T(a.v, b.v)}; }                     \
    inline Vector operator/(Vector a, Vector b) { return {P##div_p##T(a.v, b.v)}; }                     \
    inline Vector min(Vector a, Vector b) { return {P##min_p##T(a.v, b.v)}; }                           \
    inline Vector max(Vector a, Vector b) { return {P##max_p##T(a.v, b.v)}; }                           \
    inline Vector sqrt(Vector a) { return {P##sqrt_p##T(a.v)}; }                                        \
    inline Vector mul_sub(Vector a, Vector b, Vector c) { return {P##fmsub_p##T(a.v, b.v, c.v)}; }      \
    inline Vector neg_mul_add(Vector a, Vector b, Vector c) { return {P##fnmadd_p##T(a.v, b.v, c.v)}; } \
    inline Vector::Mask lt(Vector a, Vector b) { return {P##cmp_p##T##_mask(a.v, b.v, _CMP_LT_OQ)}; }   \
    inline Vector::Mask le(Vector a, Vector b) { return {P##cmp_p##T##_mask(a.v, b.v, _CMP_LE_OQ)}; }   \
    inline Vector select(Vector::Mask m, Vector a, Vector b) { return {P##mask_blend_p##T(static_cast<Cmp>(m.m), b.v, a.v)}; }

GLINT_MASKED_VECTOR(Float8, __m256, float, 8, _mm256_, s, __mmask8)
GLINT_MASKED_VECTOR(Float16, __m512, float, 16, _mm512_, s, __mmask16)
GLINT_MASKED_VECTOR(Double8, __m512d, double, 8, _mm512_, d, __mmask8)
#undef GLINT_MASKED_VECTOR

inline Float8 abs(Float8 a) { return {_mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v)}; }
inline Float16 abs(Float16 a) { return {_mm512_abs_ps(a.v)}; }
inline Double8 abs(Double8 a) { return {_mm512_abs_pd(a.v)}; }
inline Float16 copy_sign(Float16 magnitude, Float16 sign) {
    return {_mm512_or_ps(_mm512_abs_ps(magnitude.v), _mm512_and_ps(_mm512_set1_ps(-0.0f), sign.v))};
}
inline Double8 copy_sign(Double8 magnitude, Double8 sign) {
    return {_mm512_or_pd(_mm512_abs_pd(magnitude.v), _mm512_and_pd(_mm512_set1_pd(-0.0), sign.v))};
}
inline Double8 widen(Float8 a) { return {_mm512_cvtps_pd(a.v)}; }
inline Float8 narrow(Double8 a) { return {_mm512_cvtpd_ps(a.v)}; }
inline BitMask<8> narrow(BitMask<8> m) { return m; }
inline Float8 lower(Float16 a) { return {_mm512_castps512_ps256(a.v)}; }
inline Float8 upper(Float16 a) { return {_mm512_extractf32x8_ps(a.v, 1)}; }
inline Float16 join(Float8 a, Float8 b) { return {_mm512_insertf32x8(_mm512_castps256_ps512(a.v), b.v, 1)}; }
inline BitMask<16> join(BitMask<8> a, BitMask<8> b) { return {a.m | b.m << 8}; }
inline void store_where(Float16::Mask m, Float16 a, float* p) { _mm512_mask_store_ps(p, static_cast<__mmask16>(m.m), a.v); }
inline void store_where(Float16::Mask m, std::uint32_t id, std::uint32_t* p) {
    _mm512_mask_store_epi32(p, static_cast<__mmask16>(m.m), _mm512_set1_epi32(static_cast<int>(id)));
}
// Copies the lanes of m from one aligned array to another, whatever the 32 bits mean.
inline void copy_where(Float16::Mask m, const void* from, void* to) {
    _mm512_mask_store_epi32(to, static_cast<__mmask16>(m.m), _mm512_load_epi32(from));
}

#else

// Two vectors side by side: how narrower instruction sets make the wider ones.
template <class M>
struct TwiceMask {
    M lo, hi;
    static TwiceMask from_bits(unsigned b) { return {M::from_bits(b & ((1u << M::kLanes) - 1)), M::from_bits(b >> M::kLanes)}; }
    [[nodiscard]] unsigned bits() const { return lo.bits() | hi.bits() << M::kLanes; }
    friend TwiceMask operator&(TwiceMask a, TwiceMask b) { return {a.lo & b.lo, a.hi & b.hi}; }
    friend TwiceMask operator|(TwiceMask a, TwiceMask b) { return {a.lo | b.lo, a.hi | b.hi}; }
    friend TwiceMask operator-(TwiceMask a, TwiceMask b) { return {a.lo - b.lo, a.hi - b.hi}; }
    static constexpr int kLanes = 2 * M::kLanes;
};

template <class V>
struct Twice {
    static constexpr int kLanes = 2 * V::kLanes;
    using Mask = TwiceMask<typename V::Mask>;
    using Scalar = typename V::Scalar;
    V lo, hi;
    static Twice load(const Scalar* p) { return {V::load(p), V::load(p + V::kLanes)}; }
    static Twice set(Scalar x) { return {V::set(x), V::set(x)}; }
    void store(Scalar* p) const { lo.store(p), hi.store(p + V::kLanes); }
    friend Twice operator+(Twice a, Twice b) { return {a.lo + b.lo, a.hi + b.hi}; }
    friend Twice operator-(Twice a, Twice b) { return {a.lo - b.lo, a.hi - b.hi}; }
    friend Twice operator*(Twice a, Twice b) { return {a.lo * b.lo, a.hi * b.hi}; }
    friend Twice operator/(Twice a, Twice b) { return {a.lo / b.lo, a.hi / b.hi}; }
    friend Twice min(Twice a, Twice b) { return {min(a.lo, b.lo), min(a.hi, b.hi)}; }
    friend Twice max(Twice a, Twice b) { return {max(a.lo, b.lo), max(a.hi, b.hi)}; }
    friend Twice sqrt(Twice a) { return {sqrt(a.lo), sqrt(a.hi)}; }
    friend Twice abs(Twice a) { return {abs(a.lo), abs(a.hi)}; }
    friend Twice copy_sign(Twice a, Twice b) { return {copy_sign(a.lo, b.lo), copy_sign(a.hi, b.hi)}; }
    friend Twice mul_sub(Twice a, Twice b, Twice c) { return {mul_sub(a.lo, b.lo, c.lo), mul_sub(a.hi, b.hi, c.hi)}; }
    friend Twice neg_mul_add(Twice a, Twice b, Twice c) { return {neg_mul_add(a.lo, b.lo, c.lo), neg_mul_add(a.hi, b.hi, c.hi)}; }
    friend Mask lt(Twice a, Twice b) { return {lt(a.lo, b.lo), lt(a.hi, b.hi)}; }
    friend Mask le(Twice a, Twice b) { return {le(a.lo, b.lo), le(a.hi, b.hi)}; }
    friend Twice select(Mask m, Twice a, Twice b) { return {select(m.lo, a.lo, b.lo), select(m.hi, a.hi, b.hi)}; }
};

// The lanes' masks as full-width vectors; bits on demand.
#define GLINT_VECTOR(Vector, Register, Number, kWidth, P, T, LT, LE, MUL_SUB, NEG_MUL_ADD, BITS)             \
    struct Vector##Mask {                                                                                    \
        static constexpr int kLanes = kWidth;                                                                \
        Register v;                                                                                          \
        static Vector##Mask from_bits(unsigned b) { return {BITS(b)}; }                                      \
        [[nodiscard]] unsigned bits() const { return static_cast<unsigned>(P##movemask_p##T(v)); }           \
        friend Vector##Mask operator&(Vector##Mask a, Vector##Mask b) { return {P##and_p##T(a.v, b.v)}; }    \
        friend Vector##Mask operator|(Vector##Mask a, Vector##Mask b) { return {P##or_p##T(a.v, b.v)}; }     \
        friend Vector##Mask operator-(Vector##Mask a, Vector##Mask b) { return {P##andnot_p##T(b.v, a.v)}; } \
    };                                                                                                       \
    struct Vector {                                                                                          \
        static constexpr int kLanes = kWidth;                                                                \
        using Mask = Vector##Mask;                                                                           \
        using Scalar = Number;                                                                               \
        Register v;                                                                                          \
        static Vector load(const Scalar* p) { return {P##load_p##T(p)}; }                                    \
        static Vector set(Scalar x) { return {P##set1_p##T(x)}; }                                            \
        void store(Scalar* p) const { P##storeu_p##T(p, v); }                                                \
    };                                                                                                       \
    inline Vector operator+(Vector a, Vector b) { return {P##add_p##T(a.v, b.v)}; }                          \
    inline Vector operator-(Vector a, Vector b) { return {P##sub_p##T(a.v, b.v)}; }                          \
    inline Vector operator*(Vector a, Vector b) { return {P##mul_p##T(a.v, b.v)}; }                          \
    inline Vector operator/(Vector a, Vector b) { return {P##div_p##T(a.v, b.v)}; }                          \
    inline Vector min(Vector a, Vector b) { return {P##min_p##T(a.v, b.v)}; }                                \
    inline Vector max(Vector a, Vector b) { return {P##max_p##T(a.v, b.v)}; }                                \
    inline Vector sqrt(Vector a) { return {P##sqrt_p##T(a.v)}; }                                             \
    inline Vector abs(Vector a) { return {P##andnot_p##T(P##set1_p##T(-0.0f), a.v)}; }                       \
    inline Vector copy_sign(Vector magnitude, Vector sign) {                                                 \
        const Register bit = P##set1_p##T(-0.0f);                                                            \
        return {P##or_p##T(P##andnot_p##T(bit, magnitude.v), P##and_p##T(bit, sign.v))};                     \
    }                                                                                                        \
    inline Vector mul_sub(Vector a, Vector b, Vector c) { return {MUL_SUB}; }                                \
    inline Vector neg_mul_add(Vector a, Vector b, Vector c) { return {NEG_MUL_ADD}; }                        \
    inline Vector##Mask lt(Vector a, Vector b) { return {LT}; }                                              \
    inline Vector##Mask le(Vector a, Vector b) { return {LE}; }

#if defined(__AVX2__)

inline __m256 mask8_from_bits(unsigned b) {
    const __m256i lanes = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(static_cast<int>(b)), lanes), lanes));
}
inline __m256d mask4_from_bits(unsigned b) {
    const __m256i lanes = _mm256_setr_epi64x(1, 2, 4, 8);
    return _mm256_castsi256_pd(_mm256_cmpeq_epi64(_mm256_and_si256(_mm256_set1_epi64x(static_cast<int>(b)), lanes), lanes));
}
GLINT_VECTOR(Float8, __m256, float, 8, _mm256_, s, _mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ), _mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ),
             _mm256_fmsub_ps(a.v, b.v, c.v), _mm256_fnmadd_ps(a.v, b.v, c.v), mask8_from_bits)
GLINT_VECTOR(Double4, __m256d, double, 4, _mm256_, d, _mm256_cmp_pd(a.v, b.v, _CMP_LT_OQ), _mm256_cmp_pd(a.v, b.v, _CMP_LE_OQ),
             _mm256_fmsub_pd(a.v, b.v, c.v), _mm256_fnmadd_pd(a.v, b.v, c.v), mask4_from_bits)
inline Float8 select(Float8Mask m, Float8 a, Float8 b) { return {_mm256_blendv_ps(b.v, a.v, m.v)}; }
inline Double4 select(Double4Mask m, Double4 a, Double4 b) { return {_mm256_blendv_pd(b.v, a.v, m.v)}; }
using Double8 = Twice<Double4>;
inline Double8 widen(Float8 a) {
    return {{_mm256_cvtps_pd(_mm256_castps256_ps128(a.v))}, {_mm256_cvtps_pd(_mm256_extractf128_ps(a.v, 1))}};
}
inline Float8 narrow(Double8 a) {
    return {_mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(a.lo.v)), _mm256_cvtpd_ps(a.hi.v), 1)};
}

#else

inline __m128 mask4_from_bits(unsigned b) {
    const __m128i lanes = _mm_setr_epi32(1, 2, 4, 8);
    return _mm_castsi128_ps(_mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(static_cast<int>(b)), lanes), lanes));
}
inline __m128d mask2_from_bits(unsigned b) {
    const __m128i lanes = _mm_setr_epi32(1, 1, 2, 2);
    return _mm_castsi128_pd(_mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(static_cast<int>(b)), lanes), lanes));
}
GLINT_VECTOR(Float4, __m128, float, 4, _mm_, s, _mm_cmplt_ps(a.v, b.v), _mm_cmple_ps(a.v, b.v),
             _mm_sub_ps(_mm_mul_ps(a.v, b.v), c.v), _mm_sub_ps(c.v, _mm_mul_ps(a.v, b.v)), mask4_from_bits)
GLINT_VECTOR(Double2, __m128d, double, 2, _mm_, d, _mm_cmplt_pd(a.v, b.v), _mm_cmple_pd(a.v, b.v),
             _mm_sub_pd(_mm_mul_pd(a.v, b.v), c.v), _mm_sub_pd(c.v, _mm_mul_pd(a.v, b.v)), mask2_from_bits)
inline Float4 select(Float4Mask m, Float4 a, Float4 b) { return {_mm_or_ps(_mm_and_ps(m.v, a.v), _mm_andnot_ps(m.v, b.v))}; }
inline Double2 select(Double2Mask m, Double2 a, Double2 b) { return {_mm_or_pd(_mm_and_pd(m.v, a.v), _mm_andnot_pd(m.v, b.v))}; }
using Float8 = Twice<Float4>;
using Double8 = Twice<Twice<Double2> >;
inline Twice<Double2> widen(Float4 a) { return {{_mm_cvtps_pd(a.v)}, {_mm_cvtps_pd(_mm_movehl_ps(a.v, a.v))}}; }
inline Double8 widen(Float8 a) { return {widen(a.lo), widen(a.hi)}; }
inline Float4 narrow(Twice<Double2> a) { return {_mm_movelh_ps(_mm_cvtpd_ps(a.lo.v), _mm_cvtpd_ps(a.hi.v))}; }
inline Float8 narrow(Double8 a) { return {narrow(a.lo), narrow(a.hi)}; }

#endif
#undef GLINT_VECTOR

using Float16 = Twice<Float8>;
// A mask of doubles as one of floats.
inline Float8::Mask narrow(Double8::Mask m) { return Float8::Mask::from_bits(m.bits()); }
inline Float8 lower(Float16 a) { return a.lo; }
inline Float8 upper(Float16 a) { return a.hi; }
inline Float16 join(Float8 a, Float8 b) { return {a, b}; }
inline Float16::Mask join(Float8::Mask a, Float8::Mask b) { return {a, b}; }
inline void store_where(Float16::Mask m, Float16 a, float* p) { select(m, a, Float16::load(p)).store(p); }
inline void store_where(Float16::Mask m, std::uint32_t id, std::uint32_t* p) {
    for (unsigned bits = m.bits(); bits != 0; bits &= bits - 1) p[__builtin_ctz(bits)] = id;
}
// Copies the lanes of m from one aligned array to another, whatever the 32 bits mean: loads and blends do not touch them.
inline void copy_where(Float16::Mask m, const void* from, void* to) {
    store_where(m, Float16::load(static_cast<const float*>(from)), static_cast<float*>(to));
}

#endif

// The greater, and the lesser, of two floats as integers: that takes Intel's processors one cycle, not four. Of two negative ones
// it may be either.
#if defined(__AVX2__)
inline __m256i integers(Float8 a) { return _mm256_castps_si256(a.v); }
inline Float8 max_as_integers(Float8 a, Float8 b) { return {_mm256_castsi256_ps(_mm256_max_epi32(integers(a), integers(b)))}; }
inline Float8 min_as_integers(Float8 a, Float8 b) { return {_mm256_castsi256_ps(_mm256_min_epi32(integers(a), integers(b)))}; }
#else
inline Float8 max_as_integers(Float8 a, Float8 b) { return max(a, b); }
inline Float8 min_as_integers(Float8 a, Float8 b) { return min(a, b); }
#endif

// Bits of the ids that differ from the one before; the first always does. p[-1] must be readable.
inline unsigned distinct(const std::uint32_t* p) {
#if defined(__AVX2__)
    const __m256i same = _mm256_cmpeq_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(p)),
                                            _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p - 1)));
    return (~static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(same))) & 0xffu) | 1u;
#else
    unsigned bits = 1;
    for (int i = 1; i < 8; ++i) bits |= (p[i] != p[i - 1] ? 1u : 0u) << i;
    return bits;
#endif
}
inline __m128 quarter(Float8 a, bool high) {
#if defined(__AVX2__)
    return high ? _mm256_extractf128_ps(a.v, 1) : _mm256_castps256_ps128(a.v);
#else
    return high ? a.hi.v : a.lo.v;
#endif
}
// From memory.
inline float lane_of(const Float16& a, int lane) { return reinterpret_cast<const float*>(&a)[lane]; }
inline float first_lane(Float16 a) { return _mm_cvtss_f32(quarter(lower(a), false)); }
inline float reduce_min(Float16 a) {
    const Float8 b = min(lower(a), upper(a));
    __m128 c = _mm_min_ps(quarter(b, false), quarter(b, true));
    c = _mm_min_ps(c, _mm_movehl_ps(c, c));
    return _mm_cvtss_f32(_mm_min_ss(c, _mm_shuffle_ps(c, c, 1)));
}
inline float reduce_max(Float16 a) {
    const Float8 b = max(lower(a), upper(a));
    __m128 c = _mm_max_ps(quarter(b, false), quarter(b, true));
    c = _mm_max_ps(c, _mm_movehl_ps(c, c));
    return _mm_cvtss_f32(_mm_max_ss(c, _mm_shuffle_ps(c, c, 1)));
}

}  // namespace glint::GLINT_ISA
