#include "core/vertices.h"

#include <algorithm>

namespace glint {
namespace {

void fill(float (&rows)[3][kRayBatch], std::size_t first, std::size_t last, glm::vec3 v) {
    for (int i = 0; i < 3; ++i) std::fill(rows[i] + first, rows[i] + last, v[i]);
}

// Calls set(first, last, material) for neighbours of one material: mostly there are many.
template <class Set>
void for_each_run(const std::uint32_t* material, std::size_t count, std::span<const Material> materials, Set&& set) {
    for (std::size_t first = 0; first < count;) {
        std::size_t last = first + 1;
        while (last < count && material[last] == material[first]) ++last;
        set(first, last, materials[material[first]]);
        first = last;
    }
}

}  // namespace

void Vertices::set_materials(std::span<const Material> materials, bool highlights) noexcept {
    any_lit = any_highlit = any_emission = false;
    for_each_run(points.material, count, materials, [&](std::size_t first, std::size_t last, const Material& m) {
        const bool shiny = highlights && m.has_highlight(), shows = shiny || m.has_diffuse();
        any_highlit = any_highlit || shiny;
        any_lit = any_lit || shows;
        any_emission = any_emission || m.emission != glm::vec3(0.0f);
        fill(diffuse, first, last, m.diffuse);
        std::fill(lit + first, lit + last, shows ? 1u : 0u);
    });
    // What lies behind the last vertex is computed with, so it must not be too slow to compute with.
    std::fill(lit + count, lit + whole_runs(count), 0u);
    fill(direct, 0, whole_runs(count), glm::vec3(0.0f));
    if (any_highlit) set_highlights(materials);
    if (any_emission) {
        for_each_run(points.material, count, materials,
                     [&](std::size_t first, std::size_t last, const Material& m) { fill(emission, first, last, m.emission); });
    }
}

void Vertices::set_highlights(std::span<const Material> materials) noexcept {
    for_each_run(points.material, count, materials, [&](std::size_t first, std::size_t last, const Material& m) {
        fill(specular, first, last, m.specular);
        std::fill(highlight_scale + first, highlight_scale + last, m.highlight_scale);
        std::fill(shininess + first, shininess + last, m.shininess);
        std::fill(highlit + first, highlit + last, m.has_highlight() ? 1u : 0u);
    });
    std::fill(highlit + count, highlit + whole_runs(count), 0u);
}

}  // namespace glint
