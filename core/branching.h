// Where light may have come from at a mirror or at glass: the rays that one branch leaves behind at a surface (Whitted 1980).
// Knows no accelerator and no light source. Invariant: a ray is pushed only with a weight above 0 and within the depth
// limit; what the limits cut off is counted; a part that is compiled out costs not even a random number.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/dimension.h"
#include "core/fresnel.h"
#include "core/render_plan.h"
#include "core/sampler.h"
#include "core/scene.h"
#include "core/surface_point.h"
#include "core/workspace.h"

namespace glint {

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
    Branching(const Scene& scene, const RenderPlan& plan) : scene_(scene), plan_(plan) {}

    static constexpr bool kAny = (kParts & (kernel_part::mirror | kernel_part::glass)) != 0;

    // To be called before the lanes of a wave follow anything: finds what glass does to the rays of all of them.
    void divide_at_glass(Workspace& work) {
        if constexpr ((kParts & kernel_part::glass) == 0) return;
        const Vertices& vertices = work.vertices;
        Glass& g = work.glass;
        std::uint32_t any = 0;
        for (std::size_t k = 0; k < vertices.count; ++k) {
            const std::uint32_t material = vertices.points.material[k];
            g.any[k] = scene_.materials[material].glass ? 1 : 0;
            g.eta[k] = 1.0;
            any |= g.any[k];
            if (g.any[k] == 0) continue;
            const MediumStack& here = work.media[work.met[k]];
            MediumStack& beyond = work.media_beyond[k] = here;
            float ior_from = ior_of(here.top());
            if (vertices.points.outside[k] != 0) {
                beyond.enter(material);
            } else {
                // A surface left from a medium that was never entered: that of the surface itself.
                if (!here.contains(material)) ior_from = ior_of(material);
                beyond.leave(material);
            }
            g.eta[k] = static_cast<double>(ior_from) / static_cast<double>(ior_of(beyond.top()));
        }
        if (any != 0) g.divide(plan_.fresnel, vertices);
    }

    // Puts the ray that the sample of lane `lane` follows next, whose ray has met vertex `k`, into place `to` <= lane. False
    // when there is none. Where there is glass, one branch may be pushed: room must have been made.
    bool follow(Workspace& work, std::size_t k, std::size_t lane, std::size_t to) {
        const Material& m = scene_.materials[work.vertices.points.material[k]];
        From from{work,
                  to,
                  lane,
                  {work.lanes.throughput[0][lane], work.lanes.throughput[1][lane], work.lanes.throughput[2][lane]},
                  work.lanes.path[lane],
                  work.lanes.bounces[lane],
                  false};
        if constexpr ((kParts & kernel_part::mirror) != 0) {
            if (m.has_mirror()) follow_mirror(from, work.vertices.points[k], m, vector_at(work.vertices.wo, k));
        }
        if constexpr ((kParts & kernel_part::glass) != 0) {
            if (m.glass) follow_glass(from, k, m);
        }
        return from.any || resume(work, lane, to);
    }

    // The same where the ray has left the scene: takes up the branch that was left last.
    bool resume(Workspace& work, std::size_t lane, std::size_t to) {
        if constexpr ((kParts & kernel_part::glass) == 0) return false;
        const std::uint32_t node = work.lanes.waiting[lane];
        if (node == BranchStacks::kEmpty) return false;
        const Branch& b = work.stacks[node];
        put(work, to, b.origin, b.direction, b.throughput, b.path, b.bounces);
        work.media[to] = work.stacks.medium(node);
        work.lanes.waiting[lane] = b.below;
        work.stacks.release(node);
        return true;
    }

private:
    // A branch that has met a surface, and where its children go.
    struct From {
        Workspace& work;
        std::size_t to, lane;
        glm::vec3 throughput;
        std::uint32_t path;
        int bounces;
        bool any;  // whether `to` holds a child already
    };

    static void put(Workspace& work, std::size_t to, glm::vec3 origin, glm::vec3 direction, glm::vec3 throughput,
                    std::uint32_t path, int bounces) {
        for (int i = 0; i < 3; ++i) {
            work.rays.origin[i][to] = origin[i];
            work.rays.direction[i][to] = direction[i];
            work.lanes.throughput[i][to] = throughput[i];
        }
        work.rays.t_max[to] = kInfinity;
        work.lanes.path[to] = path;
        work.lanes.bounces[to] = bounces;
    }

    // Leaves the child at `to` for later.
    static void set_aside(Workspace& work, std::size_t to, std::size_t lane) {
        Branch& b = work.stacks.push(work.lanes.waiting[lane]);
        for (int i = 0; i < 3; ++i) {
            b.origin[i] = work.rays.origin[i][to];
            b.direction[i] = work.rays.direction[i][to];
            b.throughput[i] = work.lanes.throughput[i][to];
        }
        b.path = work.lanes.path[to];
        b.bounces = work.lanes.bounces[to];
        work.stacks.medium(work.lanes.waiting[lane]) = work.media[to];
    }

    // Follows the ray unless its weight is 0 or the depth limit is reached. True when it is followed; the last of several
    // children comes first.
    bool follow(From& from, glm::vec3 origin, glm::vec3 direction, glm::vec3 weight, std::uint32_t branch_index,
                std::uint64_t& counter) {
        const glm::vec3 throughput = from.throughput * weight;
        const float largest = std::max(throughput.x, std::max(throughput.y, throughput.z));
        if (!(largest > plan_.cutoff)) {
            if (largest > 0.0f) {
                ++from.work.counts.weight_cut;
                from.work.counts.weight_cut_weight += static_cast<double>(largest);
            }
            return false;
        }
        if (from.bounces >= plan_.depth) {
            ++from.work.counts.depth_cut;
            from.work.counts.depth_cut_weight += static_cast<double>(largest);
            return false;
        }
        ++counter;
        if constexpr ((kParts & kernel_part::glass) != 0) {
            if (from.any) set_aside(from.work, from.to, from.lane);
        }
        put(from.work, from.to, origin, direction, throughput, hash(from.path, branch_index + 0x40000000u), from.bounces + 1);
        from.any = true;
        return true;
    }

    void follow_mirror(From& from, const SurfacePoint& s, const Material& m, glm::vec3 wo) {
        glm::vec3 direction = above(reflect(wo, s.ns), s);
        if constexpr ((kParts & kernel_part::fuzzy) != 0) {
            const float radius = plan_.fuzz(m);
            if (radius > 0.0f) {
                const Sampler sampler = from.work.lanes.sampler(plan_.sampler, from.lane);
                // Uniform in the unit ball: the radius is the cube root of a uniform number.
                const float r = std::cbrt(sampler.interval(hash(from.path, dimension::fuzz_radius)));
                const glm::vec3 offset = r * sphere_from_square(sampler.square(hash(from.path, dimension::fuzz_direction)));
                direction = fuzzy_direction(glm::normalize(direction), s.ng, radius, offset);
            }
        }
        glm::vec3 weight = m.mirror;
        if (m.mirror_fresnel) {
            const float c = 1.0f - std::min(1.0f, glm::dot(wo, s.ns)), c2 = c * c;
            weight += (1.0f - weight) * (c2 * c2 * c);
        }
        if (!follow(from, spawn_origin(s, s.ng), direction, weight, 0, from.work.counts.reflection)) return;
        if constexpr ((kParts & kernel_part::glass) != 0) from.work.media[from.to] = from.work.media[from.lane];
    }

    void follow_glass(From& from, std::size_t k, const Material& m) {
        Workspace& work = from.work;
        const Glass& g = work.glass;
        const MediumStack here = work.media[from.lane];
        double reflected = g.reflected[k];
        if (plan_.one_branch && g.transmits[k] != 0 && reflected > 0.0) {
            // Chosen with the probability that is its weight: what is left of that is 1.
            const Sampler sampler = work.lanes.sampler(plan_.sampler, from.lane);
            const double u = static_cast<double>(sampler.interval(hash(from.path, dimension::glass_branch)));
            reflected = u < reflected ? 1.0 : 0.0;
        }
        if (plan_.refractions && g.transmits[k] != 0 && reflected < 1.0) {
            const glm::vec3 weight = m.transmittance * static_cast<float>(1.0 - reflected);
            if (follow(from, vector_at(g.beyond, k), vector_at(g.refracted, k), weight, 1, work.counts.refraction)) {
                work.media[from.to] = work.media_beyond[k];
            }
        }
        if (plan_.reflections && reflected > 0.0) {
            const glm::vec3 weight(static_cast<float>(reflected));
            if (follow(from, vector_at(g.here, k), vector_at(g.mirrored, k), weight, 0, work.counts.reflection))
                work.media[from.to] = here;
        }
    }

    [[nodiscard]] float ior_of(std::uint32_t medium) const {
        return medium == MediumStack::kAir ? 1.0f : scene_.materials[medium].ior;
    }

    const Scene& scene_;
    const RenderPlan& plan_;
};

}  // namespace glint
