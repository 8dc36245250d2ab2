// Where options meet the scene: see Job in options.h.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "app/options.h"
#include "core/accelerator_choice.h"
#include "core/threads.h"

namespace glint {
namespace {

CameraPose chosen_camera(const Options& o, const Scene& scene) {
    const auto index = static_cast<std::size_t>(o.camera_index);
    if (index >= scene.cameras.size()) {
        throw UsageError(fmt::format("--camera-index: {} is too large; {} has {} camera{}", o.camera_index, scene.name,
                                     scene.cameras.size(), scene.cameras.size() == 1 ? "" : "s"));
    }
    CameraPose c = scene.cameras[index];
    if (o.camera_position) c.eye = scene.local(*o.camera_position);
    if (o.camera_focal_point) c.target = scene.local(*o.camera_focal_point);
    if (o.camera_view_up) c.up = *o.camera_view_up;
    if (o.view_angle) c.view_angle = *o.view_angle;
    if (c.eye == c.target) throw UsageError("the camera's position and focal point are the same");
    if (o.aperture) c.lens_radius = *o.aperture;
    if (o.focus) c.focus_distance = *o.focus;
    return c;
}

// A quota of a container, in whole cores (at least one); the number of cores when there is none.
int quota_threads(int cores) {
    std::ifstream in("/sys/fs/cgroup/cpu.max");
    double quota = 0.0, period = 0.0;
    if (!(in >> quota >> period) || !(quota > 0.0) || !(period > 0.0)) return cores;
    return std::clamp(static_cast<int>(quota / period + 0.5), 1, cores);
}

// `--background environment` in a scene that has none: the procedural sky, the right way up, with its sun at the first light.
std::shared_ptr<const Scene> with_sky(const Scene& scene) {
    auto copy = std::make_shared<Scene>(scene);
    copy->environment.kind = Environment::Kind::sky;
    copy->environment.up = scene.world_up();
    copy->environment.sun_direction = copy->environment.up;
    if (!scene.lights.empty()) {
        const Light& l = scene.lights.front();
        const glm::vec3 to = l.shape == Light::Shape::directional ? -l.direction : l.position - scene.cameras.front().target;
        if (to != glm::vec3(0.0f)) copy->environment.sun_direction = glm::normalize(to);
    }
    return copy;
}

}  // namespace

int available_threads() { return quota_threads(usable_processors()); }

std::string default_scene() {
    namespace fs = std::filesystem;
    std::error_code ignored;
    const fs::path binary = fs::read_symlink("/proc/self/exe", ignored).parent_path();
    for (const fs::path& folder :
         {binary / "assets", binary / "../share/glint/assets", fs::path(GLINT_ASSETS), fs::path(GLINT_INSTALLED_ASSETS)}) {
        const fs::path scene = folder / "showpiece.p3f";
        if (fs::is_regular_file(scene, ignored)) return scene.lexically_normal().string();
    }
    return "builtin:balls,level=3";
}

Job prepare_job(const Options& o, const std::string& scene) {
    LoadOptions load;
    load.load_environment = o.settings.background != Background::color;
    load.environment = o.environment;
    Job job;
    job.scene = load_scene(scene, load);
    if (o.settings.background == Background::environment && job.scene->environment.kind == Environment::Kind::color) {
        job.scene = with_sky(*job.scene);
    }
    const Scene& s = *job.scene;
    job.settings = o.settings;
    job.settings.features = features_of(s);
    bool whitted = false;
    if (!o.features.empty()) job.settings.features = edit_features(o.features, job.settings.features, whitted);
    job.display = {o.exposure, o.transfer.value_or(s.transfer)};
    job.camera = chosen_camera(o, s);
    job.width = o.width > 0 ? o.width : s.width;
    job.height = o.height > 0 ? o.height : s.height;
    const int default_spp = o.command == Command::view ? 4096 : s.spp > 0 ? s.spp : 64;
    job.spp = o.spp > 0 ? o.spp : whitted ? 1 : default_spp;
    const int cores = available_threads();
    job.threads = o.threads > 0 ? o.threads : o.threads < 0 ? std::max(1, cores - 1) : cores;

    const auto named = o.accelerator_given ? o.accelerator : accelerator_named(s.accelerator);
    job.accelerator_is_auto = !named.has_value();
    const int crop_width = o.crop ? (*o.crop)[1] - (*o.crop)[0] : job.width;
    const int crop_height = o.crop ? (*o.crop)[3] - (*o.crop)[2] : job.height;
    const RayDemand demand = expected_rays(s, crop_width, crop_height, job.spp, job.threads);
    job.accelerator = named ? *named : automatic_accelerator(s, within(demand, *s.geometry, o.time));
    return job;
}

}  // namespace glint
