// Meshes of a glTF file as triangles of the scene: baked into world space for each node that shows them, or, where that would
// repeat many, stored once and placed.
// Knows no nodes. Invariant: every index is checked against its vertex count before it is used; all triangles stored, and all
// uses of meshes, stay below fixed limits, so nested instances cannot exhaust the memory.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <tiny_gltf.h>
#include <glm/glm.hpp>

#include "core/gltf_accessor.h"
#include "core/gltf_report.h"
#include "core/scene.h"

namespace glint {

class GltfMeshReader {
public:
    // All three must outlive the reader. The materials of `model` are added to `builder` at once.
    GltfMeshReader(const tinygltf::Model& model, SceneBuilder& builder, GltfReport& report);

    // Announces one node's use of meshes[mesh]; to be called for every use, then plan(), before the first add(). SceneError when
    // all uses together are too many, before any work is done.
    void announce(int mesh, const glm::dmat4& world_from_mesh);
    void plan();
    // One node's use of meshes[mesh]. A mirroring transform turns the winding round, so fronts stay fronts.
    void add(int mesh, const glm::dmat4& world_from_mesh);
    // Warns of the triangles that were dropped, with their numbers.
    void report_dropped();

private:
    struct Part;  // what one primitive is made of
    struct Uses {
        std::uint64_t placeable = 0, others = 0;  // how many of each
        std::uint64_t triangles = 0;              // of the mesh, as announced
        bool shared = false;                      // stored once
        std::optional<std::uint32_t> prototype;
    };

    const AccessorView& view(int accessor);
    std::uint32_t material(int index);
    void place(int mesh, const glm::dmat4& world_from_mesh);
    void bake(int mesh, const glm::dmat4& world_from_mesh);
    void add_primitive(const tinygltf::Primitive& primitive, const std::string& place, const glm::dmat4& world_from_mesh);
    void add_triangles(const Part& part);

    const tinygltf::Model& model_;
    SceneBuilder& builder_;
    GltfReport& report_;
    std::vector<std::optional<AccessorView>> views_;  // made at first use: a thousand instances check an accessor once
    std::vector<std::uint32_t> materials_;
    std::optional<std::uint32_t> default_material_;
    std::vector<Uses> uses_;                        // by mesh
    std::uint64_t placements_ = 0;                  // announced so far
    std::uint64_t not_finite_ = 0, zero_area_ = 0;  // dropped
};

}  // namespace glint
