// How fast sample means converge: errors of the samplers over many seeds against closed forms and measured tables.
#include <gtest/gtest.h>

#include "core/dimension.h"
#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

struct Integrand {
    const char* name;
    double (*value)(glm::dvec2);
    double exact;
};

// erf(1) sqrt(pi) / 2 squared: the mean of exp(-x^2 - y^2) over the unit square.
constexpr double kGauss = 0.746824132812427 * 0.746824132812427;
const Integrand kDisk{"disk", [](glm::dvec2 p) { return glm::dot(p, p) < 2.0 / kPi ? 1.0 : 0.0; }, 0.5};
const Integrand kEdge{"edge", [](glm::dvec2 p) { return p.y < 0.4 + 0.37 * p.x ? 1.0 : 0.0; }, 0.585};
const Integrand kProduct{"x*y", [](glm::dvec2 p) { return p.x * p.y; }, 0.25};
const Integrand kBell{"gauss", [](glm::dvec2 p) { return std::exp(-glm::dot(p, p)); }, kGauss};

// Root mean square errors of the mean after 4, 16, 64, 256 and 1024 samples, over independent pixels.
std::vector<double> errors(SamplerKind kind, const Integrand& f, std::uint32_t pixels = 1024) {
    std::vector<double> squares(5);
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
        double sum = 0.0;
        std::uint32_t k = 0;
        for (std::size_t row = 0; row < squares.size(); ++row) {
            const std::uint32_t n = 4u << (2 * row);
            for (; k < n; ++k) sum += f.value(glm::dvec2(Sampler(kind, pixel, 77, k, 1234).square(dimension::pixel)));
            const double error = sum / n - f.exact;
            squares[row] += error * error / pixels;
        }
    }
    for (std::size_t row = 0; row < squares.size(); ++row) {
        squares[row] = std::sqrt(squares[row]);
        note(fmt::format("{}_{}_{}", f.name, kSamplerNames[static_cast<std::size_t>(kind)], 4 << (2 * row)), squares[row]);
    }
    return squares;
}

// Least-squares slope of log error over log N, for N = 4 ... 1024.
double slope(const std::vector<double>& e) {
    double sum = 0.0, squares = 0.0;
    const double middle = 0.5 * static_cast<double>(e.size() - 1);
    for (std::size_t i = 0; i < e.size(); ++i) {
        const double x = static_cast<double>(i) - middle;
        sum += x * std::log(e[i]), squares += x * x;
    }
    return sum / squares / std::log(4.0);
}

void expect_within_a_tenth(const std::vector<double>& measured, const std::vector<double>& table, const char* name) {
    for (std::size_t i = 0; i < table.size(); ++i)
        EXPECT_NEAR(measured[i + 1] / table[i], 1.0, 0.1) << name << " N=" << (16 << (2 * i));
}

TEST(Convergence, S_SMP_06_RandomNumbersFollowTheTable) {
    struct Row {
        const Integrand& f;
        std::vector<double> table;
    };
    for (const Row& row : {Row{kDisk, {.125, .0598, .0300, .0163}},
                           {kEdge, {.123, .0629, .0311, .0155}},
                           {kProduct, {.0528, .0267, .0143, .0068}},
                           {kBell, {.0551, .0261, .0140, .0068}}}) {
        const std::vector<double> e = errors(SamplerKind::random, row.f);
        expect_within_a_tenth(e, row.table, row.f.name);
        EXPECT_NEAR(slope(e), -.50, .05) << row.f.name;
    }
}

// The table: nested uniform scrambling (Owen 1995) with a 64-bit hash for every digit, 4096 seeds.
TEST(Convergence, S_SMP_06_SobolErrsAsOwenScramblingDoes) {
    struct Row {
        const Integrand& f;
        std::vector<double> table;
        double slope;
    };
    for (const Row& row : {Row{kDisk, {.0519, .01758, .00624, .002206}, -.70},
                           {kEdge, {.0469, .01641, .00578, .002043}, -.70},
                           {kProduct, {6.81e-3, 1.000e-3, 1.452e-4, 1.963e-5}, -1.2},
                           {kBell, {4.25e-3, 5.94e-4, 7.94e-5, 1.075e-5}, -1.2}}) {
        const std::vector<double> e = errors(SamplerKind::sobol, row.f, 2048);
        expect_within_a_tenth(e, row.table, row.f.name);
        EXPECT_LE(slope(e), row.slope) << row.f.name;
    }
}

// Pixel and light together: four dimensions, of which padded pairs cover only the projections.
TEST(Convergence, S_SMP_10_JointCoversPixelAndLightTogether) {
    const auto error = [](SamplerKind kind, std::uint32_t n, bool edge) {
        double squares = 0.0;
        for (std::uint32_t pixel = 0; pixel < 512; ++pixel) {
            double sum = 0.0;
            for (std::uint32_t k = 0; k < n; ++k) {
                const Sampler sampler(kind, pixel, 77, k, 1234);
                const glm::dvec2 a = sampler.square(dimension::pixel), b = sampler.square(hash(kCameraPath, 0));
                sum += (edge ? kEdge : kBell).value(a) * kBell.value(b);
            }
            const double e = sum / n - (edge ? kEdge : kBell).exact * kBell.exact;
            squares += e * e / 512;
        }
        return std::sqrt(squares);
    };
    for (const bool edge : {false, true}) {
        for (const std::uint32_t n : {16u, 64u, 100u, 256u}) {
            const double joint = error(SamplerKind::joint, n, edge), padded = error(SamplerKind::sobol, n, edge);
            note(fmt::format("joint_{}_{}", edge ? "edge" : "bell", n), joint);
            EXPECT_LE(joint, (n < 64 ? 0.85 : edge ? 0.7 : 0.35) * padded) << n;
        }
    }
}

// Between powers of two a sequence is worse than at the last one, so errors are claimed there; but no count is worse than
// random numbers, so that every pass may be shown.
TEST(Convergence, S_SMP_07_ErrorsAreClaimedAtPowersOfTwo) {
    for (const Integrand* f : {&kProduct, &kBell}) {
        std::vector<double> squares(129);
        constexpr std::uint32_t kPixels = 2048;
        for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
            double sum = 0.0;
            for (std::uint32_t k = 0; k < 128; ++k) {
                sum += f->value(glm::dvec2(Sampler(SamplerKind::sobol, pixel, 7, k, 65).square(dimension::pixel)));
                squares[k + 1] += std::pow(sum / (k + 1.0) - f->exact, 2) / kPixels;
            }
        }
        const auto error = [&](std::size_t n) { return std::sqrt(squares[n]); };
        for (const std::size_t n : {64u, 65u, 127u, 128u}) note(fmt::format("{}_{}", f->name, n), error(n));
        EXPECT_GT(error(65), 2.0 * error(64)) << f->name;
        EXPECT_GT(error(127), 2.0 * error(128)) << f->name;
        for (std::size_t n = 1; n <= 128; ++n) EXPECT_LE(error(n), 1.05 * error(1) / std::sqrt(n)) << f->name << ' ' << n;
    }
}

// Blocks of 8 x 8 strata: the table's value at 64; further blocks are independent, so the error then falls by the root.
TEST(Convergence, S_SMP_06_JitterFollowsTheTableAtAWholeBlock) {
    struct Row {
        const Integrand& f;
        double table;
    };
    for (const Row& row : {Row{kDisk, .0202}, {kEdge, .0182}, {kProduct, .00359}, {kBell, .00335}}) {
        const std::vector<double> e = errors(SamplerKind::jittered, row.f);
        EXPECT_NEAR(e[2] / row.table, 1.0, 0.1) << row.f.name;
        EXPECT_NEAR(2.0 * e[3] / e[2], 1.0, 0.1) << row.f.name;
        EXPECT_NEAR(4.0 * e[4] / e[2], 1.0, 0.1) << row.f.name;
    }
}

// Coverage of a vertical edge at x = 0.3 by n strata of x, one sample each: only the stratum that it cuts is uncertain.
TEST(Convergence, O_AA_01_CoverageOfAVerticalEdge) {
    const Integrand edge{"vertical", [](glm::dvec2 p) { return p.x < 0.3 ? 1.0 : 0.0; }, 0.3};
    const auto cut = [](double n) { return .3 * n - std::floor(.3 * n); };
    // 8 x 8 jitter: eight strata of each column are cut.
    const std::vector<double> jittered = errors(SamplerKind::jittered, edge, 4096);
    EXPECT_NEAR(jittered[2] / .0216506, 1.0, 0.04);
    EXPECT_NEAR(std::sqrt(cut(8) * (1 - cut(8)) / 512.0), .0216506, 1e-7);
    const std::vector<double> random = errors(SamplerKind::random, edge, 4096);
    constexpr double kRandom[] = {.229, .115, .0573, .0286};
    EXPECT_NEAR(random[0] / kRandom[0], 1.0, 0.04);
    EXPECT_NEAR(random[1] / kRandom[1], 1.0, 0.04);
    EXPECT_NEAR(random[2] / kRandom[2], 1.0, 0.04);
    EXPECT_NEAR(random[3] / kRandom[3], 1.0, 0.04);
    // N strata of x, as Sobol' points have: sqrt(p (1 - p)) / N.
    const std::vector<double> sobol = errors(SamplerKind::sobol, edge, 4096);
    for (std::size_t i = 0; i < sobol.size(); ++i) {
        const double n = std::ldexp(4.0, 2 * static_cast<int>(i));
        EXPECT_NEAR(sobol[i] / (std::sqrt(cut(n) * (1 - cut(n))) / n), 1.0, 0.05) << n;
    }
}

TEST(Convergence, O_AA_02_CoverageOfASlopedEdgeAndADiskIsUnbiased) {
    for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::jittered, SamplerKind::random}) {
        for (const Integrand* f : {&kEdge, &kDisk, &kProduct, &kBell}) {
            std::vector<double> means;
            for (std::uint32_t pixel = 0; pixel < 4096; ++pixel) {
                double sum = 0.0;
                for (std::uint32_t k = 0; k < 64; ++k)
                    sum += f->value(glm::dvec2(Sampler(kind, pixel, 3, k, 99).square(dimension::pixel)));
                means.push_back(sum / 64.0);
            }
            const Estimate e = estimate(means);
            EXPECT_NEAR(e.mean, f->exact, 3.0 * e.standard_error)
                << f->name << ' ' << kSamplerNames[static_cast<std::size_t>(kind)];
            EXPECT_LE(e.standard_error, .003 * f->exact);
        }
    }
}

TEST(Convergence, O_AA_03_TheMeanPositionIsTheCentre) {
    const Integrand position{"position", [](glm::dvec2 p) { return p.x; }, 0.5};
    const double by_jitter = 1.0 / (std::sqrt(12.0) * 64.0), by_random = 1.0 / (std::sqrt(12.0) * 8.0);
    EXPECT_NEAR(errors(SamplerKind::jittered, position, 4096)[2] / by_jitter, 1.0, 0.05);
    EXPECT_NEAR(errors(SamplerKind::random, position, 4096)[2] / by_random, 1.0, 0.05);
    // 64 strata of x: each errs by 1/64 of its own, so the mean by 64^-3/2.
    EXPECT_NEAR(errors(SamplerKind::sobol, position, 4096)[2] / (by_random / 64.0), 1.0, 0.05);
}

// A checkerboard of the size of a pixel at any offset: no sampler pattern may lock into it.
TEST(Convergence, S_SMP_08_APatternOfThePixelsSizeFoolsNoSampler) {
    double worst = 0.0;
    for (int offset = 0; offset < 64; ++offset) {
        const double ox = (offset % 8 + 0.37) / 8.0, oy = (offset / 8 + 0.61) / 8.0;
        const double exact = ox * oy + (1.0 - ox) * (1.0 - oy);
        for (const std::uint32_t n : {16u, 64u}) {
            double square[2] = {0.0, 0.0};
            for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::random}) {
                for (std::uint32_t pixel = 0; pixel < 256; ++pixel) {
                    double sum = 0.0;
                    for (std::uint32_t k = 0; k < n; ++k) {
                        const glm::dvec2 u(
                            Sampler(kind, pixel, 8, k, static_cast<std::uint64_t>(offset)).square(dimension::pixel));
                        sum += (u.x < ox) == (u.y < oy) ? 1.0 : 0.0;
                    }
                    square[kind == SamplerKind::random ? 1 : 0] += std::pow(sum / n - exact, 2);
                }
            }
            worst = std::max(worst, std::sqrt(square[0] / square[1]));
        }
    }
    note("worst_ratio", worst);
    EXPECT_LE(worst, 1.1);
}

}  // namespace
}  // namespace glint
