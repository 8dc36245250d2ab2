// What will be computed for one frame: settings and scene brought together, so that nothing is done that does not show.
// Knows no pixels or threads. Invariant: a feature that is off or has nothing to act on leaves no trace in the plan.
#pragma once

#include <cstdint>
#include <vector>

#include "core/medium_stack.h"
#include "core/settings.h"

namespace glint {

// Parts of the integrator that are compiled in or out; each frame runs the kernel with just the parts it needs.
namespace kernel_part {
constexpr unsigned mirror = 1, glass = 2, soft = 4, fuzzy = 8, count = 16;
}

struct RenderPlan {
    unsigned kernel = 0;        // sum of kernel_parts
    std::vector<Light> lights;  // with the extent they have in this frame
    CameraPose camera;          // with the lens it has in this frame
    MediumStack medium;         // what the camera stands in
    float default_fuzz = 0.0f;  // fuzz radius of mirrors without one of their own
    float forced_fuzz = -1.0f;  // fuzz radius of every mirror; negative = not forced
    int depth = 8;
    float cutoff = 0.0f;      // see RenderSettings
    int light_samples = 1;    // the lights' emission is already divided by it
    bool one_branch = false;  // at glass, and only where both rays are wanted
    bool jitter = true, highlights = true, shadows = true, reflections = true, refractions = true;
    bool background_is_color = false;
    Fresnel fresnel = Fresnel::exact;
    SamplerKind sampler = SamplerKind::sobol;
    std::uint64_t seed = 0;

    [[nodiscard]] float fuzz(const Material& m) const {
        return forced_fuzz >= 0.0f ? forced_fuzz : m.roughness > 0.0f ? m.roughness : default_fuzz;
    }
    [[nodiscard]] bool has(unsigned part) const { return (kernel & part) != 0; }
    // Whether two samples of a pixel can differ. If not, one says it all.
    [[nodiscard]] bool stochastic() const { return jitter || camera.lens_radius > 0.0f || random_beyond_camera(); }
    // Whether all that is random in a sample is one point of the unit square.
    [[nodiscard]] bool one_square() const { return !(jitter && camera.lens_radius > 0.0f) && !random_beyond_camera(); }
    [[nodiscard]] bool random_beyond_camera() const { return has(kernel_part::soft) || has(kernel_part::fuzzy) || one_branch; }
};

// Features that are turned on where the scene has no data of its own take scale-free defaults from the scene's first
// camera: lights spread over a square of half side |eye - at|/60 perpendicular to its up, fuzz radius 0.3, lens radius
// |eye - at|/100 focused at the target.
[[nodiscard]] RenderPlan plan_render(const Scene& scene, const RenderSettings& settings, const CameraPose& camera);

// What a feature could act on in this scene; a toggle without it is greyed out.
[[nodiscard]] bool can_act(const Scene& scene, Feature feature);

}  // namespace glint
