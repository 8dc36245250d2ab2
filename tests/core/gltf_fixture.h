// Small glTF files for tests: written from JSON and bytes into a folder of their own that is removed afterwards.
// Knows nothing of the reader but its door. Invariant: what GltfTest writes lies below folder().
#pragma once

#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "core/scene_io.h"

namespace glint::test {

using nlohmann::json;

// Little-endian bytes of values, one after the other.
template <typename T>
std::string bytes_of(const std::vector<T>& values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

// A GLB of a document and its binary chunk, both padded as the format asks.
inline std::string glb(const json& document, std::string binary) {
    std::string text = document.dump();
    while (text.size() % 4 != 0) text += ' ';
    while (binary.size() % 4 != 0) binary += '\0';
    const auto u32 = [](std::size_t n) { return bytes_of<std::uint32_t>({static_cast<std::uint32_t>(n)}); };
    const std::size_t total = 12 + 8 + text.size() + (binary.empty() ? 0 : 8 + binary.size());
    std::string file = "glTF" + u32(2) + u32(total) + u32(text.size()) + "JSON" + text;
    if (!binary.empty()) file += u32(binary.size()) + std::string("BIN\0", 4) + binary;
    return file;
}

class GltfTest : public testing::Test {
protected:
    GltfTest() {
        static int count = 0;
        folder_ =
            std::filesystem::temp_directory_path() / ("glint_gltf_" + std::to_string(getpid()) + "_" + std::to_string(count++));
        std::filesystem::create_directories(folder_);
    }
    ~GltfTest() override { std::filesystem::remove_all(folder_); }

    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
    std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return folder_ / name;
    }

    static std::shared_ptr<const Scene> read(const std::filesystem::path& path) { return reader::read_gltf(path, {}); }
    std::shared_ptr<const Scene> load(const json& document) const { return read(write("scene.gltf", document.dump())); }

    // The file is refused in one line that starts with its name and holds `reason`.
    void expect_refused(const std::filesystem::path& path, const std::string& reason) const {
        try {
            (void)read(path);
            ADD_FAILURE() << "not refused, expected: " << reason;
        } catch (const SceneError& e) {
            const std::string what = e.what();
            EXPECT_EQ(what.rfind(path.string() + ": ", 0), 0u) << what;
            EXPECT_EQ(what.find('\n'), std::string::npos) << what;
            EXPECT_NE(what.find(reason), std::string::npos) << what << "\nexpected: " << reason;
        }
    }
    void expect_refused(const json& document, const std::string& reason) const {
        expect_refused(write("scene.gltf", document.dump()), reason);
    }
    static bool warned(const Scene& scene, const std::string& text) {
        for (const std::string& w : scene.warnings) {
            if (w.find(text) != std::string::npos) return true;
        }
        return false;
    }

    // One triangle (0,0,0) (1,0,0) (0,1,0): accessor 0 its positions, accessor 1 its indices (16 bits); data.bin is written.
    [[nodiscard]] json triangle() const {
        write("data.bin", bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + bytes_of<std::uint16_t>({0, 1, 2, 0}));
        return json::parse(R"({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "buffers": [{"byteLength": 44, "uri": "data.bin"}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                          {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}]})");
    }

    // `document` with positions (and indices) replaced by these; data.bin is rewritten, indices become 32 bits wide.
    json with_mesh(json document, const std::vector<float>& positions, const std::vector<std::uint32_t>& indices) const {
        const std::string p = bytes_of(positions), i = bytes_of(indices);
        write("data.bin", p + i);
        document["buffers"][0]["byteLength"] = p.size() + i.size();
        document["bufferViews"] = {{{"buffer", 0}, {"byteLength", p.size()}},
                                   {{"buffer", 0}, {"byteOffset", p.size()}, {"byteLength", std::max<std::size_t>(i.size(), 1)}}};
        document["accessors"] = {{{"bufferView", 0}, {"componentType", 5126}, {"count", positions.size() / 3}, {"type", "VEC3"}},
                                 {{"bufferView", 1}, {"componentType", 5125}, {"count", indices.size()}, {"type", "SCALAR"}}};
        if (indices.empty()) {
            document["meshes"][0]["primitives"][0].erase("indices");
            document["accessors"].erase(1);
            document["bufferViews"].erase(1);
        }
        return document;
    }

private:
    std::filesystem::path folder_;
};

// Six times the volume that closed triangles enclose; positive when their fronts look outwards.
inline double signed_volume(const Geometry& g) {
    double sum = 0.0;
    for (const auto& t : g.triangles) {
        sum += glm::dot(glm::dvec3(g.vertices[t[0]]), glm::cross(glm::dvec3(g.vertices[t[1]]), glm::dvec3(g.vertices[t[2]])));
    }
    return sum;
}

}  // namespace glint::test
