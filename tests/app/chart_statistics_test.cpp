// The chart's statistics against values known by hand or by theory.
#include "app/chart_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace glint::chart {
namespace {

TEST(ChartStatistics, MedianAndItsDeviationOfFewValues) {
    EXPECT_EQ(median({}), 0.0);
    EXPECT_EQ(median({3.0}), 3.0);
    EXPECT_EQ(median({9.0, 1.0, 4.0}), 4.0);
    EXPECT_EQ(median({9.0, 1.0, 4.0, 2.0}), 3.0);
    EXPECT_EQ(median_deviation({1.0, 2.0, 4.0, 9.0, 100.0}), 3.0);
}

TEST(ChartStatistics, BandHoldsTheMedianAndNeverChanges) {
    const std::vector<double> values{1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 100.0};
    const Band a = median_band(values), b = median_band(values);
    EXPECT_EQ(a.middle, 5.5);
    EXPECT_LE(a.low, a.middle);
    EXPECT_GE(a.high, a.middle);
    EXPECT_LT(a.high, 100.0) << "one outlier of ten must not carry the median";
    EXPECT_EQ(a.low, b.low);
    EXPECT_EQ(a.high, b.high);
    const Band alike = median_band({2.0, 2.0, 2.0});
    EXPECT_EQ(alike.low, 2.0);
    EXPECT_EQ(alike.high, 2.0);
}

TEST(ChartStatistics, BandCoversTheTrueMedianAboutAsOftenAsItSays) {
    std::mt19937 random(5);
    std::exponential_distribution<double> draw(1.0);
    int covered = 0;
    constexpr int kTrials = 400;
    for (int i = 0; i < kTrials; ++i) {
        std::vector<double> values(12);
        for (double& v : values) v = draw(random);
        const Band band = median_band(values);
        covered += band.low <= std::log(2.0) && std::log(2.0) <= band.high;
    }
    // The percentile bootstrap of a median of twelve is known to lie a little off 95 %.
    EXPECT_GE(covered, kTrials * 90 / 100);
    EXPECT_LT(covered, kTrials);
}

TEST(ChartStatistics, SlopeOfAPowerLawIsItsExponent) {
    std::vector<XY> points;
    for (double n = 1.0; n <= 256.0; n *= 2.0) points.push_back({n, 0.3 * std::pow(n, -1.5)});
    points.push_back({512.0, -1.0e-9});  // below the reference's own noise
    points.push_back({1024.0, std::numeric_limits<double>::quiet_NaN()});
    const auto fit = log_log_slope(points);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->slope, -1.5, 1e-12);
    EXPECT_NEAR(fit->error, 0.0, 1e-9);
    EXPECT_FALSE(log_log_slope({{1.0, 1.0}}));
    EXPECT_FALSE(log_log_slope({{2.0, 1.0}, {2.0, 3.0}}));
    EXPECT_FALSE(log_log_slope({}));
    // y = 1, 2, 1 at x = 1, e, e^2: level, residual 2/3 (log 2)^2 over one degree of freedom and a spread of 2.
    const auto bent = log_log_slope({{1.0, 1.0}, {std::exp(1.0), 2.0}, {std::exp(2.0), 1.0}});
    ASSERT_TRUE(bent);
    EXPECT_NEAR(bent->slope, 0.0, 1e-12);
    EXPECT_NEAR(bent->error, std::log(2.0) / std::sqrt(3.0), 1e-12);
}

TEST(ChartStatistics, CrossingIsOnTheLineInLogLogOrCensored) {
    const std::vector<XY> curve{{1.0, 1.0}, {4.0, 0.25}, {16.0, 0.01}};
    Crossing at = first_below(curve, 0.5);
    EXPECT_EQ(at.kind, Crossing::Kind::reached);
    EXPECT_NEAR(at.x, 2.0, 1e-12);
    at = first_below(curve, 0.001);
    EXPECT_EQ(at.kind, Crossing::Kind::after_last);
    EXPECT_EQ(at.x, 16.0);
    at = first_below(curve, 2.0);
    EXPECT_EQ(at.kind, Crossing::Kind::before_first);
    EXPECT_EQ(at.x, 1.0);
    EXPECT_EQ(first_below({{1.0, 1.0}, {4.0, -0.1}}, 0.5).x, 4.0) << "no logarithm of what lies below the reference's noise";
    EXPECT_EQ(first_below({}, 0.5).kind, Crossing::Kind::after_last);
}

TEST(ChartStatistics, ACurveIsReadBetweenItsPointsInLogLog) {
    const std::vector<XY> curve{{1.0, 1.0}, {4.0, 0.25}, {16.0, 0.01}};
    EXPECT_EQ(value_at(curve, 0.9), std::numeric_limits<double>::infinity());
    EXPECT_EQ(value_at(curve, 1.0), 1.0);
    EXPECT_NEAR(value_at(curve, 2.0), 0.5, 1e-12);
    EXPECT_NEAR(value_at(curve, 16.0), 0.01, 1e-15);
    // The last line falls by 25 over a factor of 4.
    EXPECT_NEAR(value_at(curve, 64.0), 0.0004, 1e-15);
    EXPECT_EQ(value_at(curve, 64.0, 0.002), 0.002) << "not below its bias";
    EXPECT_EQ(value_at(curve, 64.0, 0.5), 0.01) << "a bias that the curve itself is below is none";
    EXPECT_EQ(value_at({{1.0, 0.5}, {4.0, 0.6}}, 8.0), 0.6) << "a curve does not rise";
    EXPECT_EQ(value_at({{1.0, 0.5}}, 8.0), 0.5);
    EXPECT_EQ(value_at({{1.0, 1.0}, {4.0, -0.1}}, 2.0), -0.1);
    EXPECT_EQ(value_at({}, 1.0), std::numeric_limits<double>::infinity());
}

TEST(ChartStatistics, FrontHoldsWhatNothingBeats) {
    // Slower and worse; equal; slower and better; faster and worse.
    const std::vector<XY> points{{2.0, 1.0}, {3.0, 2.0}, {2.0, 1.0}, {4.0, 0.5}, {1.0, 9.0}, {4.0, 0.7}};
    EXPECT_EQ(pareto_front(points), (std::vector<std::size_t>{4, 0, 3}));
    EXPECT_TRUE(pareto_front({}).empty());
    // No point of a front dominates another one, and each other point is dominated by one of it.
    std::mt19937 random(9);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<XY> cloud(200);
    for (XY& p : cloud) p = {unit(random), unit(random)};
    const auto front = pareto_front(cloud);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const bool on = std::ranges::find(front, i) != front.end();
        bool beaten = false;
        for (std::size_t j = 0; j < cloud.size(); ++j) beaten |= j != i && cloud[j].x <= cloud[i].x && cloud[j].y <= cloud[i].y;
        EXPECT_EQ(on, !beaten);
    }
}

TEST(ChartStatistics, C_05_BiasAndVarianceAreToldApart) {
    std::mt19937 random(3);
    constexpr double kBias = 0.02, kSigma = 0.1, kReferenceSigma = 0.01;
    constexpr std::size_t kPictures = 12, kValues = 30000;
    const auto split = [&](double bias) {
        std::normal_distribution<double> noise(bias, kSigma), reference(0.0, kReferenceSigma);
        BiasSplit s(kPictures);
        for (std::size_t i = 0; i < kValues; ++i) {
            double sum = 0.0, squares = 0.0;
            for (std::size_t k = 0; k < kPictures; ++k) {
                const double v = 1.0 + noise(random);
                sum += v;
                squares += v * v;
            }
            s.add(sum, squares, 1.0 + reference(random), kReferenceSigma * kReferenceSigma, 1.0);
        }
        return s;
    };
    const BiasSplit biased = split(kBias), fair = split(0.0);
    EXPECT_NEAR(biased.variance(), kSigma * kSigma, 0.02 * kSigma * kSigma);
    EXPECT_NEAR(biased.bias2(), kBias * kBias, 0.1 * kBias * kBias);
    EXPECT_GT(biased.bias2(), biased.bias2_noise());
    EXPECT_LT(std::abs(fair.bias2()), fair.bias2_noise()) << "what chance leaves is not called a bias";
}

}  // namespace
}  // namespace glint::chart
