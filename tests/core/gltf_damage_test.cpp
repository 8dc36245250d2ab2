// Random damage to a glTF file that uses all that the reader follows: loaded or refused, never worse.
#include <random>

#include "gltf_fixture.h"

namespace glint::test {
namespace {

using GltfDamage = GltfTest;

// Everything that the reader follows, in one small file.
json rich(const json& triangle) {
    json d = triangle;
    d["buffers"][0].erase("uri");
    d["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}},
                    {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 9}}}}};
    d["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 5}},
                                                        {{"type", "spot"}, {"spot", {{"outerConeAngle", 0.5}}}}};
    d["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_ior"};
    d["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.5, 0, 1}}, {"metallicFactor", 0.5}}},
                       {"emissiveFactor", {0, 0, 1}},
                       {"extensions", {{"KHR_materials_ior", {{"ior", 1.33}}}}}}};
    d["meshes"][0]["primitives"][0]["material"] = 0;
    d["nodes"] = {{{"children", {1, 2, 3}}, {"scale", {-1, 2, 1}}},
                  {{"mesh", 0}, {"rotation", {0, 0.6, 0, 0.8}}, {"camera", 0}},
                  {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}}, {"camera", 1}},
                  {{"translation", {0, 3, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}}};
    d["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 36}, {"byteLength", 8}});
    d["accessors"][0]["sparse"] = {{"count", 1},
                                   {"indices", {{"bufferView", 2}, {"byteOffset", 4}, {"componentType", 5123}}},
                                   {"values", {{"bufferView", 0}, {"byteOffset", 24}}}};
    return d;
}

// Loaded or refused; any other exception, a crash or a sanitizer's complaint fails the test.
void load_or_refuse(const std::filesystem::path& path) {
    try {
        const auto scene = reader::read_gltf(path, {});
        ASSERT_FALSE(scene->cameras.empty());
        ASSERT_LE(scene->geometry->triangles.size(), 1000u);
    } catch (const SceneError& e) {
        EXPECT_EQ(std::string_view(e.what()).find('\n'), std::string_view::npos);
    }
}

TEST_F(GltfDamage, RandomBytesNeverCrash) {
    const std::string data = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + bytes_of<std::uint16_t>({0, 1, 2, 0});
    const std::string whole = glb(rich(triangle()), data);
    ASSERT_EQ(read(write("a.glb", whole))->geometry->triangles.size(), 2u);
    std::mt19937 random(20240611);
    for (int i = 0; i < 400; ++i) {
        std::string damaged = whole;
        for (auto n = 1 + random() % 4; n > 0; --n) damaged[random() % damaged.size()] = static_cast<char>(random());
        if (random() % 8 == 0) damaged.resize(random() % damaged.size());
        load_or_refuse(write("a.glb", damaged));
    }
}

TEST_F(GltfDamage, RandomValuesNeverCrash) {
    const std::string data = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + bytes_of<std::uint16_t>({0, 1, 2, 0});
    const json flat = rich(triangle()).flatten();
    const std::vector<json> odd{nullptr,
                                true,
                                -1,
                                0,
                                1,
                                3,
                                255,
                                5124,
                                4294967295u,
                                9223372036854775807,
                                18446744073709551615u,
                                -1e300,
                                1e-300,
                                0.5,
                                "",
                                "x",
                                json::array(),
                                json::object(),
                                json::array({-1}),
                                json::array({1, "x"})};
    std::vector<std::string> keys;
    for (const auto& [key, value] : flat.items()) keys.push_back(key);
    std::mt19937 random(7);
    for (int i = 0; i < 400; ++i) {
        json d = flat.unflatten();
        for (auto n = 1 + random() % 2; n > 0; --n) {
            // A value or, one level up, the object or list that holds it.
            json::json_pointer where(keys[random() % keys.size()]);
            for (auto up = random() % 3; up > 0 && !where.empty(); --up) where.pop_back();
            if (!where.empty() && d.contains(where)) d[where] = odd[random() % odd.size()];
        }
        load_or_refuse(write("a.glb", glb(d, data)));
    }
}

}  // namespace
}  // namespace glint::test
