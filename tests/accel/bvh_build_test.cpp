#include <cstring>
#include <span>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "accel/bvh.h"
#include "accel/bvh_split.h"
#include "tests/accel/adversarial_scenes.h"
#include "tests/accel/hit_report.h"

namespace glint {
namespace {

// A thread for each task in turn and in reversed order: nothing may hang on who does what, and when.
void contrary_for(std::size_t count, const std::function<void(std::size_t)>& task) {
    std::jthread other([&] {
        for (std::size_t i = count; i-- > 0;)
            if (i % 2 == 0) task(i);
    });
    for (std::size_t i = count; i-- > 0;)
        if (i % 2 == 1) task(i);
}

Geometry mixed(std::size_t triangles) {
    Geometry g = triangles_in_cube(5, triangles, glm::vec3(0.0f), 1.0f, 0.02f);
    Random random(6);
    for (int i = 0; i < 3000; ++i) {
        const glm::vec3 p = random.in_cube(-1.0f, 1.0f);
        g.spheres.push_back({p, 0.01f});
        g.boxes.push_back({p, p + 0.01f});
        g.cones.push_back({p, 0.01f, p + 0.02f, 0.0f});
    }
    return g;
}

TEST(BvhBuild, TheTreeIsTheSameWhateverTheThreads) {
    const Geometry g = mixed(150000);
    for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::quality}) {
        const BvhTree alone = build_bvh(g, serial_for, quality), together = build_bvh(g, contrary_for, quality);
        EXPECT_EQ(alone.nodes, together.nodes);
        EXPECT_EQ(alone.leaves, together.leaves);
        EXPECT_EQ(alone.depth, together.depth);
        ASSERT_EQ(alone.units.size(), together.units.size());
        EXPECT_EQ(std::memcmp(alone.units.data(), together.units.data(), alone.units.size() * kBvhUnit), 0);
    }
}

// A place where everything is, and a few primitives so far away that a curve over all would see one cell.
TEST(BvhBuild, ACrowdInOneCellIsBuiltAsWellAsAlone) {
    Geometry g = mixed(20000);
    const std::size_t alone = build_bvh(g, serial_for, BuildQuality::fast).leaves;
    Random random(7);
    for (int i = 0; i < 3000; ++i) g.spheres.push_back({1.0e9f * random.direction(), 1.0f});
    const std::size_t leaves = build_bvh(g, serial_for, BuildQuality::fast).leaves;
    EXPECT_LE(leaves, alone + alone / 4 + 3000);
}

// How fine a mesh is, is not decided by the floor that it stands on.
TEST(BvhBuild, TheLeafExtentIsOfWhatThereIsMostOf) {
    Geometry g = triangles_in_cube(5, 20000, glm::vec3(0.0f), 1.0f, 0.02f);
    const float alone = build_bvh(g).leaf_extent;
    EXPECT_GT(alone, 0.0f);
    for (int i = 0; i < 4; ++i) g.boxes.push_back({glm::vec3(-50.0f), {50.0f, -2.0f, 50.0f}});
    EXPECT_LT(build_bvh(g).leaf_extent, 2.0f * alone);
}

std::vector<BuildRef> random_refs(std::size_t count) {
    Random random(8);
    std::vector<BuildRef> refs;
    for (std::uint32_t i = 0; i < count; ++i) {
        const glm::vec3 lo = random.in_cube(-1.0f, 1.0f), hi = lo + random.in_cube(0.0f, 0.1f);
        refs.push_back({{lo.x, lo.y, lo.z}, i, {hi.x, hi.y, hi.z}, 1.0f});
    }
    return refs;
}

float x(__m128 v) { return _mm_cvtss_f32(v); }

// By way of a buffer, in place, and in chunks, whose members are exchanged afterwards.
TEST(BvhSplit, PartitionKeepsEveryMemberOnItsSide) {
    for (const std::uint32_t count : {9u, 700u, 5000u, 2 * kChunk + 1, 5 * kChunk, 7 * kChunk + 77}) {
        std::vector<BuildRef> refs = random_refs(count);
        const BuildRange all = measure(refs, contrary_for);
        ASSERT_EQ(in_chunks(all), count > 2 * kChunk);
        const Split split = best_split(refs, all, SplitOf::primitives, contrary_for);
        ASSERT_GE(split.axis, 0);
        BuildRange left, right;
        partition(refs, all, split, contrary_for, left, right);
        ASSERT_EQ(left.count + right.count, count);
        const BuildRange l = measure(refs, left.first, left.count), r = measure(refs, right.first, right.count);
        for (const auto& [said, is] : {std::pair(left, l), std::pair(right, r)}) {
            EXPECT_EQ(x(said.bounds.lo), x(is.bounds.lo));
            EXPECT_EQ(x(said.bounds.hi), x(is.bounds.hi));
            EXPECT_EQ(x(said.centers.lo), x(is.centers.lo));
            EXPECT_EQ(x(said.centers.hi), x(is.centers.hi));
        }
        std::vector<bool> seen(count);
        for (const BuildRef& ref : refs) seen[ref.id] = true;
        EXPECT_EQ(std::ranges::count(seen, false), 0);
    }
}

TEST(BvhSplit, ASweepFindsTheCheapestCutOfTheOrder) {
    const std::vector<BuildRef> refs = random_refs(200);
    for (const std::uint32_t count : {2u, 3u, 4u, 5u, 6u, 9u, 40u, kMaxSweep})
        for (const SweepOf what : {SweepOf::primitives, SweepOf::leaves}) {
            const Split split = best_sweep(std::span(refs).subspan(20, count), what);
            const auto cost_of = [&](std::uint32_t n) {
                return what == SweepOf::leaves ? static_cast<float>(n) : leaf_cost(n, true);
            };
            ASSERT_GE(split.bin, 1);
            ASSERT_LT(split.bin, static_cast<int>(count));
            for (std::uint32_t i = 1; i < count; ++i) {
                const BuildRange left = measure(refs, 20, i), right = measure(refs, 20 + i, count - i);
                const float cost = cost_of(i) * left.bounds.half_area() + cost_of(count - i) * right.bounds.half_area();
                EXPECT_LE(split.cost, cost);
                if (static_cast<int>(i) != split.bin) continue;
                EXPECT_EQ(split.cost, cost);
                EXPECT_EQ(split.left.half_area(), left.bounds.half_area());
                EXPECT_EQ(split.right.half_area(), right.bounds.half_area());
            }
        }
}

}  // namespace
}  // namespace glint
