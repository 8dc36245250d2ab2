// What the statements of a P3F/NFF file share while one is read. The statements themselves: shapes in p3f_shapes.cpp,
// meshes and polygons in p3f_mesh.cpp, lights in p3f_lights.cpp, materials and backgrounds in p3f_surface.cpp, the view in
// p3f_view.cpp; scene_p3f.cpp runs the loop.
// A statement is called with its word consumed; it consumes its arguments and throws SceneError when they are wrong.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/p3f_lexer.h"
#include "core/p3f_view.h"
#include "core/scene.h"

namespace glint::p3f {

struct Reader {
    Messages& messages;
    Lexer& in;
    SceneBuilder& builder;
    std::filesystem::path folder;  // of the scene; names in the file lead nowhere else

    View view{};
    bool view_open = false;        // inside `v`: its words count even where their numbers are missing
    bool renamed_dialect = false;  // a word of the 2025 hand-out was seen, where the lens size is a diameter
    std::string environment{};     // as `env` names it; empty = none
    std::size_t environment_line = 0;
    Material material{};                            // of the shapes that follow
    std::optional<std::uint32_t> material_index{};  // once a shape has used it
    std::size_t ply_bytes = 0;                      // read so far by `ply`

    [[nodiscard]] std::uint32_t current_material() {
        if (!material_index) material_index = builder.add_material(material);
        return *material_index;
    }
    // A position of the file, parsed and tested as double, as the scene stores it.
    [[nodiscard]] glm::vec3 point(double x, double y, double z) const { return builder.scene().local({x, y, z}); }
};

struct Statement {
    std::string_view word;
    void (*read)(Reader&, const Token&);
};

[[nodiscard]] std::span<const Statement> shape_statements();
[[nodiscard]] std::span<const Statement> mesh_statements();
[[nodiscard]] std::span<const Statement> light_statements();
[[nodiscard]] std::span<const Statement> surface_statements();

}  // namespace glint::p3f
