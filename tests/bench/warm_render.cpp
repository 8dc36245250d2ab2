// warm_render SCENE RADIUS THREADS: renders a loaded scene again and again, for tests/bench/pictures, which lets another
// renderer do the same in turns. A line `point|sphere SPP [FILE.pfm]` on stdin is answered by the seconds it took. `sphere`
// puts a ball of RADIUS in the place of the scene's first light, of equal light at a distance. 512x512, direct light only.
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <numbers>
#include <sstream>

#include <fmt/core.h>

#include "core/accelerator_cache.h"
#include "core/scene_io.h"
#include "timed_frame.h"

namespace {

using namespace glint;

constexpr int kSize = 512;

std::shared_ptr<const Scene> under_a_ball(const Scene& scene, float radius) {
    auto copy = std::make_shared<Scene>(scene);
    Light& light = copy->lights.front();
    light.shape = Light::Shape::sphere;
    light.radius = radius;
    light.emission /= std::numbers::pi_v<float> * radius * radius;
    return copy;
}

class WarmRender {
public:
    WarmRender(const char* source, float radius, int threads)
        : point_(load(source)), sphere_(under_a_ball(*point_, radius)), cache_(point_, threads), renderer_(threads, false) {}

    double seconds(bool sphere, int spp, const std::string& file) {
        RenderSettings settings;
        settings.features = FeatureSet();
        settings.features.set(Feature::shadows, true);
        settings.features.set(Feature::aa, spp > 1);
        settings.features.set(Feature::soft, sphere);
        settings.background = Background::color;
        const auto accelerator = cache_.wait(AcceleratorKind::bvh);
        const Progress p =
            bench::render(renderer_, bench::frame_of(sphere ? sphere_ : point_, accelerator, settings, kSize, kSize, spp));
        if (!file.empty()) {
            Image image;
            renderer_.resolve(image);
            write_file_atomically(file, encode_pfm(image));
        }
        return p.seconds;
    }

private:
    static std::shared_ptr<const Scene> load(const char* source) {
        LoadOptions options;
        options.load_environment = false;
        return load_scene(source, options);
    }

    std::shared_ptr<const Scene> point_, sphere_;
    AcceleratorCache cache_;
    Renderer renderer_;
};

}  // namespace

int main(int argc, char** argv) {
    const int threads = argc == 4 ? std::atoi(argv[3]) : 0;
    const float radius = argc == 4 ? std::strtof(argv[2], nullptr) : 0.0f;
    if (threads < 1 || !(radius > 0.0f)) {
        fmt::print(stderr, "usage: warm_render SCENE RADIUS THREADS\n");
        return 2;
    }
    try {
        WarmRender warm(argv[1], radius, threads);
        for (std::string line; std::getline(std::cin, line);) {
            std::istringstream words(line);
            std::string light, file;
            int spp = 1;
            words >> light >> spp >> file;
            fmt::print("{:.6f}\n", warm.seconds(light == "sphere", spp, file));
            std::fflush(stdout);
        }
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 3;
    }
}
