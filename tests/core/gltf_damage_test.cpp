// Random damage to a glTF file that uses all that the reader follows: loaded or refused, never worse.
#include <random>

#include "rich_files.h"

namespace glint::test {
namespace {

using GltfDamage = GltfTest;

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
    const std::string whole = glb(rich_document(triangle()), data);
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
    const json flat = rich_document(triangle()).flatten();
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
