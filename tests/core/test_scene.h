// Little scenes for tests of light transport: materials by what they do, single rays through the real integrator, whole
// pictures through the real renderer, and means with their standard errors.
// Knows no file format and no test. Invariant: every number is fixed by its arguments; nothing depends on time or threads.
#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/radiance.h"
#include "core/renderer.h"
#include "core/tile_kernels.h"
#include "tests/long.h"
#include "tests/materials.h"

namespace glint::test {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double radians(double degrees) { return degrees * kPi / 180.0; }
inline constexpr double degrees(double radians) { return radians * 180.0 / kPi; }

inline Material highlight(float strength, float shininess) {
    Material m = black();
    m.specular = glm::vec3(strength);
    m.shininess = shininess;
    return m;
}
inline Material mirror(float albedo, float roughness = 0.0f) {
    Material m = black();
    m.mirror = glm::vec3(albedo);
    m.roughness = roughness;
    return m;
}
inline Material emitter(float radiance) { return emitter(glm::vec3(radiance)); }

// Lights of brightness 1; `towards` points at the sun.
inline Light point_light(glm::vec3 position, Light::Falloff falloff = Light::Falloff::none) {
    Light light;
    light.position = position;
    light.falloff = falloff;
    return light;
}

inline Light sun(glm::dvec3 towards) {
    Light light;
    light.shape = Light::Shape::directional;
    light.direction = glm::vec3(-glm::normalize(towards));
    return light;
}

// A rectangle 2 x 2 at height 2, facing down, of radiance 1.
inline Light ceiling_light() {
    Light light;
    light.shape = Light::Shape::quad;
    light.falloff = Light::Falloff::physical;
    light.position = {-1, 2, -1};
    light.edge1 = {2, 0, 0};
    light.edge2 = {0, 0, 2};
    return light;
}

// The plane through `point` with the (not necessarily unit) normal `n`.
inline Plane plane_at(glm::dvec3 point, glm::dvec3 n) {
    const glm::dvec3 unit = n / std::sqrt(glm::dot(n, n));
    return {unit, -glm::dot(unit, point)};
}

// Two triangles: corner, corner + a, corner + a + b, corner + b; the front is the side of cross(a, b).
inline void add_quad(SceneBuilder& b, glm::vec3 corner, glm::vec3 edge_a, glm::vec3 edge_b, std::uint32_t material) {
    const std::uint32_t i = b.add_vertex(corner);
    b.add_vertex(corner + edge_a);
    b.add_vertex(corner + edge_a + edge_b);
    b.add_vertex(corner + edge_b);
    b.add_triangle(i, i + 1, i + 2, material);
    b.add_triangle(i, i + 2, i + 3, material);
}

// A box of twelve triangles, wound outwards, or inwards when `flipped`.
inline void add_mesh_box(SceneBuilder& b, glm::vec3 lo, glm::vec3 hi, std::uint32_t material, bool flipped = false) {
    const glm::vec3 d = hi - lo;
    const glm::vec3 x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
    const auto side = [&](glm::vec3 corner, glm::vec3 e, glm::vec3 f) {
        add_quad(b, corner, flipped ? f : e, flipped ? e : f, material);
    };
    side(lo, y, x), side(lo, z, y), side(lo, x, z);
    side(hi, -x, -y), side(hi, -y, -z), side(hi, -z, -x);
}

inline FeatureSet without(FeatureSet set, std::initializer_list<Feature> off) {
    for (const Feature f : off) set.set(f, false);
    return set;
}

// Settings where every pixel is one centred ray and nothing is random.
inline RenderSettings centred() {
    RenderSettings s;
    s.features = FeatureSet::whitted();
    return s;
}

inline CameraPose camera_at(glm::vec3 eye, glm::vec3 target, float view_angle = 45.0f) {
    CameraPose c;
    c.eye = eye;
    c.target = target;
    c.view_angle = view_angle;
    return c;
}

// Every ray that the integrator asks for, in order, beside the answers of brute force.
class RecordingAccelerator {
public:
    explicit RecordingAccelerator(std::shared_ptr<const Geometry> geometry) : inner_(std::move(geometry)) {}
    [[nodiscard]] Hit closest_hit(const Ray& ray) const noexcept {
        rays.push_back(ray);
        return inner_.closest_hit(ray);
    }
    [[nodiscard]] bool occluded(const Ray& ray) const noexcept {
        shadow_rays.push_back(ray);
        return inner_.occluded(ray);
    }
    void closest_hits(const RayBatch& batch, HitBatch& hits) const noexcept { closest_hits_one_by_one(*this, batch, hits); }
    void occluded(const RayBatch& batch, OccludedBatch& result) const noexcept { occluded_one_by_one(*this, batch, result); }
    [[nodiscard]] std::size_t memory_bytes() const { return inner_.memory_bytes(); }

    void forget() { rays.clear(), shadow_rays.clear(); }
    mutable std::vector<Ray> rays, shadow_rays;

private:
    BruteForce inner_;
};
static_assert(Accelerator<RecordingAccelerator>);

// Single rays through the real integrator. `plan` may be changed between rays.
class Probe {
public:
    explicit Probe(std::shared_ptr<const Scene> scene, const RenderSettings& settings = RenderSettings(),
                   const CameraPose& camera = {})
        : plan(plan_render(*scene, settings, camera)),
          scene_(std::move(scene)),
          settings_(settings),
          accelerator_(scene_->geometry) {}

    // Sample `index` of pixel (x, 0). `direction` is made unit.
    glm::dvec3 radiance(glm::vec3 origin, glm::vec3 direction, std::uint64_t index = 0, std::uint32_t x = 0) {
        return radiance(Ray{origin, glm::vec3(glm::normalize(glm::dvec3(direction))), kInfinity}, index, x);
    }
    glm::dvec3 radiance(const Ray& ray, std::uint64_t index = 0, std::uint32_t x = 0) {
        return glm::dvec3(trace({ray, {settings_.sampler, x, 0, index, settings_.seed}},
                                std::make_integer_sequence<unsigned, kernel_part::count>()));
    }
    // Rays of the last call: the camera ray first, then in the order in which they were followed.
    [[nodiscard]] const std::vector<Ray>& rays() const { return accelerator_.rays; }
    [[nodiscard]] const std::vector<Ray>& shadow_rays() const { return accelerator_.shadow_rays; }
    // Counts since the last clear_counts().
    [[nodiscard]] const RayCounts& counts() const { return work_.counts; }
    void clear_counts() { work_.counts = RayCounts(); }

    RenderPlan plan;

private:
    // Through the instance that the plan asks for, as the tile kernels do.
    template <unsigned... kParts>
    glm::vec3 trace(const CameraSample& sample, std::integer_sequence<unsigned, kParts...>) {
        glm::vec3 light(0.0f);
        const auto run = [&](auto part) {
            Integrator<RecordingAccelerator, instance_parts(part)> integrator(*scene_, accelerator_, plan, work_);
            integrator.prepare();
            accelerator_.forget();
            EXPECT_TRUE(integrator.radiance({&sample, 1}, {&light, 1}, [] { return false; }));
        };
        ((plan.kernel == kParts ? run(std::integral_constant<unsigned, kParts>()) : void()), ...);
        return light;
    }

    std::shared_ptr<const Scene> scene_;
    RenderSettings settings_;
    RecordingAccelerator accelerator_;
    Workspace work_;
};

struct Rendered {
    Image image;
    Progress progress;
};

struct RenderSize {
    int width = 64, height = 64, spp = 1;
    int threads = 1;
    AcceleratorKind accelerator = AcceleratorKind::bvh;
};

inline Rendered render(const std::shared_ptr<const Scene>& scene, const CameraPose& camera, const RenderSettings& settings,
                       const RenderSize& size) {
    Frame frame;
    frame.scene = scene;
    frame.accelerator = build_accelerator(size.accelerator, scene->geometry);
    frame.camera = camera;
    frame.settings = settings;
    frame.width = size.width;
    frame.height = size.height;
    frame.spp = size.spp;
    Renderer renderer(size.threads, false);
    renderer.restart(std::move(frame));
    renderer.wait(1e9, nullptr);
    Rendered result;
    renderer.resolve(result.image);
    result.progress = renderer.progress();
    return result;
}

inline bool same_bits(const Image& a, const Image& b) {
    return a.width == b.width && a.height == b.height && a.pixels == b.pixels;
}

inline double mean_of(const Image& image) {
    double sum = 0.0;
    for (const glm::vec3& p : image.pixels) sum += static_cast<double>(p.x);
    return sum / static_cast<double>(image.pixels.size());
}

// A mean and its standard error from independent replicates (other seeds), which is right for any sampler.
struct Estimate {
    double mean = 0.0, standard_error = 0.0;
};

inline Estimate estimate(const std::vector<double>& replicates) {
    const auto n = static_cast<double>(replicates.size());
    Estimate e;
    for (const double x : replicates) e.mean += x / n;
    double squares = 0.0;
    for (const double x : replicates) squares += (x - e.mean) * (x - e.mean);
    e.standard_error = std::sqrt(squares / (n - 1.0) / n);
    return e;
}

// Mean radiance (first channel) of one ray over `samples` samples of each of `replicates` independent pixels.
inline Estimate estimate_radiance(Probe& probe, glm::vec3 origin, glm::vec3 direction, std::uint32_t replicates = 16,
                                  std::uint64_t samples = 1024) {
    std::vector<double> means;
    samples *= scale<std::uint64_t>(1, 100);
    for (std::uint32_t pixel = 0; pixel < replicates; ++pixel) {
        double sum = 0.0;
        for (std::uint64_t k = 0; k < samples; ++k) sum += probe.radiance(origin, direction, k, pixel).x;
        means.push_back(sum / static_cast<double>(samples));
    }
    return estimate(means);
}

// Leaves a measured number in the test report (--gtest_output=xml).
inline void note(const std::string& name, double value) { testing::Test::RecordProperty(name, fmt::format("{:.7g}", value)); }

// The estimate agrees with the closed form within three standard errors (and the rounding of floats), and its standard
// error is small enough for that to mean something.
inline void expect_estimate(const std::string& name, const Estimate& e, double exact, double relative_error = 0.003) {
    note(name, e.mean);
    note(name + "_error", e.standard_error);
    EXPECT_LE(e.standard_error, relative_error * scale(1.0, 0.1) * exact) << name;
    EXPECT_NEAR(e.mean, exact, 3.0 * e.standard_error + 2e-6 * exact) << name;
}

// Uniform numbers in [0, 1) for tests, the same in every run and library.
class Random {
public:
    explicit Random(std::uint32_t seed) : state_(hash(seed)) {}
    double uniform() {
        state_ += 0x9e3779b97f4a7c15ull;
        std::uint64_t z = state_;  // SplitMix64 (Steele, Lea & Flood 2014)
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
    double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
    glm::dvec3 direction() {
        const double z = uniform(-1.0, 1.0), phi = uniform(0.0, 2.0 * kPi), r = std::sqrt(std::max(0.0, 1.0 - z * z));
        return {r * std::cos(phi), r * std::sin(phi), z};
    }

private:
    std::uint64_t state_;
};

}  // namespace glint::test
