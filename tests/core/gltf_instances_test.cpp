// Meshes of glTF files that are stored once: what is shared and what is baked, and that both look alike.
#include <cmath>

#include "core/render_plan.h"
#include "gltf_fixture.h"
#include "tests/core/render_picture.h"

namespace glint::test {
namespace {

class GltfInstances : public GltfTest {
protected:
    // A bumpy ball of 1104 triangles that several nodes may show; the accessors behind its own are floats at the buffer's end.
    json ball(int nodes, const std::vector<float>& more = {}) const {
        std::vector<float> p;
        std::vector<std::uint32_t> indices;
        constexpr std::uint32_t kColumns = 24, kRows = 24;
        for (std::uint32_t row = 0; row <= kRows; ++row) {
            for (std::uint32_t column = 0; column < kColumns; ++column) {
                const double theta = 3.141592653589793 * row / kRows, phi = 6.283185307179586 * column / kColumns;
                const double r = 1.0 + 0.1 * std::cos(5.0 * phi) * std::sin(theta);
                p.push_back(static_cast<float>(r * std::sin(theta) * std::cos(phi)));
                p.push_back(static_cast<float>(r * std::cos(theta)));
                p.push_back(static_cast<float>(r * std::sin(theta) * std::sin(phi)));
            }
        }
        for (std::uint32_t row = 0; row < kRows; ++row) {
            for (std::uint32_t column = 0; column < kColumns; ++column) {
                const std::uint32_t a = row * kColumns + column, b = row * kColumns + (column + 1) % kColumns;
                if (row + 1 < kRows) indices.insert(indices.end(), {a, b + kColumns, a + kColumns});
                if (row > 0) indices.insert(indices.end(), {a, b, b + kColumns});
            }
        }
        json d = with_mesh(triangle(), p, indices);
        const std::size_t before = d["buffers"][0]["byteLength"].get<std::size_t>();
        write("data.bin", bytes_of(p) + bytes_of(indices) + bytes_of(more));
        if (!more.empty()) {
            d["buffers"][0]["byteLength"] = before + 4 * more.size();
            d["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", before}, {"byteLength", 4 * more.size()}});
        }
        d["nodes"] = json::array();
        d["scenes"][0]["nodes"] = json::array();
        for (int i = 0; i < nodes; ++i) {
            // Turned, stretched, and every third one mirrored.
            const double s = std::sin(0.4 * i), c = std::cos(0.4 * i), m = i % 3 == 0 ? -1.0 : 1.0;
            d["nodes"].push_back({{"mesh", 0},
                                  {"translation", {2.2 * (i % 4), 2.2 * (i / 4), 0.3 * i}},
                                  {"rotation", {0.6 * s, 0.0, 0.8 * s, c}},
                                  {"scale", {m, 1.1, 0.8}}});
            d["scenes"][0]["nodes"].push_back(i);
        }
        return d;
    }
    // The same file with a copy of the mesh for each node, so that nothing can be shared.
    static json unshared(json d) {
        const json mesh = d["meshes"][0];
        d["meshes"] = json::array();
        for (std::size_t i = 0; i < d["nodes"].size(); ++i) {
            d["meshes"].push_back(mesh);
            d["nodes"][i]["mesh"] = i;
        }
        return d;
    }
    static constexpr std::size_t kBall = 1104;
};

TEST_F(GltfInstances, AMeshOfManyNodesIsStoredOnce) {
    const auto scene = load(ball(12));
    const Geometry& g = *scene->geometry;
    EXPECT_TRUE(g.triangles.empty());
    EXPECT_TRUE(g.vertices.empty());
    ASSERT_EQ(g.prototypes.size(), 1u);
    EXPECT_EQ(g.prototypes[0].count, kBall);
    EXPECT_EQ(g.instances.size(), 12u);
    EXPECT_EQ(g.seen_count(), 12 * kBall);
    ASSERT_EQ(scene->prototypes.size(), 1u);
    EXPECT_EQ(scene->prototypes[0].material_of[0].size(), kBall);
    EXPECT_FALSE(warned(*scene, "nothing to show"));
}

TEST_F(GltfInstances, FewTrianglesAndSingleUsesAreBaked) {
    EXPECT_TRUE(load(ball(1))->geometry->instances.empty());
    const auto few = load(ball(3));
    EXPECT_TRUE(few->geometry->instances.empty());
    EXPECT_EQ(few->geometry->triangles.size(), 3 * kBall);
    const auto unique = load(unshared(ball(12)));
    EXPECT_TRUE(unique->geometry->instances.empty());
    EXPECT_EQ(unique->geometry->triangles.size(), 12 * kBall);
}

TEST_F(GltfInstances, ThePictureAndTheCameraAreThoseOfTheBakedMesh) {
    const auto shared = load(ball(12)), baked = load(unshared(ball(12)));
    const CameraPose &a = shared->cameras.front(), &b = baked->cameras.front();
    EXPECT_LT(glm::length(a.eye - b.eye), 1e-4f * glm::length(b.eye));
    EXPECT_LT(glm::length(a.target - b.target), 1e-4f * glm::length(b.eye));
    Picture p;
    p.width = 96, p.height = 72, p.spp = 4;
    EXPECT_LT(difference(render_picture(shared, p), render_picture(baked, p)).rmse, 0.005);
}

TEST_F(GltfInstances, AFlatNodeOfASharedMeshIsBaked) {
    json d = ball(12);
    d["nodes"][3]["scale"] = {1.0, 0.0, 1.0};
    const auto scene = load(d);
    EXPECT_EQ(scene->geometry->instances.size(), 11u);
    EXPECT_GT(scene->geometry->triangles.size(), kBall / 2);
    // A use beyond what floats can square is left out, as its triangles would be.
    d["nodes"][3]["scale"] = {1e20, 1e20, 1e20};
    EXPECT_TRUE(warned(*load(d), "1104 triangles with NaN, infinite or huge coordinates"));
}

TEST_F(GltfInstances, AnExtensionPlacesAMeshManyTimes) {
    // Ten translations, ten rotations, ten scales behind each other.
    std::vector<float> t, r, s;
    for (int i = 0; i < 10; ++i) {
        const auto x = static_cast<float>(i);
        t.insert(t.end(), {3.0f * x, 0.5f * x, -x});
        r.insert(r.end(), {0.0f, std::sin(0.2f * x), 0.0f, std::cos(0.2f * x)});
        s.insert(s.end(), {1.0f, 1.0f + 0.1f * x, 0.7f});
    }
    std::vector<float> all = t;
    all.insert(all.end(), r.begin(), r.end());
    all.insert(all.end(), s.begin(), s.end());
    json d = ball(1, all);
    d["nodes"][0] = {{"mesh", 0}, {"translation", {1, 2, 3}}};
    const auto accessor = [](std::size_t offset, const char* type) {
        return json{{"bufferView", 2}, {"byteOffset", offset}, {"componentType", 5126}, {"count", 10}, {"type", type}};
    };
    d["accessors"].push_back(accessor(0, "VEC3"));
    d["accessors"].push_back(accessor(120, "VEC4"));
    d["accessors"].push_back(accessor(280, "VEC3"));
    json& extension = d["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"];
    extension["attributes"] = {{"TRANSLATION", 2}, {"ROTATION", 3}, {"SCALE", 4}};
    d["extensionsRequired"] = d["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    const auto scene = load(d);
    EXPECT_EQ(scene->geometry->instances.size(), 10u);
    EXPECT_FALSE(warned(*scene, "EXT_mesh_gpu_instancing"));

    extension["attributes"]["SCALE"] = 3;
    expect_refused(d, "nodes[0].EXT_mesh_gpu_instancing.SCALE is not an array of VEC3");
    extension["attributes"]["SCALE"] = 99;
    expect_refused(d, "is not the number of an accessor");
    extension["attributes"]["SCALE"] = 0;  // the mesh's own positions
    expect_refused(d, "attributes of different lengths");
    extension["attributes"] = 7;
    expect_refused(d, "is not an object");
    // Accessors without bytes cost nothing to announce.
    d["accessors"][2] = {{"componentType", 5126}, {"count", 5000000}, {"type", "VEC3"}};
    extension["attributes"] = {{"TRANSLATION", 2}};
    expect_refused(d, "instances counted");

    json nodes = ball(10);
    for (std::size_t i = 0; i < 10; ++i) {
        nodes["nodes"][i] = {{"mesh", 0},
                             {"translation", {1 + t[3 * i], 2 + t[3 * i + 1], 3 + t[3 * i + 2]}},
                             {"rotation", {0.0f, r[4 * i + 1], 0.0f, r[4 * i + 3]}},
                             {"scale", {s[3 * i], s[3 * i + 1], s[3 * i + 2]}}};
    }
    const auto same = load(nodes);
    ASSERT_EQ(same->geometry->instances.size(), 10u);
    for (std::size_t i = 0; i < 10; ++i) {
        const AffineMap &a = scene->geometry->instances[i].object_from_world, &b = same->geometry->instances[i].object_from_world;
        for (int k = 0; k < 12; ++k) EXPECT_NEAR(a.row[k / 4][k % 4], b.row[k / 4][k % 4], 1e-5);
    }
}

}  // namespace
}  // namespace glint::test
