// Samples traced in lockstep: whoever shares a batch with whom, each sample's light is the same to the bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <vector>

#include "core/builtin.h"
#include "core/scene_io.h"
#include "core/tile_kernels.h"
#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

// A scene with one of everything, so that every feature mask has something to do: mirrors and glass beside matte
// surfaces, a point light, a spread one and a sphere, all seen through a lens.
std::shared_ptr<const Scene> a_bit_of_everything() {
    auto scene = std::make_shared<Scene>(*load_scene("builtin:glass,what=nested"));
    SceneBuilder b;
    b.add(Sphere{{0, 0, 0}, 1.0f}, b.add_material(glass(1.5f)));
    b.add(Sphere{{0.1f, 0.1f, 0}, 0.5f}, b.add_material(glass(1.33f)));
    b.add(Sphere{{2, 0, 0.3f}, 0.8f}, b.add_material(mirror(0.9f, 0.2f)));
    Material shiny = highlight(0.5f, 30.0f);
    shiny.diffuse = glm::vec3(0.6f, 0.4f, 0.2f);
    shiny.mirror = glm::vec3(0.3f);
    b.add(Box{{-2.6f, -0.8f, -0.7f}, {-1.4f, 0.7f, 0.6f}}, b.add_material(shiny));
    b.add(plane_at({0, -1, 0}, {0, 1, 0}), b.add_material(matte(0.7f)));
    b.scene().lights = {point_light({3, 5, 4}), point_light({-4, 3, 2}), point_light({0, 6, -1})};
    b.scene().lights[1].edge1 = {0.5f, 0, 0}, b.scene().lights[1].edge2 = {0, 0, 0.5f};
    b.scene().lights[2].shape = Light::Shape::sphere, b.scene().lights[2].radius = 0.3f;
    b.scene().environment = scene->environment;
    b.scene().cameras = {camera_at({0.5f, 2, 7}, {0, 0, 0})};
    b.scene().cameras[0].lens_radius = 0.05f;
    return b.finish();
}

struct Lockstep : testing::Test {
    static constexpr int kSide = 24;
    std::shared_ptr<const Scene> scene = a_bit_of_everything();
    Bvh accelerator{scene->geometry};

    // Two samples of each pixel of a small picture.
    [[nodiscard]] std::vector<CameraSample> samples(const RenderPlan& plan) const {
        const Camera camera(plan.camera, kSide, kSide);
        std::vector<CameraSample> list;
        for (int i = 0; i < kSide * kSide; ++i) {
            for (std::uint64_t k = 0; k < 2; ++k) {
                const int x = i % kSide, y = i / kSide;
                const Sampler s(SamplerKind::sobol, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), k, 7);
                const glm::vec2 lens = disk_from_square(s.square(dimension::lens));
                list.push_back({camera.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, lens), s});
            }
        }
        return list;
    }

    // The samples in batches of `size`, through the instance of the plan.
    template <unsigned... kParts>
    std::vector<glm::vec3> trace(const RenderPlan& plan, const std::vector<CameraSample>& list, std::size_t size, Workspace& work,
                                 std::integer_sequence<unsigned, kParts...>) {
        std::vector<glm::vec3> light(list.size());
        const auto run = [&](auto part) {
            Integrator<Bvh, instance_parts(part)> integrator(*scene, accelerator, plan, work);
            integrator.prepare();
            for (std::size_t i = 0; i < list.size(); i += size) {
                const std::size_t n = std::min(size, list.size() - i);
                EXPECT_TRUE(
                    integrator.radiance(std::span(list).subspan(i, n), std::span(light).subspan(i, n), [] { return false; }));
            }
        };
        ((plan.kernel == kParts ? run(std::integral_constant<unsigned, kParts>()) : void()), ...);
        return light;
    }
    std::vector<glm::vec3> trace(const RenderPlan& plan, const std::vector<CameraSample>& list, std::size_t size,
                                 Workspace& work) {
        return trace(plan, list, size, work, std::make_integer_sequence<unsigned, kernel_part::count>());
    }

    // The frame's features with the parts of `mask` and no others.
    [[nodiscard]] RenderPlan plan_of(unsigned mask) const {
        RenderSettings settings;
        settings.features = FeatureSet::all();
        settings.features.set(Feature::soft, (mask & kernel_part::soft) != 0);
        settings.features.set(Feature::fuzzy, (mask & kernel_part::fuzzy) != 0);
        RenderPlan plan = plan_render(*scene, settings, scene->cameras.front());
        plan.kernel &= mask;
        return plan;
    }
};

bool equal_bits(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(glm::vec3)) == 0;
}

TEST_F(Lockstep, TheSameBitsInBatchesOfAnySizeForEveryPart) {
    Workspace work;
    std::vector<std::vector<glm::vec3>> pictures;
    for (unsigned mask = 0; mask < kernel_part::count; ++mask) {
        const RenderPlan plan = plan_of(mask);
        const std::vector<CameraSample> list = samples(plan);
        work.counts = RayCounts();
        const std::vector<glm::vec3> alone = trace(plan, list, 1, work);
        const RayCounts counts = work.counts;
        EXPECT_GT(counts.shadow, 0u);
        EXPECT_EQ(counts.reflection > 0, (mask & (kernel_part::mirror | kernel_part::glass)) != 0);
        EXPECT_EQ(counts.refraction > 0, (mask & kernel_part::glass) != 0);
        for (const std::size_t size : {256u, 255u, 64u, 17u, 2u}) {
            work.counts = RayCounts();
            EXPECT_TRUE(equal_bits(alone, trace(plan, list, size, work))) << mask << ' ' << size;
            EXPECT_EQ(work.counts.total(), counts.total());
            EXPECT_EQ(work.counts.shadow, counts.shadow);
            EXPECT_EQ(work.counts.depth_cut, counts.depth_cut);
        }
        pictures.push_back(alone);
    }
    // The parts were really different ones.
    EXPECT_FALSE(equal_bits(pictures[0], pictures[kernel_part::mirror]));
    EXPECT_FALSE(equal_bits(pictures[0], pictures[kernel_part::glass]));
    EXPECT_FALSE(equal_bits(pictures[0], pictures[kernel_part::soft]));
    EXPECT_FALSE(equal_bits(pictures[kernel_part::mirror], pictures[kernel_part::mirror | kernel_part::fuzzy]));
}

// Batches of one are traced ray by ray, full ones as packets and as rays in flight.
TEST_F(Lockstep, TheSameBitsInEveryInstructionSetAndBatch) {
    Workspace work;
    const RenderPlan plan = plan_of(kernel_part::count - 1);
    const std::vector<CameraSample> list = samples(plan);
    const std::vector<glm::vec3> expected = trace(plan, list, 1, work);
    for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
        if (!supported(isa)) continue;
        accelerator = Bvh(scene->geometry, serial_for, isa);
        for (const std::size_t size : {1u, 15u, 17u, 256u}) {
            EXPECT_TRUE(equal_bits(expected, trace(plan, list, size, work)))
                << kIsaNames[static_cast<std::size_t>(isa)] << ' ' << size;
        }
    }
}

TEST_F(Lockstep, TheSameBitsInAnyOrder) {
    Workspace work;
    const RenderPlan plan = plan_of(kernel_part::count - 1);
    std::vector<CameraSample> list = samples(plan);
    std::vector<glm::vec3> light = trace(plan, list, kRayBatch, work);
    std::reverse(list.begin(), list.end());
    std::reverse(light.begin(), light.end());
    EXPECT_TRUE(equal_bits(light, trace(plan, list, 100, work)));
}

// What an abandoned batch leaves behind must not show in the next one.
TEST_F(Lockstep, AnAbandonedBatchLeavesNothingBehind) {
    const RenderPlan plan = plan_of(kernel_part::mirror | kernel_part::glass);
    const std::vector<CameraSample> list = samples(plan);
    Workspace fresh, used;
    const std::vector<glm::vec3> expected = trace(plan, list, kRayBatch, fresh);
    const auto middle = std::span(list).subspan((list.size() - kRayBatch) / 2, kRayBatch);
    Integrator<Bvh, kernel_part::mirror | kernel_part::glass> integrator(*scene, accelerator, plan, used);
    integrator.prepare();
    for (int waves = 0; waves < 6; ++waves) {
        std::vector<glm::vec3> light(kRayBatch, glm::vec3(-1.0f));
        int left = waves;
        EXPECT_FALSE(integrator.radiance(middle, light, [&] { return left-- == 0; }));
        EXPECT_TRUE(equal_bits(expected, trace(plan, list, kRayBatch, used))) << waves;
    }
}

// Deep trees grow the stacks far beyond their first size.
TEST_F(Lockstep, TheSameBitsAtGreatDepth) {
    Workspace work;
    RenderPlan plan = plan_of(kernel_part::mirror | kernel_part::glass);
    plan.depth = 14;
    std::vector<CameraSample> list = samples(plan);
    list.erase(list.begin(), list.begin() + 426);
    list.resize(300);
    const std::vector<glm::vec3> alone = trace(plan, list, 1, work);
    EXPECT_TRUE(equal_bits(alone, trace(plan, list, kRayBatch, work)));
}

// Neighbours of a batch are neighbours in the picture: whatever rectangle, every pixel gets its samples once, in order.
TEST(TileKernel, EveryPixelOfAnyRectangleGetsItsSamples) {
    const auto scene = load_scene("builtin:balls,level=1");
    const auto accelerator = build_accelerator(AcceleratorKind::bvh, scene->geometry);
    const RenderPlan plan = plan_render(*scene, RenderSettings(), scene->cameras.front());
    const Camera camera(plan.camera, 64, 64);
    const std::atomic<std::uint64_t> generation{3};
    const KernelInput input{*scene, *accelerator, plan, camera, generation, 3};
    const auto sums_of = [&](TileRect rect, int first, int last, std::vector<PixelSum>& sums) {
        Workspace work;
        EXPECT_TRUE(render_tile(input, rect, first, last, sums, work));
        EXPECT_EQ(work.counts.camera, rect.pixels() * static_cast<std::size_t>(last - first));
    };
    std::vector<PixelSum> whole(64 * 64);
    sums_of({0, 0, 64, 64}, 0, 5, whole);
    for (const TileRect rect : {TileRect{0, 0, 16, 16}, {48, 32, 64, 48}, {3, 5, 4, 6}, {10, 7, 23, 12}, {0, 60, 64, 64}}) {
        std::vector<PixelSum> sums(rect.pixels());
        sums_of(rect, 0, 2, sums);
        sums_of(rect, 2, 5, sums);
        for (int y = rect.y0, i = 0; y < rect.y1; ++y) {
            for (int x = rect.x0; x < rect.x1; ++x, ++i) {
                const PixelSum& a = whole[static_cast<std::size_t>(y * 64 + x)];
                const PixelSum& b = sums[static_cast<std::size_t>(i)];
                ASSERT_EQ(a.radiance, b.radiance) << x << ' ' << y;
                ASSERT_EQ(a.before, b.before) << x << ' ' << y;
            }
        }
    }
    Workspace work;
    const KernelInput stale{*scene, *accelerator, plan, camera, generation, 2};
    EXPECT_FALSE(render_tile(stale, {0, 0, 16, 16}, 0, 1, whole, work));
}

}  // namespace
}  // namespace glint
