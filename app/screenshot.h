// Where a screenshot goes and how it gets there. Knows no window.
// Invariant: an existing file is never replaced, and there is never half a file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/image.h"

namespace glint {

// $XDG_PICTURES_DIR, else $HOME, else the current folder: the first one that is a folder.
[[nodiscard]] std::filesystem::path pictures_folder();

// `<scene>_<accel>_<spp>spp_<n>.png` in `folder` with the first n >= 1 that is free. What a file name or a shell
// stumbles over in the scene's name becomes an underscore.
[[nodiscard]] std::filesystem::path screenshot_path(const std::filesystem::path& folder, std::string_view scene,
                                                    std::string_view accelerator, int spp);

// The bytes that the window shows, as a PNG. Throws ImageError.
void write_screenshot(const std::filesystem::path& path, const Image& image, const DisplaySettings& display);

}  // namespace glint
