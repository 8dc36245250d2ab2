#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include <gtest/gtest.h>

#include "accel/accelerator.h"
#include "accel/bvh_successors.h"
#include "tests/accel/adversarial_scenes.h"
#include "tests/accel/bvh_survey.h"
#include "tests/accel/hit_report.h"

namespace glint {
namespace {

BvhTree build(const Geometry& geometry, BuildQuality quality) { return build_bvh(geometry, serial_for, quality); }
constexpr std::array kQualities{BuildQuality::fast, BuildQuality::quality};

void expect_sound(const Geometry& geometry) {
    for (const BuildQuality quality : kQualities) expect_sound(geometry, build(geometry, quality));
}

Geometry spheres(std::size_t count, float radius_step) {
    Geometry g;
    for (std::size_t i = 0; i < count; ++i) g.spheres.push_back({glm::vec3(1.0f), 1.0f + radius_step * static_cast<float>(i)});
    return g;
}

TEST(BvhTree, S_BVH_01_NoneOneAndTwoPrimitives) {
    for (const BuildQuality quality : kQualities) {
        EXPECT_TRUE(build(Geometry(), quality).units.empty());
        EXPECT_TRUE(build(scenes::planes_only(), quality).units.empty());
    }
    for (const std::size_t n : {1u, 2u, 8u, 9u}) {
        for (const float step : {0.0f, 1.0f}) {
            const Geometry g = spheres(n, step);
            expect_sound(g);
        }
    }
    const Bvh empty(std::make_shared<const Geometry>());
    EXPECT_FALSE(empty.closest_hit({glm::vec3(0.0f), glm::vec3(1.0f)}).found());
    EXPECT_FALSE(empty.occluded({glm::vec3(0.0f), glm::vec3(1.0f)}));
}

TEST(BvhTree, S_BVH_02_EqualCentroidsEndInSmallLeaves) {
    const Geometry concentric = spheres(100000, 1.0e-3f), same = scenes::same_triangle_70000();
    expect_sound(concentric);
    expect_sound(same);
    const Bvh bvh(std::make_shared<const Geometry>(concentric));
    const Hit hit = bvh.closest_hit({glm::vec3(1.0f), glm::vec3(0.0f, 1.0f, 0.0f)});
    EXPECT_EQ(hit.primitive, make_id(PrimitiveKind::sphere, 0)) << "the innermost";
    EXPECT_EQ(hit.t, 1.0f);
}

TEST(BvhTree, S_BVH_03_DepthIsBoundedWherePrimitivesPeelOffOneByOne) {
    Geometry g = scenes::powers_of_two();
    expect_sound(g);
    // Shrinking towards a corner in all directions, and many of each size.
    Random random(3);
    for (int i = -120; i < 58; ++i) {
        for (int k = 0; k < 30; ++k) {
            const float size = std::ldexp(1.0f, i);
            g.spheres.push_back({size * random.in_cube(-1.0f, 1.0f), 0.1f * size});
        }
    }
    expect_sound(g);
    EXPECT_GT(build_bvh(g).depth, 16) << "not the depth this test is for";
}

// What one closest-hit query costs, by the rules of the traversal but without its order.
double visits_per_ray(const Geometry& geometry, const BvhTree& tree) {
    const BvhView bvh = tree.view(geometry);
    Random random(4);
    std::size_t visits = 0;
    constexpr int kRays = 500;
    for (int i = 0; i < kRays; ++i) {
        const PreparedRay ray({random.in_cube(-2.0f, 2.0f), random.direction()}, 2.0f);
        std::vector<BvhRef> stack{0};
        while (!stack.empty()) {
            const BvhNode node = bvh.at<BvhNode>(stack.back());
            stack.pop_back();
            ++visits;
            for (int k = 0; k < kBvhWidth; ++k) {
                const Interval inside = slab_interval(ray, box_of(node, k));
                if (absent(node, k) || inside.empty() || inside.far < 0.0f) continue;
                if (is_leaf(node.child[k])) {
                    visits += members(bvh, node.child[k]).size();
                } else {
                    stack.push_back(node.child[k]);
                }
            }
        }
    }
    return static_cast<double>(visits) / kRays;
}

TEST(BvhTree, S_BVH_04_OneHugeTriangleCostsLessThanThreefold) {
    const Geometry g = triangles_in_cube(4, 100000, glm::vec3(0.0f), 1.0f, 0.01f);
    Geometry h = g;
    add_triangle(h, glm::vec3(-500.0f, -500.0f, -500.0f), glm::vec3(500.0f, 499.0f, 500.0f), glm::vec3(0.0f, 300.0f, 5.0f));
    for (const BuildQuality quality : kQualities) {
        const BvhTree with = build(h, quality);
        expect_sound(h, with);
        EXPECT_LE(visits_per_ray(h, with), 3.0 * visits_per_ray(g, build(g, quality)));
    }
}

// The leaf that blocked the last ray is asked first: it must be one of this tree, and of one that still lives.
TEST(BvhTree, WhatBlockedARayOfOneTreeBlocksNoneOfAnother) {
    const auto with_ball_at = [](float x) {
        auto g = std::make_shared<Geometry>();
        for (int i = 0; i < 40; ++i) g->spheres.push_back({{x, 3.0f * static_cast<float>(i), 0.0f}, 1.0f});
        return std::shared_ptr<const Geometry>(std::move(g));
    };
    const Ray ray{{0.0f, 0.0f, -5.0f}, {0.0f, 0.0f, 1.0f}, 10.0f};
    for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
        if (!supported(isa)) continue;
        const Bvh hit(with_ball_at(0.0f), serial_for, isa), missed(with_ball_at(3.0f), serial_for, isa);
        for (int i = 0; i < 4; ++i) {
            EXPECT_TRUE(hit.occluded(ray));
            EXPECT_TRUE(hit.occluded(ray));
            EXPECT_FALSE(missed.occluded(ray));
        }
        for (int i = 0; i < 20; ++i) {  // likely in the same memory each time
            EXPECT_EQ(Bvh(with_ball_at(i % 2 == 0 ? 0.0f : 3.0f), serial_for, isa).occluded(ray), i % 2 == 0);
        }
    }
}

// A thread's table of what came next is keyed by the low bits of references, which trees and distant nodes share.
TEST(BvhTree, WhatCameNextTheLastTimeIsAGuessOnly) {
    using namespace GLINT_ISA;
    for (const BvhRef next : {8u, 12u, 8u, kLeafBit | 8u, 8u, 8u}) {
        EXPECT_EQ(follow<false>(4, next), next);
        EXPECT_EQ(follow<false>(4 + Successors::kPlaces, next + 1), next + 1);
        EXPECT_EQ(follow<true>(4, next + 2), next + 2);
    }
}

TEST(BvhTree, S_BVH_05_WhatNoQueryCanAnswerIsInvalid) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const glm::vec3 a(0.0f), b(1.0f, 0.0f, 0.0f), c(0.0f, 1.0f, 0.0f);
    EXPECT_TRUE(valid_triangle(a, b, c));
    EXPECT_TRUE(valid_triangle(1.0e18f * a, 1.0e18f * b, 1.0e18f * c));
    EXPECT_TRUE(valid_triangle(1.0e-30f * a, 1.0e-30f * b, 1.0e-30f * c));
    for (const float bad : {nan, kInfinity, -kInfinity, 1.0e30f, -1.0e30f}) {
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 p = c;
            p[axis] = bad;
            EXPECT_FALSE(valid_triangle(p, a, b)) << bad;
            EXPECT_FALSE(valid_triangle(a, p, b)) << bad;
            EXPECT_FALSE(valid_triangle(a, b, p)) << bad;
            EXPECT_FALSE(valid(Cone{p, 1.0f, b, 1.0f})) << bad;
            EXPECT_FALSE(valid(Cone{b, 1.0f, p, 1.0f})) << bad;
        }
        EXPECT_FALSE(valid(Cone{a, bad, b, 1.0f})) << bad;
        EXPECT_FALSE(valid(Cone{a, 1.0f, b, bad})) << bad;
    }
    EXPECT_FALSE(valid(Cone{a, 1.0f, a, 1.0f}));
    EXPECT_FALSE(valid(Cone{a, 0.0f, b, 0.0f}));
    EXPECT_FALSE(valid(Cone{a, -1.0f, b, 2.0f}));
}

class OnScene : public testing::TestWithParam<AdversarialScene> {};

// A tree of eight-fold object medians over the widest axis: three halvings a node, leaves of at most eight.
class MedianTree {
public:
    explicit MedianTree(const Geometry& g) : geometry_(g), ids_(g.bounded_ids()) {}
    double cost() { return ids_.empty() ? 0.0 : node({ids_}); }

private:
    using Ids = std::span<PrimitiveId>;

    Aabb bounds(Ids ids) const {
        Aabb box;
        for (const PrimitiveId id : ids) box.grow(geometry_.bounds(id));
        return box;
    }
    void halve(Ids ids, int times, std::vector<Ids>& parts) {
        if (times == 0 || ids.size() < 2) return parts.push_back(ids);
        Aabb centers;
        for (const PrimitiveId id : ids) centers.grow(geometry_.bounds(id).center());
        const glm::vec3 size = centers.size();
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::size_t half = ids.size() / 2;
        std::ranges::nth_element(ids, ids.begin() + static_cast<std::ptrdiff_t>(half), {},
                                 [&](PrimitiveId id) { return geometry_.bounds(id).center()[axis]; });
        halve(ids.first(half), times - 1, parts);
        halve(ids.subspan(half), times - 1, parts);
    }
    double node(Ids ids) {
        std::vector<Ids> parts;
        halve(ids, ids.size() > 8 ? 3 : 0, parts);
        double sum = 0.0;
        for (const Ids part : parts) {
            const bool leaf = part.size() <= 8;
            sum += static_cast<double>(bounds(part).half_area()) * (leaf ? leaf_cost(part) : 1.0);
            if (!leaf) sum += node(part);
        }
        return sum;
    }

    // A block for each kind.
    static double leaf_cost(Ids ids) {
        double sum = 0.0;
        for (std::uint32_t kind = 0; kind < kPrimitiveKinds; ++kind) {
            const auto n =
                std::ranges::count_if(ids, [&](PrimitiveId id) { return kind_of(id) == static_cast<PrimitiveKind>(kind); });
            if (n > 0) sum += block_cost(static_cast<std::size_t>(n));
        }
        return sum;
    }

    const Geometry& geometry_;
    std::vector<PrimitiveId> ids_;
};

TEST_P(OnScene, S_BVH_08_TheTreeIsSoundAndNoWorseThanMedians) {
    const Geometry g = GetParam().build();
    const BvhTree tree = build_bvh(g);
    expect_sound(g, tree);
    const double cost = Survey(g, tree).cost, median = MedianTree(g).cost();
    // Along a row of equal balls every cut costs alike, so greedy cuts leave more blocks part full than halving does.
    EXPECT_LE(cost, (GetParam().name == "sphere_row" ? 1.1 : 1.001) * median);
    const BvhTree fast = build(g, BuildQuality::fast);
    expect_sound(g, fast);
    EXPECT_LE(Survey(g, fast).cost, 1.25 * std::max(cost, median)) << "the fast tree";
}

// The invariant that makes culling exact: a hit's t lies in the interval of every box above its primitive.
TEST_P(OnScene, S_BOX_03_AHitLiesInTheIntervalOfEveryAncestor) {
    const auto geometry = std::make_shared<const Geometry>(GetParam().build());
    const BvhTree tree = build_bvh(*geometry);
    const BvhView bvh = tree.view(*geometry);
    const BruteForce truth(geometry);
    const float magnitude = geometry->bounds().magnitude();
    Random random(3);
    const Aabb all = geometry->bounds();
    const std::size_t rays = all.empty() ? 0 : std::min<std::size_t>(20000, 20000000 / geometry->bounded_count());
    for (std::size_t i = 0; i < rays; ++i) {
        const glm::vec3 target = all.lo + random.in_cube(0.0f, 1.0f) * all.size();
        const glm::vec3 origin = all.center() + random.power_of_ten(-1.0f, 4.0f) * glm::length(all.size()) * random.direction();
        const Ray ray{origin, (target - origin) / glm::length(target - origin)};
        const Hit hit = truth.closest_hit(ray);
        if (!hit.found() || kind_of(hit.primitive) == PrimitiveKind::plane) continue;
        const Aabb bounds = geometry->bounds(hit.primitive);
        const PreparedRay prepared(ray, magnitude);
        std::size_t leaves = 0;
        std::vector<BvhRef> stack{0};
        while (!stack.empty()) {
            const BvhNode node = bvh.at<BvhNode>(stack.back());
            stack.pop_back();
            for (int k = 0; k < kBvhWidth; ++k) {
                if (absent(node, k) || !contains(box_of(node, k), bounds)) continue;
                const Interval inside = slab_interval(prepared, box_of(node, k));
                ASSERT_LE(inside.near, hit.t) << text(ray);
                ASSERT_GE(inside.far, hit.t) << text(ray);
                if (is_leaf(node.child[k])) {
                    leaves += std::ranges::count(members(bvh, node.child[k]), hit.primitive) > 0 ? 1 : 0;
                } else {
                    stack.push_back(node.child[k]);
                }
            }
        }
        ASSERT_EQ(leaves, 1u) << text(ray);
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, OnScene, testing::ValuesIn(kAdversarialScenes),
                         [](const testing::TestParamInfo<AdversarialScene>& scene) { return std::string(scene.param.name); });

}  // namespace
}  // namespace glint
