#include "core/gltf_report.h"

#include <algorithm>

#include "core/scene.h"

namespace glint {
namespace {

constexpr std::size_t kMaxLine = 400;      // bytes of one message
constexpr std::size_t kMaxWarnings = 100;  // a file of a million unknown words must not become a million lines

// Names come from the file: a line break would fake a second message, an escape sequence would reach the terminal.
std::string one_line(std::string_view text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.remove_suffix(1);
    std::string line(text.substr(0, kMaxLine));
    for (char& c : line) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    }
    if (text.size() > kMaxLine) line += "...";
    return line;
}

}  // namespace

GltfReport::GltfReport(std::string name) : name_(std::move(name)) {}

void GltfReport::fail(std::string_view reason) const { throw SceneError(name_ + ": " + one_line(reason)); }

void GltfReport::warn(std::string_view text) {
    if (warnings_.size() > kMaxWarnings) return;
    std::string line = name_ + ": " + (warnings_.size() < kMaxWarnings ? one_line(text) : "further warnings are left out");
    if (std::find(warnings_.begin(), warnings_.end(), line) == warnings_.end()) warnings_.push_back(std::move(line));
}

}  // namespace glint
