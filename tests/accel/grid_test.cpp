#include <cmath>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "accel/accelerator.h"
#include "tests/accel/adversarial_scenes.h"
#include "tests/accel/hit_report.h"

namespace glint {
namespace {

// Eight cells a primitive in one level: many more steps through many smaller cells than speed asks for.
constexpr GridDensity kFine{16.0, 16.0, 1000000};

UniformGrid fine_grid(std::shared_ptr<const Geometry> geometry) {
    return UniformGrid(std::move(geometry), serial_for, isa_in_use(), kFine);
}

void expect_same(const UniformGrid& grid, const BruteForce& truth, const Ray& ray) {
    const Hit expected = truth.closest_hit(ray), hit = grid.closest_hit(ray);
    ASSERT_TRUE(same(hit, expected)) << text(ray) << "\n" << text(hit) << "\n" << text(expected);
    ASSERT_EQ(grid.occluded(ray), expected.found()) << text(ray);
}

TEST(Grid, S_GRD_01_AHitInALaterCellDoesNotEndTheWalk) {
    auto geometry = std::make_shared<Geometry>();
    add_triangle(*geometry, glm::vec3(0.0f, 0.0f, 0.5f), glm::vec3(3.0f, 0.6f, 0.0f), glm::vec3(3.0f, 0.6f, 1.0f));
    geometry->spheres = {{glm::vec3(1.5f, 0.5f, 0.5f), 0.2f}};
    const UniformGrid grid = fine_grid(geometry);
    ASSERT_GE(grid.resolution().x, 3) << "too coarse to test anything";
    const Hit hit = grid.closest_hit({glm::vec3(-1.0f, 0.5f, 0.5f), glm::vec3(1.0f, 0.0f, 0.0f)});
    EXPECT_EQ(hit.primitive, make_id(PrimitiveKind::sphere, 0));
    EXPECT_FLOAT_EQ(hit.t, 2.3f);
}

// A lattice of spheres and triangles whose cells' faces, edges and corners the rays follow.
TEST(Grid, S_GRD_02_RaysAlongFacesEdgesAndCornersOfCells) {
    auto geometry = std::make_shared<Geometry>();
    for (int i = 0; i < 125; ++i) {
        const glm::vec3 p(i % 5, i / 5 % 5, i / 25);
        geometry->spheres.push_back({p, i % 2 == 0 ? 0.5f : 0.2f});
        add_triangle(*geometry, p, p + glm::vec3(1.0f, 0.0f, 0.0f), p + glm::vec3(0.0f, 1.0f, 0.0f));
    }
    const UniformGrid grid = fine_grid(geometry);
    const BruteForce truth(geometry);
    Random random(2);
    const auto coin = [&random] { return random.below(2) == 0; };
    const auto corner = [&] {
        glm::ivec3 cell;
        for (int k = 0; k < 3; ++k) cell[k] = static_cast<int>(random.below(static_cast<std::size_t>(grid.resolution()[k]) + 1));
        return glm::vec3(grid.corner(cell));
    };
    for (int i = 0; i < 100000; ++i) {
        const auto axis = static_cast<int>(random.below(3));
        Ray ray{corner(), random.direction()};
        switch (i % 5) {
            case 0: ray.direction[axis] = coin() ? 0.0f : -0.0f; break;  // within a face
            case 1:                                                      // along an edge
                ray.direction = glm::vec3(coin() ? 0.0f : -0.0f);
                ray.direction[axis] = coin() ? 1.0f : -1.0f;
                break;
            case 2: ray.direction = glm::vec3(coin() ? 1.0f : -1.0f, 1.0f, coin() ? 1.0f : -1.0f); break;  // through corners
            case 3: {                                                                                      // corner to corner
                const glm::vec3 to = corner();
                if (to != ray.origin) ray.direction = to - ray.origin;
                break;
            }
            default: ray.direction[axis] *= 1.0e-20f; break;  // all but within a face
        }
        if (coin()) ray.origin -= static_cast<float>(random.below(8)) * ray.direction;
        if (coin()) ray.t_max = random.uniform(0.1f, 6.0f);
        ASSERT_NO_FATAL_FAILURE(expect_same(grid, truth, ray));
    }
}

TEST(Grid, S_GRD_03_TheEndOfARowOfTenThousandIsReached) {
    const auto geometry = std::make_shared<const Geometry>(scenes::sphere_row());
    const UniformGrid grid = fine_grid(geometry);
    ASSERT_GE(grid.resolution().x, 4000);
    // Down the row just above the spheres, dipping into one far away.
    for (int i = 0; i < 10000; i += 7) {
        const double x = 0.1 * i;
        const glm::dvec3 from(-1.0, 0.0401, 0.0), d = glm::dvec3(x, 0.039, 0.0) - from;
        const Ray ray{glm::vec3(from), glm::vec3(d / std::sqrt(glm::dot(d, d)))};
        ASSERT_NO_FATAL_FAILURE(expect_same(grid, BruteForce(geometry), ray));
        const Hit across = grid.closest_hit({glm::vec3(x, 5.0, 0.0), glm::vec3(0.0f, -1.0f, 0.0f)});
        ASSERT_EQ(across.primitive, make_id(PrimitiveKind::sphere, static_cast<std::uint32_t>(i)));
    }
}

// Cells and references stay within a small multiple of the primitives, whatever the scene.
void expect_bounded(const Geometry& geometry, const char* what) {
    const std::size_t n = geometry.bounded_count();
    for (const GridDensity& density : {GridDensity{}, kFine}) {
        const UniformGrid grid(std::make_shared<const Geometry>(geometry), serial_for, isa_in_use(), density);
        EXPECT_GE(8 * grid.reference_count() + 16, n) << what;  // a few large ones may be kept out of the cells
        EXPECT_LE(grid.reference_count(), 16 * n + 4096) << what;
        EXPECT_LE(grid.cell_count(), 64 * n + 64) << what;
        // Blocks hold at most 40 bytes a primitive when full; a level costs less than 64.
        EXPECT_LE(grid.memory_bytes(), 40 * n + 2048 + 8 * (grid.cell_count() + grid.reference_count()) + 64 * grid.level_count())
            << what;
    }
}

TEST(Grid, S_GRD_05_MemoryIsBoundedByTheNumberOfPrimitives) {
    Geometry huge_and_tiny = triangles_in_cube(5, 100000, glm::vec3(0.0f), 1.0f, 1.0e-3f);
    huge_and_tiny.spheres = {{glm::vec3(0.0f), 3.0f}};
    expect_bounded(huge_and_tiny, "one huge primitive and 100,000 tiny ones");
    expect_bounded(triangles_in_cube(6, 20000, glm::vec3(0.0f), 1.0f, 1.0f), "20,000 triangles that all fill the scene");
    Geometry concentric;
    for (int i = 1; i <= 100000; ++i) concentric.spheres.push_back({glm::vec3(1.0f), 1.0f + 1.0e-3f * static_cast<float>(i)});
    expect_bounded(concentric, "100,000 spheres around each other");
    Geometry wires = triangles_in_cube(7, 1, glm::vec3(0.0f), 0.0f, 1.0f);
    Random random(7);
    while (wires.triangles.size() < 20000) {
        const glm::vec3 a = random.in_cube(-1.0f, 1.0f);
        add_triangle(wires, a, -a, a + 1.0e-4f * random.direction());
    }
    expect_bounded(wires, "20,000 needles through the whole scene");
    for (const AdversarialScene& scene : kAdversarialScenes) {
        const Geometry g = scene.build();
        if (g.bounded_count() > 0) expect_bounded(g, scene.name.data());
    }
}

TEST(Grid, S_GRD_07_OriginInsideOutsideAndExactlyOnTheBounds) {
    Geometry plane_of_boxes;
    for (int i = 0; i < 100; ++i) {
        const glm::vec3 p(i % 10, i / 10, 2.0f);
        plane_of_boxes.boxes.push_back({p, p + glm::vec3(0.5f, 0.5f, 0.0f)});
    }
    for (const Geometry& g : {scenes::one_sphere(), scenes::one_triangle(), scenes::flat_floor(), plane_of_boxes}) {
        const auto geometry = std::make_shared<const Geometry>(g);
        const UniformGrid grid(geometry);
        const BruteForce truth(geometry);
        const Aabb box = geometry->bounds();
        const glm::dvec3 grid_lo = grid.corner(glm::ivec3(0)), grid_hi = grid.corner(grid.resolution());
        Random random(8);
        for (int i = 0; i < 5000; ++i) {
            const auto axis = static_cast<int>(random.below(3));
            const float size = glm::length(box.size());
            Ray ray{box.lo + random.in_cube(0.0f, 1.0f) * box.size(), random.direction()};
            if (i % 5 == 1) ray.origin = box.center() + size * random.in_cube(-2.0f, 2.0f);
            if (i % 5 == 2) ray.origin[axis] = random.below(2) == 0 ? box.lo[axis] : box.hi[axis];
            if (i % 5 == 3) ray.origin[axis] = static_cast<float>(random.below(2) == 0 ? grid_lo[axis] : grid_hi[axis]);
            if (i % 5 == 4) ray.origin = glm::vec3(random.below(2) == 0 ? grid_lo : grid_hi);
            if (i % 3 == 0) ray.direction[axis] = 0.0f;
            ASSERT_NO_FATAL_FAILURE(expect_same(grid, truth, ray));
        }
    }
    const UniformGrid empty(std::make_shared<const Geometry>());
    EXPECT_FALSE(empty.closest_hit({glm::vec3(0.0f), glm::vec3(1.0f)}).found());
    EXPECT_FALSE(empty.occluded({glm::vec3(0.0f), glm::vec3(1.0f)}));
}

// Beyond the distance up to which cells are padded, near and far of that border, past the corners of the bounds.
TEST(Grid, S_GRD_08_RaysFromBeyondThePaddingAnswerLikeBruteForce) {
    for (const Geometry& g : {scenes::one_sphere(), scenes::one_triangle(), scenes::closed_ball()}) {
        const auto geometry = std::make_shared<const Geometry>(g);
        const UniformGrid grid(geometry);
        const BruteForce truth(geometry);
        const Aabb box = geometry->bounds();
        Random random(9);
        for (int i = 0; i < 3000; ++i) {
            glm::vec3 target = box.center();
            target[i % 3] = i % 2 == 0 ? box.lo[i % 3] : box.hi[i % 3];
            glm::vec3 direction = random.direction();
            direction[i % 3] = 0.0f;
            const glm::vec3 origin =
                target + box.magnitude() * (i % 4 == 0 ? 64.0f : random.power_of_ten(1.7f, 6.0f)) * direction;
            ASSERT_NO_FATAL_FAILURE(expect_same(grid, truth, {origin, target - origin}));
        }
    }
}

// Cameras and lamps at 10^2 to 10^5 sizes, aimed at and past the contents, towards them and back: no ray of theirs may meet
// less than brute force, however its rounding error compares with the cells.
TEST(Grid, RaysFromFarLightsAndCamerasAnswerLikeBruteForce) {
    for (const Geometry& g : {scenes::triangle_soup(), scenes::sphereflake(), scenes::stadium(), scenes::mixed()}) {
        const auto geometry = std::make_shared<const Geometry>(g);
        const Aabb box = geometry->bounds();
        Random random(10);
        for (const GridDensity& density : {GridDensity{}, kFine}) {
            const UniformGrid grid(geometry, serial_for, isa_in_use(), density);
            const BruteForce truth(geometry);
            std::size_t hits = 0;
            for (int i = 0; i < 1500; ++i) {
                const glm::vec3 target = box.lo + random.in_cube(0.0f, 1.0f) * box.size();
                const glm::vec3 origin = target + box.magnitude() * random.power_of_ten(1.0f, 5.3f) * random.direction();
                Ray ray{origin, target - origin};
                if (i % 3 == 1) ray.t_max = random.uniform(0.9f, 1.1f);
                if (i % 3 == 2) ray.direction[i / 3 % 3] = 0.0f;
                ASSERT_NO_FATAL_FAILURE(expect_same(grid, truth, ray));
                hits += truth.closest_hit(ray).found() ? 1 : 0;
            }
            EXPECT_GT(hits, 100u);
        }
    }
}

// From 100 sizes a ray must not ask a large part of the scene, as brute force would.
TEST(Grid, ARayFromFarAwayTestsFewBlocks) {
    const auto geometry = std::make_shared<const Geometry>(scenes::closed_ball());
    const UniformGrid grid(geometry);
    RayBatch batch;
    batch.clear(RayOrder::divergent);
    Random random(11);
    const Aabb box = geometry->bounds();
    while (batch.count < kRayBatch) {
        const glm::vec3 origin = 100.0f * box.magnitude() * random.direction();
        batch.push({origin, box.lo + random.in_cube(0.0f, 1.0f) * box.size() - origin});
    }
    ASSERT_GT(100.0f * box.magnitude() * 0.5f, grid.near_origin());
    const TraversalCounts counts = grid.count_traversal(batch);
    EXPECT_EQ(counts.rays, static_cast<std::size_t>(kRayBatch));
    EXPECT_LT(counts.leaves, counts.rays * geometry->bounded_count() / 8 / 5);
}

// S-GRD-06: what was tested is remembered by the ray alone, and only to save tests: one block in many cells is tested once.
TEST(Grid, S_GRD_06_ABlockInManyCellsIsTestedOnce) {
    Geometry g;
    for (int i = 0; i < 8; ++i) {
        const float y = 0.01f * static_cast<float>(i);
        add_triangle(g, glm::vec3(0.0f, y, 0.0f), glm::vec3(10.0f, y, 0.1f), glm::vec3(10.0f, y + 0.005f, 0.0f));
    }
    const UniformGrid grid(std::make_shared<const Geometry>(g), serial_for, isa_in_use(), {64.0, 64.0, 1000000});
    RayBatch batch;
    batch.clear(RayOrder::divergent);
    batch.push({glm::vec3(-1.0f, 0.042f, 0.05f), glm::vec3(1.0f, 0.0f, 0.0f)});
    const TraversalCounts counts = grid.count_traversal(batch);
    EXPECT_GT(counts.nodes, 10u);
    EXPECT_LE(counts.leaves, 2u);
}

TEST(Grid, TheCellsAreTheSameHoweverTheyAreBuilt) {
    const auto geometry = std::make_shared<const Geometry>(triangles_in_cube(12, 40000, glm::vec3(0.0f), 1.0f, 0.02f));
    const ParallelFor backwards = [](std::size_t count, const std::function<void(std::size_t)>& task) {
        std::vector<std::jthread> threads;
        for (std::size_t t = 0; t < 3; ++t) {
            threads.emplace_back([=, &task] {
                for (std::size_t i = count; i-- > 0;) {
                    if (i % 3 == t) task(i);
                }
            });
        }
    };
    const UniformGrid a(geometry), b(geometry, backwards);
    EXPECT_EQ(a.reference_count(), b.reference_count());
    EXPECT_EQ(a.cell_count(), b.cell_count());
    EXPECT_EQ(a.level_count(), b.level_count());
    RayBatch batch;
    batch.clear(RayOrder::divergent);
    Random random(13);
    while (batch.count < kRayBatch) batch.push({2.0f * random.direction(), random.direction()});
    const TraversalCounts ca = a.count_traversal(batch), cb = b.count_traversal(batch);
    EXPECT_EQ(ca.nodes, cb.nodes);
    EXPECT_EQ(ca.leaves, cb.leaves);
    for (int i = 0; i < kRayBatch; ++i) ASSERT_TRUE(same(a.closest_hit(batch[i]), b.closest_hit(batch[i])));
}

}  // namespace
}  // namespace glint
