// The children that a ray or a packet enters, and the stack of those it comes back to.
// Knows no primitive. Invariant: children are left behind far first, so that the nearest one is popped next.
#pragma once

#include "accel/bvh_rays.h"

namespace glint::GLINT_ISA {

// Each level leaves at most seven siblings behind.
constexpr int kMaxBvhLevels = 64;
constexpr int kStackSize = kMaxBvhLevels * (kBvhWidth - 1) + 2 * kBvhWidth;

// The number of entries is kept apart, so that it can live in a register.
struct TraversalStack {
    BvhRef ref[kStackSize];
    float near[kStackSize];

    // Leaves out what lies behind t, all but the bottom one; returns how many entries are left.
    int cull(int top, float t) noexcept {
        int kept = 1;
        for (int i = 1; i < top; ++i) {
            ref[kept] = ref[i];
            near[kept] = near[i];
            kept += near[i] <= t ? 1 : 0;
        }
        return kept;
    }
};

#if defined(__AVX2__) && !defined(__AVX512VL__)
// For each set of lanes their numbers in front, eight bytes that a permutation widens: what AVX-512 calls compress.
struct FrontLanes {
    alignas(64) std::uint64_t of[256];
    constexpr FrontLanes() : of() {
        for (unsigned set = 0; set < 256; ++set) {
            int n = 0;
            for (unsigned lane = 0; lane < 8; ++lane) {
                if ((set >> lane & 1u) != 0) of[set] |= std::uint64_t{lane} << (8 * n++);
            }
        }
    }
};
inline constexpr FrontLanes kFrontLanes;
inline __m256i front_lanes(unsigned set) noexcept {
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(kFrontLanes.of + set)));
}
#endif

#if defined(__AVX2__)
// Pushes the children at these places of a node's order.
inline void push_places(TraversalStack& stack, int& top, __m256i refs, __m256 near, unsigned places) noexcept {
#if defined(__AVX512VL__)
    const auto kept = static_cast<__mmask8>(places);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(stack.ref + top), _mm256_maskz_compress_epi32(kept, refs));
    _mm256_storeu_ps(stack.near + top, _mm256_maskz_compress_ps(kept, near));
#else
    const __m256i front = front_lanes(places);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(stack.ref + top), _mm256_permutevar8x32_epi32(refs, front));
    _mm256_storeu_ps(stack.near + top, _mm256_permutevar8x32_ps(near, front));
#endif
    top += __builtin_popcount(places);
}
#endif

// Pushes all children entered, none or many, far to near, and returns the place in the node's order of the nearest one.
inline int push_all(TraversalStack& stack, int& top, const BvhNode& node, Float8::Mask entered, unsigned shift,
                    Float8 near) noexcept {
#if defined(__AVX512VL__)
    const __m256i order =
        _mm256_srli_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(node.order)), static_cast<int>(shift));
    const __m256 inf = _mm256_set1_ps(HUGE_VALF);
    const __m256 sorted = _mm256_permutexvar_ps(order, _mm256_mask_blend_ps(static_cast<__mmask8>(entered.m), inf, near.v));
    const __m256i refs = _mm256_permutexvar_epi32(order, _mm256_load_si256(reinterpret_cast<const __m256i*>(node.child)));
    const __mmask8 present = _mm256_cmp_ps_mask(sorted, inf, _CMP_LT_OQ);
    push_places(stack, top, refs, sorted, present);
    return 31 - __builtin_clz(static_cast<unsigned>(present) | 1u);
#elif defined(__AVX2__)
    const __m256i order =
        _mm256_srli_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(node.order)), static_cast<int>(shift));
    const __m256 sorted = _mm256_permutevar8x32_ps(near.v, order);
    const __m256i refs = _mm256_permutevar8x32_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(node.child)), order);
    // Sorted as lanes, not as bits: those would have to come back from the integer side.
    const auto present = static_cast<unsigned>(_mm256_movemask_ps(_mm256_permutevar8x32_ps(entered.v, order)));
    push_places(stack, top, refs, sorted, present);
    return 31 - __builtin_clz(present | 1u);
#else
    alignas(32) float distance[kBvhWidth];
    near.store(distance);
    const unsigned mask = entered.bits();
    int nearest = 0;
    for (int i = 0; i < kBvhWidth; ++i) {
        const unsigned k = node.order[i] >> shift & 7u;
        const bool present = (mask >> k & 1u) != 0;
        stack.ref[top] = node.child[k];
        stack.near[top] = distance[k];
        top += present ? 1 : 0;
        nearest = present ? i : nearest;
    }
    return nearest;
#endif
}
// Pushes all but the nearest of the children entered (at least one) and returns that one. It is looked up in the node, because
// what was just compressed and stored would come back from the stack too late.
inline BvhRef push_children(TraversalStack& stack, int& top, const BvhNode& node, Float8::Mask entered, unsigned shift,
                            Float8 near) noexcept {
    const int nearest = push_all(stack, top, node, entered, shift, near);
    --top;
    return node.child[node.order[nearest] >> shift & 7u];
}

inline void push_all_unsorted(TraversalStack& stack, int& top, const BvhNode& node, unsigned mask) noexcept {
#if defined(__AVX512VL__)
    const __m256i refs = _mm256_load_si256(reinterpret_cast<const __m256i*>(node.child));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(stack.ref + top),
                        _mm256_maskz_compress_epi32(static_cast<__mmask8>(mask), refs));
    top += __builtin_popcount(mask);
#elif defined(__AVX2__)
    const __m256i refs = _mm256_load_si256(reinterpret_cast<const __m256i*>(node.child));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(stack.ref + top), _mm256_permutevar8x32_epi32(refs, front_lanes(mask)));
    top += __builtin_popcount(mask);
#else
    for (; mask != 0; mask &= mask - 1) stack.ref[top++] = node.child[__builtin_ctz(mask)];
#endif
}

// The same in any order and without distances.
inline BvhRef push_unsorted(TraversalStack& stack, int& top, const BvhNode& node, unsigned mask) noexcept {
    push_all_unsorted(stack, top, node, mask & (mask - 1));
    return node.child[__builtin_ctz(mask)];
}

// Writes the children of `mask` far to near and returns how many there are.
inline int sort_children(const BvhNode& node, unsigned mask, unsigned shift, std::uint32_t* far_first) noexcept {
#if defined(__AVX512VL__)
    const __m256i order = _mm256_and_si256(
        _mm256_srli_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(node.order)), static_cast<int>(shift)),
        _mm256_set1_epi32(7));
    const __m256i bit = _mm256_sllv_epi32(_mm256_set1_epi32(1), order);
    const __mmask8 present = _mm256_test_epi32_mask(bit, _mm256_set1_epi32(static_cast<int>(mask)));
    _mm256_store_si256(reinterpret_cast<__m256i*>(far_first), _mm256_maskz_compress_epi32(present, order));
    return __builtin_popcount(mask);
#elif defined(__AVX2__)
    const __m256i order = _mm256_and_si256(
        _mm256_srli_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(node.order)), static_cast<int>(shift)),
        _mm256_set1_epi32(7));
    const __m256 entered = _mm256_permutevar8x32_ps(mask8_from_bits(mask), order);
    const __m256i front = front_lanes(static_cast<unsigned>(_mm256_movemask_ps(entered)));
    _mm256_store_si256(reinterpret_cast<__m256i*>(far_first), _mm256_permutevar8x32_epi32(order, front));
    return __builtin_popcount(mask);
#else
    int count = 0;
    for (int i = 0; i < kBvhWidth; ++i) {
        const unsigned k = node.order[i] >> shift & 7u;
        far_first[count & 7] = k;
        count += static_cast<int>(mask >> k & 1u);
    }
    return count;
#endif
}

#if defined(__AVX2__)
// The children that a ray may enter, in the node's order, far first. Distances are brought into it before they are compared, and
// the children beside: so what comes next is known as soon as the comparison is.
class ChildrenInOrder {
public:
    ChildrenInOrder(const BvhNode& node, const SlabRay& ray, Float8 limit) noexcept {
        const __m256i order =
            _mm256_srli_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(node.order)), static_cast<int>(ray.shift));
        refs_ = _mm256_permutevar8x32_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(node.child)), order);
        _mm256_store_si256(reinterpret_cast<__m256i*>(ref_), refs_);
        Float8 near, far;
        slabs(node, ray, limit, near, far);
        near_ = _mm256_permutevar8x32_ps(near.v, order);
        entered_ = le(Float8{near_}, Float8{_mm256_permutevar8x32_ps(far.v, order)}).bits();
    }
    [[nodiscard]] bool none() const noexcept { return entered_ == 0; }
    // Pushes all but the nearest one, which it returns; there must be one. Without a branch on whether there are others: it would
    // be guessed wrong once a ray.
    BvhRef push_others(TraversalStack& stack, int& top) const noexcept {
        const int nearest = 31 - __builtin_clz(entered_);
        push_places(stack, top, refs_, near_, entered_ & ((1u << nearest) - 1));
        return ref_[nearest];
    }
    void push_all(TraversalStack& stack, int& top) const noexcept { push_places(stack, top, refs_, near_, entered_); }

private:
    alignas(32) BvhRef ref_[kBvhWidth];
    __m256i refs_;
    __m256 near_;
    unsigned entered_;
};
#else
class ChildrenInOrder {
public:
    ChildrenInOrder(const BvhNode& node, const SlabRay& ray, Float8 limit) noexcept
        : node_(node), shift_(ray.shift), entered_(enter(node, ray, limit, near_)) {}
    [[nodiscard]] bool none() const noexcept { return entered_.bits() == 0; }
    BvhRef push_others(TraversalStack& stack, int& top) const noexcept {
        return push_children(stack, top, node_, entered_, shift_, near_);
    }
    void push_all(TraversalStack& stack, int& top) const noexcept {
        glint::GLINT_ISA::push_all(stack, top, node_, entered_, shift_, near_);
    }

private:
    const BvhNode& node_;
    unsigned shift_;
    Float8 near_;
    Float8::Mask entered_;
};
#endif

}  // namespace glint::GLINT_ISA
