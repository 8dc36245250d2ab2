#include "core/error_estimate.h"

#include <algorithm>
#include <cmath>

#include "core/sampler.h"

namespace glint {
namespace {

constexpr double kNinetyFive = 1.96, kCautious = 2.0;

// By what the next doublings' changes shrink, as the logarithm of the ratio of two in a row: at a slope of 0.5 (random, and no
// scrambled net is worse in the long run) and 1.5 (smooth integrands, Owen 1997). In between, before there is evidence: the
// built-in scenes have 0.35 ... 0.5.
const double kLogSlowest = std::log(0.5), kLogFastest = std::log(0.125);
const double kLogUsual = std::log(0.4);
constexpr double kUsualSpread = 0.2;
// Where several pairs of dimensions are drawn apart (`sobol`), or more of them together than a net is good for (`joint`), what
// hangs on more than one falls as 1/N, and soon that is all there is. What hangs on one alone falls about as 1/N^1.8, between
// edges and smooth integrands.
constexpr double kFast = 0.295;          // that part's ratio
constexpr double kFirstSlow = 0.25;      // usual share of the 1/N part in the first change
constexpr double kMostUsualSlow = 0.45;  // and the largest that counts as usual later
constexpr double kUsualSlowSpread = 0.6;
constexpr double kLeastSlow = 0.1;    // its share of any change: changes that shrink faster have not shown it yet
constexpr double kModelError = 0.16;  // of the newest change, relative; older ones follow the two powers less and less
constexpr double kOlder = 1.5;
// What the two powers leave out. In `joint` errors fall in steps, where samples fill the strata of four or six dimensions.
constexpr double kSobolSteps = 0.12, kJointSteps = 0.4;

// The ratio drifts: as samples grow, the parts of a picture that converge slowly make up more of what is left.
constexpr double kDrift = 0.07;
// Changes are weighed by noisy means. By how much that misleads goes with the relative change of the pixels that make up most of
// it (measured where all pixels are dark but for 4 or 6 % of their samples): shares of that, before and after the next doubling.
constexpr double kFreshMisled = 0.6, kSettledMisled = 0.5;
// Changes that are looked at. Two tell how they shrink badly, four how they did before what is rare was seen.
constexpr std::size_t kWindow = 3;

// Mean squared error and its spread at a power of two.
struct Level {
    // z spreads above the mean squared error.
    [[nodiscard]] double upper(double z) const { return mse * most * std::exp(z * spread); }

    double mse = 0.0;
    double spread = 0.0;             // standard deviation of log(mse)
    double least = 1.0, most = 1.0;  // limits that hold beside the spread, as factors of mse
    double ratio = 0.5;              // of the next doubling's change to the last one's
    double slow = 0.0, slope = 0.5;  // see ErrorEstimate
};

// Of the changes after doubling `k`, the newest of all or one that has settled.
const Changes& changes_of(std::span<const Doubling> doublings, std::size_t k) {
    return k + 1 < doublings.size() ? doublings[k].settled : doublings[k].fresh;
}

// The last changes, newest first, as means over pixels, and their variances. Pixels are independent, so the variance of their sum
// is at most the sum of squares.
struct Window {
    std::array<double, kWindow> change{}, variance{};
    std::size_t size = 0;

    Window(std::span<const Doubling> doublings, std::size_t limit, double pixels) : size(std::min(limit, doublings.size())) {
        for (std::size_t i = 0; i < size; ++i) {
            const std::size_t k = doublings.size() - 1 - i;
            const Changes& c = changes_of(doublings, k);
            const Changes& judge = doublings[i == 0 ? k : k + 1].fresh;
            const double misled = (i == 0 ? kFreshMisled : kSettledMisled) * (judge.sum > 0.0 ? judge.squares / judge.sum : 0.0);
            change[i] = c.sum / pixels;
            variance[i] = c.squares / (pixels * pixels) + misled * misled * change[i] * change[i];
        }
    }
};

// What is still to come after the newest change when each is `ratio` times the one before. `told` is the share of the ratio
// that the changes themselves have told, and `unsure` the spread of the logarithm of the rest.
Level extrapolate(const Window& w, double ratio, double told, double unsure) {
    double newer = 0.0, older = 0.0, level = 0.0, lever = 0.0, power = 1.0;
    const auto n = static_cast<double>(w.size);
    for (std::size_t i = 0; i < w.size; ++i, power *= ratio) {
        if (i + 1 < w.size) newer += w.change[i];
        if (i > 0) older += w.change[i];
        level += power * w.change[i] / n;
        lever += static_cast<double>(i) * power * w.change[i] / n;
    }
    Level out;
    out.ratio = ratio;
    out.slope = -0.5 * std::log2(ratio);
    out.mse = level * ratio / (1.0 - ratio);
    if (!(level > 0.0)) return out;
    // Of log(mse) by log(ratio), then by each change (delta method).
    const double by_ratio = lever / level + 1.0 / (1.0 - ratio);
    // This picture's own error strays from the expected one as the newest change, of as many pixels, does.
    double variance = by_ratio * by_ratio * unsure * unsure;
    if (w.change[0] > 0.0) variance += w.variance[0] / (w.change[0] * w.change[0]);
    power = 1.0;
    for (std::size_t i = 0; i < w.size; ++i, power *= ratio) {
        double by_change = power / (n * level);
        if (told > 0.0) by_change += by_ratio * told * ((i + 1 < w.size ? 1.0 / newer : 0.0) - (i > 0 ? 1.0 / older : 0.0));
        variance += by_change * by_change * w.variance[i];
    }
    out.spread = std::sqrt(variance);
    return out;
}

// What few samples cannot have seen yet, such as sparks, widens the interval: so much for one of them, as log(mse).
constexpr double kUnseen = 0.8;

// `units` independent samples, or blocks of them: the error falls as N^-1/2, for certain.
Level independent(const Window& w, double units) {
    Level out = extrapolate(w, 0.5, 0.0, 0.0);
    out.spread = std::hypot(out.spread, kUnseen / std::sqrt(units));
    return out;
}

// The ratio is what the changes say, weighed against what is usual by how well they say it.
Level scrambled(const Window& w) {
    double newer = 0.0, older = 0.0, variance = 0.0;
    for (std::size_t i = 0; i < w.size; ++i) {
        if (i + 1 < w.size) newer += w.change[i];
        if (i > 0) older += w.change[i];
    }
    double told = 0.0, ratio = kLogUsual;
    if (newer > 0.0 && older > 0.0) {
        for (std::size_t i = 0; i < w.size; ++i) {
            const double by_change = (i + 1 < w.size ? 1.0 / newer : 0.0) - (i > 0 ? 1.0 / older : 0.0);
            variance += by_change * by_change * w.variance[i];
        }
        told = kUsualSpread * kUsualSpread / (kUsualSpread * kUsualSpread + variance);
        ratio += told * (std::log(newer / older) - kLogUsual);
    }
    ratio = std::exp(std::clamp(ratio, kLogFastest, kLogSlowest));
    return extrapolate(w, ratio, told, std::hypot((1.0 - told) * kUsualSpread, kDrift));
}

// Two powers of the samples, fitted to the changes and to the usual shares, each weighed by what is unsure about it.
Level padded(const Window& w, std::size_t known, double steps) {
    double usual = std::ldexp(kFirstSlow / (1.0 - kFirstSlow), static_cast<int>(known) - 1);
    usual = std::min(kMostUsualSlow, usual / (1.0 + usual));
    Level out = extrapolate(w, 0.5, 0.0, 0.0);  // of the right size
    if (!(out.mse > 0.0)) return out;
    const double unit = out.mse;
    // Normal equations for the two parts of the newest change, in that unit.
    const double by_slow = (1.0 - usual) / kUsualSlowSpread, by_fast = -usual / kUsualSlowSpread;
    double ss = by_slow * by_slow, sf = by_slow * by_fast, ff = by_fast * by_fast, s = 0.0, f = 0.0;
    double slower = 1.0, faster = 1.0, model = kModelError;
    for (std::size_t i = 0; i < w.size; ++i, slower /= 0.5, faster /= kFast, model *= kOlder) {
        const double change = w.change[i] / unit, unsure = model * std::max(change, 0.5 * slower);
        const double weight = 1.0 / (unsure * unsure + w.variance[i] / (unit * unit));
        ss += weight * slower * slower;
        sf += weight * slower * faster;
        ff += weight * faster * faster;
        s += weight * slower * change;
        f += weight * faster * change;
    }
    const double determinant = ss * ff - sf * sf;
    double slow = (ff * s - sf * f) / determinant, fast = (ss * f - sf * s) / determinant;
    if (slow < kLeastSlow * (slow + fast)) {
        constexpr double a = kLeastSlow, b = 1.0 - kLeastSlow;
        const double change = (a * s + b * f) / (a * a * ss + 2.0 * a * b * sf + b * b * ff);
        slow = a * change, fast = b * change;
    }
    if (fast < 0.0) fast = 0.0, slow = s / ss;
    constexpr double kFastRest = kFast / (1.0 - kFast);  // all later changes over the newest
    const double mse = slow + kFastRest * fast;
    double variance = (ff - 2.0 * kFastRest * sf + kFastRest * kFastRest * ss) / (determinant * mse * mse);
    variance += steps * steps + kUnseen * kUnseen * std::ldexp(1.0, -static_cast<int>(known));
    if (w.change[0] > 0.0) variance += w.variance[0] / (w.change[0] * w.change[0]);
    out.mse = unit * mse;
    out.slow = slow / mse;
    out.slope = 0.5 * out.slow - 0.5 * std::log2(kFast) * (1.0 - out.slow);
    out.ratio = 0.5 * out.slow + kFast * (1.0 - out.slow);
    out.spread = std::sqrt(variance);
    return out;
}

// Up to a whole block of strata a pixel has drawn cells without replacement (Cochran 1977, section 2.6): with S = what random
// samples would have, its error lies between S (1/N - 1/64), all of it between cells, and S/N, all of it within them. Mostly it
// is between them, by how much no sample tells: the interval has both ends.
Level within_a_block(const Window& w, double samples) {
    constexpr double kBlock = kStrata * kStrata, kUsuallyBetween = 0.75;
    Level out = independent(w, samples);
    const double left = 1.0 - samples / kBlock;
    const double middle = 1.0 - kUsuallyBetween * samples / kBlock;
    out.mse *= middle;
    out.least = left / middle;
    out.most = 1.0 / middle;
    return out;
}

Level level_at(std::span<const Doubling> doublings, double pixels, Randomness random) {
    constexpr std::size_t kInBlock = std::bit_width(kStrata * kStrata) - 1;
    const std::size_t n = doublings.size();
    const double samples = std::ldexp(1.0, static_cast<int>(n));
    switch (random.sampler) {
        case SamplerKind::random: return independent({doublings, kWindow, pixels}, samples);
        case SamplerKind::jittered:
            if (n <= kInBlock) return within_a_block({doublings, kWindow, pixels}, samples);
            return independent({doublings, std::min(kWindow, n - kInBlock), pixels}, samples / (kStrata * kStrata));
        default: break;
    }
    if (!random.one_square)
        return padded({doublings, kWindow, pixels}, n, random.sampler == SamplerKind::joint ? kJointSteps : kSobolSteps);
    return scrambled({doublings, kWindow, pixels});
}

// What no net exceeds by much, and tells better in small pictures, whose changes tell a ratio badly.
Level ceiling_at(std::span<const Doubling> doublings, double pixels, SamplerKind sampler, const Level& level) {
    const bool net = sampler != SamplerKind::random && sampler != SamplerKind::jittered;
    return net ? independent({doublings, kWindow, pixels}, std::ldexp(1.0, static_cast<int>(doublings.size()))) : level;
}

// Between powers of two a sequence may be worse than at the last one. N samples are blocks of powers of two; a block of n and any
// later part of its twin have the covariance 2 MSE(2n) - MSE(n), since the twins' mean has MSE(2n). Returns MSE(N) over the one
// at the greatest power of two in N.
double between_doublings(std::span<const Doubling> doublings, double pixels, const Level& level, int spp) {
    std::array<double, kDoublings + 1> mse{};  // at 2^k
    const std::size_t top = doublings.size();
    mse[top] = level.mse;
    mse[top + 1] = level.mse * level.ratio;
    for (std::size_t k = top; k-- > 0;) mse[k] = mse[k + 1] + changes_of(doublings, k).sum / pixels;
    const auto n = static_cast<std::uint32_t>(spp);
    double sum = 0.0;
    std::uint32_t later = n;
    for (std::size_t k = top + 1; k-- > 0;) {
        const std::uint32_t block = 1u << k;
        if ((n & block) == 0) continue;
        later -= block;
        const auto size = static_cast<double>(block);
        sum += size * size * mse[k] + 2.0 * size * static_cast<double>(later) * (2.0 * mse[k + 1] - mse[k]);
    }
    return std::max(0.0, sum / (static_cast<double>(n) * n)) / level.mse;
}

}  // namespace

ErrorEstimate estimate_error(std::span<const Doubling> doublings, std::size_t pixels, int spp, Randomness random) {
    ErrorEstimate e;
    e.spp = spp;
    const std::size_t known = std::min({doublings.size(), doublings_within(spp), kDoublings - 1});
    // The lattice is the same in every pixel and with every seed; what it misses, no sample shows.
    if (random.sampler == SamplerKind::regular || known == 0 || pixels == 0) return e;
    doublings = doublings.first(known);
    const auto count = static_cast<double>(pixels);
    const Level level = level_at(doublings, count, random);
    e.kind = ErrorEstimate::Kind::estimated;
    e.slope = level.slope;
    e.slow = level.slow;
    if (!(level.mse > 0.0)) return e;
    const bool doubled = std::has_single_bit(static_cast<std::uint32_t>(spp));
    const double here = doubled ? 1.0 : between_doublings(doublings, count, level, spp);
    const Level ceiling = ceiling_at(doublings, count, random.sampler, level);
    const auto upper = [&](double z) {
        return std::sqrt(here * std::max(level.mse, std::min(level.upper(z), ceiling.upper(z))));
    };
    e.relrmse = std::sqrt(here * level.mse);
    e.low = std::sqrt(here * level.mse * level.least * std::exp(-kNinetyFive * level.spread));
    e.high = upper(kNinetyFive);
    e.cautious = upper(kCautious);
    return e;
}

}  // namespace glint
