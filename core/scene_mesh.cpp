// Mesh files as scenes: the faces of a .ply, packed or not, on a stage of our own.
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/gunzip.h"
#include "core/mesh_stage.h"
#include "core/p3f_lexer.h"
#include "core/ply.h"
#include "core/polygon.h"
#include "core/scene_io.h"
#include "core/scene_origin.h"

namespace glint {
namespace {

// What was not a proper surface.
struct Flaws {
    std::size_t faces = 0;     // announced
    std::size_t dropped = 0;   // without area, or beyond what coordinates may be
    std::size_t crossing = 0;  // outlines that cross themselves
};

// Unit length, or (0,0,0) for "none": a normal without direction cannot shade.
glm::vec3 shading_normal(glm::dvec3 n) {
    const double length = std::sqrt(glm::dot(n, n));
    return length > 0.0 && std::isfinite(length) ? glm::vec3(n / length) : glm::vec3(0.0f);
}

bool add_polygon(SceneBuilder& builder, std::span<const std::uint32_t> corners, std::uint32_t material, Flaws& flaws) {
    std::vector<glm::dvec3> outline;
    outline.reserve(corners.size());
    for (const std::uint32_t i : corners) outline.emplace_back(builder.geometry().vertices[i]);
    const Triangulation cut = triangulate(outline);
    bool any = false;
    for (const auto& t : cut.triangles) {
        // Slivers at repeated points may have no area of their own: nothing is missing without them.
        any = builder.add_triangle(corners[t[0]], corners[t[1]], corners[t[2]], material) || any;
    }
    if (!cut.simple) ++flaws.crossing;
    return any;
}

Flaws add_mesh(SceneBuilder& builder, const PlyMesh& mesh) {
    const std::uint32_t material = builder.add_material(clay());
    // Triangles take four numbers; a few more vertices and triangles belong to the floor.
    builder.reserve(mesh.positions.size() + 4, mesh.corners.size() / 4 + 2);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        builder.add_vertex(mesh.positions[i], mesh.normals.empty() ? glm::vec3(0.0f) : shading_normal(mesh.normals[i]));
    }
    Flaws flaws;
    for (std::size_t begin = 0; begin < mesh.corners.size(); begin += 1 + mesh.corners[begin]) {
        const std::span<const std::uint32_t> corners(&mesh.corners[begin + 1], mesh.corners[begin]);
        const bool added = corners.size() == 3 ? builder.add_triangle(corners[0], corners[1], corners[2], material)
                                               : add_polygon(builder, corners, material, flaws);
        ++flaws.faces;
        if (!added) ++flaws.dropped;
    }
    return flaws;
}

// Of the faces: a vertex that none uses lies nowhere.
Aabb extent_of(const PlyMesh& mesh) {
    Aabb extent;
    for (std::size_t begin = 0; begin < mesh.corners.size() && !lies_near(extent); begin += 1 + mesh.corners[begin]) {
        for (std::size_t i = 1; i <= mesh.corners[begin]; ++i) extent.grow(mesh.positions[mesh.corners[begin + i]]);
    }
    return extent;
}

PlyMesh read_near(std::string_view file, const std::string& name, SceneOrigin& origin) {
    for (;;) {
        PlyMesh mesh = read_ply(file, name, origin.world());
        if (origin.suits(extent_of(mesh))) return mesh;
    }
}

PlyMesh read_packed_or_not(const std::filesystem::path& path, SceneOrigin& origin) {
    const std::string name = path.string();
    std::string file = reader::read_file(path);
    if (!is_gzip(file)) return read_near(file, name, origin);
    const UnpackedBytes unpacked = gunzip(file, name);
    file = std::string();
    return read_near(unpacked.view(), name, origin);
}

}  // namespace

std::shared_ptr<const Scene> reader::read_mesh(const std::filesystem::path& path) {
    SceneOrigin origin;
    PlyMesh mesh = read_packed_or_not(path, origin);
    SceneBuilder builder(origin.world());
    builder.scene().name = path.string();
    const Flaws flaws = add_mesh(builder, std::exchange(mesh, {}));
    if (builder.geometry().triangles.empty()) {
        throw SceneError(fmt::format("{}: nothing to show: {} faces, none with an area", path.string(), flaws.faces));
    }
    p3f::Messages messages(path.string());
    if (flaws.dropped > 0) messages.warn(fmt::format("{} of {} faces have no area, dropped", flaws.dropped, flaws.faces));
    if (flaws.crossing > 0) messages.warn(fmt::format("{} faces have an outline that crosses itself", flaws.crossing));
    builder.scene().warnings = messages.take();
    set_stage(builder);
    return builder.finish();
}

}  // namespace glint
