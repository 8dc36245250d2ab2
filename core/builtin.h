// The makers of the built-in scenes, one per recipe; scene_builtin.cpp holds the table that names them.
// Knows no file. Arguments are in range: the table checks what a user types.
// The course's scenes answer as their P3F files do: no falloff, transfer linear. The others are our own.
#pragma once

#include "core/scene.h"

namespace glint::builtin {

[[nodiscard]] SceneBuilder balls(int level);
[[nodiscard]] SceneBuilder mount(int level);
[[nodiscard]] SceneBuilder balls_box();
[[nodiscard]] SceneBuilder dof();
[[nodiscard]] SceneBuilder cornell();

enum class GlassPiece { all, ball, slab, nested, shell };
[[nodiscard]] SceneBuilder glass(GlassPiece what);

// n triangles beside a handful of others; knot and stadium make an odd n even.
[[nodiscard]] SceneBuilder knot(int n);
[[nodiscard]] SceneBuilder stadium(int n);
[[nodiscard]] SceneBuilder soup(int n);
// n instances.
[[nodiscard]] SceneBuilder crowd(int n);

}  // namespace glint::builtin
