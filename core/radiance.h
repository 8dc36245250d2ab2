// The integrator: light along camera rays, many samples in lockstep, read top to bottom. Whitted's model (1980) with the
// samples of distribution ray tracing (Cook, Porter & Carpenter 1984); batches as in Boulos et al. 2007, "Packet-based
// Whitted and Distribution Ray Tracing".
// Knows no tiles, threads or pixels' sums. Invariant: each sample follows its branches depth first and adds its light in that
// order, so the answer does not depend on which samples share a batch, to the bit.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
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
        : scene_(scene), accelerator_(accelerator), plan_(plan), work_(workspace), branching_(scene, plan) {}

    // To be called once for each plan and workspace, before radiance().
    void prepare() { work_.shadow_origins.decide(scene_.geometry, plan_.lights, accelerator_); }

    // The light along each camera ray; at most kRayBatch of them. Neighbours in `samples` should be neighbours in the
    // picture. `stop()` is asked before each wave; false, and no answer, when it said so.
    template <class Stop>
    [[nodiscard]] bool radiance(std::span<const CameraSample> samples, std::span<glm::vec3> result, Stop&& stop) {
        work_.rays.clear(RayOrder::divergent);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            work_.rays.push({samples[i].ray.origin, samples[i].ray.direction, kInfinity});
            work_.lanes.pixel[i] = samples[i].sampler.pixel();
            work_.lanes.index[i] = samples[i].sampler.index();
        }
        return radiance(result, stop);
    }

    // The same of the workspace's rays, where also pixel and index of their lanes are set.
    template <class Stop>
    [[nodiscard]] bool radiance(std::span<glm::vec3> result, Stop&& stop) {
        start();
        for (int wave = 0; work_.lanes.count > 0; ++wave) {
            if (stop()) return false;
            work_.rays.order = order_of_wave(wave, plan_.camera.lens_radius > 0.0f, (kParts & kernel_part::fuzzy) != 0);
            accelerator_.closest_hits(work_.rays, work_.hits);
            meet_surfaces();
            for (std::uint32_t i = 0; i < plan_.lights.size() && work_.vertices.any_lit; ++i) add_points_of_light(i, wave);
            collect();
            go_on(result);
        }
        return true;
    }

private:
    void start() {
        Lanes& lanes = work_.lanes;
        const auto n = static_cast<std::size_t>(work_.rays.count);
        work_.counts.camera += n;
        work_.stacks.clear();
        lanes.count = n;
        std::iota(lanes.sample, lanes.sample + n, 0u);
        std::fill_n(lanes.path, n, kCameraPath);
        for (int i = 0; i < 3; ++i) {
            std::fill_n(lanes.sum[i], n, 0.0f);
            std::fill_n(lanes.throughput[i], n, 1.0f);
        }
        if constexpr (Branching<kParts>::kAny) {
            std::fill_n(lanes.bounces, n, 0);
            std::fill_n(lanes.waiting, n, BranchStacks::kEmpty);
        }
        if constexpr ((kParts & kernel_part::glass) != 0) std::fill_n(work_.media.begin(), n, plan_.medium);
    }

    // Adds the background to lanes whose ray has left the scene, and lists the vertices of the others.
    void meet_surfaces() {
        Vertices& vertices = work_.vertices;
        const std::size_t lanes = work_.lanes.count;
        vertices.count = 0;
        for (std::uint32_t i = 0; i < lanes; ++i) {
            work_.met[vertices.count] = i;
            vertices.count += work_.hits.primitive[i] != kNoPrimitive ? 1 : 0;
        }
        if (!all_met()) add_background();
        find_surface_points(scene_, work_.rays, work_.hits, std::span(work_.met).first(vertices.count), vertices.points);
        for (int axis = 0; axis < 3; ++axis) {
            const float* direction = work_.rays.direction[axis];
            if (all_met()) {
                for (std::size_t k = 0; k < lanes; ++k) vertices.wo[axis][k] = -direction[k];
            } else {
                for (std::size_t k = 0; k < vertices.count; ++k) vertices.wo[axis][k] = -direction[work_.met[k]];
            }
        }
        vertices.set_materials(scene_.materials, plan_.highlights);
    }

    // Then vertices and lanes have the same places.
    [[nodiscard]] bool all_met() const { return work_.vertices.count == work_.lanes.count; }

    void add_background() {
        for (std::size_t i = 0; i < work_.lanes.count; ++i) {
            if (work_.hits.primitive[i] != kNoPrimitive) continue;
            const auto& d = work_.rays.direction;
            work_.lanes.add_light(i, plan_.background_is_color ? scene_.environment.color
                                                               : scene_.environment.radiance({d[0][i], d[1][i], d[2][i]}));
        }
    }

    // Adds light i to all vertices that it reaches: from as many of its points as are asked for, where it has more than one.
    void add_points_of_light(std::uint32_t i, int wave) {
        const int points = plan_.lights[i].has_area() ? plan_.light_samples : 1;
        for (int point = 0; point < points; ++point) add_light(i, point, wave);
    }

    // With one shadow ray a vertex and only where it would show.
    void add_light(std::uint32_t i, int point, int wave) {
        const Light& light = plan_.lights[i];
        DirectLight& direct = work_.direct_light;
        if (light.has_area()) choose_points(i, point, wave);
        direct.reflect(light, work_.vertices);
        if (!plan_.shadows) return direct.add(work_.vertices);
        const bool at_light = work_.shadow_origins.at_light(i);
        RayBatch& rays = work_.shadow_rays;
        rays.clear(order_of_shadows(wave, at_light));
        direct.cast(light, at_light, work_.vertices, rays);
        if (rays.count == 0) return;
        work_.counts.shadow += static_cast<std::uint64_t>(rays.count);
        accelerator_.occluded(rays, work_.blocked);
        if (work_.vertices.points.smooth && direct.cast_lifts(work_.blocked, work_.vertices, rays)) {
            work_.counts.shadow += static_cast<std::uint64_t>(rays.count);
            accelerator_.occluded(rays, work_.lifts_blocked);
            direct.block(work_.lifts_blocked, work_.blocked);
        }
        direct.add(work_.blocked, work_.vertices);
    }

    // Where on light i each vertex looks for its point number `point`: at its middle without soft shadows. All points of all
    // samples of a pixel are one sequence, so that they are spread evenly together.
    void choose_points(std::uint32_t i, int point, int wave) {
        const Lanes& lanes = work_.lanes;
        const std::size_t n = work_.vertices.count;
        auto& u = work_.direct_light.u;
        if constexpr ((kParts & kernel_part::soft) == 0) {
            for (auto& row : u) std::fill_n(row, n, 0.5f);
            return;
        }
        const auto per_sample = static_cast<std::uint32_t>(plan_.light_samples);
        if (wave == 0 && all_met() && per_sample == 1) {
            return Sampler::squares(plan_.sampler, lanes.pixel, lanes.index, hash(kCameraPath, i), n, u[0], u[1]);
        }
        for (std::size_t k = 0; k < n; ++k) {
            work_.pixels[k] = lanes.pixel[work_.met[k]];
            work_.indices[k] = lanes.index[work_.met[k]] * per_sample + static_cast<std::uint32_t>(point);
        }
        if (wave == 0) {
            return Sampler::squares(plan_.sampler, work_.pixels, work_.indices, hash(kCameraPath, i), n, u[0], u[1]);
        }
        for (std::size_t k = 0; k < n; ++k) work_.dimensions[k] = hash(lanes.path[work_.met[k]], i);
        Sampler::squares(plan_.sampler, work_.pixels, work_.indices, work_.dimensions, n, u[0], u[1]);
    }

    // Adds each vertex's light to its lane.
    void collect() {
        Vertices& v = work_.vertices;
        for (int axis = 0; axis < 3; ++axis) {
            float *sum = work_.lanes.sum[axis], *light = v.direct[axis];
            const float* throughput = work_.lanes.throughput[axis];
            if (v.any_emission) {
                for (std::size_t k = 0; k < v.count; ++k) light[k] = v.emission[axis][k] + light[k];
            }
            if (all_met()) {
                for (std::size_t k = 0; k < v.count; ++k) sum[k] += throughput[k] * light[k];
            } else {
                for (std::size_t k = 0; k < v.count; ++k) sum[work_.met[k]] += throughput[work_.met[k]] * light[k];
            }
        }
    }

    // Lets every lane follow its next ray, hands out the sums of those that have none, and closes the ranks.
    void go_on(std::span<glm::vec3> result) {
        Lanes& lanes = work_.lanes;
        std::size_t kept = 0, k = 0;
        if constexpr ((kParts & kernel_part::glass) != 0) work_.stacks.make_room(work_.vertices.count);
        branching_.divide_at_glass(work_);
        for (std::size_t lane = 0; lane < lanes.count; ++lane) {
            const bool met = Branching<kParts>::kAny && k < work_.vertices.count && work_.met[k] == lane;
            if (met ? branching_.follow(work_, k++, lane, kept) : branching_.resume(work_, lane, kept)) {
                lanes.move_sample(lane, kept++);
            } else {
                result[lanes.sample[lane]] = {lanes.sum[0][lane], lanes.sum[1][lane], lanes.sum[2][lane]};
            }
        }
        lanes.count = kept;
        work_.rays.count = static_cast<int>(kept);
    }

    const Scene& scene_;
    const A& accelerator_;
    const RenderPlan& plan_;
    Workspace& work_;
    Branching<kParts> branching_;
};

}  // namespace glint
