// Every choice a user can make about a picture, as plain comparable data: options, keys, state files and tests share it.
// Knows no scene; what a setting means for a given scene is worked out in render_plan.h.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/scene.h"

namespace glint {

enum class Feature : std::uint32_t { aa, dof, soft, fuzzy, specular, shadows, reflections, refractions };
constexpr std::array<std::string_view, 8> kFeatureNames{"aa",       "dof",     "soft",        "fuzzy",
                                                        "specular", "shadows", "reflections", "refractions"};

// A set of features; the names above are the ones users type.
struct FeatureSet {
    std::uint32_t bits = 0;

    bool operator==(const FeatureSet&) const = default;
    [[nodiscard]] constexpr bool has(Feature f) const { return (bits >> static_cast<std::uint32_t>(f)) & 1u; }
    constexpr void set(Feature f, bool on) {
        const std::uint32_t bit = 1u << static_cast<std::uint32_t>(f);
        bits = on ? bits | bit : bits & ~bit;
    }
    [[nodiscard]] static constexpr FeatureSet all() { return {0xffu}; }
    // specular, shadows, reflections, refractions: one centred ray, nothing random.
    [[nodiscard]] static constexpr FeatureSet whitted() { return {0xf0u}; }
};

enum class Fresnel { exact, schlick };
// Which rays go on from glass: the mirrored and the refracted one, or one of them by chance (then no path divides).
enum class GlassBranches { both, one };
enum class SamplerKind { sobol, jittered, random, regular, joint };
constexpr std::array<std::string_view, 5> kSamplerNames{"sobol", "jittered", "random", "regular", "joint"};
enum class Background { scene, color, environment };

// What decides the samples: two equal RenderSettings on one scene and camera give the same bytes.
struct RenderSettings {
    FeatureSet features = FeatureSet::all();
    Fresnel fresnel = Fresnel::exact;
    SamplerKind sampler = SamplerKind::sobol;
    Background background = Background::scene;
    int depth = 8;  // bounces after the camera ray
    // Branches whose weight (its largest channel) is not above this are not followed (Hall & Greenberg 1983). Biased: each one
    // darkens its sample by at most cutoff times the light along it.
    float cutoff = 0.0f;
    int light_samples = 1;  // points on each area light at every vertex
    GlassBranches glass = GlassBranches::both;
    std::uint64_t seed = 0;
    // Samples go where they take most error away, see adaptive.h; their number is then the mean over pixels.
    bool adaptive = false;
    std::optional<float> light_size;  // half side of the square put around point lights, scene units
    std::optional<float> roughness;   // fuzz radius of every mirror

    bool operator==(const RenderSettings&) const = default;
};

// What only the shown picture depends on, never the samples.
struct DisplaySettings {
    float exposure_ev = 0.0f;  // stops; radiance is multiplied by 2^exposure_ev
    Transfer transfer = Transfer::srgb;

    bool operator==(const DisplaySettings&) const = default;
};

// The features a scene starts with: everything it has data for (aa and the four Whitted ones always).
[[nodiscard]] FeatureSet features_of(const Scene& scene);

}  // namespace glint
