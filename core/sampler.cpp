#include "core/sampler.h"

#include <algorithm>
#include <cmath>

#include "accel/isa.h"
#include "core/dimension.h"
#include "core/sobol_columns.h"

namespace glint {
namespace {

// The top 24 bits, so that 0xffffffff stays below 1 (a float product with 2^-32 would round to 1).
inline float unit_float(std::uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24f; }

inline std::uint32_t reverse_bits(std::uint32_t x) {
    x = (x >> 16) | (x << 16);
    x = ((x & 0xff00ff00u) >> 8) | ((x & 0x00ff00ffu) << 8);
    x = ((x & 0xf0f0f0f0u) >> 4) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x & 0xccccccccu) >> 2) | ((x & 0x33333333u) << 2);
    return ((x & 0xaaaaaaaau) >> 1) | ((x & 0x55555555u) << 1);
}

// Owen scrambling of a bit-reversed number: each bit is flipped by a hash of the bits below it (Laine & Karras 2011;
// constants of Vegdahl 2021, "Building a Better LK Hash").
inline std::uint32_t owen_scramble_reversed(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

// Second Sobol' dimension, bit-reversed: the Pascal matrix modulo 2 as five butterfly steps instead of 32 columns.
inline std::uint32_t sobol_second_reversed(std::uint32_t i) {
    i ^= (i & 0xaaaaaaaau) >> 1;
    i ^= (i & 0xccccccccu) >> 2;
    i ^= (i & 0xf0f0f0f0u) >> 4;
    i ^= (i & 0xff00ff00u) >> 8;
    return i ^ (i >> 16);
}

// Every dimension pair is the same (0,2)-sequence, shuffled and scrambled on its own (Burley 2020): what of that depends on
// pixel and dimension alone.
struct SobolSeeds {
    std::uint32_t order, scramble_x, scramble_y;

    explicit SobolSeeds(std::uint32_t seed)
        : order(seed), scramble_x(hash(seed ^ 0x68bc21ebu)), scramble_y(hash(seed ^ 0x02e5be93u)) {}
    // `joint`: the order of the pixel's own dimension, so that what is drawn together stays together.
    SobolSeeds(std::uint32_t pixel, std::uint32_t dimension, bool joined) : SobolSeeds(hash(pixel, dimension)) {
        if (joined) order = hash(pixel, dimension::pixel);
    }
    [[nodiscard]] std::uint32_t shuffled(std::uint32_t index) const {
        return reverse_bits(owen_scramble_reversed(reverse_bits(index), order));
    }
    // The pair of dimensions whose generator matrices are given.
    [[nodiscard]] glm::vec2 pair(std::uint32_t i, const SobolColumns& columns) const {
        std::uint32_t a = 0, b = 0;
        for (std::uint32_t bit = 0; bit < 32; ++bit) {
            const std::uint32_t mask = 0u - (i >> bit & 1u);
            a ^= mask & columns.first[bit];
            b ^= mask & columns.second[bit];
        }
        return {unit_float(reverse_bits(owen_scramble_reversed(a, scramble_x))),
                unit_float(reverse_bits(owen_scramble_reversed(b, scramble_y)))};
    }
    [[nodiscard]] float x(std::uint32_t i) const { return unit_float(reverse_bits(owen_scramble_reversed(i, scramble_x))); }
    [[nodiscard]] float y(std::uint32_t i) const {
        return unit_float(reverse_bits(owen_scramble_reversed(sobol_second_reversed(i), scramble_y)));
    }
};

// The matrices of a dimension that `joint` draws together with the pixel's; null for all others, which are as in `sobol`.
const SobolColumns* joint_columns(std::uint32_t dimension) {
    constexpr std::uint32_t kFirstLight = hash(kCameraPath, 0);
    if (dimension == kFirstLight) return &kSobolLight;
    return dimension == dimension::lens ? &kSobolLens : nullptr;
}

// The dimension of each sample.
struct ByLane {
    const std::uint32_t* dimension;
    std::uint32_t operator[](std::size_t k) const { return dimension[k]; }
};
struct OfAll {
    std::uint32_t dimension;
    std::uint32_t operator[](std::size_t) const { return dimension; }
};

// Plain loops, of which compilers make vector instructions; integers and powers of two have the same bits in all of them.
template <class Dimension>
[[gnu::always_inline]] inline void sobol_squares(const std::uint32_t* pixel, const std::uint32_t* index, Dimension dimension,
                                                 std::size_t n, float* x, float* y) {
    for (std::size_t first = 0; first < n; first += Sampler::kRun) {
#pragma GCC ivdep
        for (std::size_t k = first; k < first + Sampler::kRun; ++k) {
            const SobolSeeds seeds(hash(pixel[k], dimension[k]));
            const std::uint32_t i = seeds.shuffled(index[k]);
            x[k] = seeds.x(i);
            y[k] = seeds.y(i);
        }
    }
}
template <class Dimension>
[[gnu::target("avx2")]] void sobol_squares_avx2(const std::uint32_t* pixel, const std::uint32_t* index, Dimension dimension,
                                                std::size_t n, float* x, float* y) {
    sobol_squares(pixel, index, dimension, n, x, y);
}

[[gnu::always_inline]] inline void joint_squares(const std::uint32_t* pixel, const std::uint32_t* index, std::uint32_t dimension,
                                                 const SobolColumns& columns, std::size_t n, float* x, float* y) {
    for (std::size_t first = 0; first < n; first += Sampler::kRun) {
#pragma GCC ivdep
        for (std::size_t k = first; k < first + Sampler::kRun; ++k) {
            const SobolSeeds seeds(pixel[k], dimension, true);
            const glm::vec2 p = seeds.pair(seeds.shuffled(index[k]), columns);
            x[k] = p.x;
            y[k] = p.y;
        }
    }
}
[[gnu::target("avx2")]] void joint_squares_avx2(const std::uint32_t* pixel, const std::uint32_t* index, std::uint32_t dimension,
                                                const SobolColumns& columns, std::size_t n, float* x, float* y) {
    joint_squares(pixel, index, dimension, columns, n, x, y);
}

template <class Dimension>
void squares_of(SamplerKind kind, const std::uint32_t* pixel, const std::uint32_t* index, Dimension dimension, std::size_t n,
                float* x, float* y) {
    if (kind == SamplerKind::sobol) {
        return isa_in_use() == Isa::baseline ? sobol_squares(pixel, index, dimension, n, x, y)
                                             : sobol_squares_avx2(pixel, index, dimension, n, x, y);
    }
    for (std::size_t k = 0; k < n; ++k) {
        const glm::vec2 p = Sampler(kind, pixel[k], index[k]).square(dimension[k]);
        x[k] = p.x;
        y[k] = p.y;
    }
}

// A random permutation of 0..n-1 without a table (Kensler 2013, "Correlated Multi-Jittered Sampling").
std::uint32_t permute(std::uint32_t i, std::uint32_t n, std::uint32_t p) {
    std::uint32_t w = n - 1;
    w |= w >> 1;
    w |= w >> 2;
    w |= w >> 4;
    w |= w >> 8;
    w |= w >> 16;
    do {
        i ^= p;
        i *= 0xe170893du;
        i ^= p >> 16;
        i ^= (i & w) >> 4;
        i ^= p >> 8;
        i *= 0x0929eb3fu;
        i ^= p >> 23;
        i ^= (i & w) >> 1;
        i *= 1u | p >> 27;
        i *= 0x6935fa69u;
        i ^= (i & w) >> 11;
        i *= 0x74dcb303u;
        i ^= (i & w) >> 2;
        i *= 0x9e501cc3u;
        i ^= (i & w) >> 2;
        i *= 0xc860a3dfu;
        i &= w;
        i ^= i >> 5;
    } while (i >= n);
    return (i + p) % n;
}

constexpr std::uint32_t kCells = kStrata * kStrata;

// Lattice cell of `regular`: the pixel's own dimension runs through it coarse to fine; the others pair at random, alike
// in every pixel.
std::uint32_t regular_cell(std::uint32_t index, std::uint32_t dimension) {
    const std::uint32_t i = index % kCells;
    if (dimension != 0) return permute(i, kCells, hash(dimension));
    std::uint32_t x = 0, y = 0;
    for (std::uint32_t bit = 0; bit < 3; ++bit) {
        x |= ((i >> (2 * bit)) & 1u) << (2 - bit);
        y |= ((i >> (2 * bit + 1)) & 1u) << (2 - bit);
    }
    return y * kStrata + x;
}

}  // namespace

void Sampler::squares(SamplerKind kind, const std::uint32_t* pixel, const std::uint32_t* index, const std::uint32_t* dimension,
                      std::size_t n, float* x, float* y) noexcept {
    const auto joint = [](std::uint32_t d) { return joint_columns(d) != nullptr; };
    if (kind == SamplerKind::joint && std::none_of(dimension, dimension + n, joint)) kind = SamplerKind::sobol;
    squares_of(kind, pixel, index, ByLane{dimension}, n, x, y);
}

void Sampler::squares(SamplerKind kind, const std::uint32_t* pixel, const std::uint32_t* index, std::uint32_t dimension,
                      std::size_t n, float* x, float* y) noexcept {
    if (kind == SamplerKind::joint) {
        const SobolColumns* columns = joint_columns(dimension);
        if (columns == nullptr) return squares_of(SamplerKind::sobol, pixel, index, OfAll{dimension}, n, x, y);
        return isa_in_use() == Isa::baseline ? joint_squares(pixel, index, dimension, *columns, n, x, y)
                                             : joint_squares_avx2(pixel, index, dimension, *columns, n, x, y);
    }
    squares_of(kind, pixel, index, OfAll{dimension}, n, x, y);
}

glm::vec2 Sampler::square(std::uint32_t dimension) const noexcept {
    const std::uint32_t seed = hash(pixel_, dimension);
    switch (kind_) {
        case SamplerKind::joint:
            if (const SobolColumns* columns = joint_columns(dimension)) {
                const SobolSeeds seeds(pixel_, dimension, true);
                return seeds.pair(seeds.shuffled(index_), *columns);
            }
            [[fallthrough]];
        case SamplerKind::sobol: {
            const SobolSeeds seeds(seed);
            const std::uint32_t i = seeds.shuffled(index_);
            return {seeds.x(i), seeds.y(i)};
        }
        case SamplerKind::jittered: {
            const std::uint32_t block = hash(seed, index_ / kCells);
            const std::uint32_t cell = permute(index_ % kCells, kCells, block);
            const std::uint32_t jitter = hash(block, index_ + 1);
            const glm::vec2 p((static_cast<float>(cell % kStrata) + unit_float(jitter)) / kStrata,
                              (static_cast<float>(cell / kStrata) + unit_float(hash(jitter))) / kStrata);
            return glm::min(p, 0x1.fffffep-1f);
        }
        case SamplerKind::random: {
            const std::uint32_t x = hash(seed, index_);
            return {unit_float(x), unit_float(hash(x ^ 0x967a889bu))};
        }
        case SamplerKind::regular: break;
    }
    const std::uint32_t cell = regular_cell(index_, dimension);
    return (glm::vec2(cell % kStrata, cell / kStrata) + 0.5f) / static_cast<float>(kStrata);
}

float Sampler::interval(std::uint32_t dimension) const noexcept {
    const std::uint32_t seed = hash(pixel_, dimension);
    switch (kind_) {
        case SamplerKind::joint:
        case SamplerKind::sobol: {
            const SobolSeeds seeds(seed);
            return seeds.x(seeds.shuffled(index_));
        }
        case SamplerKind::jittered: {
            const std::uint32_t block = hash(seed, index_ / kCells);
            const auto cell = static_cast<float>(permute(index_ % kCells, kCells, block));
            return std::min((cell + unit_float(hash(block, index_ + 1))) / kCells, 0x1.fffffep-1f);
        }
        case SamplerKind::random: return unit_float(hash(seed, index_));
        case SamplerKind::regular: break;
    }
    return (static_cast<float>(permute(index_ % kCells, kCells, hash(dimension))) + 0.5f) / static_cast<float>(kCells);
}

glm::vec2 disk_from_square(glm::vec2 u) noexcept {
    const glm::vec2 p = 2.0f * u - 1.0f;
    if (p.x == 0.0f && p.y == 0.0f) return {0.0f, 0.0f};
    constexpr float kQuarterPi = 0.785398163397448309616f;
    const bool wide = std::abs(p.x) > std::abs(p.y);
    const float r = wide ? p.x : p.y;
    const float angle = kQuarterPi * (wide ? p.y / p.x : p.x / p.y);
    const float c = std::cos(angle), s = std::sin(angle);
    return wide ? glm::vec2(r * c, r * s) : glm::vec2(r * s, r * c);
}

glm::vec3 sphere_from_square(glm::vec2 u) noexcept {
    constexpr float kTwoPi = 6.28318530717958647692f;
    const float z = 1.0f - 2.0f * u.x;
    const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    return {r * std::cos(kTwoPi * u.y), r * std::sin(kTwoPi * u.y), z};
}

}  // namespace glint
