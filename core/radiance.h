// The integrator: light along camera rays, many samples in lockstep, read top to bottom. Whitted's model (1980) with the
// samples of distribution ray tracing (Cook, Porter & Carpenter 1984); batches as in Boulos et al. 2007, "Packet-based
// Whitted and Distribution Ray Tracing".
// Knows no tiles, threads or pixels' sums. Invariant: each sample follows its branches depth first and adds its light in that
// order, so the answer does not depend on which samples share a batch, to the bit.
#pragma once

#include <cstdint>
#include <span>

#include "accel/accelerator.h"
#include "core/branching.h"
#include "core/direct_light.h"
#include "core/workspace.h"

namespace glint {

// What the rays of a wave have in common. Wave 0 are the camera rays, wave 1 the first bounces of the same lanes: of
// neighbours, still alike unless they are fuzzy. Later each lane follows branches of its own.
[[nodiscard]] constexpr RayOrder order_of_wave(int wave, bool lens, bool fuzzy) {
    if (wave == 0) return lens ? RayOrder::coherent : RayOrder::common_origin;
    return wave == 1 && !fuzzy ? RayOrder::coherent : RayOrder::divergent;
}

// The same of the shadow rays of a wave towards one light.
[[nodiscard]] constexpr RayOrder order_of_shadows(int wave, bool start_at_light) {
    if (start_at_light) return RayOrder::common_origin;
    return wave < 2 ? RayOrder::coherent : RayOrder::divergent;
}

template <Accelerator A, unsigned kParts>
class Integrator {
public:
    Integrator(const Scene& scene, const A& accelerator, const RenderPlan& plan, Workspace& workspace)
        : scene_(scene),
          accelerator_(accelerator),
          plan_(plan),
          work_(workspace),
          branching_(scene, plan, workspace.stacks, workspace.counts) {}

    // To be called once for each plan and workspace, before radiance().
    void prepare() { work_.shadow_origins.decide(scene_.geometry, plan_.lights, accelerator_); }

    // The light along each camera ray; at most kRayBatch of them. Neighbours in `samples` should be neighbours in the
    // picture. `stop()` is asked before each wave; false, and no answer, when it said so.
    template <class Stop>
    [[nodiscard]] bool radiance(std::span<const CameraSample> samples, std::span<glm::vec3> result, Stop&& stop) {
        start(samples);
        for (int wave = 0; !work_.lanes.empty(); ++wave) {
            if (stop()) return false;
            trace(order_of_wave(wave, plan_.camera.lens_radius > 0.0f, (kParts & kernel_part::fuzzy) != 0));
            meet_surfaces();
            for (std::uint32_t i = 0; i < plan_.lights.size(); ++i) {
                add_light(i, wave);
            }
            go_on();
            retire(result);
        }
        return true;
    }

private:
    void start(std::span<const CameraSample> samples) {
        work_.counts.camera += samples.size();
        work_.stacks.clear();
        work_.stacks.make_room(samples.size());
        work_.lanes.clear();
        for (const CameraSample& sample : samples) {
            Lane& lane = work_.lanes.add();
            lane.sampler = sample.sampler;
            lane.sum = glm::vec3(0.0f);
            lane.top = BranchStacks::kEmpty;
            lane.sample = static_cast<std::uint32_t>(work_.lanes.size() - 1);
            Branch& branch = work_.stacks.push(lane.top);
            branch.origin = sample.ray.origin;
            branch.direction = sample.ray.direction;
            branch.throughput = glm::vec3(1.0f);
            branch.path = 1;
            branch.bounces = 0;
            if constexpr ((kParts & kernel_part::glass) != 0) work_.stacks.medium(lane.top) = plan_.medium;
        }
    }

    // Follows the top branch of every lane to the first surface.
    void trace(RayOrder order) {
        work_.rays.clear(order);
        for (const Lane& lane : work_.lanes) {
            const Branch& branch = work_.stacks[lane.top];
            work_.rays.push({branch.origin, branch.direction, kInfinity});
        }
        accelerator_.closest_hits(work_.rays, work_.hits);
    }

    // Adds the background to lanes whose ray has left the scene, and lists the vertices of the others.
    void meet_surfaces() {
        work_.met.clear();
        for (std::uint32_t i = 0; i < work_.lanes.size(); ++i) {
            if (work_.hits.primitive[i] != kNoPrimitive) {
                work_.met.add() = i;
                continue;
            }
            Lane& lane = work_.lanes[i];
            const Branch& branch = work_.stacks[lane.top];
            lane.sum += branch.throughput * background(branch.direction);
            const std::uint32_t below = branch.below;
            work_.stacks.release(lane.top);
            lane.top = below;
        }
        find_surface_points(scene_, work_.rays, work_.hits, work_.met.all(), work_.points);
        work_.vertices.clear();
        for (const std::uint32_t i : work_.met) {
            const Material& m = scene_.materials[work_.points.material[work_.vertices.size()]];
            Vertex& v = work_.vertices.add();
            v.wo = -glm::vec3(work_.rays.direction[0][i], work_.rays.direction[1][i], work_.rays.direction[2][i]);
            v.material = &m;
            v.highlight = plan_.highlights && m.has_highlight();
            v.lit = v.highlight || m.has_diffuse();
            v.direct = glm::vec3(0.0f);
        }
    }

    [[nodiscard]] glm::vec3 background(glm::vec3 d) const {
        return plan_.background_is_color ? scene_.environment.color : scene_.environment.radiance(d);
    }

    // Adds light i to all vertices that it reaches, with one shadow ray each and only where it would show.
    void add_light(std::uint32_t i, int wave) {
        const Light& light = plan_.lights[i];
        const bool at_light = work_.shadow_origins.at_light(i);
        const bool plain = is_plain_point(light);
        RayBatch& rays = work_.shadow_rays;
        rays.clear(order_of_shadows(wave, at_light));
        for (std::uint32_t k = 0; k < work_.vertices.size(); ++k) {
            Vertex& v = work_.vertices[k];
            if (!v.lit) continue;
            const SurfacePoint s = work_.points[k];
            glm::vec2 u(0.5f);
            if constexpr ((kParts & kernel_part::soft) != 0) {
                const Lane& lane = work_.lanes[work_.met[k]];
                if (light.has_area()) u = lane.sampler.square(hash(work_.stacks[lane.top].path, i));
            }
            const LightSample l = plain ? sample_plain_point(light, s.p) : sample_light(light, s.p, u);
            const glm::vec3 light_in = reflected_light(l, s, *v.material, v.wo, v.highlight);
            if (light_in == glm::vec3(0.0f)) continue;
            if (!plan_.shadows) {
                v.direct += light_in;
                continue;
            }
            const auto n = static_cast<std::size_t>(rays.count);
            work_.shadow_light[n] = light_in;
            work_.shadow_vertex[n] = k;
            rays.push(shadow_ray(light, l, s, at_light));
        }
        if (rays.count == 0) return;
        work_.counts.shadow += static_cast<std::uint64_t>(rays.count);
        accelerator_.occluded(rays, work_.blocked);
        for (std::size_t n = 0; n < static_cast<std::size_t>(rays.count); ++n) {
            if (!work_.blocked[n]) work_.vertices[work_.shadow_vertex[n]].direct += work_.shadow_light[n];
        }
    }

    // Adds each vertex's light to its lane, and puts the branches that go on from there in place of the one that came.
    void go_on() {
        work_.stacks.make_room(work_.vertices.size() * Branching<kParts>::kMaxChildren);
        for (std::uint32_t k = 0; k < work_.vertices.size(); ++k) {
            const Vertex& v = work_.vertices[k];
            Lane& lane = work_.lanes[work_.met[k]];
            lane.sum += work_.stacks[lane.top].throughput * (v.material->emission + v.direct);
            branching_.replace(lane.top, work_.points[k], *v.material, v.wo, lane.sampler);
        }
    }

    // Hands out the sums of lanes without branches and closes the ranks.
    void retire(std::span<glm::vec3> result) {
        std::size_t kept = 0;
        for (const Lane& lane : work_.lanes) {
            if (lane.top == BranchStacks::kEmpty)
                result[lane.sample] = lane.sum;
            else
                work_.lanes[kept++] = lane;
        }
        work_.lanes.keep(kept);
    }

    const Scene& scene_;
    const A& accelerator_;
    const RenderPlan& plan_;
    Workspace& work_;
    Branching<kParts> branching_;
};

}  // namespace glint
