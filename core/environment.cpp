#include "core/environment.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <sstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <stb/stb_image.h>

#include "core/picture_size.h"
#include "core/scene.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

constexpr int kLargestSide = 16384;
constexpr std::int64_t kMostPixels = std::int64_t{1} << 26;  // 8192 x 8192; a small file can claim any size
constexpr std::array<std::string_view, 6> kFaceNames{"right", "left", "top", "bottom", "front", "back"};
constexpr std::array<std::string_view, 3> kEndings{".jpg", ".jpeg", ".png"};
enum Face : std::size_t { right, left, top, bottom, front, back };

struct FacePoint {
    Face face;
    double s, t;  // 0..1 from the left and from the bottom of the picture
};

// The course's convention: a left-handed set of names, +x is `left`. A component beats the one before only if it is strictly
// larger, so each edge and corner belongs to one face: y before x, and z last.
FacePoint locate(glm::dvec3 d) {
    const glm::dvec3 a = glm::abs(d);
    FacePoint p{};
    double largest = 0.0;
    if (a.z > std::max(a.x, a.y)) {
        p = d.z >= 0.0 ? FacePoint{front, -d.x, d.y} : FacePoint{back, d.x, d.y};
        largest = a.z;
    } else if (a.x > a.y) {
        p = d.x >= 0.0 ? FacePoint{left, d.z, d.y} : FacePoint{right, -d.z, d.y};
        largest = a.x;
    } else {
        p = d.y >= 0.0 ? FacePoint{top, -d.x, -d.z} : FacePoint{bottom, -d.x, d.z};
        largest = a.y;
    }
    p.s = (p.s / largest + 1.0) / 2.0;
    p.t = (p.t / largest + 1.0) / 2.0;
    return p;
}

// Nearest texel below, as the course's loader picks it. A direction without length gives NaN, which ends at 0.
std::size_t texel(int size, double s) {
    const double at = s > 0.0 ? std::min(s, 1.0) : 0.0;
    return static_cast<std::size_t>(static_cast<double>(size - 1) * at);
}

// The radiance that is displayed as `byte`: the least float x with floor(255.99 x) = byte, so that a sky box comes out as
// it went in (byte / 255.99 itself is rounded down for three bytes of four, and would be shown one darker).
float radiance_of_byte(std::uint8_t byte) {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> t{};
        for (int b = 0; b < 256; ++b) {
            auto x = static_cast<float>(b / 255.99);
            while (255.99 * static_cast<double>(x) < b) x = std::nextafter(x, 1.0f);
            t[static_cast<std::size_t>(b)] = x;
        }
        return t;
    }();
    return table[byte];
}

glm::vec3 cube_radiance(const std::array<CubeFace, 6>& faces, glm::vec3 d) {
    const FacePoint p = locate(glm::dvec3(d));
    const CubeFace& face = faces[p.face];
    if (face.rgb.empty()) return glm::vec3(0.0f);
    const std::size_t at = 3 * (texel(face.height, p.t) * static_cast<std::size_t>(face.width) + texel(face.width, p.s));
    return {radiance_of_byte(face.rgb[at]), radiance_of_byte(face.rgb[at + 1]), radiance_of_byte(face.rgb[at + 2])};
}

glm::vec3 sky_radiance(const Environment& e, glm::vec3 d) {
    // Over the largest component first, so that the square below neither overflows nor vanishes.
    const glm::vec3 a = glm::abs(d);
    const glm::vec3 scaled = d / std::max(a.x, std::max(a.y, a.z));
    const glm::vec3 unit = scaled / std::sqrt(glm::dot(scaled, scaled));
    const float height = glm::dot(unit, e.up);  // sine of the elevation

    // The air thickens towards the horizon, so most of the change happens in the lowest third; a free choice, no measured sky.
    const float depth = 1.0f - std::clamp(height, 0.0f, 1.0f);
    const glm::vec3 air = glm::mix(e.zenith, e.horizon, depth * depth * depth);
    constexpr float kGroundEdge = 0.03f;  // sine of 1.7 degrees: haze instead of a line that would alias
    const float ground = glm::smoothstep(0.0f, kGroundEdge, -height);
    const bool in_sun = glm::dot(unit, e.sun_direction) > e.sun_cos;
    return glm::mix(in_sun ? air + e.sun : air, e.ground, ground);
}

[[noreturn]] void refuse(const fs::path& path, std::string_view reason) {
    throw SceneError(fmt::format("{}: {}", path.string(), reason));
}

CubeFace read_face(const fs::path& path) {
    int width = 0;
    int height = 0;
    int channels = 0;
    const auto reason = [] {
        const char* text = stbi_failure_reason();
        std::string line = text != nullptr ? text : "unknown error";
        // stb quotes the file's bytes where it does not know a chunk.
        std::replace_if(
            line.begin(), line.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
        return "cannot read the picture: " + line;
    };
    // Asked before it is read; stb counts bytes in an int.
    std::error_code unknown;
    if (fs::file_size(path, unknown) > std::uintmax_t{1} << 30) refuse(path, "the file is larger than 2^30 bytes");
    std::ostringstream contents;
    contents << std::ifstream(path, std::ios::binary).rdbuf();
    const std::string bytes = std::move(contents).str();
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const int size = static_cast<int>(bytes.size());
    // The header is asked before decoding, which allocates what it claims.
    if (stbi_info_from_memory(data, size, &width, &height, &channels) == 0) refuse(path, reason());
    const bool usable = width > 0 && height > 0 && width <= kLargestSide && height <= kLargestSide;
    if (!usable || std::int64_t{width} * height > kMostPixels) {
        refuse(path, fmt::format("{} x {} pixels are too many: at most {} a side, 2^26 in all", width, height, kLargestSide));
    }
    if (!can_hold(bytes.size(), width, height) || !chunks_fit(bytes)) {
        refuse(path, fmt::format("the file is too short for {} x {} pixels", width, height));
    }
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
        stbi_load_from_memory(data, size, &width, &height, &channels, 3), &stbi_image_free);
    if (!pixels) refuse(path, reason());
    CubeFace face;
    face.width = width;
    face.height = height;
    const std::size_t row = 3 * static_cast<std::size_t>(width);
    face.rgb.reserve(row * static_cast<std::size_t>(height));
    // Files run from the top down.
    for (std::size_t y = static_cast<std::size_t>(height); y-- > 0;) {
        face.rgb.insert(face.rgb.end(), pixels.get() + y * row, pixels.get() + (y + 1) * row);
    }
    return face;
}

}  // namespace

glm::vec3 Environment::radiance(glm::vec3 d) const {
    switch (kind) {
        case Kind::color: return color;
        case Kind::cube: return cube_radiance(faces, d);
        case Kind::sky: return sky_radiance(*this, d);
    }
    return color;
}

std::array<fs::path, 6> cube_files(const fs::path& folder) {
    std::error_code error;
    if (!fs::is_directory(folder, error)) refuse(folder, "no such folder of sky box pictures");
    std::array<fs::path, 6> files;
    for (std::size_t i = 0; i < files.size(); ++i) {
        for (const std::string_view ending : kEndings) {
            const fs::path file = folder / fmt::format("{}{}", kFaceNames[i], ending);
            // A pipe under such a name would block for ever.
            if (files[i].empty() && fs::is_regular_file(file, error)) files[i] = file;
        }
        if (files[i].empty()) refuse(folder / fmt::format("{}.jpg", kFaceNames[i]), "sky box picture is missing");
    }
    return files;
}

void load_cube(Environment& environment, const fs::path& folder) {
    const std::array<fs::path, 6> files = cube_files(folder);
    std::array<CubeFace, 6> faces;
    for (std::size_t i = 0; i < files.size(); ++i) faces[i] = read_face(files[i]);
    environment.faces = std::move(faces);
    environment.kind = Environment::Kind::cube;
}

}  // namespace glint
