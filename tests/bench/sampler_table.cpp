// Errors of the mean of N points for the samplers that glint ships and for others that work at any sample count, over
// independent seeds, on smooth and broken integrands of two and four dimensions with known means: whether another sequence
// should replace `sobol`. Knows no scene. Prints Markdown; errors hang on the seeds alone and are the same on every machine.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/dimension.h"
#include "core/sampler.h"

namespace glint::bench {
namespace {

constexpr std::size_t kMost = 4;  // dimensions
struct Point {
    double x[kMost];
};
struct Sequence {
    std::string name;
    std::function<Point(std::uint32_t seed, std::uint32_t index)> at;
};
struct Integrand {
    std::string name;
    std::size_t dimensions;
    double mean;
    std::function<double(const Point&)> value;
};

double unit(std::uint32_t x) { return static_cast<double>(x) * 0x1p-32; }
double shift_of(std::uint32_t seed, std::size_t axis) { return unit(hash(seed, 0x51ed270bu + static_cast<std::uint32_t>(axis))); }
double fraction(double x) { return x - std::floor(x); }

Sequence shipped(std::string name, SamplerKind kind) {
    return {std::move(name), [kind](std::uint32_t seed, std::uint32_t index) {
                const Sampler sampler(kind, seed, 77, index, 1234);
                const glm::vec2 a = sampler.square(dimension::pixel), b = sampler.square(hash(kCameraPath, 0));
                return Point{{a.x, a.y, b.x, b.y}};
            }};
}

// Radical inverse whose digits are permuted at random, each by what the digits before it are (Owen 1995).
double owen_radical_inverse(std::uint32_t index, std::uint32_t base, std::uint32_t seed) {
    double value = 0.0, weight = 1.0;
    std::uint32_t prefix = seed;
    for (int digit = 0; weight > 0x1p-40; ++digit) {
        const std::uint32_t d = index % base;
        index /= base;
        // A random permutation of the base's digits by sorting hashes; the rank of d.
        std::uint32_t rank = 0;
        const std::uint32_t own = hash(prefix, d);
        for (std::uint32_t other = 0; other < base; ++other) rank += hash(prefix, other) < own ? 1 : 0;
        weight /= base;
        value += rank * weight;
        prefix = hash(prefix, d + 1);
    }
    return value;
}
Point halton(std::uint32_t seed, std::uint32_t index) {
    constexpr std::uint32_t kBases[kMost] = {2, 3, 5, 7};
    Point p{};
    for (std::uint32_t i = 0; i < kMost; ++i) p.x[i] = owen_radical_inverse(index, kBases[i], hash(seed, i));
    return p;
}

// Four dimensions of one Sobol' sequence (direction numbers of Joe & Kuo 2008), nested uniform scrambling.
Point sobol4(std::uint32_t seed, std::uint32_t index) {
    struct Polynomial {
        std::uint32_t degree, coefficients, m[3];
    };
    constexpr Polynomial kPolynomials[3] = {{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}};
    Point p{};
    p.x[0] = owen_radical_inverse(index, 2, hash(seed, 0));
    for (std::uint32_t axis = 1; axis < kMost; ++axis) {
        const Polynomial& q = kPolynomials[axis - 1];
        std::uint32_t v[32];
        for (std::uint32_t k = 0; k < 32; ++k) {
            if (k < q.degree) {
                v[k] = q.m[k] << (31 - k);
                continue;
            }
            v[k] = v[k - q.degree] ^ (v[k - q.degree] >> q.degree);
            for (std::uint32_t j = 1; j < q.degree; ++j) v[k] ^= (q.coefficients >> (q.degree - 1 - j) & 1u) * v[k - j];
        }
        std::uint32_t x = 0, reversed = 0;
        for (std::uint32_t k = 0; k < 32; ++k) x ^= (index >> k & 1u) * v[k];
        for (std::uint32_t k = 0; k < 32; ++k) reversed |= (x >> k & 1u) << (31 - k);
        p.x[axis] = owen_radical_inverse(reversed, 2, hash(seed, axis));
    }
    return p;
}

// The additive recurrence of Roberts 2018 ("The Unreasonable Effectiveness of Quasirandom Sequences"), shifted.
Point additive(std::uint32_t seed, std::uint32_t index) {
    constexpr double kRoot2 = 1.32471795724474602596, kRoot4 = 1.16730397826141868426;
    const double step[kMost] = {1 / kRoot2, 1 / (kRoot2 * kRoot2), 1 / std::pow(kRoot4, 3), 1 / std::pow(kRoot4, 4)};
    Point p{};
    for (std::size_t i = 0; i < kMost; ++i) p.x[i] = fraction(step[i] * index + shift_of(seed, i));
    return p;
}

// An extensible rank-1 lattice in radical inverse order, shifted (generating vector: Cools, Kuo & Nuyens 2006); folded it
// integrates smooth functions faster (Hickernell 2002).
Point lattice(std::uint32_t seed, std::uint32_t index, bool folded) {
    constexpr double kVector[kMost] = {1, 182667, 469891, 498753};
    std::uint32_t reversed = 0;
    for (std::uint32_t k = 0; k < 32; ++k) reversed |= (index >> k & 1u) << (31 - k);
    Point p{};
    for (std::size_t i = 0; i < kMost; ++i) {
        const double x = fraction(unit(reversed) * kVector[i] + shift_of(seed, i));
        p.x[i] = folded ? 1.0 - std::abs(2.0 * x - 1.0) : x;
    }
    return p;
}

std::vector<Sequence> sequences() {
    return {shipped("joint", SamplerKind::joint),
            shipped("sobol", SamplerKind::sobol),
            shipped("jittered", SamplerKind::jittered),
            shipped("random", SamplerKind::random),
            {"Sobol' in 4-D, Owen", sobol4},
            {"Halton, Owen", halton},
            {"additive (R2, R4)", additive},
            {"lattice", [](std::uint32_t seed, std::uint32_t i) { return lattice(seed, i, false); }},
            {"lattice, folded", [](std::uint32_t seed, std::uint32_t i) { return lattice(seed, i, true); }}};
}

std::vector<Integrand> integrands() {
    constexpr double kPi = 3.14159265358979323846, kBell = 0.746824132812427;
    const auto bell = [](double x) { return std::exp(-x * x); };
    return {{"edge", 2, 0.585, [](const Point& p) { return p.x[1] < 0.4 + 0.37 * p.x[0] ? 1.0 : 0.0; }},
            {"disk", 2, 0.5, [](const Point& p) { return p.x[0] * p.x[0] + p.x[1] * p.x[1] < 2.0 / kPi ? 1.0 : 0.0; }},
            {"edge of the light", 2, 0.585, [](const Point& p) { return p.x[3] < 0.4 + 0.37 * p.x[2] ? 1.0 : 0.0; }},
            {"bell of the light", 2, kBell * kBell, [bell](const Point& p) { return bell(p.x[2]) * bell(p.x[3]); }},
            {"x y", 2, 0.25, [](const Point& p) { return p.x[0] * p.x[1]; }},
            {"bell", 2, kBell * kBell, [bell](const Point& p) { return bell(p.x[0]) * bell(p.x[1]); }},
            {"sum < 2", 4, 0.5, [](const Point& p) { return p.x[0] + p.x[1] + p.x[2] + p.x[3] < 2.0 ? 1.0 : 0.0; }},
            {"edge · bell", 4, 0.585 * kBell * kBell,
             [bell](const Point& p) { return (p.x[1] < 0.4 + 0.37 * p.x[0] ? 1.0 : 0.0) * bell(p.x[2]) * bell(p.x[3]); }},
            {"bell of 4", 4, std::pow(kBell, 4),
             [bell](const Point& p) { return bell(p.x[0]) * bell(p.x[1]) * bell(p.x[2]) * bell(p.x[3]); }}};
}

void print_table(const Integrand& f, const std::vector<std::uint32_t>& counts, std::uint32_t seeds) {
    fmt::print("\n| {}, {}-D |", f.name, f.dimensions);
    for (const std::uint32_t n : counts) fmt::print(" {} |", n);
    fmt::print("\n| --- |");
    for (std::size_t i = 0; i < counts.size(); ++i) fmt::print(" --- |");
    for (const Sequence& sequence : sequences()) {
        std::vector<double> squares(counts.size(), 0.0);
        for (std::uint32_t seed = 0; seed < seeds; ++seed) {
            double sum = 0.0;
            std::uint32_t k = 0;
            for (std::size_t i = 0; i < counts.size(); ++i) {
                for (; k < counts[i]; ++k) sum += f.value(sequence.at(seed, k));
                const double error = sum / counts[i] - f.mean;
                squares[i] += error * error / seeds;
            }
        }
        fmt::print("\n| {} |", sequence.name);
        for (const double s : squares) fmt::print(" {:.2g} |", std::sqrt(s));
    }
    fmt::print("\n");
}

}  // namespace
}  // namespace glint::bench

int main() {
    constexpr std::uint32_t kSeeds = 512;
    const std::vector<std::uint32_t> counts{16, 24, 64, 65, 96, 127, 256, 400, 1000, 1024};
    fmt::print("Root mean square error of the mean of N points, {} seeds.\n", kSeeds);
    for (const glint::bench::Integrand& f : glint::bench::integrands()) glint::bench::print_table(f, counts, kSeeds);
}
