// What a well-formed glTF file becomes: triangles, transforms, normals, materials.
#include <cmath>
#include <numbers>

#include "gltf_fixture.h"

namespace glint::test {
namespace {

using Corners = std::vector<std::array<glm::vec3, 3>>;

Corners corners(const Scene& scene) {
    Corners all;
    const Geometry& g = *scene.geometry;
    for (const auto& t : g.triangles) all.push_back({g.vertices[t[0]], g.vertices[t[1]], g.vertices[t[2]]});
    return all;
}

class Gltf : public GltfTest {
protected:
    // A cube from -1 to 1 with fronts outwards, without normals.
    json cube() const {
        std::vector<float> p;
        for (int i = 0; i < 8; ++i) p.insert(p.end(), {i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f});
        return with_mesh(triangle(), p, {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                         2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5});
    }
    // The material of a triangle that has this one in the file.
    Material material(const json& source) const {
        json d = triangle();
        d["materials"] = {source};
        d["meshes"][0]["primitives"][0]["material"] = 0;
        return load(d)->material(0);
    }
};

TEST_F(Gltf, IndexedPlainAndPackedTrianglesAreTheSame) {
    const Corners expected{{glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)}};
    json d = triangle();
    EXPECT_EQ(corners(*load(d)), expected);
    d["meshes"][0]["primitives"][0].erase("indices");
    EXPECT_EQ(corners(*load(d)), expected);
    d = with_mesh(triangle(), {0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2});
    EXPECT_EQ(corners(*load(d)), expected);

    d = triangle();
    write("data.bin", bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + std::string("\0\1\2\0\0\0\0\0", 8));
    d["accessors"][1]["componentType"] = 5121;
    EXPECT_EQ(corners(*load(d)), expected);

    json binary = triangle();
    binary["buffers"][0].erase("uri");
    const std::string data = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + bytes_of<std::uint16_t>({0, 1, 2, 0});
    EXPECT_EQ(corners(*read(write("scene.glb", glb(binary, data)))), expected);
    d = with_mesh(triangle(), {0, 0, 0, 0, 0, 0, 0, 0, 0}, {});
    d["buffers"][0] = {{"byteLength", 36},
                       {"uri", "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}};
    EXPECT_EQ(corners(*load(d)), expected);
}

TEST_F(Gltf, InterleavedVerticesAreReadByTheirStride) {
    json d = triangle();
    write("data.bin", bytes_of<float>({0, 0, 0, 0, 0, 2, 1, 0, 0, 0, 0, 2, 0, 1, 0, 0, 0, 2}));
    d["buffers"][0]["byteLength"] = 72;
    d["bufferViews"] = {{{"buffer", 0}, {"byteLength", 72}, {"byteStride", 24}}};
    d["accessors"] = {{{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}},
                      {{"bufferView", 0}, {"byteOffset", 12}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}};
    d["meshes"][0]["primitives"][0] = {{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}};
    const auto scene = load(d);
    EXPECT_EQ(corners(*scene), (Corners{{glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)}}));
    EXPECT_EQ(scene->normals, std::vector<glm::vec3>(3, glm::vec3(0, 0, 1)));
}

TEST_F(Gltf, QuantizedPositionsAreMappedAsTheFormatSays) {
    json d = triangle();
    write("data.bin", bytes_of<std::int16_t>({-32768, 0, 0, 0, 32767, 0, 0, 0, 0, 32767, 0, 0}) + std::string(20, '\0'));
    d["bufferViews"][0] = {{"buffer", 0}, {"byteLength", 24}, {"byteStride", 8}};
    d["accessors"][0]["componentType"] = 5122;
    d["accessors"][0]["normalized"] = true;
    d["meshes"][0]["primitives"][0].erase("indices");
    d["extensionsRequired"] = {"KHR_mesh_quantization"};
    EXPECT_EQ(corners(*load(d)), (Corners{{glm::vec3(-1, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)}}));
    d["accessors"][0]["normalized"] = false;
    EXPECT_EQ(load(d)->geometry->vertices[0], glm::vec3(-32768, 0, 0));
}

TEST_F(Gltf, StripsAndFansKeepTheirFronts) {
    const std::vector<float> square{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    for (const auto& [mode, order] :
         {std::pair{5, std::vector<std::uint32_t>{0, 1, 2, 3}}, std::pair{6, std::vector<std::uint32_t>{0, 1, 3, 2}}}) {
        json d = with_mesh(triangle(), square, order);
        d["meshes"][0]["primitives"][0]["mode"] = mode;
        const auto scene = load(d);
        ASSERT_EQ(scene->geometry->triangles.size(), 2u) << mode;
        double area = 0.0;
        for (const auto& t : corners(*scene)) {
            const glm::vec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
            EXPECT_GT(n.z, 0.0f) << mode;
            area += 0.5 * static_cast<double>(n.z);
        }
        EXPECT_DOUBLE_EQ(area, 1.0);
    }
    json d = triangle();
    d["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
    EXPECT_TRUE(warned(*load(d), "points and lines"));
}

TEST_F(Gltf, MatrixAndItsPartsPlaceANodeAlike) {
    json parts = triangle();
    parts["nodes"][0].update(
        {{"translation", {1, 2, 3}}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}, {"scale", {2, 3, 4}}});
    json matrix = triangle();
    matrix["nodes"][0]["matrix"] = {0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 1, 2, 3, 1};
    const Corners a = corners(*load(parts)), b = corners(*load(matrix));
    ASSERT_EQ(a.size(), 1u);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(glm::length(a[0][k] - b[0][k]), 1e-6f);
    EXPECT_EQ(b[0][1], glm::vec3(1, 4, 3));
    // A child is placed in its parent's space: the same matrix twice.
    matrix["nodes"] = {{{"matrix", matrix["nodes"][0]["matrix"]}, {"children", {1}}}, matrix["nodes"][0]};
    EXPECT_EQ(corners(*load(matrix))[0][0], glm::vec3(-5, 4, 15));
}

TEST_F(Gltf, MirroredNodesKeepTheirFrontsOutwards) {
    const std::vector<std::vector<double>> scales{{1, 1, 1}, {-1, 1, 1}, {1, -2, 1}, {-1, -1, 1}, {-1, -3, -1}};
    for (const auto& scale : scales) {
        SCOPED_TRACE(testing::PrintToString(scale));
        json d = cube();
        d["nodes"][0]["scale"] = scale;
        // Normals that point from the centre to the corners.
        d["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 0;
        const auto scene = load(d);
        EXPECT_GT(signed_volume(*scene->geometry), 0.0);
        ASSERT_EQ(scene->normals.size(), scene->geometry->vertices.size());
        for (std::size_t i = 0; i < scene->normals.size(); ++i) {
            EXPECT_GT(glm::dot(scene->normals[i], scene->geometry->vertices[i]), 0.0f);
            EXPECT_NEAR(glm::length(scene->normals[i]), 1.0f, 1e-6f);
        }
    }
}

TEST_F(Gltf, NormalsStayPerpendicularUnderUnevenScale) {
    json d = with_mesh(triangle(), {0, 0, 0, 1, 0, -1, 0, 1, -1}, {0, 1, 2});
    write("data.bin", bytes_of<float>({0, 0, 0, 1, 0, -1, 0, 1, -1}) + bytes_of<std::uint32_t>({0, 1, 2}) +
                          bytes_of<float>({1, 1, 1, 1, 1, 1, 0, 0, 0}));
    d["buffers"][0]["byteLength"] = 84;
    d["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 36}});
    d["accessors"].push_back({{"bufferView", 2}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
    d["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 2;
    d["nodes"][0]["scale"] = {1, 5, 1e-3};
    const auto scene = read(write("scene.gltf", d.dump()));
    const auto t = corners(*scene)[0];
    const glm::vec3 n = glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
    EXPECT_LT(glm::length(n - scene->normals[0]), 1e-5f);
    EXPECT_EQ(scene->normals[2], glm::vec3(0.0f));  // a normal without direction: shaded flat
    EXPECT_TRUE(load(triangle())->normals.empty());
}

TEST_F(Gltf, InstancesOfAMeshStandWhereTheirNodesAre) {
    json d = triangle();
    d["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {10, 0, 0}}}, {{"mesh", 0}, {"translation", {99, 0, 0}}}};
    d["scenes"] = {{{"nodes", {0, 1}}}, {{"nodes", {2}}}};
    const auto scene = load(d);
    EXPECT_EQ(scene->geometry->triangles.size(), 2u);
    EXPECT_EQ(scene->geometry->bounds().hi.x, 11.0f);
    EXPECT_TRUE(warned(*scene, "scenes[0] of 2"));
    d["scene"] = 1;
    const auto far = load(d);
    EXPECT_EQ(static_cast<double>(far->geometry->bounds().lo.x) + far->origin.x, 99.0);
    d.erase("scene");
    d.erase("scenes");
    EXPECT_EQ(load(d)->geometry->triangles.size(), 3u);
}

TEST_F(Gltf, DielectricsAndMetalsFollowTheMapping) {
    const float pi = std::numbers::pi_v<float>;
    Material m = material(
        {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.5, 0.25, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 0.5}}}});
    EXPECT_LT(glm::length(m.diffuse - glm::vec3(1, 0.5, 0.25) / pi), 1e-6f);
    EXPECT_LT(glm::length(m.mirror - glm::vec3(0.04f)), 1e-6f);  // ((1.5 - 1) / (1.5 + 1))^2
    EXPECT_EQ(m.specular, m.mirror);
    EXPECT_TRUE(m.mirror_fresnel);
    EXPECT_FLOAT_EQ(m.shininess, 34.0f);  // a = 1/4: 2 * 16 - 2, and 4 for the cosine
    EXPECT_FLOAT_EQ(m.roughness, 0.75f);

    m = material(
        {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.5, 0.25, 1}}, {"metallicFactor", 1}, {"roughnessFactor", 0}}}});
    EXPECT_EQ(m.diffuse, glm::vec3(0.0f));
    EXPECT_EQ(m.mirror, glm::vec3(1, 0.5, 0.25));
    EXPECT_EQ(m.roughness, 0.0f);
    EXPECT_TRUE(std::isfinite(m.shininess) && std::isfinite(m.highlight_scale));
    EXPECT_EQ(load(triangle())->material(0).mirror, glm::vec3(1.0f));  // the format's default is a rough white metal
}

TEST_F(Gltf, S_BPH_04_TheHighlightReflectsItsColourAndNoMore) {
    for (const double roughness : {0.1, 0.3, 0.5, 0.8, 1.0}) {
        const Material m = material({{"pbrMetallicRoughness", {{"roughnessFactor", roughness}}}});
        // Over the hemisphere at normal incidence; n.h = cos(theta / 2).
        double sum = 0.0;
        constexpr int kSteps = 20000;
        for (int i = 0; i < kSteps; ++i) {
            const double theta = (i + 0.5) / kSteps * std::numbers::pi / 2.0;
            sum += std::sin(theta) * std::pow(std::cos(theta / 2.0), static_cast<double>(m.shininess));
        }
        sum *= static_cast<double>(m.highlight_scale) * 2.0 * std::numbers::pi * (std::numbers::pi / 2.0) / kSteps;
        EXPECT_NEAR(sum, 1.0, 1e-4) << roughness;
    }
}

TEST_F(Gltf, MaterialExtensionsThatAreSupportedTakeEffect) {
    const Material glow = material(
        {{"emissiveFactor", {1, 0.5, 0}}, {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}}});
    EXPECT_EQ(glow.emission, glm::vec3(8, 4, 0));
    const Material unlit = material({{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 1, 1}}}},
                                     {"extensions", {{"KHR_materials_unlit", json::object()}}}});
    EXPECT_EQ(unlit.emission, glm::vec3(0.5, 0.25, 1));
    EXPECT_FALSE(unlit.has_diffuse() || unlit.has_mirror() || unlit.has_highlight());
    const Material glass = material(
        {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}},
         {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}, {"KHR_materials_ior", {{"ior", 1.33}}}}}});
    EXPECT_TRUE(glass.glass);
    EXPECT_FLOAT_EQ(glass.ior, 1.33f);
    EXPECT_EQ(glass.diffuse, glm::vec3(0.0f));
    EXPECT_EQ(glass.transmittance, glm::vec3(1.0f));
}

TEST_F(Gltf, WhatIsNotShownIsSaidOnce) {
    json d = triangle();
    d["materials"] = {{{"alphaMode", "MASK"}, {"extensions", {{"KHR_materials_clearcoat", json::object()}}}},
                      {{"alphaMode", "BLEND"}},
                      {{"normalTexture", {{"index", 0}}}, {"emissiveTexture", {{"index", 0}}}, {"emissiveFactor", {1, 1, 1}}},
                      {{"pbrMetallicRoughness", {{"baseColorFactor", {2, 0, 0, 1}}, {"roughnessFactor", -3}}}}};
    d["textures"] = {json::object()};
    d["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 0;
    d["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}};
    d["skins"] = {{{"joints", {0}}}};
    d["nodes"] = {{{"mesh", 0}, {"skin", 0}}, {{"mesh", 0}, {"skin", 0}}};
    d["scenes"][0]["nodes"] = {0, 1};
    d["animations"] = {{{"channels", json::array()}, {"samplers", json::array()}}};
    const auto scene = load(d);
    for (const char* text :
         {"alphaMode MASK", "alphaMode BLEND", "KHR_materials_clearcoat", "normal maps", "emissive textures", "vertex colours",
          "morph targets", "skins", "baseColorFactor outside", "roughnessFactor outside", "no camera", "no light"}) {
        int count = 0;
        for (const std::string& w : scene->warnings) {
            if (w.find(text) != std::string::npos) ++count;
            EXPECT_EQ(w.rfind((folder() / "scene.gltf").string() + ": ", 0), 0u) << w;
        }
        EXPECT_EQ(count, 1) << text;
    }
    for (const Material& m : scene->materials)
        EXPECT_EQ(m.emission, glm::vec3(0.0f));  // a glowing texture is not a glowing surface
}

}  // namespace
}  // namespace glint::test
