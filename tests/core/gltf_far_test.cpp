// glTF scenes far from zero: nodes moved by a translation, and meshes whose own vertices lie far out, keep their picture.
#include <cmath>

#include "gltf_fixture.h"
#include "tests/core/render_picture.h"

namespace glint::test {
namespace {

class GltfFar : public GltfTest {
protected:
    // Balls of 1520 triangles around `at`: positions are multiples of 2^-6, so that floats near 2^17 hold them.
    json ball(glm::dvec3 at) const {
        std::vector<float> p;
        std::vector<std::uint32_t> indices;
        constexpr std::uint32_t kColumns = 40, kRows = 20;
        for (std::uint32_t row = 0; row <= kRows; ++row) {
            for (std::uint32_t column = 0; column < kColumns; ++column) {
                const double theta = 3.141592653589793 * row / kRows, phi = 6.283185307179586 * column / kColumns;
                const glm::dvec3 d(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
                const glm::dvec3 v = glm::round(d * 64.0) / 64.0 + at;
                for (int k = 0; k < 3; ++k) p.push_back(static_cast<float>(v[k]));
            }
        }
        for (std::uint32_t row = 0; row < kRows; ++row) {
            for (std::uint32_t column = 0; column < kColumns; ++column) {
                const std::uint32_t a = row * kColumns + column, b = row * kColumns + (column + 1) % kColumns;
                if (row + 1 < kRows) indices.insert(indices.end(), {a, b + kColumns, a + kColumns});
                if (row > 0) indices.insert(indices.end(), {a, b, b + kColumns});
            }
        }
        return with_mesh(triangle(), p, indices);
    }

    // Four balls that share a mesh around `mesh_at`, a flat one baked as their floor, a camera, a point and a spot light;
    // all below a node that moves the balls back to zero and everything to `t`.
    json scene(glm::dvec3 t, glm::dvec3 mesh_at = glm::dvec3(0.0)) const {
        json d = ball(mesh_at);
        const auto triple = [](glm::dvec3 v) { return json{v.x, v.y, v.z}; };
        d["extensionsUsed"] = {"KHR_lights_punctual"};
        d["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 40.0}},
                                                            {{"type", "spot"}, {"intensity", 60.0}, {"spot", json::object()}}};
        d["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.9}, {"znear", 0.1}}}}};
        d["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {0.7, 0.6, 0.5, 1.0}}, {"metallicFactor", 0.5}}}}};
        d["meshes"][0]["primitives"][0]["material"] = 0;
        json nodes = json::array();
        nodes.push_back({{"translation", triple(t)}, {"children", {1, 2, 3, 4, 5, 6, 7, 8}}});
        for (int i = 0; i < 4; ++i) {
            const glm::dvec3 place(1.25 * i - 2.0, 0.25 * i, -0.5 * i);
            nodes.push_back({{"mesh", 0}, {"translation", triple(place - mesh_at)}});
        }
        nodes.push_back({{"mesh", 0},
                         {"scale", {4.0, 0.0, 4.0}},
                         {"translation", triple(glm::dvec3(0.0, -1.25, 0.0) - glm::dvec3(4.0, 0.0, 4.0) * mesh_at)}});
        nodes.push_back({{"camera", 0}, {"translation", {0.0, 1.0, 6.0}}});
        const auto light = [](int i) { return json{{"KHR_lights_punctual", {{"light", i}}}}; };
        nodes.push_back({{"translation", {2.0, 4.0, 3.0}}, {"extensions", light(0)}});
        nodes.push_back({{"translation", {-2.0, 5.0, 2.0}}, {"rotation", {-0.6, 0.0, 0.0, 0.8}}, {"extensions", light(1)}});
        d["nodes"] = nodes;
        d["scenes"][0]["nodes"] = {0};
        return d;
    }

    static void expect_same_picture(const std::shared_ptr<const Scene>& here, const std::shared_ptr<const Scene>& there) {
        EXPECT_EQ(here->geometry->instances.size(), 4u);
        EXPECT_EQ(here->geometry->vertices, there->geometry->vertices);
        EXPECT_EQ(here->geometry->prototypes.at(0).geometry->vertices, there->geometry->prototypes.at(0).geometry->vertices);
        EXPECT_EQ(here->lights, there->lights);
        EXPECT_EQ(here->cameras, there->cameras);
        EXPECT_EQ(here->warnings, there->warnings);
        Picture p;
        p.spp = 4;
        p.settings.features = FeatureSet::all();
        const Image expected = render_picture(here, p);
        for (const AcceleratorKind kind : {AcceleratorKind::grid, AcceleratorKind::bvh}) {
            p.accelerator = kind;
            EXPECT_EQ(differing_pixels(expected, render_picture(there, p)), 0u) << static_cast<int>(kind);
        }
    }
};

TEST_F(GltfFar, S_MET_03_ATranslatedNodeTreeKeepsItsBits) {
    const auto here = load(scene({}));
    EXPECT_EQ(here->origin, glm::dvec3(0.0));
    EXPECT_EQ(here->lights.size(), 2u);
    for (const glm::dvec3 t : {glm::dvec3(1024, -2048, 4096), glm::dvec3(1e6, -2e6, 5e5), glm::dvec3(0, 0, 0x1p30)}) {
        const auto there = load(scene(t));
        EXPECT_EQ(there->origin, t);
        expect_same_picture(here, there);
    }
}

TEST_F(GltfFar, S_MET_03_AFarMeshThatIsStoredOnceKeepsItsBits) {
    const glm::dvec3 out(0x1p17, -0x1p16, 0x1p17);
    const auto here = load(scene({})), moved = load(scene({}, out));
    EXPECT_EQ(moved->origin, glm::dvec3(0.0));
    expect_same_picture(here, moved);
    const glm::dvec3 t(0x1p20, 0, 0);
    const auto both = load(scene(t, out));
    EXPECT_EQ(both->origin, t);
    expect_same_picture(here, both);
}

// Without a camera of its own the scene is framed as it would be near zero.
TEST_F(GltfFar, AFarSceneIsFramedLikeANearOne) {
    json d = triangle();
    const CameraPose near = load(d)->cameras.front();
    d["nodes"][0]["translation"] = {1e6, -2e6, 5e5};
    const auto far = load(d);
    EXPECT_EQ(far->cameras.front(), near);
    EXPECT_EQ(far->origin, glm::dvec3(1e6, -2e6, 5e5));
}

// Further out than floats can tell the corners apart.
TEST_F(GltfFar, TrianglesThatFloatsMakePointsComeBack) {
    json d = triangle();
    d["nodes"][0]["translation"] = {1e9, 1e9, -1e9};
    const auto scene = load(d);
    EXPECT_EQ(scene->geometry->triangles.size(), 1u);
    EXPECT_EQ(scene->geometry->bounds().size(), glm::vec3(1.0f, 1.0f, 0.0f));
    EXPECT_FALSE(warned(*scene, "without area"));
}

}  // namespace
}  // namespace glint::test
