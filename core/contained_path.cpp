#include "core/contained_path.h"

#include <algorithm>
#include <system_error>

namespace glint {

std::optional<std::filesystem::path> path_below(const std::filesystem::path& folder, const std::filesystem::path& name) {
    std::error_code error;
    const auto root = std::filesystem::canonical(folder.empty() ? "." : folder, error);
    if (error) return std::nullopt;
    const auto path = std::filesystem::canonical(root / name, error);
    if (error) return std::nullopt;
    // Compared part by part: "/scenes2" starts with the letters of "/scenes" but is not below it.
    const auto [in_root, in_path] = std::mismatch(root.begin(), root.end(), path.begin(), path.end());
    if (in_root != root.end()) return std::nullopt;
    return path;
}

}  // namespace glint
