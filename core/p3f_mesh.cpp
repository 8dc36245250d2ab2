#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/contained_path.h"
#include "core/p3f_reader.h"
#include "core/ply.h"
#include "core/polygon.h"
#include "core/scene_io.h"

namespace glint::p3f {
namespace {

using Index = std::uint32_t;

// What of one statement was not a proper surface, told in one line however many faces it has.
struct Flaws {
    std::size_t faces = 0;     // announced
    std::size_t dropped = 0;   // without area
    std::size_t crossing = 0;  // outlines that cross themselves

    void warn(Messages& messages, const Token& word) const {
        const std::string what = in_quotes(word.text);
        if (dropped > 0 && faces == 1) messages.warn(word.line, fmt::format("{} has no area, dropped", what));
        if (dropped > 0 && faces > 1) {
            messages.warn(word.line, fmt::format("{}: {} of {} faces have no area, dropped", what, dropped, faces));
        }
        if (crossing > 0) messages.warn(word.line, fmt::format("{} has an outline that crosses itself", what));
    }
};

void add_face(Reader& r, std::span<const Index> corners, Flaws& flaws) {
    ++flaws.faces;
    const Index material = r.current_material();
    if (corners.size() == 3) {
        if (!r.builder.add_triangle(corners[0], corners[1], corners[2], material)) ++flaws.dropped;
        return;
    }
    std::vector<glm::dvec3> outline;
    outline.reserve(corners.size());
    for (const Index i : corners) outline.emplace_back(r.builder.geometry().vertices[i]);
    const Triangulation cut = triangulate(outline);
    bool any = false;
    for (const auto& t : cut.triangles) {
        // Slivers at repeated points may have no area of their own: nothing is missing without them.
        any = r.builder.add_triangle(corners[t[0]], corners[t[1]], corners[t[2]], material) || any;
    }
    if (!any) ++flaws.dropped;
    if (!cut.simple) ++flaws.crossing;
}

std::size_t corner_count(Reader& r, const std::string& what) {
    const std::size_t corners = r.in.count(what, 3);
    if (corners < 3) r.messages.fail(r.in.line(), fmt::format("{} needs at least 3 vertices, found {}", what, corners));
    if (corners > kMaxPolygonCorners) {
        r.messages.fail(r.in.line(), fmt::format("{} has {} vertices, more than {}", what, corners, kMaxPolygonCorners));
    }
    return corners;
}

void read_polygon(Reader& r, const Token& word) {
    const std::size_t corners = corner_count(r, "'p'");
    std::vector<Index> outline;
    outline.reserve(corners);
    for (std::size_t i = 0; i < corners; ++i) {
        const auto [x, y, z] = r.in.numbers<3>("a vertex of 'p'");
        outline.push_back(r.builder.add_vertex(r.point(x, y, z)));
    }
    Flaws flaws;
    add_face(r, outline, flaws);
    flaws.warn(r.messages, word);
}

// Unit length, or (0,0,0) for "none": a normal without direction cannot shade.
glm::vec3 shading_normal(glm::dvec3 n) {
    const double length = glm::length(n);
    return length > 0.0 && std::isfinite(length) ? glm::vec3(n / length) : glm::vec3(0.0f);
}

// Positions with normals as NFF has it; one teapot of the course writes positions only, which the count of numbers tells.
void read_patch(Reader& r, const Token& word) {
    const std::size_t corners = corner_count(r, "'pp'");
    const std::vector<double> v = r.in.numbers_until_word(6 * corners);
    if (v.size() != 6 * corners && v.size() != 3 * corners) {
        r.messages.fail(r.in.line(), fmt::format("'pp' needs {} numbers, or {} without normals, found {}", 6 * corners,
                                                 3 * corners, v.size()));
    }
    const std::size_t stride = v.size() / corners;
    std::vector<Index> outline;
    outline.reserve(corners);
    for (std::size_t i = 0; i < v.size(); i += stride) {
        const glm::vec3 normal = stride == 6 ? shading_normal({v[i + 3], v[i + 4], v[i + 5]}) : glm::vec3(0.0f);
        outline.push_back(r.builder.add_vertex(r.point(v[i], v[i + 1], v[i + 2]), normal));
    }
    Flaws flaws;
    add_face(r, outline, flaws);
    flaws.warn(r.messages, word);
}

// 1-based; negative counts from the end, -1 is the last vertex.
Index mesh_index(Reader& r, Index first, std::int64_t vertices) {
    const std::int64_t index = r.in.integer("an index of 'mesh'");
    const std::int64_t at = index > 0 ? index - 1 : vertices + index;
    if (index == 0 || at < 0 || at >= vertices) {
        r.messages.fail(r.in.line(), fmt::format("index {} is out of range: the mesh has {} vertices", index, vertices));
    }
    return first + static_cast<Index>(at);
}

void read_mesh(Reader& r, const Token& word) {
    const Index vertices = r.in.count("'mesh' vertices", 3);
    const Index faces = r.in.count("'mesh' faces", 3);
    const auto first = static_cast<Index>(r.builder.geometry().vertices.size());
    for (Index i = 0; i < vertices; ++i) {
        const auto [x, y, z] = r.in.numbers<3>("a vertex of 'mesh'");
        r.builder.add_vertex(r.point(x, y, z));
    }
    Flaws flaws;
    for (Index i = 0; i < faces; ++i) {
        std::array<Index, 3> corners{};
        for (Index& corner : corners) corner = mesh_index(r, first, vertices);
        add_face(r, corners, flaws);
    }
    flaws.warn(r.messages, word);
}

void read_included_mesh(Reader& r, const Token& word) {
    // A scene of a few lines may name a large file again and again.
    constexpr std::size_t kMostBytes = std::size_t{1} << 30;
    const std::string_view name = r.in.name("'ply'");
    const auto path = path_below(r.folder, name);
    if (!path) r.messages.fail(word.line, fmt::format("ply {}: no such file below the scene's folder", in_quotes(name)));
    const std::string text = reader::read_file(*path, kMostBytes - r.ply_bytes);
    r.ply_bytes += text.size();
    const PlyMesh mesh = read_ply(text, path->string(), r.builder.scene().origin);
    const auto first = static_cast<Index>(r.builder.geometry().vertices.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        r.builder.add_vertex(mesh.positions[i], mesh.normals.empty() ? glm::vec3(0.0f) : shading_normal(mesh.normals[i]));
    }
    Flaws flaws;
    std::vector<Index> corners;
    for (std::size_t begin = 0; begin < mesh.corners.size();) {
        const std::size_t n = mesh.corners[begin];
        corners.clear();
        for (std::size_t k = 1; k <= n; ++k) corners.push_back(first + mesh.corners[begin + k]);
        add_face(r, corners, flaws);
        begin += 1 + n;
    }
    flaws.warn(r.messages, word);
}

constexpr std::array<Statement, 4> kStatements{
    {{"p", read_polygon}, {"pp", read_patch}, {"mesh", read_mesh}, {"ply", read_included_mesh}}};

}  // namespace

std::span<const Statement> mesh_statements() { return kStatements; }

}  // namespace glint::p3f
