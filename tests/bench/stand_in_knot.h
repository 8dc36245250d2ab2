// A displaced torus knot for as long as there is no builtin:knot; goes when there is one.
// Knows only SceneBuilder. Invariant: the surface is closed and its triangles number about `triangles`.
#pragma once

#include <cstddef>
#include <string_view>

#include "core/scene.h"

namespace glint::bench {

constexpr std::string_view kKnotPrefix = "builtin:knot,n=";
[[nodiscard]] std::shared_ptr<const Scene> stand_in_knot(std::size_t triangles);

}  // namespace glint::bench
