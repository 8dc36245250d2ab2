#include "app/screenshot.h"

#include <cctype>
#include <cstdlib>
#include <system_error>

#include <fmt/format.h>

namespace glint {

std::filesystem::path pictures_folder() {
    for (const char* variable : {"XDG_PICTURES_DIR", "HOME"}) {
        const char* folder = std::getenv(variable);
        std::error_code ignored;
        if (folder != nullptr && std::filesystem::is_directory(folder, ignored)) return folder;
    }
    return ".";
}

std::filesystem::path screenshot_path(const std::filesystem::path& folder, std::string_view scene, std::string_view accelerator,
                                      int spp) {
    std::string name =
        scene.starts_with("builtin:") ? std::string(scene.substr(8)) : std::filesystem::path(scene).stem().string();
    for (char& c : name) {
        const auto code = static_cast<unsigned char>(c);
        if (code < 128 && std::isalnum(code) == 0 && c != '.' && c != '-') c = '_';
    }
    for (int n = 1;; ++n) {
        const std::filesystem::path path = folder / fmt::format("{}_{}_{}spp_{}.png", name, accelerator, spp, n);
        std::error_code error;
        // A folder that cannot be looked into ends the search too; writing then says why.
        if (!std::filesystem::exists(path, error)) return path;
    }
}

void write_screenshot(const std::filesystem::path& path, const Image& image, const DisplaySettings& display) {
    write_file_atomically(path, encode_png(to_display(image, display), display.transfer));
}

}  // namespace glint
