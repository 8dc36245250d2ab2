// The commands that need no window: render, info, list (compare.h has the other). Each returns the program's exit code.
// Data goes to stdout, everything else to stderr. Errors of files and options leave as exceptions for main to word.
#pragma once

#include "app/options.h"

namespace glint {

[[nodiscard]] int run_render(const Options& options);
[[nodiscard]] int run_info(const Options& options);
[[nodiscard]] int run_list();

// Prints the scene's warnings to stderr, the first few unless verbose.
void print_warnings(const Scene& scene, const Options& options);

}  // namespace glint
