// One picture, byte for byte: whatever accelerator, thread count, batch or scale; and toggles that leave no trace.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <thread>

#include "tests/core/render_picture.h"

namespace glint {
namespace {

constexpr AcceleratorKind kAll[] = {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh};

// Scenes that together use every primitive, every light, glass, mirrors, lens, sky and a cube of colours.
const char* const kScenes[] = {"builtin:balls,level=2", "builtin:mount,level=4", "builtin:balls_box",
                               "builtin:dof",           "builtin:cornell",       "builtin:glass,what=nested"};

FeatureSet everything() { return FeatureSet::all(); }

class SameBits : public testing::TestWithParam<const char*> {
protected:
    std::shared_ptr<const Scene> scene = load_scene(GetParam());

    // Brute force pays for every primitive, so scenes with many get a smaller picture and fewer bounces.
    [[nodiscard]] Picture picture(int spp) const {
        Picture p;
        p.spp = spp;
        if (scene->geometry->bounded_count() > 400) {
            p.width = p.height = 20;
            p.settings.depth = 4;
        }
        return p;
    }
};

TEST_P(SameBits, S_DET_01_FromEveryAcceleratorAndThreadCount) {
    Picture p = picture(3);
    p.settings.features = everything();
    p.threads = 1;
    const Image first = render_picture(scene, p);
    for (const AcceleratorKind kind : kAll) {
        for (const int threads : {1, 2, 3, 8}) {
            p.accelerator = kind;
            p.threads = threads;
            EXPECT_EQ(differing_pixels(first, render_picture(scene, p)), 0u)
                << kAcceleratorNames[static_cast<std::size_t>(kind)] << " " << threads;
        }
    }
}

// Single rays, packets and rays in flight all occur here; same_hit_test compares each of them by itself.
TEST_P(SameBits, S_DET_01_FromEveryInstructionSet) {
    Picture p = picture(3);
    p.settings.features = everything();
    p.settings.depth = 4;
    p.accelerator = AcceleratorKind::none;
    const Image expected = render_picture(scene, p);
    p.accelerator = AcceleratorKind::bvh;
    for_each_isa([&](Isa isa) {
        EXPECT_EQ(differing_pixels(expected, render_picture(scene, p)), 0u) << kIsaNames[static_cast<std::size_t>(isa)];
    });
}

TEST_P(SameBits, OneSeedOnePictureAnotherSeedAnother) {
    Picture p = picture(2);
    p.settings.seed = 1;
    const Image first = render_picture(scene, p);
    EXPECT_EQ(differing_pixels(first, render_picture(scene, p)), 0u);
    p.settings.seed = 2;
    EXPECT_NE(differing_pixels(first, render_picture(scene, p)), 0u);
}

TEST_P(SameBits, OfACropAndTheWholePicture) {
    Picture p;
    p.spp = 2;
    const Image whole = render_picture(scene, p);
    Renderer renderer(2, false);
    Frame frame = frame_of(scene, p);
    frame.x0 = 19, frame.x1 = 50, frame.y0 = 7, frame.y1 = 33;
    renderer.restart(frame);
    renderer.wait(1e9, nullptr);
    Image crop;
    ASSERT_TRUE(renderer.resolve(crop));
    ASSERT_EQ(crop.width, 31);
    ASSERT_EQ(crop.height, 26);
    for (int y = 0; y < crop.height; ++y) {
        for (int x = 0; x < crop.width; ++x) ASSERT_EQ(crop.at(x, y), whole.at(x + 19, y + 7)) << x << " " << y;
    }
}

// A pause, a restart with another frame in between, and a preview: the picture does not remember them.
TEST_P(SameBits, S_DET_01_AfterPausesAndRestarts) {
    Picture p = picture(4);
    const Image expected = render_picture(scene, p);
    Renderer renderer(2, true);
    Frame frame = frame_of(scene, p);
    Frame other = frame;
    other.camera.eye += glm::vec3(0.1f, 0.2f, 0.05f);
    for (int i = 0; i < 20; ++i) {
        renderer.restart(i % 2 == 0 ? other : frame);
        renderer.set_paused(i % 3 == 0);
    }
    renderer.set_paused(false);
    renderer.restart(frame);
    renderer.wait(1e9, nullptr);
    Image image;
    ASSERT_TRUE(renderer.resolve(image));
    EXPECT_EQ(differing_pixels(expected, image), 0u);
}

// Scaling by a power of two is exact, so any absolute epsilon shows as a difference.
std::shared_ptr<const Scene> scaled(const Scene& scene, float f) {
    auto result = std::make_shared<Scene>(scene);
    auto g = std::make_shared<Geometry>(*scene.geometry);
    for (auto& v : g->vertices) v *= f;
    for (auto& s : g->spheres) s.center *= f, s.radius *= f;
    for (auto& b : g->boxes) b.lo *= f, b.hi *= f;
    for (auto& c : g->cones) c.base *= f, c.apex *= f, c.base_radius *= f, c.apex_radius *= f;
    for (auto& plane : g->planes) plane.offset *= static_cast<double>(f);
    result->geometry = g;
    for (auto& l : result->lights) {
        l.position *= f, l.edge1 *= f, l.edge2 *= f, l.radius *= f, l.range *= f;
        const bool intensity = l.falloff == Light::Falloff::physical && l.shape == Light::Shape::point;
        if (intensity) l.emission *= f * f;
    }
    for (auto& c : result->cameras) c.eye *= f, c.target *= f, c.lens_radius *= f, c.focus_distance *= f;
    return result;
}

TEST_P(SameBits, S_MET_01_AtEveryScaleOfTwo) {
    Picture p = picture(2);
    p.settings.features = everything();
    const Image expected = render_picture(scene, p);
    for (const int k : {-20, -10, 10, 20}) {
        EXPECT_EQ(differing_pixels(expected, render_picture(scaled(*scene, std::ldexp(1.0f, k)), p)), 0u) << "2^" << k;
    }
}

// Each of the 256 sets of features, with samplers, approximations and accelerators taking turns.
TEST_P(SameBits, S_MET_01_WithEverySetOfFeatures) {
    const auto tiny = scaled(*scene, 0x1p-20f), huge = scaled(*scene, 0x1p20f);
    Picture p;
    p.width = 14, p.height = 10, p.threads = 1;
    p.settings.depth = 4;
    for (std::uint32_t bits = 0; bits < 256; ++bits) {
        p.settings.features.bits = bits;
        p.settings.sampler = static_cast<SamplerKind>(bits % 5);
        p.settings.fresnel = static_cast<Fresnel>(bits % 2);
        p.settings.glass = static_cast<GlassBranches>(bits / 2 % 2);
        p.settings.cutoff = bits % 3 == 0 ? 0.02f : 0.0f;
        p.settings.light_samples = 1 + static_cast<int>(bits / 4 % 2);
        p.accelerator = kAll[bits % 3];
        const Image expected = render_picture(scene, p);
        EXPECT_EQ(differing_pixels(expected, render_picture(tiny, p)), 0u) << "features " << bits;
        EXPECT_EQ(differing_pixels(expected, render_picture(huge, p)), 0u) << "features " << bits;
    }
}

// A toggle that is off gives the picture of a scene that never had the feature.
TEST_P(SameBits, OffIsBitEqualToNeverHad) {
    Picture p = picture(2);
    const auto without = [&](Feature f, auto&& strip) {
        auto bare = std::make_shared<Scene>(*scene);
        strip(*bare);
        p.settings.features = features_of(*scene);
        p.settings.features.set(f, false);
        const Image off = render_picture(scene, p);
        p.settings.features = features_of(*bare);
        p.settings.features.set(f, false);  // a light that faces one way keeps its quad, sampled at its centre
        EXPECT_EQ(differing_pixels(off, render_picture(bare, p)), 0u) << kFeatureNames[static_cast<std::size_t>(f)];
    };
    without(Feature::dof, [](Scene& s) {
        for (auto& c : s.cameras) c.lens_radius = 0.0f;
    });
    without(Feature::soft, [](Scene& s) {
        for (auto& l : s.lights) l = without_area(l);
    });
    without(Feature::fuzzy, [](Scene& s) {
        for (auto& m : s.materials) m.roughness = 0.0f;
    });
}

// What a screenshot takes in the middle of a render: a whole pass, as if it had been asked for.
TEST_P(SameBits, OfACompletePassInTheMiddleOfARender) {
    Picture p;
    p.spp = 1 << 20;
    p.width = p.height = 160;
    Renderer renderer(2, true);
    Frame frame = frame_of(scene, p);
    renderer.restart(frame);
    Image image;
    int pass = 0;
    // The renderer has a million samples to go, so only a pass that never completes runs into the limit.
    for (int i = 0; i < 30000 && pass < 3; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        pass = renderer.resolve_pass(image);
    }
    ASSERT_GE(pass, 3);
    p.spp = pass;
    EXPECT_EQ(differing_pixels(render_picture(scene, p), image), 0u) << pass;
}

// No work that does not show: samples that could only be alike are taken once.
TEST_P(SameBits, OneSampleWhereNothingIsRandom) {
    Picture p = picture(1);
    p.settings.features = FeatureSet::whitted();
    Progress once, many;
    const Image expected = render_picture(scene, p, &once);
    p.spp = 64;
    EXPECT_EQ(differing_pixels(expected, render_picture(scene, p, &many)), 0u);
    EXPECT_EQ(once.rays.total(), many.rays.total());
    EXPECT_TRUE(many.finished);
    p.settings.features.set(Feature::aa, true);
    (void)render_picture(scene, p, &many);
    EXPECT_GE(many.rays.camera, 64 * once.rays.camera);
}

INSTANTIATE_TEST_SUITE_P(Builtin, SameBits, testing::ValuesIn(kScenes), test_name);
INSTANTIATE_TEST_SUITE_P(Asset, SameBits, testing::Values(GLINT_TESTS "/../assets/soft_shadow.p3f"),
                         [](const auto&) { return "cones"; });

// The paper's seven scenes as their authors wrote them, at reduced size.
class CourseScene : public testing::TestWithParam<const char*> {};

TEST_P(CourseScene, S_DET_01_SameBitsFromEveryAcceleratorAndThreadCount) {
    const std::string path = std::string(GLINT_SHARED "/scenes/p3f/") + GetParam() + ".p3f";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
    LoadOptions options;
    options.load_environment = false;
    const auto scene = load_scene(path, options);
    Picture p;
    const bool large = scene->geometry->bounded_count() > 10000;
    p.width = p.height = large ? 12 : scene->geometry->bounded_count() > 1000 ? 32 : 96;
    p.spp = 2;
    p.settings.seed = 1;
    p.settings.features = everything();
    p.threads = 1;
    const Image first = render_picture(scene, p);
    for (const AcceleratorKind kind : kAll) {
        for (const int threads : {1, 2, 3}) {
            if (kind == AcceleratorKind::none && threads != 2) continue;
            p.accelerator = kind;
            p.threads = threads;
            EXPECT_EQ(differing_pixels(first, render_picture(scene, p)), 0u)
                << kAcceleratorNames[static_cast<std::size_t>(kind)] << " " << threads;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Paper, CourseScene,
                         testing::Values("balls_low", "balls_high", "balls_box", "dof", "mount_low", "mount_high", "dragon"));

}  // namespace
}  // namespace glint
