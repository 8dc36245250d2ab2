#include "app/chart_curves.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace glint::chart {
namespace {

// Sums over pictures, for telling bias from variance.
struct Sums {
    std::vector<double> sum, squares;

    void add(const Image& image) {
        sum.resize(image.pixels.size() * 3, 0.0);
        squares.resize(sum.size(), 0.0);
        for (std::size_t i = 0; i < sum.size(); ++i) {
            const double v = image.pixels[i / 3][static_cast<int>(i % 3)];
            sum[i] += v;
            squares[i] += v * v;
        }
    }
    [[nodiscard]] BiasSplit split(const Reference& r, std::size_t pictures) const {
        BiasSplit s(pictures);
        for (std::size_t i = 0; i < sum.size(); ++i) {
            const int c = static_cast<int>(i % 3);
            s.add(sum[i], squares[i], r.mean[i / 3][c], r.variance[i / 3][c], relative_scale(r.mean[i / 3][c]));
        }
        return s;
    }
};

struct Raw {
    std::vector<double> seconds, errors, honesty;
    double rays = 0.0, covered = 0.0;

    void add(const Shot& shot, double error) {
        seconds.push_back(shot.seconds);
        errors.push_back(error);
        rays = static_cast<double>(shot.rays.total());
        const ErrorEstimate& e = shot.estimate;
        if (e.kind != ErrorEstimate::Kind::estimated || !(error > 0.0)) return;
        const double truth = std::sqrt(error);
        honesty.push_back(e.relrmse / truth);
        if (e.low <= truth && truth <= e.high) covered += 1.0;
    }
};

}  // namespace

std::vector<XY> Curve::error_over_seconds() const {
    std::vector<XY> xy;
    for (const Measured& m : points) xy.push_back({m.total(build), m.error.middle});
    return xy;
}

std::optional<Slope> Curve::exponent() const {
    std::vector<XY> xy;
    for (const Measured& m : points) xy.push_back({static_cast<double>(m.spp), m.error.middle});
    const auto fit = log_log_slope(xy);
    if (!fit) return std::nullopt;
    return Slope{-0.5 * fit->slope, 0.5 * fit->error};
}

std::vector<Curve> measure_curves(Bench& bench, const std::vector<Variant>& variants, int seeds, bool split, Meter& meter) {
    std::vector<std::vector<Raw>> raw(variants.size());
    std::vector<Sums> sums(split ? variants.size() : 0);
    for (std::size_t v = 0; v < variants.size(); ++v) {
        raw[v].resize(variants[v].spps.size());
        (void)bench.take(variants[v].settings, 1, variants[v].accelerator);
    }
    const double per_spp = bench.seconds_per_spp();
    for (int seed = 0; seed < seeds; ++seed) {
        for (std::size_t v = 0; v < variants.size(); ++v) {
            RenderSettings settings = variants[v].settings;
            settings.seed = bench.subject().seed + static_cast<std::uint64_t>(seed);
            for (std::size_t i = 0; i < variants[v].spps.size(); ++i) {
                const int spp = variants[v].spps[i];
                const Shot shot = bench.take(settings, spp, variants[v].accelerator);
                raw[v][i].add(shot, relative_error(shot.image, *variants[v].reference));
                if (split && i + 1 == variants[v].spps.size()) sums[v].add(shot.image);
                meter.did(per_spp * spp);
            }
        }
    }
    std::vector<Curve> curves;
    for (std::size_t v = 0; v < variants.size(); ++v) {
        Curve c{variants[v].name, variants[v].settings, bench.build_seconds(variants[v].accelerator), {}, {}};
        for (std::size_t i = 0; i < raw[v].size(); ++i) {
            const Raw& r = raw[v][i];
            const double told = static_cast<double>(r.honesty.size());
            c.points.push_back({variants[v].spps[i], median(r.seconds), median_deviation(r.seconds), median_band(r.errors),
                                r.rays, median_band(r.honesty), told > 0.0 ? r.covered / told : 0.0});
        }
        if (split) c.split = sums[v].split(*variants[v].reference, static_cast<std::size_t>(seeds));
        curves.push_back(std::move(c));
    }
    return curves;
}

double planned_seconds(Bench& bench, const std::vector<Variant>& variants, int seeds) {
    double samples = 0.0;
    for (const Variant& v : variants) samples += std::accumulate(v.spps.begin(), v.spps.end(), 0.0);
    return samples * seeds * bench.seconds_per_spp();
}

std::vector<int> powers(int step, int most) {
    std::vector<int> list;
    for (int n = 1; n <= most; n *= step) list.push_back(n);
    return list;
}

}  // namespace glint::chart
