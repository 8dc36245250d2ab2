// Khronos' sample models, where they are at hand: counts and bounds as an independent reader finds them, and every other
// model loaded or refused with a reason.
#include <cmath>

#include "gltf_fixture.h"

namespace glint::test {
namespace {

namespace fs = std::filesystem;

const fs::path kModels = fs::path(GLINT_SHARED) / "scenes" / "gltf";

struct Expected {
    const char* file;
    std::size_t triangles;
    glm::vec3 lo, hi;
    std::size_t cameras;
};

// Counted with a few lines of Python that share nothing with the reader. MetalRoughSpheres has 1040409 triangles in the
// file; the two poles of each of its 98 spheres hold one without area, which is dropped.
const std::vector<Expected> kExpected{
    {"Box/glTF/Box.gltf", 12, {-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, 1},
    {"Box/glTF-Binary/Box.glb", 12, {-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, 1},
    {"BoxInterleaved/glTF-Binary/BoxInterleaved.glb", 12, {-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, 1},
    {"TriangleWithoutIndices/glTF/TriangleWithoutIndices.gltf", 1, {0, 0, 0}, {1, 1, 0}, 1},
    {"Cameras/glTF/Cameras.gltf", 2, {0, 0, -0.7075925f}, {1, 0.706622f, 0}, 2},
    {"Duck/glTF/Duck.gltf", 4212, {-0.692985f, 0.0992937f, -0.613282f}, {0.961799f, 1.6397f, 0.539252f}, 1},
    {"Duck/glTF-Binary/Duck.glb", 4212, {-0.692985f, 0.0992937f, -0.613282f}, {0.961799f, 1.6397f, 0.539252f}, 1},
    {"NegativeScaleTest/glTF-Binary/NegativeScaleTest.glb", 7724, {-5.161674f, -4.45354f, -0.5f}, {5.161674f, 4.45354f, 0.5f}, 1},
    {"MetalRoughSpheresNoTextures/glTF-Binary/MetalRoughSpheresNoTextures.glb",
     1040409 - 2 * 98,
     {-0.0009243164f, -0.001010498f, -0.003349959f},
     {0.006476562f, 0.006494141f, 0.0003499593f},
     1},
    {"SimpleSparseAccessor/glTF/SimpleSparseAccessor.gltf", 12, {0, 0, 0}, {6, 4, 0}, 1}};

TEST(GltfShared, ModelsHaveTheTrianglesAndBoundsOfTheirFiles) {
    if (!fs::exists(kModels)) GTEST_SKIP() << "no sample models";
    for (const Expected& e : kExpected) {
        SCOPED_TRACE(e.file);
        const auto scene = reader::read_gltf(kModels / e.file, {});
        EXPECT_EQ(scene->geometry->triangles.size(), e.triangles);
        EXPECT_EQ(scene->cameras.size(), e.cameras);
        const Aabb box = scene->geometry->bounds();
        const float size = glm::length(e.hi - e.lo);
        EXPECT_LT(glm::length(box.lo - e.lo), 1e-5f * size);
        EXPECT_LT(glm::length(box.hi - e.hi), 1e-5f * size);
        EXPECT_EQ(scene->transfer, Transfer::srgb);
    }
}

TEST(GltfShared, ABoxAndABoxInterleavedAreTheSameBox) {
    if (!fs::exists(kModels)) GTEST_SKIP() << "no sample models";
    const auto a = reader::read_gltf(kModels / "Box/glTF-Binary/Box.glb", {});
    const auto b = reader::read_gltf(kModels / "BoxInterleaved/glTF-Binary/BoxInterleaved.glb", {});
    EXPECT_NEAR(signed_volume(*a->geometry), 6.0, 1e-6);
    EXPECT_NEAR(signed_volume(*b->geometry), 6.0, 1e-6);
}

TEST(GltfShared, NormalsOfEveryModelAgreeWithTheFrontsOfItsTriangles) {
    if (!fs::exists(kModels)) GTEST_SKIP() << "no sample models";
    for (const char* file : {"Duck/glTF-Binary/Duck.glb", "NegativeScaleTest/glTF-Binary/NegativeScaleTest.glb",
                             "OrientationTest/glTF-Binary/OrientationTest.glb", "DamagedHelmet/glTF-Binary/DamagedHelmet.glb"}) {
        const auto scene = reader::read_gltf(kModels / file, {});
        const Geometry& g = *scene->geometry;
        std::size_t agreeing = 0;
        for (const auto& t : g.triangles) {
            const glm::vec3 n = glm::cross(g.vertices[t[1]] - g.vertices[t[0]], g.vertices[t[2]] - g.vertices[t[0]]);
            if (glm::dot(n, scene->normals[t[0]] + scene->normals[t[1]] + scene->normals[t[2]]) > 0.0f) ++agreeing;
        }
        EXPECT_GT(static_cast<double>(agreeing), 0.995 * static_cast<double>(g.triangles.size())) << file;
    }
}

TEST(GltfShared, EveryModelLoadsOrIsRefusedWithAReason) {
    if (!fs::exists(kModels)) GTEST_SKIP() << "no sample models";
    std::size_t loaded = 0;
    for (const auto& entry : fs::recursive_directory_iterator(kModels)) {
        const std::string ending = entry.path().extension().string();
        if (ending != ".gltf" && ending != ".glb") continue;
        try {
            const auto scene = reader::read_gltf(entry.path(), {});
            ++loaded;
            EXPECT_FALSE(scene->geometry->triangles.empty()) << entry.path();
            for (const glm::vec3 n : scene->normals) ASSERT_TRUE(n == glm::vec3(0.0f) || std::abs(glm::length(n) - 1.0f) < 1e-5f);
        } catch (const SceneError& e) {
            EXPECT_EQ(std::string(e.what()).rfind(entry.path().string() + ": ", 0), 0u) << e.what();
        }
    }
    EXPECT_GT(loaded, 0u);
}

}  // namespace
}  // namespace glint::test
