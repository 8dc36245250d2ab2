#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "accel/accelerator.h"
#include "tests/accel/adversarial_rays.h"
#include "tests/accel/adversarial_scenes.h"
#include "tests/accel/hit_report.h"

namespace glint {
namespace {

struct Case {
    AdversarialScene scene;
    AcceleratorKind kind;
};

std::string name_of(const Case& c) {
    return std::string(c.scene.name) + "_" + std::string(kAcceleratorNames[static_cast<std::size_t>(c.kind)]);
}
void PrintTo(const Case& c, std::ostream* out) { *out << name_of(c); }

std::vector<Case> all_cases() {
    std::vector<Case> cases;
    for (const AdversarialScene& scene : kAdversarialScenes) {
        for (const auto kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh})
            cases.push_back({scene, kind});
    }
    return cases;
}

// Compares with brute force ray by ray; the first mismatch is kept for the report.
class Comparison {
public:
    explicit Comparison(const Case& c)
        : geometry_(std::make_shared<const Geometry>(c.scene.build())),
          brute_force_(geometry_),
          accelerator_(build_accelerator(c.kind, geometry_)) {}

    // Returns the truth.
    Hit compare(const Ray& ray) {
        const Hit expected = brute_force_.closest_hit(ray);
        const Hit actual = kind_of(*accelerator_) == AcceleratorKind::none ? expected : closest_hit(*accelerator_, ray);
        const bool shadow = occluded(*accelerator_, ray);
        const bool in_range = !expected.found() || (expected.t > 0.0f && expected.t <= ray.t_max && expected.t < kInfinity);
        if (!same(expected, actual) || shadow != expected.found() || !in_range) {
            if (mismatches_++ == 0) {
                first_ = text(ray) + "\n  brute force: " + text(expected) + "\n  accelerator: " + text(actual) +
                         "\n  occluded: " + (shadow ? "yes" : "no");
            }
        }
        ++rays_;
        hits_ += expected.found() ? 1 : 0;
        return expected;
    }

    [[nodiscard]] const Geometry& geometry() const { return *geometry_; }
    [[nodiscard]] std::size_t rays() const { return rays_; }
    [[nodiscard]] std::size_t hits() const { return hits_; }
    [[nodiscard]] std::size_t mismatches() const { return mismatches_; }
    [[nodiscard]] const std::string& first() const { return first_; }

private:
    std::shared_ptr<const Geometry> geometry_;
    BruteForce brute_force_;
    std::shared_ptr<const AnyAccelerator> accelerator_;
    std::size_t rays_ = 0, hits_ = 0, mismatches_ = 0;
    std::string first_;
};

std::vector<glm::dvec3> corners_of_cells(const Geometry& geometry) {
    const UniformGrid grid(std::make_shared<const Geometry>(geometry));
    std::vector<glm::dvec3> corners;
    Random random(17);
    for (int i = 0; i < 500 && !geometry.bounds().empty(); ++i) {
        glm::ivec3 cell;
        for (int k = 0; k < 3; ++k) cell[k] = static_cast<int>(random.below(static_cast<std::size_t>(grid.resolution()[k]) + 1));
        corners.push_back(grid.corner(cell));
    }
    return corners;
}

class Adversarial : public testing::TestWithParam<Case> {};

// S-BVH-06, S-GRD-02..05, S-SHD-04, S-BOX-02, S-PLN-03: the same id and the same bits of t, u and v from every accelerator,
// and occluded() exactly where there is a hit.
TEST_P(Adversarial, SameHitAsBruteForce) {
    const Case c = GetParam();
    Comparison comparison(c);
    const std::vector<glm::dvec3> corners = corners_of_cells(comparison.geometry());
    AdversarialRays rays(comparison.geometry(), corners, 1);
    for (std::size_t i = 0; i < c.scene.rays; ++i) {
        Ray ray = rays.next();
        const Hit hit = comparison.compare(ray);
        // A bound exactly at the hit keeps it; one float below, it must go.
        if (hit.found() && i % 8 == 0) {
            ray.t_max = hit.t;
            EXPECT_EQ(comparison.compare(ray).primitive, hit.primitive) << text(ray);
            ray.t_max = std::nextafter(hit.t, 0.0f);
            EXPECT_FALSE(comparison.compare(ray).found()) << text(ray);
        }
    }
    EXPECT_EQ(comparison.mismatches(), 0u) << "of " << comparison.rays() << " rays; first: " << comparison.first();
    EXPECT_GE(comparison.hits(), c.scene.name == "empty" ? 0 : comparison.rays() / 10) << "the rays test too little";
}

// Directions from 1e-45 to 1e38 long, origins up to 1e30, bounds down to the smallest float: reciprocals and products
// overflow or vanish, and the accelerators must still agree.
TEST_P(Adversarial, SameHitForExtremeRays) {
    const Case c = GetParam();
    Comparison comparison(c);
    AdversarialRays rays(comparison.geometry(), {}, 2);
    Random random(3);
    for (std::size_t i = 0; i < c.scene.rays / 4; ++i) {
        Ray ray = rays.next();
        ray.t_max = kInfinity;
        ray.direction *= random.power_of_ten(-44.0f, 37.0f);
        if (i % 3 == 1) ray.direction[static_cast<int>(random.below(3))] = random.power_of_ten(-44.0f, -30.0f);
        if (i % 5 == 1) ray.origin[static_cast<int>(random.below(3))] *= random.power_of_ten(0.0f, 12.0f);
        if (i % 7 == 1) ray.t_max = random.power_of_ten(-44.5f, 38.0f);
        comparison.compare(ray);
    }
    EXPECT_EQ(comparison.mismatches(), 0u) << "of " << comparison.rays() << " rays; first: " << comparison.first();
}

INSTANTIATE_TEST_SUITE_P(Scenes, Adversarial, testing::ValuesIn(all_cases()),
                         [](const testing::TestParamInfo<Case>& c) { return name_of(c.param); });

}  // namespace
}  // namespace glint
