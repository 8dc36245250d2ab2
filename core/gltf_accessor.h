// One glTF accessor as checked numbers: the only code that turns file bytes into vertices and indices.
// Knows no meshes. Invariant: once constructed, every element below size() can be read; ranges were checked in
// 64-bit arithmetic that cannot overflow, and the replacements of a sparse accessor are applied.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <tiny_gltf.h>
#include <glm/glm.hpp>

#include "core/gltf_report.h"

namespace glint {

class AccessorView {
public:
    // `accessor` is a valid index; the view points into `model`. SceneError names what is wrong with the accessor.
    AccessorView(const tinygltf::Model& model, int accessor, const GltfReport& report);

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] int components() const { return components_; }
    // False when the accessor has no bytes of its own: all zero, apart from sparse replacements.
    [[nodiscard]] bool has_data() const { return data_ != nullptr; }
    // Unsigned integers, one each: what may serve as indices.
    [[nodiscard]] bool is_index() const;

    // Normalised integers are mapped to [0, 1] or [-1, 1] (glTF 2.0, section 3.11), others keep their value.
    [[nodiscard]] double component(std::size_t i, int c) const;
    [[nodiscard]] glm::dvec3 vec3(std::size_t i) const { return {component(i, 0), component(i, 1), component(i, 2)}; }
    [[nodiscard]] std::uint32_t index(std::size_t i) const { return static_cast<std::uint32_t>(component(i, 0)); }

private:
    void read_sparse(const tinygltf::Model& model, const tinygltf::Accessor& accessor, std::size_t element,
                     const std::string& place, const GltfReport& report);

    const unsigned char* data_ = nullptr;
    std::size_t stride_ = 0, size_ = 0;
    int components_ = 0, component_type_ = 0;
    std::size_t component_size_ = 0;
    bool normalized_ = false;
    std::vector<std::uint32_t> sparse_indices_;  // ascending
    const unsigned char* sparse_values_ = nullptr;
};

}  // namespace glint
