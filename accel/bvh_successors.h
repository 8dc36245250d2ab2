// What came next the last time: the processor's guess at where a single ray goes, so that it does not wait for a node's
// comparison to load the next one. Knows references only. Invariant: whatever is remembered, the answer is the one that was
// computed.
#pragma once

#include "accel/bvh_layout.h"
#include "accel/simd.h"

namespace glint::GLINT_ISA {

// Of each node and leaf what this thread's last ray to come there went on to, those with equal low bits sharing a place.
struct Successors {
    static constexpr BvhRef kPlaces = 1024;
    BvhRef of[kPlaces];
};
template <bool any>
constinit thread_local Successors successors{};

// `next`, which a ray takes after `from`. Where the last one took the same, the answer comes from memory and the comparison is
// left to a branch: a processor guesses branches where it would wait for a value, so neighbouring rays overlap their steps
// (value prediction, Lipasti, Wilkerson & Shen 1996, by means of software).
template <bool any>
[[gnu::always_inline]] inline BvhRef follow(BvhRef from, BvhRef next) noexcept {
    BvhRef& place = successors<any>.of[from % Successors::kPlaces];
    const BvhRef last = place;
    BvhRef guess = last;
    asm("" : "+r"(guess));  // or the compiler, seeing that they are equal, would return `next`
    if (last == next) return guess;
    place = next;
    return next;
}

}  // namespace glint::GLINT_ISA
