// The integrator: light along one camera ray, read top to bottom. Whitted's model (1980) with the samples of
// distribution ray tracing (Cook, Porter & Carpenter 1984).
// Knows no tiles, threads or pixels' sums. Invariant: branches are followed with an explicit stack, so depth is bounded by
// memory alone; what a part that is compiled out would have done costs nothing, not even a random number.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/accelerator.h"
#include "core/fresnel.h"
#include "core/ray_counts.h"
#include "core/render_plan.h"
#include "core/sampler.h"
#include "core/scene.h"
#include "core/surface_point.h"

namespace glint {

// A ray still to be followed.
struct Branch {
    Ray ray;
    glm::vec3 throughput{1.0f};
    MediumStack medium;
    std::uint32_t path = 1;  // names this node of the ray tree; random dimensions hang on it
    int bounces = 0;
};

// What one worker keeps between samples.
struct Workspace {
    std::vector<Branch> stack;
    RayCounts counts;
};

// Random dimensions of a camera ray; those of a path node are hash(path, purpose) with the purposes below.
namespace dimension {
constexpr std::uint32_t pixel = 0, lens = 1;
constexpr std::uint32_t fuzz_direction = 0x80000000u, fuzz_radius = 0x80000001u;  // lights take their index
}  // namespace dimension

// Adds `offset` (in the unit ball) times `radius` to the unit direction `r`. What would go below the surface is mirrored
// back across the tangent plane, so that no energy is lost; a zero sum gives r.
[[nodiscard]] inline glm::vec3 fuzzy_direction(glm::vec3 r, glm::vec3 ng, float radius, glm::vec3 offset) {
    glm::vec3 d = r + radius * offset;
    const float below = glm::dot(d, ng);
    if (below < 0.0f) d -= 2.0f * below * ng;
    const float length2 = glm::dot(d, d);
    return length2 > 0.0f ? d / std::sqrt(length2) : r;
}

template <Accelerator A, unsigned kParts>
class Integrator {
public:
    Integrator(const Scene& scene, const A& accelerator, const RenderPlan& plan, Workspace& workspace)
        : scene_(scene), accelerator_(accelerator), plan_(plan), work_(workspace) {}

    [[nodiscard]] glm::vec3 radiance(const Ray& camera_ray, const Sampler& sampler) {
        ++work_.counts.camera;
        work_.stack.clear();
        work_.stack.push_back({camera_ray, glm::vec3(1.0f), plan_.medium, 1, 0});
        glm::vec3 sum(0.0f);
        while (!work_.stack.empty()) {
            const Branch branch = work_.stack.back();
            work_.stack.pop_back();
            const Hit hit = accelerator_.closest_hit(branch.ray);
            if (!hit.found()) {
                sum += branch.throughput * background(branch.ray.direction);
                continue;
            }
            const SurfacePoint s = surface_point(scene_, branch.ray, hit);
            const Material& m = scene_.materials[s.material];
            const glm::vec3 wo = -branch.ray.direction;
            sum += branch.throughput * (m.emission + direct_light(s, m, wo, branch.path, sampler));
            if constexpr ((kParts & kernel_part::mirror) != 0) {
                if (m.has_mirror()) follow_mirror(branch, s, m, wo, sampler);
            }
            if constexpr ((kParts & kernel_part::glass) != 0) {
                if (m.glass) follow_glass(branch, s, m, wo);
            }
        }
        return sum;
    }

private:
    [[nodiscard]] glm::vec3 background(glm::vec3 d) const {
        return plan_.background_is_color ? scene_.environment.color : scene_.environment.radiance(d);
    }

    // Blinn-Phong (Blinn 1977) under every light, one shadow ray each and only where the light would show.
    [[nodiscard]] glm::vec3 direct_light(const SurfacePoint& s, const Material& m, glm::vec3 wo, std::uint32_t path,
                                         const Sampler& sampler) {
        const bool highlight = plan_.highlights && m.has_highlight();
        glm::vec3 sum(0.0f);
        if (!highlight && !m.has_diffuse()) return sum;
        for (std::uint32_t i = 0; i < plan_.lights.size(); ++i) {
            const Light& light = plan_.lights[i];
            glm::vec2 u(0.5f);
            if constexpr ((kParts & kernel_part::soft) != 0) {
                if (light.has_area()) u = sampler.square(hash(path, i));
            }
            const LightSample l = sample_light(light, s.p, u);
            const float n_l = glm::dot(s.ns, l.wi);
            // Both terms need the light above the surface; a highlight on the dark side is a classic slip.
            if (!(n_l > 0.0f) || !(glm::dot(s.ng, l.wi) > 0.0f)) continue;
            glm::vec3 reflectance = m.diffuse * n_l;
            if (highlight) {
                const glm::vec3 h = wo + l.wi;
                const float h2 = glm::dot(h, h);
                const float n_h = h2 > 0.0f ? glm::dot(s.ns, h) / std::sqrt(h2) : 0.0f;
                if (n_h > 0.0f) reflectance += m.specular * (m.highlight_scale * std::pow(n_h, m.shininess));
            }
            const glm::vec3 light_in = l.arriving * reflectance;
            if (light_in == glm::vec3(0.0f) || (plan_.shadows && shadowed(s, light, l))) continue;
            sum += light_in;
        }
        return sum;
    }

    [[nodiscard]] bool shadowed(const SurfacePoint& s, const Light& light, const LightSample& l) {
        ++work_.counts.shadow;
        Ray ray;
        ray.origin = spawn_origin(s, s.ng);
        if (l.at_infinity) {
            ray.direction = l.wi;
        } else {
            ray.direction = l.point - ray.origin;
            ray.t_max = shadow_reach(light, ray.origin, ray.direction);
        }
        return accelerator_.occluded(ray);
    }

    // Pushes the ray unless its weight is 0 or the depth limit is reached; the latter is counted.
    void follow(const Branch& from, const SurfacePoint& s, glm::vec3 side, glm::vec3 direction, glm::vec3 weight,
                const MediumStack& medium, std::uint32_t branch_index, std::uint64_t& counter) {
        const glm::vec3 throughput = from.throughput * weight;
        const float largest = std::max(throughput.x, std::max(throughput.y, throughput.z));
        if (!(largest > 0.0f)) return;
        if (from.bounces >= plan_.depth) {
            ++work_.counts.depth_cut;
            work_.counts.depth_cut_weight += static_cast<double>(largest);
            return;
        }
        ++counter;
        work_.stack.push_back({Ray{spawn_origin(s, side), direction, kInfinity}, throughput, medium,
                               hash(from.path, branch_index + 0x40000000u), from.bounces + 1});
    }

    void follow_mirror(const Branch& branch, const SurfacePoint& s, const Material& m, glm::vec3 wo, const Sampler& sampler) {
        glm::vec3 direction = above(reflect(wo, s.ns), s);
        if constexpr ((kParts & kernel_part::fuzzy) != 0) {
            const float radius = plan_.fuzz(m);
            if (radius > 0.0f) {
                // Uniform in the unit ball: the radius is the cube root of a uniform number.
                const float r = std::cbrt(sampler.interval(hash(branch.path, dimension::fuzz_radius)));
                const glm::vec3 offset = r * sphere_from_square(sampler.square(hash(branch.path, dimension::fuzz_direction)));
                direction = fuzzy_direction(glm::normalize(direction), s.ng, radius, offset);
            }
        }
        glm::vec3 weight = m.mirror;
        if (m.mirror_fresnel) {
            const float c = 1.0f - std::min(1.0f, glm::dot(wo, s.ns)), c2 = c * c;
            weight += (1.0f - weight) * (c2 * c2 * c);
        }
        follow(branch, s, s.ng, direction, weight, branch.medium, 0, work_.counts.reflection);
    }

    void follow_glass(const Branch& branch, const SurfacePoint& s, const Material& m, glm::vec3 wo) {
        MediumStack beyond = branch.medium;
        float ior_from = ior_of(branch.medium.top());
        if (s.outside) {
            beyond.enter(s.material);
        } else {
            // A surface left from a medium that was never entered: that of the surface itself.
            if (!branch.medium.contains(s.material)) ior_from = m.ior;
            beyond.leave(s.material);
        }
        const double eta = static_cast<double>(ior_from) / static_cast<double>(ior_of(beyond.top()));
        const double cos_i = std::min(1.0, static_cast<double>(glm::dot(wo, s.ns)));
        const double reflected = plan_.fresnel == Fresnel::exact ? fresnel_dielectric(cos_i, eta) : fresnel_schlick(cos_i, eta);
        if (plan_.refractions && transmitted_cos2(cos_i, eta) > 0.0) {
            const glm::vec3 weight = m.transmittance * static_cast<float>(1.0 - reflected);
            follow(branch, s, -s.ng, refract(wo, s.ns, eta), weight, beyond, 1, work_.counts.refraction);
        }
        if (plan_.reflections && reflected > 0.0) {
            follow(branch, s, s.ng, above(reflect(wo, s.ns), s), glm::vec3(static_cast<float>(reflected)), branch.medium, 0,
                   work_.counts.reflection);
        }
    }

    // An interpolated normal can mirror a ray into the surface; it is then mirrored back across the tangent plane.
    [[nodiscard]] static glm::vec3 above(glm::vec3 direction, const SurfacePoint& s) {
        const float below = glm::dot(direction, s.ng);
        return below < 0.0f ? direction - 2.0f * below * s.ng : direction;
    }

    [[nodiscard]] float ior_of(std::uint32_t medium) const {
        return medium == MediumStack::kAir ? 1.0f : scene_.materials[medium].ior;
    }

    const Scene& scene_;
    const A& accelerator_;
    const RenderPlan& plan_;
    Workspace& work_;
};

}  // namespace glint
