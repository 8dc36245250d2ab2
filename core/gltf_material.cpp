#include "core/gltf_material.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <glm/glm.hpp>

namespace glint {
namespace {

// Fuzz radius over a = roughness^2, fitted against the lobe of GGX (Walter et al. 2007; sampled by visible normals, Heitz
// 2018, weighted with Smith's shadowing): the mean distance between the angles from the mirror direction (Wasserstein 1,
// over a = 0.0025 ... 1 and 0, 30, 60 degrees of incidence) is least at 3.0, where it is 4.4 degrees, at worst 8.
constexpr double kFuzzPerAlpha = 3.0;
// Below this a the highlight of a point light becomes narrower than a pixel is wide; the mirror branch shows what a smooth
// surface reflects, so the exponent stops here (514).
constexpr double kLeastHighlightAlpha = 1.0 / 16.0;

// A number of the file, forced into [lo, hi] with a warning when it lies outside.
double within(double x, double lo, double hi, const char* what, GltfReport& report) {
    if (x >= lo && x <= hi) return x;
    report.warn(fmt::format("{} outside {}..{} is clamped", what, lo, hi));
    return std::isnan(x) ? lo : std::clamp(x, lo, hi);
}

glm::dvec3 color_within(const std::vector<double>& v, const char* what, GltfReport& report) {
    glm::dvec3 color(1.0);
    for (int i = 0; i < 3 && static_cast<std::size_t>(i) < v.size(); ++i)
        color[i] = within(v[static_cast<std::size_t>(i)], 0.0, 1.0, what, report);
    return color;
}

// A number of an extension of this material; `absent` where the file does not say.
double extension_number(const tinygltf::Material& source, const char* extension, const char* key, double absent) {
    const auto found = source.extensions.find(extension);
    if (found == source.extensions.end() || !found->second.IsObject()) return absent;
    const tinygltf::Value& value = found->second.Get(key);
    return value.IsNumber() ? value.GetNumberAsDouble() : absent;
}

void warn_of_missing_parts(const tinygltf::Material& source, GltfReport& report) {
    const auto& pbr = source.pbrMetallicRoughness;
    if (pbr.baseColorTexture.index >= 0) report.warn("base colour textures are not shown, only the factors");
    if (pbr.metallicRoughnessTexture.index >= 0) report.warn("metallic-roughness textures are not shown, only the factors");
    if (source.normalTexture.index >= 0) report.warn("normal maps are not shown");
    if (source.occlusionTexture.index >= 0) report.warn("occlusion textures are not shown");
    if (source.emissiveTexture.index >= 0) report.warn("emissive textures are not shown, such surfaces do not glow");
    if (source.alphaMode == "MASK" || source.alphaMode == "BLEND") {
        report.warn(fmt::format("alphaMode {} is not supported, such surfaces are opaque", source.alphaMode));
    }
}

// The strength that makes the highlight reflect, over the hemisphere and at normal incidence, exactly the specular colour:
// one over the integral of (n.h)^s over directions. With u = cos(theta/2) that is 8 pi * the integral of u^(s+1) from
// 1/sqrt(2) to 1 (in the manner of Giesen 2009, "Phong and Blinn-Phong normalization factors").
double highlight_scale(double exponent) {
    return (exponent + 2.0) / (8.0 * std::numbers::pi * (1.0 - std::pow(2.0, -(exponent + 2.0) / 2.0)));
}

}  // namespace

Material gltf_material(const tinygltf::Material& source, GltfReport& report) {
    warn_of_missing_parts(source, report);
    const auto& pbr = source.pbrMetallicRoughness;
    const glm::dvec3 base = color_within(pbr.baseColorFactor, "baseColorFactor", report);

    Material m;
    m.mirror_fresnel = true;
    if (source.extensions.contains("KHR_materials_unlit")) {
        m.diffuse = m.specular = glm::vec3(0.0f);
        m.emission = glm::vec3(base);
        return m;
    }

    const double metallic = within(pbr.metallicFactor, 0.0, 1.0, "metallicFactor", report);
    const double roughness = within(pbr.roughnessFactor, 0.0, 1.0, "roughnessFactor", report);
    const double transmission =
        (1.0 - metallic) * within(extension_number(source, "KHR_materials_transmission", "transmissionFactor", 0.0), 0.0, 1.0,
                                  "transmissionFactor", report);
    // The extension gives 0 the meaning "reflects everything"; nothing else below 1 is an index of refraction.
    double ior = extension_number(source, "KHR_materials_ior", "ior", 1.5);
    const bool all_reflecting = ior == 0.0;
    if (!all_reflecting) ior = within(ior, 1.0, 100.0, "ior", report);

    const double f0_root = all_reflecting ? 1.0 : (ior - 1.0) / (ior + 1.0);
    const glm::dvec3 f0 = glm::mix(glm::dvec3(f0_root * f0_root), base, metallic);
    const double alpha = roughness * roughness;
    const double highlight_alpha = std::max(alpha, kLeastHighlightAlpha);
    // 2/a^2 - 2 is the exponent of the distribution (Walter et al. 2007, section 5.2). Our highlight carries no n.l; 4 more
    // stand for it, since cos(2x) = cos^4(x) to second order around the mirror direction.
    const double exponent = 2.0 / (highlight_alpha * highlight_alpha) - 2.0 + 4.0;

    m.diffuse = glm::vec3(base * ((1.0 - metallic) * (1.0 - transmission) / std::numbers::pi));
    m.specular = glm::vec3(f0);
    m.shininess = static_cast<float>(exponent);
    m.highlight_scale = static_cast<float>(highlight_scale(exponent));
    m.mirror = glm::vec3(f0);
    m.roughness = static_cast<float>(kFuzzPerAlpha * alpha);
    if (transmission > 0.0) {
        m.glass = true;
        m.ior = static_cast<float>(all_reflecting ? 1.5 : ior);
        m.transmittance = glm::vec3(base * transmission);
        if (!source.extensions.contains("KHR_materials_volume")) report.warn("transmissive thin walls are shown as solid glass");
    }
    if (source.emissiveTexture.index < 0) {
        const glm::dvec3 factor =
            source.emissiveFactor.size() == 3 ? color_within(source.emissiveFactor, "emissiveFactor", report) : glm::dvec3(0.0);
        const double strength = extension_number(source, "KHR_materials_emissive_strength", "emissiveStrength", 1.0);
        m.emission = glm::vec3(factor * within(strength, 0.0, 1.0e9, "emissiveStrength", report));
    }
    return m;
}

}  // namespace glint
