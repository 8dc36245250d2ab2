#include "core/scene_io.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <new>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

namespace glint {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBuiltinPrefix = "builtin:";
constexpr std::string_view kReadable = ".p3f, .nff, .gltf, .glb, .ply, .ply.gz or builtin:NAME";

std::string ending_of(const fs::path& path) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return ending;
}

std::shared_ptr<const Scene> load_file(const std::string& name, const LoadOptions& options) {
    const fs::path path = name;
    const std::string ending = ending_of(path);
    if (ending == ".p3f" || ending == ".nff") {
        return reader::read_p3f(reader::read_file(path), name, path.parent_path(), options);
    }
    if (ending == ".gltf" || ending == ".glb") return reader::read_gltf(path, options);
    if (ending == ".ply" || (ending == ".gz" && ending_of(path.stem()) == ".ply")) return reader::read_mesh(path);
    if (ending == ".obj") throw SceneError(fmt::format("{}: {} is not supported yet", name, ending));
    const auto& scenes = builtin_scenes();
    if (std::any_of(scenes.begin(), scenes.end(), [&](const BuiltinScene& s) { return s.name == name; })) {
        throw SceneError(fmt::format("{}: not a scene file; did you mean builtin:{}?", name, name));
    }
    throw SceneError(fmt::format("{}: unknown kind of scene, expected {}", name, kReadable));
}

std::shared_ptr<const Scene> load(const std::string& scene, const LoadOptions& options) {
    // A sky box that is replaced need not even exist, so the scene's own is not opened then.
    const bool replaced = options.load_environment && !options.environment.empty();
    LoadOptions own = options;
    own.load_environment = options.load_environment && !replaced;
    const bool builtin = scene.starts_with(kBuiltinPrefix);
    auto loaded = builtin ? reader::make_builtin(scene.substr(kBuiltinPrefix.size())) : load_file(scene, own);
    if (!replaced) return loaded;
    auto copy = std::make_shared<Scene>(*loaded);
    load_cube(copy->environment, options.environment);
    copy->environment.kind = Environment::Kind::cube;
    return copy;
}

}  // namespace

std::shared_ptr<const Scene> load_scene(const std::string& scene, const LoadOptions& options) {
    // Readers let these pass: only here nothing of the scene holds memory any more, and the line can be written.
    try {
        return load(scene, options);
    } catch (const std::bad_alloc&) {
    } catch (const std::length_error&) {
    }
    throw SceneError(fmt::format("{}: not enough memory for this scene", scene));
}

std::string reader::read_file(const fs::path& path, std::size_t limit) {
    const auto refuse = [&](std::string_view reason) { throw SceneError(fmt::format("{}: {}", path.string(), reason)); };
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (status.type() == fs::file_type::not_found) refuse("no such file");
    if (error) refuse(error.message());
    if (fs::is_directory(status)) refuse("is a folder, not a file");
    // A pipe or a device could block or never end.
    if (!fs::is_regular_file(status)) refuse("not a regular file");
    const std::uintmax_t size = fs::file_size(path, error);
    const std::string too_large = fmt::format("larger than {} bytes", limit);
    if (!error && size > limit) refuse(too_large);
    std::ifstream file(path, std::ios::binary);
    if (!file) refuse("cannot be opened");
    // Read in pieces until the end: some regular files (below /proc, or still growing) do not know their size.
    constexpr std::size_t kPiece = std::size_t{1} << 20;
    std::string text;
    while (file) {
        const std::size_t filled = text.size();
        text.resize(filled + kPiece);
        file.read(text.data() + filled, static_cast<std::streamsize>(kPiece));
        text.resize(filled + static_cast<std::size_t>(file.gcount()));
        if (text.size() > limit) refuse(too_large);
    }
    if (file.bad()) refuse("cannot be read");
    return text;
}

}  // namespace glint
