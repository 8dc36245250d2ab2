// When a picture may stop, and when it will: what error_estimate.h promises beside the estimate itself.
#include <algorithm>
#include <bit>
#include <cmath>

#include "core/error_estimate.h"

namespace glint {
namespace {

// Rare events have to show in the picture as a whole, and three doublings have to tell how it converges.
constexpr int kLeastSamples = 8;
constexpr std::size_t kLeastPictureSamples = std::size_t{1} << 16;

}  // namespace

int least_samples(std::size_t pixels) {
    const std::size_t each = (kLeastPictureSamples + pixels - 1) / std::max<std::size_t>(1, pixels);
    return std::max(kLeastSamples, static_cast<int>(std::bit_ceil(each)));
}

bool error_reached(const ErrorEstimate& e, std::size_t pixels, double target) {
    if (e.kind == ErrorEstimate::Kind::exact) return true;
    return e.kind == ErrorEstimate::Kind::estimated && std::has_single_bit(static_cast<std::uint32_t>(e.spp)) &&
           e.spp >= least_samples(pixels) && e.cautious <= target;
}

double square_left(const ErrorEstimate& e, double doublings) {
    const double rest = e.slow < 1.0 ? (2.0 * e.slope - e.slow) / (1.0 - e.slow) : 1.0;
    return e.slow * std::exp2(-doublings) + (1.0 - e.slow) * std::exp2(-rest * doublings);
}

double times_until(const ErrorEstimate& e, double part) {
    const auto doublings_until = [&e](double left) {
        double low = -64.0, high = 64.0;
        for (int i = 0; i < 64; ++i) {
            const double middle = 0.5 * (low + high);
            (square_left(e, middle) > left * left ? low : high) = middle;
        }
        return high;
    };
    // Choosing spares its part bit by bit until the error is halved, and nothing more from there on.
    const double all = doublings_until(part);
    const double halved = e.spared < 1.0 ? std::clamp(all / doublings_until(0.5), 0.0, 1.0) : 0.0;
    return std::exp2(all + halved * std::log2(e.spared));
}

int predicted_samples(const ErrorEstimate& e, std::size_t pixels, double target) {
    if (e.kind != ErrorEstimate::Kind::estimated || !(target > 0.0)) return e.kind == ErrorEstimate::Kind::exact ? e.spp : 0;
    const double times = e.cautious > target ? times_until(e, target / e.cautious) : 1.0;
    const double wanted = std::max(times * e.spp, static_cast<double>(least_samples(pixels)));
    if (!(wanted <= 0x1p30)) return 0;
    return static_cast<int>(std::bit_ceil(static_cast<std::uint32_t>(std::ceil(wanted))));
}

}  // namespace glint
