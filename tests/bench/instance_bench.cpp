// Instances beside the same scene flattened, in one process: nanoseconds a ray by kind of ray, seconds to build, bytes.
// Rounds alternate between the two, and the median round counts, so that a busy machine slows both.
#include <algorithm>
#include <cstdlib>
#include <ctime>

#include <fmt/format.h>

#include "accel/accelerator.h"
#include "core/sampler.h"
#include "core/torus_knot.h"

namespace {

using namespace glint;
// Of this thread's own time, so that others on the machine matter less.
double now() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

class Numbers {
public:
    double next() { return static_cast<double>(Sampler(SamplerKind::random, n_++, 0, 0, 7).interval(0)); }
    glm::dvec3 direction() {
        const double z = 2.0 * next() - 1.0, phi = 6.283185307179586 * next(), r = std::sqrt(std::max(0.0, 1.0 - z * z));
        return {r * std::cos(phi), r * std::sin(phi), z};
    }

private:
    std::uint32_t n_ = 0;
};

Geometry knot(int triangles) {
    const KnotMesh mesh = torus_knot(triangles);
    Geometry g;
    g.vertices = mesh.vertices;
    for (glm::vec3& v : g.vertices) v *= 0.01f;
    g.triangles = mesh.triangles;
    return g;
}

// `count` knots in a cube, so large that they fill a part of it that does not depend on their number.
Geometry crowd(int count, int triangles) {
    Geometry g;
    g.prototypes.emplace_back(std::make_shared<const Geometry>(knot(triangles)));
    Numbers random;
    const double size = 1.6 / std::cbrt(static_cast<double>(count));
    for (int i = 0; i < count; ++i) {
        const glm::dvec3 x = random.direction(), y = glm::normalize(glm::cross(x, random.direction()));
        glm::dmat4 m(size * glm::dmat3(x, y, glm::cross(x, y)));
        for (int k = 0; k < 3; ++k) m[3][k] = 2.0 * random.next() - 1.0;
        g.place(0, affine_map(m));
    }
    return g;
}

Geometry flattened(const Geometry& from) {
    Geometry g;
    for (const Instance& instance : from.instances) {
        const AffineMap out = inverse(instance.object_from_world);
        const Geometry& mesh = *from.prototypes[instance.prototype].geometry;
        const auto first = static_cast<std::uint32_t>(g.vertices.size());
        for (const glm::vec3 v : mesh.vertices) g.vertices.emplace_back(out.point(glm::dvec3(v)));
        for (const auto& t : mesh.triangles) g.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    return g;
}

struct RaySet {
    const char* name;
    bool any;
    std::vector<RayBatch> batches;
};

std::vector<RaySet> ray_sets(const Bvh& tree) {
    constexpr int kBatches = 200;
    std::vector<RaySet> sets{{"primary, 16 a pixel", false, {}}, {"shadow", true, {}}, {"diffuse", false, {}}, {"ao", true, {}}};
    for (RaySet& s : sets) s.batches.resize(kBatches);
    Numbers random;
    const glm::dvec3 eye(0.4, 0.7, 3.2), lamp(2.0, 3.0, 2.5);
    std::vector<Ray> diffuse;
    for (int b = 0; b < kBatches; ++b) {
        RayBatch& primary = sets[0].batches[static_cast<std::size_t>(b)];
        primary.clear(RayOrder::common_origin);
        const double x = 1.2 * (2.0 * random.next() - 1.0), y = 1.2 * (2.0 * random.next() - 1.0);
        for (int i = 0; i < kRayBatch; ++i) {
            // Four by four pixels of 720 rows, sixteen samples each.
            const int pixel = i / 16;
            const double px = x + (pixel % 4 + random.next()) * 2.4 / 720.0, py = y + (pixel / 4 + random.next()) * 2.4 / 720.0;
            primary.push({glm::vec3(eye), glm::vec3(glm::normalize(glm::dvec3(px, py, 0.0) - eye)), kInfinity});
        }
        HitBatch hits;
        tree.closest_hits(primary, hits);
        RayBatch& shadow = sets[1].batches[static_cast<std::size_t>(b)];
        shadow.clear(RayOrder::common_origin);
        for (int i = 0; i < kRayBatch; ++i) {
            if (hits.primitive[i] == kNoPrimitive) continue;
            const glm::dvec3 p =
                glm::dvec3(primary[i].origin) + 0.9999 * static_cast<double>(hits.t[i]) * glm::dvec3(primary[i].direction);
            shadow.push({glm::vec3(lamp), glm::vec3(p - lamp), 0.9999f});
            diffuse.push_back({glm::vec3(p), glm::vec3(random.direction()), kInfinity});
        }
    }
    for (std::size_t kind : {2u, 3u}) {
        sets[kind].batches.resize(diffuse.size() / kRayBatch);
        for (std::size_t i = 0; i < sets[kind].batches.size() * kRayBatch; ++i) {
            RayBatch& batch = sets[kind].batches[i / kRayBatch];
            if (i % kRayBatch == 0) batch.clear(RayOrder::divergent);
            Ray ray = diffuse[i];
            if (kind == 3) ray.t_max = 0.3f;
            batch.push(ray);
        }
    }
    return sets;
}

// Nanoseconds a ray; adds to `found` what was hit.
double trace(const Bvh& tree, const RaySet& set, std::size_t& found) {
    HitBatch hits;
    OccludedBatch blocked{};
    std::size_t rays = 0;
    const double start = now();
    for (const RayBatch& batch : set.batches) {
        set.any ? tree.occluded(batch, blocked) : tree.closest_hits(batch, hits);
        for (int i = 0; i < batch.count; ++i)
            found += (set.any ? blocked[static_cast<std::size_t>(i)] : hits.primitive[i] != kNoPrimitive) ? 1 : 0;
        rays += static_cast<std::size_t>(batch.count);
    }
    return 1e9 * (now() - start) / static_cast<double>(std::max<std::size_t>(rays, 1));
}

double median(std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
}

void compare(int count, int triangles, int rounds) {
    const auto world = std::make_shared<const Geometry>(crowd(count, triangles));
    double start = now();
    const Bvh instanced(world);
    const double build = (now() - start);
    const double mesh = static_cast<double>(Bvh(world->prototypes[0].geometry).memory_bytes());
    const double bytes = static_cast<double>(instanced.memory_bytes() + world->instances.capacity() * sizeof(Instance));
    fmt::print("{} instances of {} triangles: build {:.3f} s, {:.1f} MB = {:.1f} MB of the mesh + {:.0f} bytes an instance\n",
               count, triangles, build, bytes * 1e-6, mesh * 1e-6, (bytes - mesh) / count);
    const bool both = static_cast<double>(count) * triangles <= 2.0e7;
    std::unique_ptr<Bvh> flat;
    if (both) {
        const auto geometry = std::make_shared<const Geometry>(flattened(*world));
        start = now();
        flat = std::make_unique<Bvh>(geometry);
        fmt::print("flattened: build {:.3f} s, {:.1f} MB\n", (now() - start), static_cast<double>(flat->memory_bytes()) * 1e-6);
    }
    for (const RaySet& set : ray_sets(instanced)) {
        std::vector<double> a, b;
        std::size_t found_a = 0, found_b = 0;
        for (int i = 0; i < rounds; ++i) {
            a.push_back(trace(instanced, set, found_a));
            if (flat) b.push_back(trace(*flat, set, found_b));
        }
        fmt::print("  {:<20} {:7.1f} ns", set.name, median(a));
        if (flat)
            fmt::print(", flattened {:7.1f} ns, ratio {:.2f}, hits {} / {}", median(b), median(a) / median(b),
                       found_a / static_cast<std::size_t>(rounds), found_b / static_cast<std::size_t>(rounds));
        fmt::print("\n");
    }
}

}  // namespace

int main(int argc, char** argv) {
    const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 7;
    compare(8, 200000, rounds);
    compare(1000, 10000, rounds);
    compare(3000, 1000, rounds);
    compare(100000, 1000, rounds);
}
