// The words of a command line into Options: every option of every command declared once, with its help and its check.
// Knows no scene and no rule that joins options; parse_options() does. Errors: UsageError.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "app/options.h"

namespace glint {

constexpr std::array<std::string_view, 6> kCommandNames{"view", "render", "compare", "chart", "info", "list"};

// Fills `options`, whose command is set, from the words behind the command. False when only help or version was asked for.
[[nodiscard]] bool fill_options(Options& options, const std::vector<std::string>& words);

}  // namespace glint
