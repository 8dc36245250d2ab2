// Every scene that comes with the program, and those beside it where they exist: not one sample that is not finite.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/builtin.h"
#include "tests/core/render_picture.h"
#include "tests/long.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

void expect_finite(const std::string& spec) {
    SCOPED_TRACE(spec);
    LoadOptions options;
    options.load_environment = false;
    const auto scene = load_scene(spec, options);
    for (const SamplerKind sampler : {SamplerKind::sobol, SamplerKind::random}) {
        Picture p;
        p.width = 24, p.height = 18, p.spp = 4;
        p.settings.sampler = sampler;
        p.settings.features = FeatureSet::all();
        Progress progress;
        const Image image = render_picture(scene, p, &progress);
        EXPECT_EQ(progress.rays.non_finite, 0u);
        for (const glm::vec3& c : image.pixels) {
            ASSERT_TRUE(std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z));
            ASSERT_GE(std::min(c.x, std::min(c.y, c.z)), 0.0f);
        }
    }
}

// The scene files below a folder; packed meshes of a million triangles only at night.
std::vector<std::string> files_below(const fs::path& folder) {
    std::vector<std::string> files;
    std::error_code none;
    for (const auto& entry : fs::recursive_directory_iterator(folder, none)) {
        const std::string name = entry.path().filename(), ending = entry.path().extension();
        const bool scene = ending == ".p3f" || ending == ".gltf" || ending == ".glb";
        if (scene || (is_long_run() && name.ends_with(".ply.gz"))) files.push_back(entry.path());
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
    int rendered = 0;
    for (const std::string& file : files) {
        try {
            expect_finite(file);
            ++rendered;
        } catch (const SceneError&) {
            // Some of them are there to be refused; that they are is tested elsewhere.
        }
    }
    EXPECT_GT(rendered, 5);
}

}  // namespace
}  // namespace glint
