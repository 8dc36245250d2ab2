// Damaged copies of every kind of file that is read, through the doors that users' files take. What still loads is rendered, with
// every feature and from every accelerator, to the same finite picture; what does not is refused in one line.
#include <stb/stb_image_write.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <functional>

#include "core/environment.h"
#include "core/exr.h"
#include "core/image.h"
#include "core/rgbe.h"
#include "tests/core/damage.h"
#include "tests/core/ply_file.h"
#include "tests/core/render_picture.h"
#include "tests/core/rich_files.h"
#include "tests/core/test_scene.h"
#include "tests/long.h"

namespace glint::test {
namespace {

long peak_kib() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
}

// A crash or a hang leaves the damaged file behind, in a folder below the temporary one.
class Fuzz : public GltfTest {
protected:
    // Damages copies of `whole` in turn, each under `name`; `read` reads one or throws a SceneError or an ImageError.
    void damage(const std::string& name, const std::vector<std::string>& whole,
                const std::function<void(const std::filesystem::path&)>& read) const {
        for (const std::string& bytes : whole) EXPECT_NO_THROW(read(write(name, bytes))) << name;
        const long before = peak_kib();
        std::mt19937 random(20240611);
        const int rounds = scale(120, 10000);
        int accepted = 0;
        for (int i = 0; i < rounds && !HasFailure(); ++i) {
            SCOPED_TRACE(fmt::format("{}, round {}", name, i));
            const std::string& other = whole[random() % whole.size()];
            const auto path = write(name, damaged(whole[static_cast<std::size_t>(i) % whole.size()], other, random));
            alarm(100);  // ends what hangs
            try {
                read(path);
                ++accepted;
            } catch (const SceneError& e) {
                expect_one_line(e.what());
            } catch (const ImageError& e) {
                expect_one_line(e.what());
            }
            alarm(0);
        }
        note(name + "_accepted_of_" + std::to_string(rounds), accepted);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
        EXPECT_LT(peak_kib() - before, 256 * 1024) << name << " took memory that no small file needs";
#else
        (void)before;
#endif
    }

    static void read_scene(const std::filesystem::path& path) {
        const auto scene = load_scene(path.string());
        ASSERT_FALSE(scene->cameras.empty());
        const Geometry& g = *scene->geometry;
        for (const auto& t : g.triangles) {
            for (const std::uint32_t i : t) ASSERT_LT(i, g.vertices.size());
        }
        Picture p;
        p.width = 7, p.height = 5, p.threads = 1;
        p.settings.features = FeatureSet::all();
        p.settings.depth = 5;
        Progress progress;
        const Image image = render_picture(scene, p, &progress);
        for (const glm::vec3& c : image.pixels) ASSERT_TRUE(std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z));
        ASSERT_EQ(progress.rays.non_finite, 0u);
        for (const AcceleratorKind kind : {AcceleratorKind::none, AcceleratorKind::grid}) {
            p.accelerator = kind;
            ASSERT_EQ(differing_pixels(image, render_picture(scene, p)), 0u) << static_cast<int>(kind);
        }
    }

private:
    static void expect_one_line(const std::string& message) {
        EXPECT_FALSE(message.empty());
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
};

// Small, with all statements and materials; the sky box and the mesh it names are there.
TEST_F(Fuzz, P3fScenesAreRenderedOrRefused) {
    write("mesh.ply", kQuad);
    std::filesystem::create_directories(folder() / "skybox");
    for (const char* face : {"right", "left", "top", "bottom", "front", "back"}) {
        write(fmt::format("skybox/{}.png", face), std::string("P6 1 1 255\n") + "abc");
    }
    const std::string asset = reader::read_file(std::filesystem::path(GLINT_TESTS) / "../assets/soft_shadow.p3f");
    damage("a.p3f", {std::string(kEveryStatement), asset, std::string(kEveryStatement)}, read_scene);
}

TEST_F(Fuzz, GltfScenesAreRenderedOrRefused) {
    const std::string data = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + bytes_of<std::uint16_t>({0, 1, 2, 0});
    const json plain = triangle(), rich = rich_document(plain);
    json outside = rich, inside = plain;
    outside["buffers"][0]["uri"] = "data.bin";
    inside["buffers"][0]["uri"] =
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=";
    inside["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", 0}, {"SCALE", 0}};
    inside["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 0;
    damage("a.gltf", {outside.dump(), inside.dump()}, read_scene);
    damage("a.glb", {glb(rich, data)}, read_scene);
}

TEST_F(Fuzz, MeshesAreRenderedOrRefused) {
    const std::vector<std::string> whole{kQuad, arrow().text(), arrow().binary(false), arrow().binary(true)};
    damage("a.ply", whole, read_scene);
    damage("a.ply.gz", {gzipped(whole[0]), gzipped(whole[2])}, read_scene);
}

TEST_F(Fuzz, PicturesAreReadOrRefused) {
    Image image{17, 9, {}};
    std::vector<std::uint8_t> grey;
    for (int i = 0; i < 17 * 9; ++i) {
        image.pixels.emplace_back(std::ldexp(1.0f, i % 40 - 20), 0.3f, i % 7 < 4 ? 0.0f : 0.7f);
        grey.push_back(static_cast<std::uint8_t>(i * 37 % 256));
    }
    std::string jpeg;
    stbi_write_jpg_to_func(
        [](void* to, void* bytes, int size) {
            static_cast<std::string*>(to)->append(static_cast<const char*>(bytes), static_cast<std::size_t>(size));
        },
        &jpeg, 17, 9, 1, grey.data(), 80);
    const std::string png = encode_png(to_display(image, {}), Transfer::srgb);
    const auto read = [](const std::filesystem::path& path) {
        const Image back = read_image(path);
        EXPECT_EQ(back.pixels.size(), static_cast<std::size_t>(back.width) * static_cast<std::size_t>(back.height));
    };
    damage("a.pfm", {encode_pfm(image)}, read);
    damage("a.hdr", {encode_rgbe(image)}, read);
    damage("a.exr", {encode_exr(image)}, read);
    damage("a.png", {png}, read);
    damage("a.jpg", {jpeg}, read);
    // As a face of a sky box too.
    for (const char* face : {"left", "top", "bottom", "front", "back"}) write(fmt::format("{}.png", face), png);
    damage("right.jpg", {jpeg, png}, [this](const std::filesystem::path&) {
        Environment sky;
        load_cube(sky, folder());
        EXPECT_EQ(sky.kind, Environment::Kind::cube);
    });
}

}  // namespace
}  // namespace glint::test
