#include "core/ranks.h"

#include <immintrin.h>

#include <algorithm>
#include <array>
#include <bit>

#include "accel/isa.h"

namespace glint {
namespace {

constexpr std::size_t kRun = Ranks::kRun;

// For each mask the numbers that go on.
constexpr std::array<std::array<std::uint8_t, kRun>, 256> kKept = [] {
    std::array<std::array<std::uint8_t, kRun>, 256> table{};
    for (unsigned mask = 0; mask < 256; ++mask) {
        std::size_t n = 0;
        for (std::uint8_t i = 0; i < kRun; ++i) {
            if ((mask >> i & 1u) != 0) table[mask][n++] = i;
        }
    }
    return table;
}();

template <class T>
void close_row(const std::uint8_t* masks, std::size_t runs, T* row) {
    T* to = row;
    for (std::size_t r = 0; r < runs; ++r) {
        for (std::size_t i = 0; i < kRun; ++i) {
            if ((masks[r] >> i & 1) != 0) *to++ = row[kRun * r + i];
        }
    }
}

// Eight numbers are written for each run; what is too much is written over by the next.
template <class T>
[[gnu::target("avx2,popcnt")]] void close_row_avx2(const std::uint8_t* masks, std::size_t runs, T* row) {
    T* to = row;
    for (std::size_t r = 0; r < runs; ++r) {
        const __m128i kept = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(kKept[masks[r]].data()));
        const __m256i run = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(row + kRun * r));
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), _mm256_permutevar8x32_epi32(run, _mm256_cvtepu8_epi32(kept)));
        to += std::popcount(masks[r]);
    }
}

template <class T>
void close_in_use(const std::uint8_t* masks, std::size_t runs, T* row) {
    isa_in_use() == Isa::baseline ? close_row(masks, runs, row) : close_row_avx2(masks, runs, row);
}

}  // namespace

Ranks::Ranks(const std::uint32_t* flags, std::size_t n) noexcept : runs_((n + kRun - 1) / kRun) {
    for (std::size_t r = 0; r < runs_; ++r) {
        unsigned mask = 0;
        for (unsigned i = 0; i < kRun; ++i) mask |= (flags[kRun * r + i] != 0 ? 1u : 0u) << i;
        const std::size_t here = std::min(kRun, n - kRun * r);
        mask &= (1u << here) - 1u;
        masks_[r] = static_cast<std::uint8_t>(mask);
        kept_ += static_cast<std::size_t>(std::popcount(mask));
    }
}

void Ranks::close(float* row) const noexcept {
    if (kept_ < kRun * runs_) close_in_use(masks_, runs_, row);
}
void Ranks::close(std::uint32_t* row) const noexcept {
    if (kept_ < kRun * runs_) close_in_use(masks_, runs_, row);
}

}  // namespace glint
