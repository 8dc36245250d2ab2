#include "core/gltf_mesh.h"

#include <cmath>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "core/gltf_material.h"

namespace glint {
namespace {

// What is baked is stored for each use, so a small file can ask for any number of triangles. 2^26 take about 3 GB with their
// vertices.
constexpr std::uint64_t kMaxTriangles = std::uint64_t{1} << 26;
constexpr std::uint64_t kMaxPrimitives = std::uint64_t{1} << 22;
constexpr std::uint64_t kMaxPlacements = std::uint64_t{1} << 22;  // some 0.7 GB, placed
// All uses of a mesh together may bake so many triangles: half a megabyte, and traced faster than through instances.
constexpr std::uint64_t kMostBaked = 4096;

std::uint64_t triangle_count(int mode, std::uint64_t corners) {
    if (mode == TINYGLTF_MODE_TRIANGLES) return corners / 3;
    return corners < 3 ? 0 : corners - 2;
}

// The corners of triangle i, counter-clockwise (glTF 2.0, section 3.7.2.1).
std::array<std::size_t, 3> corners_of(int mode, std::size_t i) {
    switch (mode) {
        case TINYGLTF_MODE_TRIANGLE_STRIP: return {i, i + 1 + i % 2, i + 2 - i % 2};
        case TINYGLTF_MODE_TRIANGLE_FAN: return {i + 1, i + 2, 0};
        default: return {3 * i, 3 * i + 1, 3 * i + 2};
    }
}

// Moves normals: the inverse transpose up to a positive factor, by cofactors, so that a flat scale divides by nothing.
glm::dmat3 normal_transform(const glm::dmat3& linear) {
    double largest = 0.0;
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(linear[i][k]));
    }
    if (!(largest > 0.0)) return glm::dmat3(0.0);
    const glm::dmat3 m = linear / largest;  // products of a scene measured in light years would overflow
    const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    return glm::determinant(m) < 0.0 ? -1.0 * cofactors : cofactors;
}

// A unit vector, or zero where there is no direction: the surface is then shaded flat.
glm::vec3 unit_or_zero(glm::dvec3 n) {
    const double length = std::sqrt(glm::dot(n, n));
    return length > 0.0 && std::isfinite(length) ? glm::vec3(n / length) : glm::vec3(0.0f);
}

// Vertices of one primitive that are already in the scene. A table where the primitive uses a good part of its vertices;
// otherwise (many primitives cut from one big array, or an array without bytes) the work must not grow with the array.
class VertexMap {
public:
    VertexMap(std::size_t vertices, std::size_t corners, bool has_data) {
        if (has_data && vertices / 4 <= corners) table_.assign(vertices, kNone);
    }
    // The slot of vertex i; kNone in it means: not yet.
    std::uint32_t& slot(std::size_t i) {
        if (!table_.empty()) return table_[i];
        return map_.try_emplace(i, kNone).first->second;
    }
    static constexpr std::uint32_t kNone = 0xffffffffu;

private:
    std::vector<std::uint32_t> table_;
    std::unordered_map<std::size_t, std::uint32_t> map_;
};

}  // namespace

struct GltfMeshReader::Part {
    const std::string& place;
    int mode;
    const AccessorView& positions;
    const AccessorView* normals;
    const AccessorView* indices;
    glm::dmat4 world_from_mesh;
    std::uint32_t material;

    [[nodiscard]] std::size_t corners() const { return indices != nullptr ? indices->size() : positions.size(); }
    [[nodiscard]] glm::vec3 position(std::size_t i) const {
        return glm::vec3(glm::dvec3(world_from_mesh * glm::dvec4(positions.vec3(i), 1.0)));
    }
};

GltfMeshReader::GltfMeshReader(const tinygltf::Model& model, SceneBuilder& builder, GltfReport& report)
    : model_(model), builder_(builder), report_(report), views_(model.accessors.size()), uses_(model.meshes.size()) {
    for (const tinygltf::Material& m : model.materials) materials_.push_back(builder.add_material(gltf_material(m, report)));
}

const AccessorView& GltfMeshReader::view(int accessor) {
    auto& slot = views_.at(static_cast<std::size_t>(accessor));
    if (!slot) slot.emplace(model_, accessor, report_);
    return *slot;
}

std::uint32_t GltfMeshReader::material(int index) {
    if (index >= 0) return materials_.at(static_cast<std::size_t>(index));
    if (!default_material_) default_material_ = builder_.add_material(gltf_material(tinygltf::Material(), report_));
    return *default_material_;
}

void GltfMeshReader::announce(int mesh_index, const glm::dmat4& world_from_mesh) {
    if (++placements_ > kMaxPlacements) report_.fail(fmt::format("more than {} meshes, instances counted", kMaxPlacements));
    Uses& uses = uses_.at(static_cast<std::size_t>(mesh_index));
    if (uses.placeable + uses.others == 0) {
        const tinygltf::Mesh& mesh = model_.meshes.at(static_cast<std::size_t>(mesh_index));
        for (const tinygltf::Primitive& primitive : mesh.primitives) {
            const auto position = primitive.attributes.find("POSITION");
            if (primitive.mode < TINYGLTF_MODE_TRIANGLES || position == primitive.attributes.end()) continue;
            const int corners = primitive.indices >= 0 ? primitive.indices : position->second;
            uses.triangles += triangle_count(primitive.mode, model_.accessors.at(static_cast<std::size_t>(corners)).count);
        }
    }
    ++(object_from_world(affine_map(world_from_mesh)) ? uses.placeable : uses.others);
}

void GltfMeshReader::plan() {
    std::uint64_t triangles = 0, primitives = 0;
    for (std::size_t i = 0; i < uses_.size(); ++i) {
        Uses& uses = uses_[i];
        uses.shared = uses.placeable > 1 && uses.placeable > kMostBaked / std::max<std::uint64_t>(uses.triangles, 1);
        const std::uint64_t copies = uses.shared ? 1 + uses.others : uses.placeable + uses.others;
        if (copies == 0) continue;
        primitives += copies * model_.meshes[i].primitives.size();
        if (primitives > kMaxPrimitives)
            report_.fail(fmt::format("more than {} mesh primitives, instances counted", kMaxPrimitives));
        if (uses.triangles > (kMaxTriangles - triangles) / copies)
            report_.fail(fmt::format("more than {} triangles, instances counted", kMaxTriangles));
        triangles += copies * uses.triangles;
    }
}

void GltfMeshReader::add(int mesh, const glm::dmat4& world_from_mesh) {
    const bool shared = uses_.at(static_cast<std::size_t>(mesh)).shared;
    shared&& object_from_world(affine_map(world_from_mesh)) ? place(mesh, world_from_mesh) : bake(mesh, world_from_mesh);
}

void GltfMeshReader::place(int mesh, const glm::dmat4& world_from_mesh) {
    Uses& uses = uses_[static_cast<std::size_t>(mesh)];
    if (!uses.prototype) {
        builder_.begin_prototype();
        bake(mesh, glm::dmat4(1.0));
        uses.prototype = builder_.end_prototype();
    }
    const std::uint32_t stored = builder_.geometry().prototypes[*uses.prototype].count;
    if (stored > 0 && !builder_.place(*uses.prototype, world_from_mesh)) not_finite_ += stored;
}

void GltfMeshReader::bake(int mesh_index, const glm::dmat4& world_from_mesh) {
    const tinygltf::Mesh& mesh = model_.meshes.at(static_cast<std::size_t>(mesh_index));
    for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
        add_primitive(mesh.primitives[i], fmt::format("meshes[{}].primitives[{}]", mesh_index, i), world_from_mesh);
    }
}

void GltfMeshReader::add_primitive(const tinygltf::Primitive& primitive, const std::string& place,
                                   const glm::dmat4& world_from_mesh) {
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) return report_.warn("points and lines are not shown");
    if (!primitive.targets.empty()) report_.warn("morph targets are not supported, meshes keep their rest shape");
    if (primitive.attributes.contains("COLOR_0")) report_.warn("vertex colours are not shown");
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) return report_.warn(place + " has no positions and is not shown");
    const AccessorView& positions = view(position->second);
    if (positions.components() != 3) report_.fail(place + ".POSITION is not an array of VEC3");
    const AccessorView* normals = nullptr;
    if (const auto normal = primitive.attributes.find("NORMAL"); normal != primitive.attributes.end()) {
        normals = &view(normal->second);
        if (normals->components() != 3) report_.fail(place + ".NORMAL is not an array of VEC3");
        if (normals->size() < positions.size()) report_.fail(place + " has fewer normals than positions");
    }
    const AccessorView* indices = nullptr;
    if (primitive.indices >= 0) {
        indices = &view(primitive.indices);
        if (!indices->is_index()) report_.fail(place + ".indices is not an array of unsigned integers");
    }
    const Part part{place, primitive.mode, positions, normals, indices, world_from_mesh, material(primitive.material)};
    if (part.mode == TINYGLTF_MODE_TRIANGLES && part.corners() % 3 != 0)
        report_.warn(place + " ends within a triangle, which is left out");
    add_triangles(part);
}

void GltfMeshReader::add_triangles(const Part& part) {
    const glm::dmat3 linear(part.world_from_mesh);
    const glm::dmat3 normals_to_world = normal_transform(linear);
    const bool mirrored = glm::determinant(linear) < 0.0;
    const std::size_t vertices = part.positions.size();
    VertexMap known(vertices, part.corners(), part.positions.has_data());
    const auto vertex = [&](std::size_t i, glm::vec3 position) {
        std::uint32_t& slot = known.slot(i);
        if (slot == VertexMap::kNone) {
            const glm::vec3 n =
                part.normals != nullptr ? unit_or_zero(normals_to_world * part.normals->vec3(i)) : glm::vec3(0.0f);
            slot = builder_.add_vertex(position, n);
        }
        return slot;
    };

    const std::size_t count = triangle_count(part.mode, part.corners());
    for (std::size_t t = 0; t < count; ++t) {
        std::array<std::size_t, 3> v = corners_of(part.mode, t);
        if (mirrored) std::swap(v[1], v[2]);
        std::array<glm::vec3, 3> p;
        for (std::size_t k = 0; k < 3; ++k) {
            if (part.indices != nullptr) v[k] = part.indices->index(v[k]);
            if (v[k] >= vertices) report_.fail(fmt::format("{}.indices names vertex {} of {}", part.place, v[k], vertices));
            p[k] = part.position(v[k]);
        }
        // Strips are stitched together by triangles that repeat a corner; they are no loss.
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
        // Decided before any vertex is stored: an array without bytes may announce millions of vertices at one point.
        if (valid_triangle(p[0], p[1], p[2])) {
            // One after the other: as arguments of one call they would be stored in an order that compilers choose.
            std::array<std::uint32_t, 3> stored;
            for (std::size_t k = 0; k < 3; ++k) stored[k] = vertex(v[k], p[k]);
            builder_.add_triangle(stored[0], stored[1], stored[2], part.material);
        } else if (valid_vertex(p[0]) && valid_vertex(p[1]) && valid_vertex(p[2])) {
            for (const glm::vec3 corner : p) builder_.mark(corner);
            ++zero_area_;
        } else {
            ++not_finite_;
        }
    }
}

void GltfMeshReader::report_dropped() {
    if (not_finite_ > 0)
        report_.warn(fmt::format("{} triangles with NaN, infinite or huge coordinates are left out", not_finite_));
    if (zero_area_ > 0) report_.warn(fmt::format("{} triangles without area are left out", zero_area_));
}

}  // namespace glint
