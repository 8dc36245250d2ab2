#include "core/ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>

#include "core/p3f_lexer.h"
#include "core/ply_header.h"
#include "core/ply_values.h"
#include "core/polygon.h"

namespace glint {
namespace {

using p3f::in_quotes;

template <class Values>
class BodyReader {
public:
    BodyReader(Values values, const ply::Header& header, const std::string& name, glm::dvec3 origin)
        : values_(values), header_(header), messages_(name), origin_(origin) {}

    PlyMesh read() {
        for (const ply::Element& element : header_.elements) {
            const std::size_t least = element.least_bytes(header_.format);
            if (least == 0) continue;  // records without properties are nothing
            // A lie about the count is found before anything is allocated. The last number of a text needs no blank.
            if (element.announced > (values_.remaining() + (kText ? 1 : 0)) / least) {
                messages_.fail(element.line, fmt::format("{} announces {}, more than the file can hold", in_quotes(element.name),
                                                         element.announced));
            }
            if (element.name == "vertex") {
                read_vertices(element);
            } else if (element.name == "face") {
                read_faces(element);
            } else {
                for (std::uint64_t i = 0; i < element.announced; ++i) {
                    for (const ply::Property& property : element.properties) skip(property);
                }
            }
        }
        if (mesh_.positions.empty()) values_.fail("the file has no vertices");
        return std::move(mesh_);
    }

private:
    static constexpr bool kText = std::is_same_v<Values, ply::TextValues>;

    void read_vertices(const ply::Element& element) {
        // Two such elements could disagree about normals, which would then no longer run beside the positions.
        if (!mesh_.positions.empty()) messages_.fail(element.line, "a second element 'vertex'");
        constexpr std::array<std::string_view, 6> kNames{"x", "y", "z", "nx", "ny", "nz"};
        std::vector<std::size_t> slots(element.properties.size(), kNames.size());
        std::array<bool, 6> found{};
        for (std::size_t i = 0; i < kNames.size(); ++i) {
            const auto at = element.find(kNames[i]);
            if (!at || element.properties[*at].length) continue;
            slots[*at] = i;
            found[i] = true;
        }
        if (!(found[0] && found[1] && found[2])) messages_.fail(element.line, "'vertex' has no x, y, z");
        const bool normals = found[3] && found[4] && found[5];
        // The count was checked: at least one record's bytes stand behind each of these.
        mesh_.positions.reserve(element.announced);
        if (normals) mesh_.normals.reserve(element.announced);
        std::array<double, 6> v{};
        for (std::uint64_t i = 0; i < element.announced; ++i) {
            for (std::size_t k = 0; k < slots.size(); ++k) {
                if (slots[k] < v.size()) {
                    v[slots[k]] = values_.real(element.properties[k].type);
                } else {
                    skip(element.properties[k]);
                }
            }
            const glm::vec3 p(glm::dvec3(v[0], v[1], v[2]) - origin_);
            if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))) {
                values_.fail(fmt::format("vertex {} is not finite", i));
            }
            mesh_.positions.push_back(p);
            if (normals) mesh_.normals.emplace_back(v[3], v[4], v[5]);
        }
    }

    void read_faces(const ply::Element& element) {
        const auto named = element.find("vertex_indices") ? element.find("vertex_indices") : element.find("vertex_index");
        if (!named || !element.properties[*named].length) messages_.fail(element.line, "'face' has no list vertex_indices");
        if (!ply::is_integer(element.properties[*named].type)) messages_.fail(element.line, "vertex_indices must be integers");
        // Nearly all faces are triangles; more of them than fit into the rest of the file need no room.
        const ply::Type index = element.properties[*named].type;
        const std::size_t least = element.least_bytes(header_.format) + 3 * (kText ? 2 : ply::size_of(index));
        mesh_.corners.reserve(mesh_.corners.size() + 4 * std::min(element.announced, (values_.remaining() + 1) / least));
        for (std::uint64_t i = 0; i < element.announced; ++i) {
            for (std::size_t k = 0; k < element.properties.size(); ++k) {
                if (k == *named) {
                    read_face(element.properties[k]);
                } else {
                    skip(element.properties[k]);
                }
            }
        }
    }

    void read_face(const ply::Property& list) {
        const std::uint64_t n = read_length(list);
        if (n < 3 || n > kMaxPolygonCorners) {
            values_.fail(fmt::format("a face of {} vertices, expected 3 to {}", n, kMaxPolygonCorners));
        }
        mesh_.corners.push_back(static_cast<std::uint32_t>(n));
        const auto vertices = static_cast<std::int64_t>(mesh_.positions.size());
        for (std::uint64_t i = 0; i < n; ++i) {
            const std::int64_t corner = values_.integer(list.type);
            if (corner < 0 || corner >= vertices) {
                values_.fail(fmt::format("index {} is out of range: the file has {} vertices so far", corner, vertices));
            }
            mesh_.corners.push_back(static_cast<std::uint32_t>(corner));
        }
    }

    std::uint64_t read_length(const ply::Property& list) {
        const std::int64_t n = values_.integer(*list.length);
        if (n < 0) values_.fail(fmt::format("a list of negative length {}", n));
        if (!values_.has_room(list.type, static_cast<std::uint64_t>(n))) {
            values_.fail(fmt::format("a list announces {}, more than the file can hold", n));
        }
        return static_cast<std::uint64_t>(n);
    }

    void skip(const ply::Property& property) { values_.skip(property.type, property.length ? read_length(property) : 1); }

    Values values_;
    const ply::Header& header_;
    p3f::Messages messages_;
    glm::dvec3 origin_;
    PlyMesh mesh_;
};

template <class Values>
PlyMesh read_body(std::string_view file, const ply::Header& header, const std::string& name, glm::dvec3 origin) {
    return BodyReader<Values>(Values(file, header, name), header, name, origin).read();
}

}  // namespace

PlyMesh read_ply(std::string_view file, const std::string& name, glm::dvec3 origin) {
    const ply::Header header = ply::read_header(file, name);
    if (header.format == ply::Format::ascii) return read_body<ply::TextValues>(file, header, name, origin);
    const bool little = header.format == ply::Format::binary_little_endian;
    if (little == (std::endian::native == std::endian::little)) {
        return read_body<ply::BinaryValues<false>>(file, header, name, origin);
    }
    return read_body<ply::BinaryValues<true>>(file, header, name, origin);
}

}  // namespace glint
