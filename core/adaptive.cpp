#include "core/adaptive.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace glint {
namespace {

// By what the error's decrease shrinks from one doubling to the next, see error_estimate.cpp.
constexpr double kRatio = 0.4;
// Samples given out between two looks at the tiles, as a part of all so far: few would leave threads without work, many would
// decide by what is known no longer.
constexpr std::uint64_t kLooks = 4;

std::uint64_t cost(const TileState& t) { return static_cast<std::uint64_t>(doubled(t.samples) - t.samples) * t.pixels; }

// Error that the next doubling takes away for its work, up to a factor that is the same for all. Two changes tell more than one,
// which may be small by chance.
double promise(const TileState& t) { return (t.change + kRatio * t.change_before) / static_cast<double>(t.work); }

// As many of `order` as there is room for, up to `most` samples.
std::vector<std::size_t> taken(std::span<const TileState> tiles, const std::vector<std::size_t>& order, std::uint64_t room,
                               std::uint64_t most) {
    std::vector<std::size_t> out;
    std::uint64_t sum = 0;
    for (const std::size_t i : order) {
        if (sum >= most) break;
        const std::uint64_t c = cost(tiles[i]);
        if (sum + c > room) continue;
        sum += c;
        out.push_back(i);
    }
    return out;
}

// A stratum on the way to half the picture's error. Errors are summed squares, samples those of all its pixels.
struct Course {
    ErrorEstimate estimate;
    double pixels, samples, error;
    double doublings = 0.0;

    [[nodiscard]] double error_after(double more) const { return error * square_left(estimate, doublings + more); }
    [[nodiscard]] double samples_after(double more) const { return samples * std::exp2(doublings + more); }
};

// By how many times all samples have to grow until the error is half, where each goes to the stratum that gains most by it.
double fewest_times_to_halve(std::vector<Course> courses) {
    constexpr double kStep = 0.125, kMostTimes = 0x1p10;
    double pixels = 0.0, before = 0.0, error = 0.0;
    for (const Course& c : courses) pixels += c.pixels, before += c.samples, error += c.error;
    double samples = before;
    const double wanted = 0.25 * error;
    while (error > wanted && samples < kMostTimes * before) {
        Course* next = nullptr;
        double most = -1.0;
        for (Course& c : courses) {
            const bool behind = c.samples_after(0.0) / c.pixels * kMostBehind <= samples / pixels;
            const double gain = (c.error_after(0.0) - c.error_after(kStep)) / (c.samples_after(kStep) - c.samples_after(0.0));
            const double promised = behind ? std::numeric_limits<double>::infinity() : gain;
            if (promised > most) most = promised, next = &c;
        }
        samples += next->samples_after(kStep) - next->samples_after(0.0);
        error -= next->error_after(0.0) - next->error_after(kStep);
        next->doublings += kStep;
    }
    return samples / before;
}

}  // namespace

int doubled(int samples) { return 2 * static_cast<int>(std::bit_floor(static_cast<unsigned>(samples))); }

std::vector<std::size_t> tiles_to_double(std::span<const TileState> tiles, int spp) {
    std::uint64_t pixels = 0, samples = 0;
    for (const TileState& t : tiles) {
        pixels += t.pixels;
        samples += static_cast<std::uint64_t>(t.samples) * t.pixels;
    }
    std::vector<std::size_t> behind, order;
    std::vector<double> promised(tiles.size());
    for (std::size_t i = 0; i < tiles.size(); ++i) {
        const auto n = static_cast<std::uint64_t>(tiles[i].samples);
        promised[i] = promise(tiles[i]);
        (n < kUniformSamples || n * kMostBehind * pixels <= samples ? behind : order).push_back(i);
    }
    std::stable_sort(behind.begin(), behind.end(),
                     [&](std::size_t a, std::size_t b) { return tiles[a].samples < tiles[b].samples; });
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return promised[a] > promised[b]; });
    const std::uint64_t last = static_cast<std::uint64_t>(spp) * pixels;
    for (std::uint64_t stop = pixels; samples < last; stop *= 2) {
        if (stop <= samples && stop < last) continue;
        const std::uint64_t room = std::min(stop, last) - samples;
        std::vector<std::size_t> out = taken(tiles, behind, room, room);
        if (out.empty()) out = taken(tiles, order, room, std::max<std::uint64_t>(1, samples / kLooks));
        if (!out.empty() || stop >= last) return out;
    }
    return {};
}

ErrorEstimate estimate_error(std::span<const Stratum> strata, int spp, Randomness random) {
    ErrorEstimate all;
    all.spp = spp;
    double pixels = 0.0, relmse = 0.0, low = 0.0, high = 0.0, cautious = 0.0, slope = 0.0, slow = 0.0;
    std::vector<Course> courses;
    for (const Stratum& s : strata) {
        const ErrorEstimate e = estimate_error(s.doublings, s.pixels, s.spp, random);
        if (e.kind == ErrorEstimate::Kind::unknown) return all;
        const auto n = static_cast<double>(s.pixels);
        const double part = n * e.relrmse * e.relrmse;
        pixels += n;
        relmse += part;
        low += n * e.low * e.low;
        high += n * e.high * e.high;
        cautious += n * e.cautious * e.cautious;
        slope += part * e.slope;
        slow += part * e.slow;
        courses.push_back({e, n, n * s.spp, part});
    }
    if (!(pixels > 0.0)) return all;
    all.kind = ErrorEstimate::Kind::estimated;
    all.relrmse = std::sqrt(relmse / pixels);
    all.low = std::sqrt(low / pixels);
    all.high = std::sqrt(high / pixels);
    all.cautious = std::sqrt(cautious / pixels);
    if (!(relmse > 0.0)) return all;
    all.slope = slope / relmse;
    all.slow = slow / relmse;
    // Tiles are doubled whole, and chosen by changes that are partly chance: half way, as factors, from all alike to the best.
    all.spared = std::min(1.0, std::sqrt(fewest_times_to_halve(std::move(courses)) / times_until(all, 0.5)));
    return all;
}

}  // namespace glint
