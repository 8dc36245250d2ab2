#include "core/gltf_check.h"

#include <cstring>
#include <initializer_list>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace glint {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxJsonBytes = std::size_t{1} << 28;  // parsed JSON takes up to ten times its text
constexpr int kMaxJsonDepth = 128;                           // glTF itself needs 7; extras may be anything
constexpr std::size_t kAnyNumber = std::numeric_limits<std::size_t>::max();

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
    std::uint32_t value;
    std::memcpy(&value, bytes.data() + at, sizeof(value));
    return value;
}

// The JSON chunk of a GLB. Sizes are checked because tinygltf forgets the second chunk's header and would read past the end.
std::string_view json_of_glb(std::string_view bytes, const GltfReport& report) {
    constexpr std::size_t kHeader = 12, kChunkHeader = 8;
    if (bytes.size() < kHeader + kChunkHeader) report.fail("the GLB file is truncated");
    if (little_endian(bytes, 4) != 2) report.fail(fmt::format("GLB version {} is not supported (2 is)", little_endian(bytes, 4)));
    const std::size_t length = little_endian(bytes, 8);
    if (length > bytes.size()) report.fail("the GLB file is truncated");
    std::string_view text;
    int chunks = 0;
    for (std::size_t at = kHeader; at < length && chunks < 2; ++chunks) {
        if (kChunkHeader > length - at) report.fail("the GLB file ends within the header of a chunk");
        const std::size_t size = little_endian(bytes, at);
        if (size > length - at - kChunkHeader) report.fail("a chunk of the GLB file is longer than the file");
        if (chunks == 0) {
            constexpr std::uint32_t kJson = 0x4E4F534A;
            if (little_endian(bytes, at + 4) != kJson) report.fail("the first chunk of the GLB file is not JSON");
            text = bytes.substr(at + kChunkHeader, size);
        }
        at += kChunkHeader + size;
    }
    return text;
}

// tinygltf follows extras and extensions by recursion. Counted in the text, because the parser's own hook for this walks
// the whole parent again after each object.
void check_depth(std::string_view text, const GltfReport& report) {
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\') ++i;  // whatever is escaped does not end the string
            if (c == '"') in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            if (++depth > kMaxJsonDepth) report.fail(fmt::format("JSON nested deeper than {} levels", kMaxJsonDepth));
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
}

// Where in the file a value stands; put into words only when something is wrong there.
struct Place {
    const char* array;
    std::size_t index;
    const char* inner_array = nullptr;
    std::size_t inner_index = 0;

    [[nodiscard]] std::string text() const {
        std::string place = fmt::format("{}[{}]", array, index);
        if (inner_array != nullptr) place += fmt::format(".{}[{}]", inner_array, inner_index);
        return place;
    }
};

class JsonCheck {
public:
    JsonCheck(const json& root, const GltfReport& report) : root_(root), report_(report) {}

    void all(bool glb) const {
        asset();
        buffers(glb);
        views_and_accessors();
        meshes();
        nodes_and_scenes();
        materials();
        for (const char* name : {"images", "textures", "samplers", "cameras", "skins", "animations"}) array(root_, name);
    }

private:
    // The array of objects called `name`; empty when there is none.
    const json& array(const json& parent, const char* name) const {
        static const json kEmpty = json::array();
        const auto found = parent.find(name);
        if (found == parent.end()) return kEmpty;
        if (!found->is_array()) report_.fail(fmt::format("{} is not an array", name));
        for (std::size_t i = 0; i < found->size(); ++i) {
            if (!(*found)[i].is_object()) report_.fail(fmt::format("{}[{}] is not an object", name, i));
        }
        return *found;
    }
    std::size_t count(const char* name) const { return array(root_, name).size(); }

    // A whole number from 0 to below `limit`. tinygltf would cut off or skip anything else without a word.
    void natural(const json& value, const char* name, const Place& place, std::size_t limit) const {
        if (!value.is_number_unsigned()) report_.fail(fmt::format("{}.{} is not a whole number from 0", place.text(), name));
        if (limit == kAnyNumber || value.get<std::uint64_t>() < limit) return;
        report_.fail(fmt::format("{}.{} is {}, but there are only {}", place.text(), name, value.get<std::uint64_t>(), limit));
    }
    // The same for a member that may be missing.
    void member(const json& object, const char* name, const Place& place, std::size_t limit) const {
        const auto found = object.find(name);
        if (found != object.end()) natural(*found, name, place, limit);
    }
    void required(const json& object, const char* name, const Place& place, std::size_t limit) const {
        if (!object.contains(name)) report_.fail(fmt::format("{} has no {}", place.text(), name));
        member(object, name, place, limit);
    }
    void naturals(const json& object, const char* name, const Place& place, std::size_t limit) const {
        const auto found = object.find(name);
        if (found == object.end()) return;
        if (!found->is_array()) report_.fail(fmt::format("{}.{} is not an array", place.text(), name));
        for (const json& value : *found) natural(value, name, place, limit);
    }
    // `length` numbers, or one number where length is 0.
    void numbers(const json& object, const char* name, const Place& place, std::size_t length) const {
        const auto found = object.find(name);
        if (found == object.end()) return;
        bool good = length == 0 ? found->is_number() : found->is_array() && found->size() == length;
        if (good && length > 0) {
            for (const json& value : *found) good = good && value.is_number();
        }
        if (good) return;
        const std::string expected = length == 0 ? "a number" : fmt::format("an array of {} numbers", length);
        report_.fail(fmt::format("{}.{} is not {}", place.text(), name, expected));
    }

    void asset() const {
        const auto found = root_.find("asset");
        const bool has_version =
            found != root_.end() && found->is_object() && found->contains("version") && (*found)["version"].is_string();
        if (!has_version) report_.fail("asset.version is missing: this is not glTF 2.0");
        const std::string version = (*found)["version"].get<std::string>();
        if (!version.starts_with("2.")) report_.fail(fmt::format("glTF version {} is not supported (2.0 is)", version));
    }

    void buffers(bool glb) const {
        const json& list = array(root_, "buffers");
        std::uint64_t total = 0;
        for (std::size_t i = 0; i < list.size(); ++i) {
            const Place place{"buffers", i};
            required(list[i], "byteLength", place, kAnyNumber);
            const std::uint64_t bytes = list[i]["byteLength"].get<std::uint64_t>();
            if (bytes == 0) report_.fail(place.text() + ".byteLength is 0");
            if (bytes > kMaxGltfBytes - total) report_.fail(fmt::format("the buffers hold more than {} bytes", kMaxGltfBytes));
            total += bytes;
            const auto uri = list[i].find("uri");
            if (uri != list[i].end() && !uri->is_string()) report_.fail(place.text() + ".uri is not a string");
            // Only the first buffer of a GLB is its binary chunk; a thousand more would each get a copy of it.
            if (uri == list[i].end() && !(glb && i == 0)) report_.fail(place.text() + " has no uri");
        }
    }

    void views_and_accessors() const {
        const json& views = array(root_, "bufferViews");
        const std::size_t buffer_count = count("buffers");
        for (std::size_t i = 0; i < views.size(); ++i) {
            const Place place{"bufferViews", i};
            required(views[i], "buffer", place, buffer_count);
            required(views[i], "byteLength", place, kAnyNumber);
            member(views[i], "byteOffset", place, kAnyNumber);
            member(views[i], "byteStride", place, kAnyNumber);
        }
        const json& accessors = array(root_, "accessors");
        for (std::size_t i = 0; i < accessors.size(); ++i) {
            const Place place{"accessors", i};
            required(accessors[i], "count", place, kAnyNumber);
            required(accessors[i], "componentType", place, kAnyNumber);
            member(accessors[i], "bufferView", place, views.size());
            member(accessors[i], "byteOffset", place, kAnyNumber);
            const auto sparse = accessors[i].find("sparse");
            if (sparse == accessors[i].end()) continue;
            if (!sparse->is_object()) report_.fail(place.text() + ".sparse is not an object");
            required(*sparse, "count", place, std::size_t{1} << 31);
            for (const char* part : {"indices", "values"}) {
                const auto found = sparse->find(part);
                if (found == sparse->end() || !found->is_object())
                    report_.fail(fmt::format("{}.sparse has no {}", place.text(), part));
                required(*found, "bufferView", place, views.size());
                member(*found, "byteOffset", place, std::size_t{1} << 31);
            }
        }
    }

    void meshes() const {
        const json& list = array(root_, "meshes");
        const std::size_t accessors = count("accessors"), materials = count("materials");
        for (std::size_t i = 0; i < list.size(); ++i) {
            const json& primitives = array(list[i], "primitives");
            for (std::size_t k = 0; k < primitives.size(); ++k) {
                const Place place{"meshes", i, "primitives", k};
                const json& primitive = primitives[k];
                member(primitive, "indices", place, accessors);
                member(primitive, "material", place, materials);
                member(primitive, "mode", place, 7);
                const auto attributes = primitive.find("attributes");
                if (attributes == primitive.end() || !attributes->is_object()) report_.fail(place.text() + " has no attributes");
                for (const auto& [name, accessor] : attributes->items()) natural(accessor, name.c_str(), place, accessors);
            }
        }
    }

    void nodes_and_scenes() const {
        const json& nodes = array(root_, "nodes");
        const std::size_t meshes = count("meshes"), cameras = count("cameras"), skins = count("skins");
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const Place place{"nodes", i};
            member(nodes[i], "mesh", place, meshes);
            member(nodes[i], "camera", place, cameras);
            member(nodes[i], "skin", place, skins);
            naturals(nodes[i], "children", place, nodes.size());
            numbers(nodes[i], "matrix", place, 16);
            numbers(nodes[i], "rotation", place, 4);
            numbers(nodes[i], "scale", place, 3);
            numbers(nodes[i], "translation", place, 3);
        }
        const json& scenes = array(root_, "scenes");
        for (std::size_t i = 0; i < scenes.size(); ++i) naturals(scenes[i], "nodes", Place{"scenes", i}, nodes.size());
        const auto chosen = root_.find("scene");
        if (chosen == root_.end()) return;
        if (!chosen->is_number_unsigned()) report_.fail("scene is not a whole number from 0");
        if (chosen->get<std::uint64_t>() >= scenes.size()) {
            report_.fail(fmt::format("scene is {}, but there are only {}", chosen->get<std::uint64_t>(), scenes.size()));
        }
    }

    void materials() const {
        const json& list = array(root_, "materials");
        for (std::size_t i = 0; i < list.size(); ++i) {
            const Place place{"materials", i};
            numbers(list[i], "emissiveFactor", place, 3);
            const auto pbr = list[i].find("pbrMetallicRoughness");
            if (pbr == list[i].end()) continue;
            if (!pbr->is_object()) report_.fail(place.text() + ".pbrMetallicRoughness is not an object");
            numbers(*pbr, "baseColorFactor", place, 4);
            numbers(*pbr, "metallicFactor", place, 0);
            numbers(*pbr, "roughnessFactor", place, 0);
        }
    }

    const json& root_;
    const GltfReport& report_;
};

}  // namespace

bool is_glb(std::string_view bytes) { return bytes.starts_with("glTF"); }

void check_gltf(std::string_view bytes, const GltfReport& report) {
    const bool glb = is_glb(bytes);
    const std::string_view text = glb ? json_of_glb(bytes, report) : bytes;
    if (text.empty()) report.fail("the file is empty");
    if (text.size() > kMaxJsonBytes) report.fail(fmt::format("more than {} bytes of JSON", kMaxJsonBytes));
    check_depth(text, report);
    json root;
    try {
        root = json::parse(text.begin(), text.end());
    } catch (const json::exception& e) {
        // "[json.exception.parse_error.101] parse error at line 1, column 1: ...": the tag says nothing to a user.
        const std::string_view what = e.what();
        const std::size_t tag = what.find("] ");
        report.fail(fmt::format("not JSON: {}", tag == what.npos ? what : what.substr(tag + 2)));
    }
    if (!root.is_object()) report.fail("the JSON is not an object");
    JsonCheck(root, report).all(glb);
}

}  // namespace glint
