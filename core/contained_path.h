// Where a scene file may look: only below its own folder.
// Knows no format; every reader that follows a name written in a scene asks here. Links are followed before the check.
#pragma once

#include <filesystem>
#include <optional>

namespace glint {

// The canonical path of `name` when that exists and is `folder` (empty: the working directory) or lies below; else nullopt.
// Absolute names, `..` and links are all fine as long as they end up below.
[[nodiscard]] std::optional<std::filesystem::path> path_below(const std::filesystem::path& folder,
                                                              const std::filesystem::path& name);

}  // namespace glint
