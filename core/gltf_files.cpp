#include "core/gltf_files.h"

#include <fstream>
#include <system_error>

#include "core/contained_path.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

GuardedFolder& guard(void* user) { return *static_cast<GuardedFolder*>(user); }

bool file_exists(const std::string& path, void* user) {
    fs::path ignored;
    return guard(user).resolve(path, ignored);
}

// No `~` and no `$HOME`: a file's words are names, not commands.
std::string expand_nothing(const std::string& path, void*) { return path; }

bool read_whole_file(std::vector<unsigned char>* bytes, std::string* error, const std::string& path, void* user) {
    if (guard(user).read(path, *bytes)) return true;
    if (error != nullptr) *error += guard(user).refusal();
    return false;
}

bool write_nothing(std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; }

}  // namespace

GuardedFolder::GuardedFolder(const fs::path& folder, std::uint64_t limit) : left_(limit) {
    std::error_code error;
    root_ = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
    base_ = root_.string();
}

tinygltf::FsCallbacks GuardedFolder::callbacks() {
    return {&file_exists, &expand_nothing, &read_whole_file, &write_nothing, this};
}

bool GuardedFolder::refuse(const std::string& path, const char* reason) {
    // The shown name is the one that the file used, without the folder that was put before it.
    const bool below = path.starts_with(base_ + "/");
    refusal_ = "`" + (below ? path.substr(base_.size() + 1) : path) + "` " + reason;
    return false;
}

bool GuardedFolder::resolve(const std::string& path, fs::path& canonical) {
    // tinygltf also looks in the working directory of the process; that is nobody's folder. A refusal is not recorded,
    // since the reason found in the right folder is the one worth telling.
    if (base_.empty() || !path.starts_with(base_ + "/")) return false;
    if (path.find('\0') != std::string::npos) return refuse(path, "is not a file name");
    std::error_code error;
    const auto below = path_below(root_, path);
    if (!below) return refuse(path, fs::exists(path, error) ? "lies outside the folder of the scene" : "does not exist");
    canonical = *below;
    if (!fs::is_regular_file(canonical, error)) return refuse(path, "is not a regular file");
    return true;
}

bool GuardedFolder::read(const std::string& path, std::vector<unsigned char>& bytes) {
    fs::path canonical;
    if (!resolve(path, canonical)) return false;
    std::error_code error;
    const std::uintmax_t size = fs::file_size(canonical, error);
    if (error) return refuse(path, "cannot be read");
    if (size > left_) return refuse(path, "is too large");
    bytes.resize(static_cast<std::size_t>(size));
    std::ifstream file(canonical, std::ios::binary);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (!file || file.gcount() != static_cast<std::streamsize>(size)) return refuse(path, "cannot be read");
    left_ -= size;
    return true;
}

}  // namespace glint
