// One hand-made file per way in which a glTF file can lie: refused in one line, or loaded with a warning.
#include <limits>

#include "gltf_fixture.h"

namespace glint::test {
namespace {

class GltfHazard : public GltfTest {
protected:
    json with_accessor(const char* key, const json& value, std::size_t accessor = 0) const {
        json d = triangle();
        d["accessors"][accessor][key] = value;
        return d;
    }
    // A sparse replacement of positions: its indices are the file's (0, 1, 2, 0) from `first` on.
    json with_sparse(int count, int first) const {
        json d = triangle();
        d["accessors"][0]["sparse"] = {{"count", count},
                                       {"indices", {{"bufferView", 2}, {"byteOffset", 2 * first}, {"componentType", 5123}}},
                                       {"values", {{"bufferView", 0}}}};
        d["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 36}, {"byteLength", 8}});
        return d;
    }
};

TEST_F(GltfHazard, ComponentTypesOutsideTheTableAreRefused) {
    for (const int type : {0, 5119, 5124, 5127, 5128, 5129, 5130, 5131}) {
        SCOPED_TRACE(type);
        expect_refused(with_accessor("componentType", type), "omponentType");
    }
    expect_refused(with_accessor("componentType", -1), "componentType");
    expect_refused(with_accessor("componentType", 5126, 1), "accessors[1]");
    expect_refused(with_accessor("componentType", 5122, 1), "unsigned");
    expect_refused(with_accessor("type", "VEC2"), "VEC3");
    expect_refused(with_accessor("type", "MAT4"), "matrices");
    expect_refused(with_accessor("type", "VEC5"), "VEC5");
}

TEST_F(GltfHazard, AccessorsStayWithinTheirBytes) {
    const std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
    for (const std::uint64_t count : {std::uint64_t{4}, std::uint64_t{1} << 28, std::uint64_t{1} << 60, most / 12 + 2, most}) {
        SCOPED_TRACE(count);
        expect_refused(with_accessor("count", count), "accessors[0]");
    }
    for (const std::uint64_t offset : {std::uint64_t{4}, std::uint64_t{37}, most - 35, most}) {
        SCOPED_TRACE(offset);
        expect_refused(with_accessor("byteOffset", offset), "accessors[0]");
        json d = triangle();
        d["bufferViews"][0]["byteOffset"] = std::max(offset, std::uint64_t{12});
        expect_refused(d, "bufferViews[0]");
    }
    expect_refused(with_accessor("byteOffset", -4), "byteOffset");
    json d = triangle();
    d["bufferViews"][0]["byteLength"] = most;
    expect_refused(d, "bufferViews[0] reaches past");
    d = triangle();
    d["bufferViews"][0]["byteStride"] = 16;
    expect_refused(d, "accessors[0] reaches past");
    d["bufferViews"][0]["byteStride"] = 4;
    expect_refused(d, "byteStride");
}

TEST_F(GltfHazard, AHugeAccessorWithoutBytesIsRefusedOrDrawsNothing) {
    json d = triangle();
    d["accessors"][0].erase("bufferView");
    EXPECT_TRUE(load(d)->geometry->triangles.empty());
    d["meshes"][0]["primitives"][0].erase("indices");
    d["accessors"][0]["count"] = 1u << 28;
    expect_refused(d, "triangles");
}

TEST_F(GltfHazard, SparseIndicesAreChecked) {
    EXPECT_EQ(load(with_sparse(3, 0))->geometry->triangles.size(), 1u);
    expect_refused(with_sparse(4, 0), "more elements than there are");
    expect_refused(with_sparse(-1, 0), "count");
    expect_refused(with_sparse(2, 2), "ascend");
    expect_refused(with_sparse(3, 2), "reaches past");
    json d = with_sparse(1, 0);
    write("data.bin", std::string(36, '\0') + bytes_of<std::uint16_t>({3, 0, 0, 0}));
    expect_refused(write("scene.gltf", d.dump()), "element 3 of 3");
    d["accessors"][0]["sparse"]["indices"]["componentType"] = 5126;
    expect_refused(write("scene.gltf", d.dump()), "componentType 5126");
    d["accessors"][0]["sparse"]["indices"].erase("bufferView");
    expect_refused(write("scene.gltf", d.dump()), "bufferView");
}

TEST_F(GltfHazard, IndicesNameExistingThings) {
    json d = triangle();
    write("data.bin", bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + bytes_of<std::uint16_t>({0, 1, 3, 0}));
    expect_refused(write("scene.gltf", d.dump()), "names vertex 3 of 3");
    const std::vector<std::pair<const char*, const char*>> members{{"/nodes/0/mesh", "mesh"},
                                                                   {"/nodes/0/camera", "camera"},
                                                                   {"/nodes/0/skin", "skin"},
                                                                   {"/nodes/0/children", "children"},
                                                                   {"/scenes/0/nodes", "nodes"},
                                                                   {"/meshes/0/primitives/0/material", "material"},
                                                                   {"/meshes/0/primitives/0/indices", "indices"},
                                                                   {"/meshes/0/primitives/0/attributes/POSITION", "POSITION"},
                                                                   {"/meshes/0/primitives/0/mode", "mode"},
                                                                   {"/accessors/0/bufferView", "bufferView"},
                                                                   {"/bufferViews/0/buffer", "buffer"},
                                                                   {"/scene", "scene"}};
    for (const auto& [pointer, name] : members) {
        for (const json& value : {json(7), json(-1), json(4294967296), json(0.5), json("0"), json(1e30)}) {
            SCOPED_TRACE(std::string(pointer) + " = " + value.dump());
            d = triangle();
            const bool list = std::string_view(pointer).ends_with("children") || std::string_view(pointer).ends_with("/nodes");
            d[json::json_pointer(pointer)] = list ? json::array({value}) : value;
            expect_refused(d, name);
        }
    }
}

TEST_F(GltfHazard, NodesMustFormATree) {
    json d = triangle();
    d["nodes"][0]["children"] = {0};
    expect_refused(d, "tree");
    d["nodes"] = {{{"children", {1}}}, {{"children", {2}}}, {{"children", {0}}, {"mesh", 0}}};
    expect_refused(d, "tree");
    d["nodes"] = {{{"children", {1, 2}}}, {{"children", {3}}}, {{"children", {3}}}, {{"mesh", 0}}};
    expect_refused(d, "nodes[3] is reached twice");
    d["nodes"] = json::array();
    for (int i = 0; i < 20000; ++i) d["nodes"].push_back({{"children", {i + 1}}});
    d["nodes"].push_back({{"mesh", 0}});
    expect_refused(d, "deeper");
}

TEST_F(GltfHazard, TransformsOfTheWrongShapeAreRefused) {
    json d = triangle();
    d["nodes"][0]["matrix"] = std::vector<double>(15, 1.0);
    expect_refused(d, "nodes[0].matrix");
    d = triangle();
    d["nodes"][0]["rotation"] = {0, 0, 0, 0};
    expect_refused(d, "rotation");
    d["nodes"][0]["rotation"] = {0, 0, "x", 1};
    expect_refused(d, "rotation");
    d = triangle();
    d["nodes"][0]["scale"] = {1e300, 1e300, 1e300};
    EXPECT_TRUE(warned(*load(d), "1 triangles with NaN"));
    d["nodes"][0]["scale"] = {0, 0, 0};
    EXPECT_TRUE(warned(*load(d), "1 triangles without area"));
}

TEST_F(GltfHazard, NaNPositionsDropTheirTrianglesAndAreCounted) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto scene = load(with_mesh(triangle(), {0, 0, 0, 1, 0, 0, 0, 1, 0, nan, 1, 0}, {0, 1, 2, 1, 3, 2, 3, 0, 1}));
    EXPECT_EQ(scene->geometry->triangles.size(), 1u);
    EXPECT_EQ(scene->geometry->vertices.size(), 3u);
    EXPECT_TRUE(warned(*scene, "2 triangles with NaN"));
}

TEST_F(GltfHazard, InstancesCannotExplode) {
    // 2^13 triangles, 2^14 nodes: two ordinary numbers whose product is not.
    std::vector<std::uint32_t> indices;
    for (int i = 0; i < 8192; ++i) indices.insert(indices.end(), {0u, 0u, 1u});  // no area, so nothing is stored before the limit
    json d = with_mesh(triangle(), {0, 0, 0, 1, 0, 0, 0, 1, 0}, indices);
    d["nodes"] = json::array();
    d["scenes"][0]["nodes"] = json::array();
    // Flat ones, which have to be baked.
    for (int i = 0; i < 16384; ++i) {
        d["nodes"].push_back({{"mesh", 0}, {"scale", {1, 0, 1}}});
        d["scenes"][0]["nodes"].push_back(i);
    }
    expect_refused(d, "instances counted");
    // Others are stored once.
    for (json& node : d["nodes"]) node.erase("scale");
    EXPECT_TRUE(load(d)->geometry->instances.empty());
}

TEST_F(GltfHazard, RequiredExtensionsAreHonouredOrRefusedByName) {
    json d = triangle();
    d["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    expect_refused(d, "KHR_draco_mesh_compression");
    d["extensionsRequired"] = {"EVIL\nname: all is well\x1b[2J"};
    expect_refused(d, "EVIL name");
    d["extensionsRequired"] = {"KHR_lights_punctual", "KHR_materials_unlit", "KHR_materials_ior", "KHR_mesh_quantization"};
    EXPECT_EQ(load(d)->geometry->triangles.size(), 1u);
    d["extensionsUsed"] = json::array();
    for (int i = 0; i < 100000; ++i) d["extensionsUsed"].push_back("EXT_" + std::to_string(i));
    const auto scene = load(d);
    EXPECT_TRUE(warned(*scene, "the extension EXT_7 is not supported"));
    EXPECT_LE(scene->warnings.size(), 101u);
}

TEST_F(GltfHazard, PrimitivesWithoutWhatTheyNeedAreNamed) {
    json d = triangle();
    d["meshes"][0]["primitives"][0].erase("attributes");
    expect_refused(d, "meshes[0].primitives[0] has no attributes");
    d["meshes"][0]["primitives"][0]["attributes"] = json::object();
    EXPECT_TRUE(warned(*load(d), "has no positions"));
    d = triangle();
    d["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 1;
    expect_refused(d, "NORMAL");
    d["accessors"].push_back(d["accessors"][0]);
    d["accessors"][2]["count"] = 2;
    d["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 2;
    expect_refused(d, "fewer normals");
    EXPECT_TRUE(warned(*load(json::parse(R"({"asset": {"version": "2.0"}})")), "nothing to show"));
}

}  // namespace
}  // namespace glint::test
