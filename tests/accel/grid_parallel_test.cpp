// One grid, byte for byte, whoever builds it.
#include <cstring>
#include <stdexcept>

#include <gtest/gtest.h>

#include "accel/accelerator.h"
#include "tests/accel/adversarial_scenes.h"
#include "tests/accel/schedules.h"

namespace glint {
namespace {

constexpr double kPadding = 1.0e-5;

struct Built {
    GridBlocks blocks;
    GridCells cells;
};

Built build(const Geometry& g, const ParallelFor& parallel_for) {
    std::vector<BoundedPrimitive> primitives;
    for (const PrimitiveId id : g.bounded_ids()) primitives.push_back({g.bounds(id), id});
    Built built;
    built.blocks = make_grid_blocks(g, primitives, std::min<std::size_t>(3, primitives.size() / 2), parallel_for);
    built.cells = build_grid_cells(built.blocks, primitives, kPadding, {}, parallel_for);
    return built;
}

bool equal(const GridLevel& a, const GridLevel& b) { return std::memcmp(&a, &b, offsetof(GridLevel, n) + sizeof(a.n)) == 0; }

void expect_equal(const Built& a, const Built& b) {
    ASSERT_EQ(a.blocks.refs, b.blocks.refs);
    EXPECT_EQ(a.blocks.first, b.blocks.first);
    EXPECT_EQ(a.blocks.large, b.blocks.large);
    ASSERT_EQ(a.blocks.units.size(), b.blocks.units.size());
    for (const BvhRef ref : a.blocks.refs) {
        const std::size_t used = block_bytes(static_cast<PrimitiveKind>(leaf_kind(ref))).first;
        const std::size_t unit = ref & kUnitMask;
        ASSERT_EQ(std::memcmp(a.blocks.units[unit].bytes, b.blocks.units[unit].bytes, used), 0);
    }
    EXPECT_EQ(a.cells.references, b.cells.references);
    EXPECT_EQ(a.cells.cells, b.cells.cells);
    EXPECT_EQ(a.cells.lists, b.cells.lists);
    ASSERT_EQ(a.cells.levels.size(), b.cells.levels.size());
    for (std::size_t i = 0; i < a.cells.levels.size(); ++i) ASSERT_TRUE(equal(a.cells.levels[i], b.cells.levels[i])) << i;
}

void expect_one_grid(const Geometry& g) {
    if (g.bounded_count() == 0) return;
    const Built expected = build(g, serial_for);
    for (const ParallelFor& parallel_for : {ParallelFor(shuffled_for), ParallelFor(on_four_threads)})
        ASSERT_NO_FATAL_FAILURE(expect_equal(build(g, parallel_for), expected));
}

// Large enough for every loop of the builder: ranges halved side by side, slices, a level within a cell that is shared out.
TEST(GridParallel, OneGridFromAnyScheduleOfALargeScene) {
    expect_one_grid(triangles_in_cube(11, 150000, glm::vec3(0.0f), 1.0f, 0.02f));
    expect_one_grid(scenes::mixture(12, 30000, 1.0f));
    Geometry corner = triangles_in_cube(13, 60000, glm::vec3(0.0f), 0.01f, 0.0005f);
    corner.spheres = {{glm::vec3(9.0f), 1.0f}, {glm::vec3(-9.0f, 9.0f, 9.0f), 1.0f}};
    for (int i = 0; i < 200; ++i)
        corner.boxes.push_back(
            {glm::vec3(static_cast<float>(i % 20), -9.0f, 0.0f), glm::vec3(static_cast<float>(i % 20), 9.0f, 9.0f)});
    const Built built = build(corner, serial_for);
    EXPECT_GT(built.cells.levels.size(), 1u) << "no level to share out";
    expect_one_grid(corner);
}

class GridParallelOnScene : public testing::TestWithParam<AdversarialScene> {};
TEST_P(GridParallelOnScene, OneGridFromAnySchedule) { expect_one_grid(GetParam().build()); }
INSTANTIATE_TEST_SUITE_P(Scenes, GridParallelOnScene, testing::ValuesIn(kAdversarialScenes),
                         [](const testing::TestParamInfo<AdversarialScene>& scene) { return std::string(scene.param.name); });

TEST(GridParallel, TheCallersLoopIsTheOneThatIsUsed) {
    const auto g = std::make_shared<const Geometry>(triangles_in_cube(13, 100000, glm::vec3(0.0f), 1.0f, 0.02f));
    std::size_t tasks = 0;
    const auto counting = [&](std::size_t count, const std::function<void(std::size_t)>& task) {
        tasks += count;
        serial_for(count, task);
    };
    EXPECT_NE(build_accelerator(AcceleratorKind::grid, g, counting), nullptr);
    EXPECT_GT(tasks, 64u);
    const auto stopping = [&](std::size_t, const std::function<void(std::size_t)>&) { throw std::runtime_error("stop"); };
    EXPECT_THROW((void)build_accelerator(AcceleratorKind::grid, g, stopping), std::runtime_error);
}

// Every block holds eight neighbours: their boxes are small beside the scene, and no primitive is lost or doubled.
TEST(GridOrder, BlocksHoldEachPrimitiveOnceAndNeighboursTogether) {
    const Geometry g = triangles_in_cube(17, 50000, glm::vec3(0.0f), 1.0f, 1.0e-4f);
    std::vector<BoundedPrimitive> primitives;
    for (const PrimitiveId id : g.bounded_ids()) primitives.push_back({g.bounds(id), id});
    order_by_neighbours(primitives, {{0, primitives.size()}}, serial_for);
    std::vector<int> seen(primitives.size());
    double area = 0.0;
    for (std::size_t i = 0; i < primitives.size(); i += 8) {
        Aabb box;
        for (std::size_t k = i; k < std::min(primitives.size(), i + 8); ++k) {
            box.grow(primitives[k].bounds);
            ++seen[index_of(primitives[k].id)];
        }
        area += static_cast<double>(box.half_area());
    }
    EXPECT_TRUE(std::ranges::all_of(seen, [](int n) { return n == 1; }));
    // Cubes of a volume of eight primitives each have half areas of 3 * (8 * 8 / 50000)^(2/3).
    EXPECT_LT(area / (static_cast<double>(primitives.size()) / 8.0), 1.5 * 3.0 * std::pow(64.0 / 50000.0, 2.0 / 3.0));
}

}  // namespace
}  // namespace glint
