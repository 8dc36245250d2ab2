// The view statement (`v` or `camera`) of a P3F/NFF file: collected word by word, turned into a camera at the end,
// because the meaning of the lens depends on the dialect, which a later word may give away.
// Knows no other statement. Lengths in scene units, angles in degrees.
#pragma once

#include <cstddef>
#include <optional>

#include <glm/glm.hpp>

#include "core/p3f_lexer.h"
#include "core/scene.h"

namespace glint::p3f {

struct View {
    std::size_t line = 0;  // of `v`, or of its first word; 0 = the file has no view
    std::optional<glm::dvec3> eye, target, up;
    std::optional<double> angle;
    std::optional<glm::ivec2> resolution;
    double aperture = 0.0;  // lens size in pixels of the window through the target; 0 = pinhole
    double focal = 1.0;     // distance of the sharp plane over the distance of the target
    bool renamed = false;   // written with `eye`: a mark of the 2025 dialect
};

[[nodiscard]] bool is_view_word(std::string_view word);
// Consumes the arguments of the view's word `keyword` and stores them.
void read_view_word(View& view, Lexer& in, const Messages& messages, const Token& keyword);
// Sets cameras, width and height of the builder's scene. Without a view the scene's bounds are framed.
void finish_view(const View& view, bool aperture_is_diameter, SceneBuilder& builder, Messages& messages);

}  // namespace glint::p3f
