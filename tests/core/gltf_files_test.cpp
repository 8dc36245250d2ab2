// What a glTF file may be made of, and which other files it may reach: containers, buffers, pictures.
#include <sys/stat.h>

#include "gltf_fixture.h"

namespace glint::test {
namespace {

namespace fs = std::filesystem;

class GltfFiles : public GltfTest {
protected:
    json with_uri(const std::string& uri) const {
        json d = triangle();
        d["buffers"][0]["uri"] = uri;
        return d;
    }
};

TEST_F(GltfFiles, FilesThatAreNoneAreRefused) {
    expect_refused(folder() / "missing.gltf", "no such file");
    expect_refused(folder(), "folder");
    expect_refused(write("empty.gltf", ""), "empty");
    expect_refused(write("text.gltf", "What is this?"), "not JSON");
    expect_refused(write("half.gltf", R"({"asset": {"version": "2.0"}, "nodes": [)"), "not JSON");
    expect_refused(write("list.gltf", "[1, 2, 3]"), "not an object");
    expect_refused(write("binary.gltf", std::string("\x7f"
                                                    "ELF\0\1\2\3",
                                                    8)),
                   "not JSON");
    expect_refused(write("old.gltf", R"({"asset": {"version": "1.0"}})"), "1.0");
    expect_refused(write("none.gltf", "{}"), "version");
    expect_refused(write("deep.gltf", std::string(1000000, '[')), "nested");
    expect_refused(write("huge.gltf", R"({"asset": {"version": "2.0"}, "x": 1e999})"), "not JSON");
}

TEST_F(GltfFiles, OtherFilesAreReadOnlyBelowTheFolderOfTheScene) {
    fs::create_directories(folder() / "inside");
    write("secret.bin", std::string(44, 'x'));
    const auto expect_outside = [&](const std::string& uri, const std::string& reason) {
        json d = with_uri(uri);
        expect_refused(write("inside/scene.gltf", d.dump()), reason);
    };
    expect_outside("../secret.bin", "outside");
    expect_outside("a/../../secret.bin", "does not exist");
    expect_outside("%2e%2e/secret.bin", "outside");
    expect_outside("/etc/passwd", "does not exist");
    fs::create_symlink(folder() / "secret.bin", folder() / "inside" / "link.bin");
    expect_outside("link.bin", "outside");
    expect_outside(".", "not a regular file");
    expect_outside("http://example.com/data.bin", "does not exist");
    expect_outside(std::string("a\0b", 3), "is not a file name");
}

TEST_F(GltfFiles, TheWorkingDirectoryIsNotSearched) {
    fs::create_directories(folder() / "elsewhere");
    write("elsewhere/only_here.bin", std::string(44, '\0'));
    const fs::path before = fs::current_path();
    fs::current_path(folder() / "elsewhere");
    expect_refused(with_uri("only_here.bin"), "does not exist");
    fs::current_path(before);
}

TEST_F(GltfFiles, FoldersPipesAndHugeFilesAreNoBuffers) {
    fs::create_directories(folder() / "sub");
    expect_refused(with_uri("sub"), "not a regular file");
    ASSERT_EQ(mkfifo((folder() / "pipe").c_str(), 0600), 0);
    expect_refused(with_uri("pipe"), "not a regular file");
    write("large.bin", "");
    fs::resize_file(folder() / "large.bin", std::uintmax_t{3} << 30);  // sparse: takes no space
    expect_refused(with_uri("large.bin"), "too large");
    expect_refused(with_uri("missing.bin"), "does not exist");
    expect_refused(with_uri("data:application/octet-stream;base64,AAAA"), "");
    json d = triangle();
    d["buffers"][0].erase("uri");
    expect_refused(d, "buffers[0] has no uri");
    d = triangle();
    d["buffers"][0]["byteLength"] = 45;
    expect_refused(d, "size mismatch");
}

TEST_F(GltfFiles, BuffersTogetherAreLimited) {
    json d = triangle();
    d["buffers"][0]["byteLength"] = std::uint64_t{1} << 40;
    expect_refused(d, "buffers hold more");
    d["buffers"] = json::array();
    for (int i = 0; i < 5; ++i) d["buffers"].push_back({{"byteLength", 1u << 29}, {"uri", "data.bin"}});
    expect_refused(d, "buffers hold more");
    d["buffers"] = {{{"byteLength", 0}, {"uri", "data.bin"}}};
    expect_refused(d, "byteLength is 0");
}

TEST_F(GltfFiles, PicturesNeverStopAModel) {
    for (const char* uri : {"missing.png", "../../etc/passwd", "data:image/png;base64,AAAA", "broken.png"}) {
        SCOPED_TRACE(uri);
        json d = triangle();
        // A header that promises 65535 x 65535 pixels.
        write("broken.png", std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\xff\xff\0\0\xff\xff\x08\6\0\0\0", 29));
        d["images"] = {{{"uri", uri}}};
        d["textures"] = {{{"source", 0}}};
        d["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
        d["meshes"][0]["primitives"][0]["material"] = 0;
        const auto scene = load(d);
        EXPECT_EQ(scene->geometry->triangles.size(), 1u);
        EXPECT_TRUE(warned(*scene, "base colour textures"));
    }
    json d = triangle();
    d["images"] = {{{"bufferView", 0}, {"mimeType", "image/png"}}};
    d["bufferViews"][0]["byteOffset"] = 0;
    EXPECT_EQ(load(d)->geometry->triangles.size(), 1u);
}

TEST_F(GltfFiles, GlbChunksThatLieAreRefused) {
    json d = triangle();
    d["buffers"][0].erase("uri");
    const std::string data = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + bytes_of<std::uint16_t>({0, 1, 2, 0});
    const std::string whole = glb(d, data);
    EXPECT_EQ(read(write("a.glb", whole))->geometry->triangles.size(), 1u);
    for (std::size_t n = 0; n < whole.size(); ++n) {
        SCOPED_TRACE(n);
        EXPECT_THROW((void)read(write("a.glb", whole.substr(0, n))), SceneError);
    }
    // The last chunk claims the eight bytes of its own header once more: past the end of the file.
    std::string longer = whole;
    const std::size_t chunk = whole.size() - data.size() - 8;
    longer[chunk] = static_cast<char>(data.size() + 8);
    expect_refused(write("a.glb", longer), "longer than the file");
    d["buffers"].push_back({{"byteLength", 44}});
    expect_refused(write("a.glb", glb(d, data)), "buffers[1] has no uri");
    d["buffers"].erase(1);
    d["buffers"][0]["byteLength"] = 0;
    expect_refused(write("a.glb", glb(d, data)), "byteLength is 0");
    d["buffers"][0]["byteLength"] = 48;
    expect_refused(write("a.glb", glb(d, data)), "byteLength");
    expect_refused(write("a.glb", glb(triangle(), "").substr(0, 12) + std::string(2000, '\0')), "JSON");
}

}  // namespace
}  // namespace glint::test
