// What the glTF reader tells the user: refusals and warnings, each one line that starts with the file's name.
// Knows no glTF. Invariant: a message is one printable line of bounded length, whatever a hostile file put into its strings,
// and the same warning is kept once.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace glint {

class GltfReport {
public:
    explicit GltfReport(std::string name);

    // Throws SceneError `name: reason`.
    [[noreturn]] void fail(std::string_view reason) const;
    // Keeps `name: text` unless it has been said before.
    void warn(std::string_view text);
    [[nodiscard]] std::vector<std::string> take_warnings() { return std::move(warnings_); }

private:
    std::string name_;
    std::vector<std::string> warnings_;
};

}  // namespace glint
