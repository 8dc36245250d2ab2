// Every scene that comes with the program, and those beside it where they exist: not one sample that is not finite.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/builtin.h"
#include "tests/core/render_picture.h"
#include "tests/core/test_scene.h"
#include "tests/long.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

// With every feature, each sampler, either approximation and two accelerators, at a low resolution.
void expect_finite(const std::string& spec) {
    SCOPED_TRACE(spec);
    const auto scene = load_scene(spec);
    Picture p;
    p.width = 24, p.height = 18;
    Frame frame = frame_of(scene, p);
    const auto grid = build_accelerator(AcceleratorKind::grid, scene->geometry);
    frame.spp = 8;
    frame.settings.features = FeatureSet::all();
    Renderer renderer(2, false);
    for (std::size_t i = 0; i < kSamplerNames.size(); ++i) {
        frame.settings.sampler = static_cast<SamplerKind>(i);
        frame.settings.fresnel = static_cast<Fresnel>(i % 2);
        frame.settings.glass = static_cast<GlassBranches>((i + 1) % 2);
        frame.settings.cutoff = i % 2 == 0 ? 0.001f : 0.0f;
        frame.settings.light_samples = 1 + static_cast<int>(i / 3);
        if (i == 3) frame.accelerator = grid;
        renderer.restart(frame);
        renderer.wait(1e9, nullptr);
        Image image;
        ASSERT_TRUE(renderer.resolve(image));
        EXPECT_EQ(renderer.progress().rays.non_finite, 0u) << kSamplerNames[i];
        for (const glm::vec3& c : image.pixels) {
            ASSERT_TRUE(std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z)) << kSamplerNames[i];
            ASSERT_GE(std::min(c.x, std::min(c.y, c.z)), 0.0f) << kSamplerNames[i];
        }
    }
}

// The scene files below a folder; packed meshes of a million triangles only at night.
std::vector<std::string> files_below(const fs::path& folder) {
    std::vector<std::string> files;
    std::error_code none;
    for (const auto& entry : fs::recursive_directory_iterator(folder, none)) {
        const std::string name = entry.path().filename(), ending = entry.path().extension();
        const bool scene = ending == ".p3f" || ending == ".gltf" || ending == ".glb" || ending == ".ply";
        const bool packed = name.ends_with(".ply.gz") && (is_long_run() || entry.file_size() < std::size_t{1} << 20);
        if (scene || packed) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

TEST(ShippedScenes, S_ACC_03_HaveNoSampleThatIsNotFinite) {
    for (const char* spec :
         {"balls,level=3", "mount,level=4", "balls_box", "dof", "cornell", "glass", "glass,what=ball", "glass,what=slab",
          "glass,what=nested", "glass,what=shell", "knot,n=10000", "stadium,n=10000", "soup,n=10000", "crowd,n=20"})
        expect_finite(std::string("builtin:") + spec);
    const std::vector<std::string> assets = files_below(fs::path(GLINT_TESTS) / "../assets");
    EXPECT_GE(assets.size(), 4u);
    for (const std::string& file : assets) expect_finite(file);
}

TEST(ShippedScenes, S_ACC_03_NorHaveTheSharedOnes) {
    const std::vector<std::string> files = files_below(fs::path(GLINT_SHARED) / "scenes");
    if (files.empty()) GTEST_SKIP() << "no scenes below " << GLINT_SHARED;
    for (const std::string& file : files) EXPECT_NO_THROW(expect_finite(file)) << file;
    test::note("scenes", static_cast<double>(files.size()));
}

}  // namespace
}  // namespace glint
