// Whole structures in every instruction set, by single rays and by batches: a closed mesh holds every ray aimed at an edge or a
// vertex, segments are blocked exactly where there is a hit, and a crowd in a corner stays cheap.
#include <deque>
#include <memory>

#include <gtest/gtest.h>

#include "accel/accelerator.h"
#include "tests/accel/adversarial_rays.h"
#include "tests/accel/adversarial_scenes.h"
#include "tests/accel/hit_report.h"
#include "tests/long.h"

namespace glint {
namespace {

// Calls visit(accelerator, name) for the tree and the grid in each instruction set of this machine.
template <class Visit>
void for_each_structure(const std::shared_ptr<const Geometry>& geometry, const Visit& visit) {
    for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
        if (!supported(isa)) continue;
        const std::string name(kIsaNames[static_cast<std::size_t>(isa)]);
        visit(Bvh(geometry, serial_for, isa), "bvh " + name);
        visit(UniformGrid(geometry, serial_for, isa), "grid " + name);
    }
}

// The instruction set that is used; the others are compared with it elsewhere.
bool is_in_use(const std::string& name) { return name.ends_with(kIsaNames[static_cast<std::size_t>(isa_in_use())]); }

// From within the ball to points of its edges (or its vertices): every ray must be stopped.
void expect_no_leak(bool vertices) {
    const auto geometry = std::make_shared<const Geometry>(scenes::closed_ball());
    const glm::vec3 center = geometry->bounds().center();
    for_each_structure(geometry, [&](const auto& accelerator, const std::string& name) {
        const int batches = is_in_use(name) ? scale(4000, 400000) : scale(1000, 40000);
        Random random(vertices ? 7 : 6);
        RayBatch batch;
        HitBatch hits;
        int leaks = 0;
        for (int i = 0; i < batches; ++i) {
            batch.clear(static_cast<RayOrder>(i % 3));
            const glm::vec3 eye = center + random.in_cube(-0.8f, 0.8f);
            while (batch.count < kRayBatch) {
                const auto& t = geometry->triangles[random.below(geometry->triangles.size())];
                const glm::vec3 a = geometry->vertices[t[0]], b = geometry->vertices[t[1]];
                const glm::vec3 target = vertices ? a : a + random.uniform(0.01f, 0.99f) * (b - a);
                const glm::vec3 origin = i % 3 == 0 ? eye : eye + random.in_cube(-0.2f, 0.2f);
                batch.push({origin, i % 2 == 0 ? target - origin : glm::normalize(target - origin)});
            }
            accelerator.closest_hits(batch, hits);
            for (int k = 0; k < kRayBatch; ++k) {
                const bool held = hits[k].found() && (k % 4 != 0 || accelerator.closest_hit(batch[k]).found());
                if (!held && leaks++ == 0) ADD_FAILURE() << name << ' ' << text(batch[k]);
            }
        }
        EXPECT_EQ(leaks, 0) << name << " of " << batches * kRayBatch;
    });
}

TEST(ClosedMesh, S_TRI_06_NoRayLeaksThroughAnEdgeInAnyStructure) { expect_no_leak(false); }
TEST(ClosedMesh, S_TRI_07_NoRayLeaksThroughAVertexInAnyStructure) { expect_no_leak(true); }

TEST(Segments, S_SHD_04_BlockedExactlyWhereThereIsAHit) {
    const auto compare = [](const auto& accelerator, const Geometry& g, std::size_t count, const std::string& name) {
        AdversarialRays adversarial(g, {}, 4);
        Random random(4);
        const Aabb box = g.bounds();
        RayBatch batch;
        HitBatch hits;
        OccludedBatch occluded{};
        std::size_t blocked = 0;
        for (std::size_t i = 0; i < count; i += kRayBatch) {
            batch.clear(static_cast<RayOrder>(i / kRayBatch % 3));
            while (batch.count < kRayBatch) {
                // Between two points of the scene's box, ending anywhere; some picked to be hard.
                const glm::vec3 from = box.lo + random.in_cube(-0.2f, 1.2f) * box.size();
                const glm::vec3 to = box.lo + random.in_cube(-0.2f, 1.2f) * box.size();
                batch.push(batch.count % 16 == 0 ? adversarial.next() : Ray{from, to - from, random.uniform(0.0f, 1.0f)});
            }
            accelerator.closest_hits(batch, hits);
            accelerator.occluded(batch, occluded);
            for (int k = 0; k < kRayBatch; ++k) {
                ASSERT_EQ(hits[k].found(), occluded[static_cast<std::size_t>(k)]) << name << ' ' << text(batch[k]);
                blocked += hits[k].found() ? 1 : 0;
            }
        }
        EXPECT_GT(blocked, count / 20) << name;
    };
    const std::size_t count = scale<std::size_t>(1000000, 10000000);
    for (const auto build : {&scenes::mixed, &scenes::sphereflake}) {
        const auto geometry = std::make_shared<const Geometry>(build());
        for_each_structure(geometry, [&](const auto& accelerator, const std::string& name) {
            compare(accelerator, *geometry, is_in_use(name) ? count / 2 : count / 20, name);
        });
    }
    const auto few = std::make_shared<const Geometry>(scenes::mixture(5, 3, 1.0f));
    compare(BruteForce(few), *few, count, "none");
}

// What the catalogue's stadium costs a ray, by rays as pictures have them: in the tree a small part of what the loop tests.
TEST(Stadium, S_GRD_04_ACrowdInACornerIsFoundCheaply) {
    const auto geometry = std::make_shared<const Geometry>(scenes::stadium());
    const Aabb box = geometry->bounds();
    Random random(4);
    RayBatch batch;
    batch.clear(RayOrder::divergent);
    while (batch.count < kRayBatch) {
        // Every second one into the corner, from near and far.
        const bool near = batch.count % 4 == 0;
        const glm::vec3 target = batch.count % 2 == 0 ? glm::vec3(-50.0f) + 1e-3f * random.in_cube(-1.0f, 1.0f)
                                                      : box.lo + random.in_cube(0.0f, 1.0f) * box.size();
        const glm::vec3 origin = target + (near ? 0.01f : glm::length(box.size())) * random.direction();
        batch.push({origin, target - origin});
    }
    for_each_structure(geometry, [&](const auto& accelerator, const std::string& name) {
        const TraversalCounts counts = accelerator.count_traversal(batch);
        const double rays = static_cast<double>(counts.rays), blocks = static_cast<double>(counts.leaves) / rays;
        RecordProperty(name + " nodes a ray", std::to_string(static_cast<double>(counts.nodes) / rays));
        RecordProperty(name + " blocks a ray", std::to_string(blocks));
        // The grid's cells cannot be smaller than the rounding errors of rays from afar, and here the whole crowd is.
        if (name.starts_with("bvh")) {
            EXPECT_LT(blocks, static_cast<double>(geometry->bounded_count()) / 8.0 / 10.0) << name;
        }
        for (int i = 0; i < kRayBatch; ++i)
            EXPECT_TRUE(same(BruteForce(geometry).closest_hit(batch[i]), accelerator.closest_hit(batch[i]))) << name;
    });
}

}  // namespace
}  // namespace glint
