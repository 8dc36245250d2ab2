// Where light may have come from at a mirror or at glass: the rays that one branch leaves behind at a surface (Whitted 1980).
// Knows no accelerator and no light source. Invariant: a ray is pushed only with a weight above 0 and within the depth
// limit; what the limit cuts off is counted; a part that is compiled out costs not even a random number.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/branch_stacks.h"
#include "core/fresnel.h"
#include "core/ray_counts.h"
#include "core/render_plan.h"
#include "core/sampler.h"
#include "core/scene.h"
#include "core/surface_point.h"

namespace glint {

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

template <unsigned kParts>
class Branching {
public:
    Branching(const Scene& scene, const RenderPlan& plan, BranchStacks& stacks, RayCounts& counts)
        : scene_(scene), plan_(plan), stacks_(stacks), counts_(counts) {}

    // The branches a surface can leave behind; as much room must have been made.
    static constexpr std::size_t kMaxChildren = (kParts & kernel_part::glass) != 0 ? 2 : 1;
    static constexpr bool kAny = (kParts & (kernel_part::mirror | kernel_part::glass)) != 0;

    // Replaces the branch `node`, which was the top of its stack and has met `s`, by its children.
    void replace(std::uint32_t& node, const SurfacePoint& s, const Material& m, glm::vec3 wo, const Sampler& sampler) {
        const Branch& branch = stacks_[node];
        std::uint32_t top = branch.below;
        if constexpr ((kParts & kernel_part::mirror) != 0) {
            if (m.has_mirror()) follow_mirror(node, top, s, m, wo, sampler);
        }
        if constexpr ((kParts & kernel_part::glass) != 0) {
            if (m.glass) follow_glass(node, top, s, m, wo);
        }
        stacks_.release(node);
        node = top;
    }

private:
    // Pushes the ray unless its weight is 0 or the depth limit is reached. True when it was pushed.
    bool follow(const Branch& from, std::uint32_t& top, const SurfacePoint& s, glm::vec3 side, glm::vec3 direction,
                glm::vec3 weight, std::uint32_t branch_index, std::uint64_t& counter) {
        const glm::vec3 throughput = from.throughput * weight;
        const float largest = std::max(throughput.x, std::max(throughput.y, throughput.z));
        if (!(largest > 0.0f)) return false;
        if (from.bounces >= plan_.depth) {
            ++counts_.depth_cut;
            counts_.depth_cut_weight += static_cast<double>(largest);
            return false;
        }
        ++counter;
        Branch& to = stacks_.push(top);
        to.origin = spawn_origin(s, side);
        to.direction = direction;
        to.throughput = throughput;
        to.path = hash(from.path, branch_index + 0x40000000u);
        to.bounces = from.bounces + 1;
        return true;
    }

    void follow_mirror(std::uint32_t node, std::uint32_t& top, const SurfacePoint& s, const Material& m, glm::vec3 wo,
                       const Sampler& sampler) {
        const Branch& branch = stacks_[node];
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
        if (!follow(branch, top, s, s.ng, direction, weight, 0, counts_.reflection)) return;
        if constexpr ((kParts & kernel_part::glass) != 0) stacks_.medium(top) = stacks_.medium(node);
    }

    void follow_glass(std::uint32_t node, std::uint32_t& top, const SurfacePoint& s, const Material& m, glm::vec3 wo) {
        const Branch& branch = stacks_[node];
        const MediumStack& here = stacks_.medium(node);
        MediumStack beyond = here;
        float ior_from = ior_of(here.top());
        if (s.outside) {
            beyond.enter(s.material);
        } else {
            // A surface left from a medium that was never entered: that of the surface itself.
            if (!here.contains(s.material)) ior_from = m.ior;
            beyond.leave(s.material);
        }
        const double eta = static_cast<double>(ior_from) / static_cast<double>(ior_of(beyond.top()));
        const double cos_i = std::min(1.0, static_cast<double>(glm::dot(wo, s.ns)));
        const double reflected = plan_.fresnel == Fresnel::exact ? fresnel_dielectric(cos_i, eta) : fresnel_schlick(cos_i, eta);
        if (plan_.refractions && transmitted_cos2(cos_i, eta) > 0.0) {
            const glm::vec3 weight = m.transmittance * static_cast<float>(1.0 - reflected);
            if (follow(branch, top, s, -s.ng, refract(wo, s.ns, eta), weight, 1, counts_.refraction)) {
                stacks_.medium(top) = beyond;
            }
        }
        if (plan_.reflections && reflected > 0.0) {
            const glm::vec3 weight(static_cast<float>(reflected));
            if (follow(branch, top, s, s.ng, above(reflect(wo, s.ns), s), weight, 0, counts_.reflection)) {
                stacks_.medium(top) = here;
            }
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
    const RenderPlan& plan_;
    BranchStacks& stacks_;
    RayCounts& counts_;
};

}  // namespace glint
