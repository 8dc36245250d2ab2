// The only way in which a glTF file reaches other files: tinygltf's file callbacks, fenced in.
// Knows no glTF. Invariant: a file is opened only when its canonical path is a regular file below the scene's folder,
// and all reads of one load together stay below a limit, so `../../etc/passwd`, a device or a huge file do no harm.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <tiny_gltf.h>

namespace glint {

class GuardedFolder {
public:
    // folder: where the glTF file lies; an empty path means the current one. limit: bytes of all reads together.
    GuardedFolder(const std::filesystem::path& folder, std::uint64_t limit);

    // The callbacks point to this object, which must outlive them.
    [[nodiscard]] tinygltf::FsCallbacks callbacks();
    // What tinygltf must be given as the folder of the file.
    [[nodiscard]] const std::string& base() const { return base_; }
    // Why the last file was not handed out; empty when none was refused.
    [[nodiscard]] const std::string& refusal() const { return refusal_; }

    // True, and `canonical` set, when `path` may be read.
    bool resolve(const std::string& path, std::filesystem::path& canonical);
    bool read(const std::string& path, std::vector<unsigned char>& bytes);

private:
    bool refuse(const std::string& path, const char* reason);

    std::string base_;
    std::filesystem::path root_;  // canonical
    std::uint64_t left_;          // bytes that may still be read
    std::string refusal_;
};

}  // namespace glint
