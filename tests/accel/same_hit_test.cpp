#include <algorithm>
#include <deque>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "accel/accelerator.h"
#include "tests/accel/adversarial_rays.h"
#include "tests/accel/adversarial_scenes.h"
#include "tests/accel/hit_report.h"
#include "tests/accel/instance_scenes.h"
#include "tests/long.h"

namespace glint {

void PrintTo(const AdversarialScene& scene, std::ostream* out) { *out << scene.name; }

namespace {

// Every structure in every instruction set of this machine against brute force, by single rays and by batches of each order.
// The first mismatch is kept for the report.
class Comparison {
public:
    explicit Comparison(const AdversarialScene& scene)
        : geometry_(std::make_shared<const Geometry>(scene.build())), brute_force_(geometry_) {
        for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
            if (!supported(isa)) continue;
            trees_.emplace_back(geometry_, serial_for, isa);
            grids_.emplace_back(geometry_, serial_for, isa);
        }
        trees_.emplace_back(geometry_, serial_for, isa_in_use(), BuildQuality::fast);
    }

    // At most kRayBatch rays; truth()[i] afterwards belongs to rays[i].
    void compare(const std::vector<Ray>& rays) {
        truth_.clear();
        for (const Ray& ray : rays) {
            truth_.push_back(brute_force_.closest_hit(ray));
            const Hit& h = truth_.back();
            hits_ += h.found() ? 1 : 0;
            check(!h.found() || (h.t > 0.0f && h.t <= ray.t_max && h.t < kInfinity), ray, h, h, "range of t");
        }
        rays_ += rays.size();
        for (std::size_t i = 0; i < grids_.size(); ++i) {
            compare_with(trees_[i], kIsaNames[i], rays);
            compare_with(grids_[i], "grid " + std::string(kIsaNames[i]), rays);
        }
        compare_with(trees_.back(), "fast build", rays);
    }

    [[nodiscard]] const Geometry& geometry() const { return *geometry_; }
    [[nodiscard]] const std::vector<Hit>& truth() const { return truth_; }
    [[nodiscard]] std::size_t rays() const { return rays_; }
    [[nodiscard]] std::size_t hits() const { return hits_; }
    [[nodiscard]] std::size_t mismatches() const { return mismatches_; }
    [[nodiscard]] const std::string& first() const { return first_; }

private:
    template <class A>
    void compare_with(const A& accelerator, std::string_view name, const std::vector<Ray>& rays) {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Hit hit = accelerator.closest_hit(rays[i]);
            check(same(truth_[i], hit), rays[i], truth_[i], hit, name);
            check(accelerator.occluded(rays[i]) == truth_[i].found(), rays[i], truth_[i], hit, "occluded by", name);
        }
        for (const RayOrder order : {RayOrder::common_origin, RayOrder::coherent, RayOrder::divergent}) {
            batch_.clear(order);
            for (const Ray& ray : rays) batch_.push(ray);
            accelerator.closest_hits(batch_, hit_batch_);
            accelerator.occluded(batch_, occluded_);
            static constexpr std::string_view kOrders[]{"common origin", "coherent", "divergent"};
            const std::string_view order_name = kOrders[static_cast<std::size_t>(order)];
            for (std::size_t i = 0; i < rays.size(); ++i) {
                const Hit hit = hit_batch_[static_cast<int>(i)];
                check(same(truth_[i], hit), rays[i], truth_[i], hit, name, order_name);
                check(occluded_[i] == truth_[i].found(), rays[i], truth_[i], hit, name, "occluded, ", order_name);
            }
        }
    }
    template <class... Words>
    void check(bool fine, const Ray& ray, const Hit& expected, const Hit& actual, const Words&... words) {
        if (fine || mismatches_++ > 0) return;
        first_ = text(ray) + "\n  brute force: " + text(expected) + "\n  other:       " + text(actual) + "\n ";
        ((first_ += " " + std::string(words)), ...);
    }

    std::shared_ptr<const Geometry> geometry_;
    BruteForce brute_force_;
    std::deque<Bvh> trees_;
    std::deque<UniformGrid> grids_;
    std::vector<Hit> truth_;
    RayBatch batch_;
    HitBatch hit_batch_;
    OccludedBatch occluded_{};
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

class Adversarial : public testing::TestWithParam<AdversarialScene> {
protected:
    void expect_no_mismatch() const {
        EXPECT_EQ(comparison.mismatches(), 0u) << "of " << comparison.rays() << " rays; first: " << comparison.first();
    }
    Comparison comparison{GetParam()};
    // A night's three tests are a million rays for each scene, a quarter of it where all rays meet most primitives.
    const std::size_t wanted = GetParam().rays < 4000 ? GetParam().rays * scale<std::size_t>(1, 25)
                                                      : std::max(GetParam().rays, scale<std::size_t>(0, 310000));
};

// S-GRD-02..05, S-SHD-04, S-BOX-02 and S-PLN-03 as well: the same id and the same bits of t, u and v from every structure,
// and occluded() exactly where there is a hit.
TEST_P(Adversarial, S_BVH_06_S_BVH_07_SameHitAsBruteForce) {
    const std::vector<glm::dvec3> corners = corners_of_cells(comparison.geometry());
    AdversarialRays source(comparison.geometry(), corners, 1);
    std::vector<Ray> rays, bounded, too_short;
    for (std::size_t done = 0; done < wanted; done += rays.size()) {
        rays.resize(std::min<std::size_t>(kRayBatch - done % 7, wanted - done));
        for (Ray& ray : rays) ray = source.next();
        comparison.compare(rays);
        // A bound exactly at the hit keeps it; one float below, it must go.
        bounded.clear();
        too_short.clear();
        std::vector<PrimitiveId> ids;
        for (std::size_t i = 0; i < rays.size(); i += 8) {
            const Hit hit = comparison.truth()[i];
            if (!hit.found()) continue;
            bounded.push_back({rays[i].origin, rays[i].direction, hit.t});
            too_short.push_back({rays[i].origin, rays[i].direction, std::nextafter(hit.t, 0.0f)});
            ids.push_back(hit.primitive);
        }
        comparison.compare(bounded);
        for (std::size_t i = 0; i < ids.size(); ++i) EXPECT_EQ(comparison.truth()[i].primitive, ids[i]) << text(bounded[i]);
        comparison.compare(too_short);
        for (std::size_t i = 0; i < ids.size(); ++i) EXPECT_FALSE(comparison.truth()[i].found()) << text(too_short[i]);
    }
    expect_no_mismatch();
    EXPECT_GE(comparison.hits(), GetParam().name == "empty" ? 0 : comparison.rays() / 10) << "the rays test too little";
}

// Directions from 1e-45 to 1e38 long, origins up to 1e30, bounds down to the smallest float: reciprocals and products
// overflow or vanish, and the accelerators must still agree.
TEST_P(Adversarial, S_BVH_06_SameHitForExtremeRays) {
    AdversarialRays source(comparison.geometry(), {}, 2);
    Random random(3);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < wanted / 4; ++i) {
        Ray ray = source.next();
        ray.t_max = kInfinity;
        ray.direction *= random.power_of_ten(-44.0f, 37.0f);
        if (i % 3 == 1) ray.direction[static_cast<int>(random.below(3))] = random.power_of_ten(-44.0f, -30.0f);
        if (i % 5 == 1) ray.origin[static_cast<int>(random.below(3))] *= random.power_of_ten(0.0f, 12.0f);
        if (i % 7 == 1) ray.t_max = random.power_of_ten(-44.5f, 38.0f);
        rays.push_back(ray);
        if (rays.size() == kRayBatch) comparison.compare(rays), rays.clear();
    }
    comparison.compare(rays);
    expect_no_mismatch();
}

// Bundles as a camera, a lens or a light makes them: neighbours aim close by, from one point or from a small patch, at an edge,
// a vertex or past everything, and some rays have a bound.
TEST_P(Adversarial, S_BVH_07_SameHitForBundles) {
    AdversarialRays source(comparison.geometry(), {}, 4);
    Random random(5);
    std::vector<Ray> rays;
    for (std::size_t done = 0; done < wanted; done += rays.size()) {
        const Ray axis = source.next();
        const float length = glm::length(axis.direction);
        const float width = random.power_of_ten(-6.0f, -0.3f) * length;
        const float patch = random.below(2) == 0 ? 0.0f : random.power_of_ten(-6.0f, -1.0f) * glm::length(axis.origin);
        const bool bounded = random.below(3) == 0;
        rays.resize(std::min<std::size_t>(1 + random.below(kRayBatch), wanted - done));
        for (std::size_t i = 0; i < rays.size(); ++i) {
            // Sixteen by sixteen, some of them exactly along the axis.
            const glm::vec3 jitter = i % 16 == 3 ? glm::vec3(0.0f) : width * random.in_cube(-1.0f, 1.0f);
            rays[i] = {axis.origin + patch * random.in_cube(-1.0f, 1.0f), axis.direction + jitter, kInfinity};
            if (patch == 0.0f) rays[i].origin = axis.origin;
            if (bounded) rays[i].t_max = axis.t_max < kInfinity ? axis.t_max : random.power_of_ten(-3.0f, 3.0f);
        }
        comparison.compare(rays);
        // Shadow rays of the points seen: as close before and behind the hit as float can tell, and farther off.
        const std::vector<Hit> hits = comparison.truth();
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (!hits[i].found()) continue;
            const float off = random.below(2) == 0 ? random.power_of_ten(-7.5f, -2.0f) : 0.0f;
            rays[i].t_max = hits[i].t * (random.below(2) == 0 ? 1.0f - off : 1.0f + off);
        }
        comparison.compare(rays);
    }
    expect_no_mismatch();
}

INSTANTIATE_TEST_SUITE_P(Scenes, Adversarial, testing::ValuesIn(kAdversarialScenes),
                         [](const testing::TestParamInfo<AdversarialScene>& s) { return std::string(s.param.name); });
INSTANTIATE_TEST_SUITE_P(Instances, Adversarial, testing::ValuesIn(kInstanceScenes),
                         [](const testing::TestParamInfo<AdversarialScene>& s) { return std::string(s.param.name); });

}  // namespace
}  // namespace glint
