#include <gtest/gtest.h>

#include "accel/accelerator.h"
#include "tests/accel/hit_report.h"
#include "tests/accel/instance_scenes.h"

namespace glint {
namespace {

std::shared_ptr<const Geometry> shared(Geometry g) { return std::make_shared<const Geometry>(std::move(g)); }

// Seen from afar through a bent map a ray moves by many times the rounding of its origin, so it may hit an instance whose box it
// misses. Rays that pass the boxes at about that distance.
TEST(Instance, BoxesCullNoHitOfARayThatTheMapMoves) {
    std::size_t hits = 0, moved = 0;
    Random random(31);
    for (int maps = 0; maps < 1500; ++maps) {
        Geometry g;
        const std::uint32_t ball = scenes::add_prototype(g, tessellated_ball(glm::dvec3(0.0), 1.0, 6, 4));
        const auto power = [&] { return std::pow(10.0, -3.0 + 6.0 * random.uniform()); };
        const double x = power(), y = power(), z = power();
        const glm::dmat3 linear = scenes::stretch(x, y, z) * scenes::odd_rotation(random);
        if (!scenes::place(g, ball, linear, glm::dvec3(random.in_cube(-10.0f, 10.0f)))) continue;
        const auto geometry = shared(std::move(g));
        const BruteForce truth(geometry);
        const Bvh tree(geometry);
        const UniformGrid grid(geometry);
        const Instance& instance = geometry->instances.front();
        const AffineMap out = inverse(instance.object_from_world);
        const double bend = out.growth() * instance.object_from_world.growth();
        const Aabb box = geometry->bounds();
        RayBatch batch;
        HitBatch found;
        batch.clear(RayOrder::coherent);
        while (batch.count < kRayBatch) {
            const glm::dvec3 vertex = out.point(random.unit());
            const double distance = box.magnitude() * std::pow(10.0, -0.5 + 4.5 * random.uniform());
            const double miss = 0x1p-24 * bend * distance * std::pow(10.0, -2.0 + 2.5 * random.uniform());
            const glm::dvec3 origin = vertex + distance * random.unit(), target = vertex + miss * random.unit();
            batch.push({glm::vec3(origin), glm::vec3(glm::normalize(target - origin)), kInfinity});
        }
        tree.closest_hits(batch, found);
        for (int i = 0; i < kRayBatch; ++i) {
            const Hit expected = truth.closest_hit(batch[i]);
            ASSERT_TRUE(same(found[i], expected)) << text(batch[i]) << text(expected);
            ASSERT_TRUE(same(tree.closest_hit(batch[i]), expected)) << text(batch[i]) << text(expected);
            ASSERT_TRUE(same(grid.closest_hit(batch[i]), expected)) << text(batch[i]) << text(expected);
            if (!expected.found()) continue;
            ++hits;
            // By the boxes as they are, padded by no more than any box of the world is.
            moved += slab_interval(PreparedRay(batch[i], box.magnitude()), box).empty() ? 1 : 0;
        }
    }
    EXPECT_GT(hits, 10000u);
    EXPECT_GT(moved, 20u) << "the rays test too little";
}

TEST(Instance, AMapWithoutAnInverseToRelyOnIsRefused) {
    Geometry g;
    const std::uint32_t soup = scenes::add_prototype(g, scenes::triangle_soup());
    const std::uint32_t empty = scenes::add_prototype(g, Geometry());
    const glm::dvec3 origin(0.0);
    const double nan = std::nan(""), inf = static_cast<double>(kInfinity);
    EXPECT_FALSE(scenes::place(g, soup, scenes::stretch(1.0, 0.0, 1.0), origin)) << "flat";
    EXPECT_FALSE(scenes::place(g, soup, glm::dmat3(1, 2, 3, 2, 4, 6, 0, 0, 1), origin)) << "flat, but no zero in sight";
    EXPECT_FALSE(scenes::place(g, soup, glm::dmat3(0.0), origin)) << "a point";
    EXPECT_FALSE(scenes::place(g, soup, scenes::stretch(1.0, nan, 1.0), origin));
    EXPECT_FALSE(scenes::place(g, soup, glm::dmat3(1.0), {inf, 0.0, 0.0}));
    EXPECT_FALSE(scenes::place(g, soup, scenes::stretch(1.0, 1.0, 1e-8), origin)) << "too bent";
    EXPECT_FALSE(scenes::place(g, soup, scenes::stretch(1e19, 1e19, 1e19), origin)) << "beyond 1e18";
    EXPECT_FALSE(scenes::place(g, soup, glm::dmat3(1.0), glm::dvec3(1e20))) << "beyond 1e18";
    EXPECT_FALSE(scenes::place(g, empty, glm::dmat3(1.0), origin)) << "nothing to place";
    EXPECT_TRUE(g.instances.empty());
    EXPECT_TRUE(scenes::place(g, soup, scenes::stretch(-1e3, 1.0, 1e-3), origin));
    EXPECT_TRUE(scenes::place(g, soup, scenes::stretch(1e-30, 1e-30, 1e-30), origin));
}

TEST(Instance, TheInverseOfABentMapIsGoodToASixteenthOfFloat) {
    Random random(32);
    int accepted = 0;
    for (int i = 0; i < 20000; ++i) {
        const auto power = [&] { return std::pow(10.0, -3.0 + 6.0 * random.uniform()); };
        const double x = power(), y = power(), z = power();
        const glm::dmat3 linear = scenes::odd_rotation(random) * scenes::stretch(x, -y, z) * scenes::odd_rotation(random);
        const AffineMap out = affine_map(scenes::placed(linear, glm::dvec3(random.in_cube(-1e3f, 1e3f))));
        const auto in = object_from_world(out);
        if (!in) continue;
        ++accepted;
        const AffineMap back = inverse(*in);
        const glm::dvec3 v(random.in_cube(-1.0f, 1.0f));
        for (const AffineMap& map : {out, back}) {
            const glm::dvec3 error = glm::abs(in->vector(map.vector(v)) - v);
            EXPECT_LE(std::max(error.x, std::max(error.y, error.z)), 1.1 * 0x1p-28);
        }
    }
    EXPECT_GT(accepted, 15000);
}

TEST(Instance, EveryIdLeadsBackToItsPrimitive) {
    const Geometry g = scenes::instances_of_all_kinds();
    std::uint32_t next = kFirstInstancedId;
    for (const Instance& instance : g.instances) {
        EXPECT_EQ(instance.first_id, next);
        const Geometry& prototype = *g.prototypes[instance.prototype].geometry;
        for (const PrimitiveId id : prototype.bounded_ids()) {
            const PrimitiveId seen = next++;
            EXPECT_EQ(instance.first_id + prototype.rank(id), seen);
            const Located at = g.locate(seen);
            EXPECT_EQ(at.geometry, &prototype);
            EXPECT_EQ(at.instance, &instance);
            EXPECT_EQ(at.id, id);
        }
    }
    EXPECT_EQ(g.seen_count(), g.bounded_count() + (next - kFirstInstancedId));
    const PrimitiveId own = make_id(PrimitiveKind::plane, 1);
    EXPECT_EQ(g.locate(own).instance, nullptr);
    EXPECT_EQ(g.locate(own).id, own);
}

TEST(Instance, MoreIdsThanThereAreAreRefused) {
    Geometry g;
    Geometry many = scenes::one_triangle();
    many.triangles.assign(1u << 20, many.triangles.front());
    const std::uint32_t prototype = scenes::add_prototype(g, std::move(many));
    const std::uint32_t room = (kNoPrimitive - kFirstInstancedId) >> 20;
    for (std::uint32_t i = 0; i < room; ++i) ASSERT_TRUE(scenes::place(g, prototype, glm::dmat3(1.0), glm::dvec3(i)));
    EXPECT_THROW(scenes::place(g, prototype, glm::dmat3(1.0), glm::dvec3(0.0)), std::length_error);
    EXPECT_EQ(g.instances.size(), room);
}

TEST(Instance, BoundsHoldEveryVertex) {
    for (const auto& scene : {scenes::instances_bent(), scenes::instances_far(), scenes::instances_scaled_by_decades()}) {
        for (const Instance& instance : scene.instances) {
            const Aabb box = scene.instance_bounds(instance);
            const AffineMap out = inverse(instance.object_from_world);
            for (const glm::vec3 v : scene.prototypes[instance.prototype].geometry->vertices) {
                const glm::dvec3 p = out.point(glm::dvec3(v));
                EXPECT_TRUE(glm::all(glm::lessThanEqual(glm::dvec3(box.lo), p)) &&
                            glm::all(glm::lessThanEqual(p, glm::dvec3(box.hi))));
            }
        }
    }
}

// The tree of one mesh and some bytes for each of its instances.
TEST(Instance, MemoryIsThatOfOneMesh) {
    Geometry g;
    const Geometry mesh = scenes::closed_ball();
    const std::size_t alone = Bvh(shared(mesh)).memory_bytes();
    const std::uint32_t ball = scenes::add_prototype(g, mesh);
    Random random(33);
    constexpr std::size_t kInstances = 20000;
    for (std::size_t i = 0; i < kInstances; ++i)
        ASSERT_TRUE(scenes::place(g, ball, scenes::odd_rotation(random), glm::dvec3(random.in_cube(-100.0f, 100.0f))));
    const std::size_t bytes = Bvh(shared(g)).memory_bytes() + sizeof(Instance) * g.instances.capacity();
    std::size_t each = (bytes - alone) / kInstances;
    EXPECT_LE(each, 250u);
    EXPECT_EQ(sizeof(Instance), 104u);
}

// An inside of a closed mesh cannot be left, whatever the map: one arithmetic for all triangles of an instance.
TEST(Instance, ClosedMeshesStayWatertight) {
    std::size_t rays = 0, leaks = 0;
    Random random(34);
    for (int maps = 0; maps < 10; ++maps) {
        Geometry g;
        const std::uint32_t ball = scenes::add_prototype(g, scenes::closed_ball());
        const double x = random.uniform() + 0.1, y = 10.0 * x, z = -30.0 * x;
        const glm::dmat3 linear = scenes::odd_rotation(random) * scenes::stretch(x, y, z) * scenes::odd_rotation(random);
        ASSERT_TRUE(scenes::place(g, ball, linear, glm::dvec3(random.in_cube(-1000.0f, 1000.0f))));
        const auto geometry = shared(g);
        const Bvh tree(geometry);
        const AffineMap out = inverse(geometry->instances.front().object_from_world);
        const Geometry& mesh = *geometry->prototypes.front().geometry;
        RayBatch batch;
        HitBatch found;
        for (int i = 0; i < 100000 / kRayBatch; ++i) {
            batch.clear(RayOrder::divergent);
            while (batch.count < kRayBatch) {
                const auto& t = mesh.triangles[random.below(mesh.triangles.size())];
                const glm::dvec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]);
                const double w = random.below(3) == 0 ? 0.0 : random.uniform();
                const glm::dvec3 origin = out.point(glm::dvec3(0.3, -0.1, 0.2) + 0.5 * glm::dvec3(random.in_cube(-1.0f, 1.0f)));
                batch.push({glm::vec3(origin), glm::vec3(out.point((1.0 - w) * a + w * b) - origin), kInfinity});
            }
            tree.closest_hits(batch, found);
            for (int k = 0; k < batch.count; ++k) leaks += found[k].found() ? 0 : 1;
            rays += kRayBatch;
        }
    }
    EXPECT_GT(rays, 990000u);
    EXPECT_EQ(leaks, 0u);
}

}  // namespace
}  // namespace glint
