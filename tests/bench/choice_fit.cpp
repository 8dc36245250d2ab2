#include "choice_fit.h"

#include <cmath>

#include <fmt/core.h>

#include "spread.h"

namespace glint::bench {
namespace {

struct Point {
    double x, y;
};
struct Line {
    double at_zero = 0.0, slope = 0.0;
};

// Least squares of (y - at_zero - slope * x) / y.
Line fit(const std::vector<Point>& points) {
    double w = 0.0, wx = 0.0, wxx = 0.0, wy = 0.0, wxy = 0.0;
    for (const Point& p : points) {
        const double weight = 1.0 / (p.y * p.y);
        w += weight, wx += weight * p.x, wxx += weight * p.x * p.x, wy += weight * p.y, wxy += weight * p.x * p.y;
    }
    const double determinant = w * wxx - wx * wx;
    if (!(determinant > 0.0)) return {w > 0.0 ? wy / w : 0.0, 0.0};
    return {(wxx * wy - wx * wxy) / determinant, (w * wxy - wx * wy) / determinant};
}

enum class Mostly { triangles, other };

bool is_mostly(Mostly what, const Geometry& g) {
    const auto all = static_cast<double>(g.bounded_count()), triangles = static_cast<double>(g.triangles.size());
    return all > 0.0 && (what == Mostly::triangles ? triangles > 0.8 * all : triangles < 0.3 * all);
}

}  // namespace

std::string fitted_constants(const std::vector<Measured>& measured) {
    std::string text;
    constexpr std::array<const char*, kAcceleratorChoices.size()> kNames{"none", "grid", "bvh", "fast"};
    for (const Mostly what : {Mostly::triangles, Mostly::other}) {
        for (std::size_t c = 0; c < kAcceleratorChoices.size(); ++c) {
            std::vector<Point> build, ray, serial;
            for (const Measured& m : measured) {
                const Geometry& g = *m.scene->geometry;
                if (!is_mostly(what, g)) continue;
                const auto n = static_cast<double>(g.bounded_count());
                const CandidateCost& cost = m.cost.by[c];
                const double built = spread(cost.build).median;
                build.push_back({n, 1.0e9 * built});
                // Rays of a converging picture: the caches are warm.
                if (m.cost.demand.spp >= 16) {
                    ray.push_back({c == 0 ? n : std::log2(1.0 + n / 8.0), 1.0e9 * spread(cost.trace).median / m.cost.rays});
                }
                if (n > 5.0e4) serial.push_back({0.0, cost.build_serial / built});
            }
            const Line b = fit(build), r = fit(ray);
            text += fmt::format(
                "{:<4} {:<9} build {:9.0f} ns + {:6.1f} a primitive, serial {:4.2f}; a ray {:6.1f} ns + {:5.2f} a {}\n",
                kNames[c], what == Mostly::triangles ? "triangles" : "others", b.at_zero, b.slope,
                serial.empty() ? 0.0 : fit(serial).at_zero, r.at_zero, r.slope, c == 0 ? "primitive" : "doubling");
        }
    }
    return text;
}

}  // namespace glint::bench
