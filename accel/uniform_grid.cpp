#include "accel/uniform_grid.h"

#include <algorithm>
#include <utility>

#include "accel/instance_level.h"

namespace glint {
namespace {

// As many of the largest primitives may stay outside the grid and be tested for every ray.
constexpr std::size_t kMaxLarge = 16;
// What a ray costs in a grid that fits its contents, counted in blocks.
constexpr double kBlocksInFittingGrid = 6.0;
// A ray from within this many times the geometry's largest coordinate is walked cell by cell, if that pads primitives by no
// more than kPaddingOfSize of the median size; from the least of them always.
constexpr double kLeastNear = 1.0, kMostNear = 32.0, kPaddingOfSize = 0.1;
constexpr double kReach = 1.5 * static_cast<double>(kPadding);

double diagonal2(const Aabb& box) {
    const glm::dvec3 d = glm::dvec3(box.hi) - glm::dvec3(box.lo);
    return glm::dot(d, d);
}

// The sides with none below a thousandth of the widest, so that flat contents have a volume.
glm::dvec3 solid(glm::dvec3 size) { return glm::max(size, glm::dvec3(std::max(size.x, std::max(size.y, size.z)) * 0x1p-10)); }

// How many of the first primitives (the largest, in descending order) to keep out. A floor under a small model would
// stretch the cells until the model fills a few of them: tests per ray grow with the volume per cell to the power 2/3.
std::size_t count_large(const std::vector<BoundedPrimitive>& primitives) {
    const std::size_t most = std::min(kMaxLarge, primitives.size() / 2);
    Aabb rest;
    for (std::size_t i = most; i < primitives.size(); ++i) rest.grow(primitives[i].bounds);
    const auto volume = [](const Aabb& box) {
        const glm::dvec3 s = solid(glm::dvec3(box.hi) - glm::dvec3(box.lo));
        return s.x * s.y * s.z;
    };
    const double least = volume(rest);
    std::size_t best = 0;
    double best_cost = static_cast<double>(kInfinity);
    for (std::size_t k = most + 1; k-- > 0;) {
        if (k < most) rest.grow(primitives[k].bounds);
        const double stretch = least > 0.0 ? volume(rest) / least : 1.0;
        const double cost = std::ceil(static_cast<double>(k) / kBvhWidth) + kBlocksInFittingGrid * std::cbrt(stretch * stretch);
        if (cost <= best_cost) best_cost = cost, best = k;
    }
    return best;
}

// Moves the large primitives to the front and returns their number.
std::size_t large_first(std::vector<BoundedPrimitive>& primitives) {
    const auto front = primitives.begin() + static_cast<std::ptrdiff_t>(std::min(kMaxLarge, primitives.size()));
    std::partial_sort(primitives.begin(), front, primitives.end(), [](const BoundedPrimitive& a, const BoundedPrimitive& b) {
        const double da = diagonal2(a.bounds), db = diagonal2(b.bounds);
        return da != db ? da > db : a.id < b.id;
    });
    return count_large(primitives);
}

// The largest side of the median primitive, from a sample.
double median_size(const std::vector<BoundedPrimitive>& primitives) {
    std::vector<float> sizes;
    const std::size_t step = std::max<std::size_t>(1, primitives.size() / 4096);
    for (std::size_t i = 0; i < primitives.size(); i += step) {
        const glm::vec3 s = primitives[i].bounds.size();
        sizes.push_back(std::max(s.x, std::max(s.y, s.z)));
    }
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    return static_cast<double>(*middle);
}

std::vector<BoundedPrimitive> bounded_primitives(const Geometry& geometry, const ParallelFor& parallel_for) {
    const std::vector<PrimitiveId> ids = geometry.bounded_ids();
    std::vector<BoundedPrimitive> primitives(ids.size());
    constexpr std::size_t kChunk = 65536;
    parallel_for((ids.size() + kChunk - 1) / kChunk, [&](std::size_t t) {
        for (std::size_t i = t * kChunk; i < std::min(ids.size(), (t + 1) * kChunk); ++i) {
            primitives[i] = {geometry.bounds(ids[i]), ids[i]};
        }
    });
    return primitives;
}

}  // namespace

const GridKernels& grid_kernels_for(Isa isa) {
    switch (isa) {
        case Isa::avx512: return isa_avx512::grid_kernels;
        case Isa::avx2: return isa_avx2::grid_kernels;
        case Isa::baseline: break;
    }
    return isa_baseline::grid_kernels;
}

UniformGrid::UniformGrid(std::shared_ptr<const Geometry> geometry, const ParallelFor& parallel_for, Isa isa,
                         const GridDensity& density)
    : geometry_(std::move(geometry)), has_planes_(!geometry_->planes.empty()), kernels_(&grid_kernels_for(isa)) {
    build_cells(parallel_for, density);
    const auto make = [&](std::shared_ptr<const Geometry> prototype) {
        return UniformGrid(std::move(prototype), parallel_for, isa, density);
    };
    instances_ = InstanceLevel<UniformGrid>::build(geometry_, parallel_for, isa, make);
}

void UniformGrid::build_cells(const ParallelFor& parallel_for, const GridDensity& density) {
    std::vector<BoundedPrimitive> primitives = bounded_primitives(*geometry_, parallel_for);
    if (primitives.empty()) return;
    Aabb all;
    for (const BoundedPrimitive& p : primitives) all.grow(p.bounds);
    magnitude_ = all.magnitude();
    const auto magnitude = static_cast<double>(magnitude_);
    const double wanted = kPaddingOfSize * median_size(primitives) / (kReach * magnitude) - 1.0;
    near_origin_ = static_cast<float>(magnitude * (wanted > kLeastNear ? std::min(wanted, kMostNear) : kLeastNear));
    padding_ = kReach * (static_cast<double>(near_origin_) + magnitude);

    // The large ones go through the same blocks, in a run of their own.
    const std::size_t large = large_first(primitives);
    blocks_ = make_grid_blocks(*geometry_, primitives, large, parallel_for);
    large_.assign(blocks_.refs.begin(), blocks_.refs.begin() + static_cast<std::ptrdiff_t>(blocks_.large));
    if (!large_.empty()) large_.back() |= kLastOfList;
    cells_ = build_grid_cells(blocks_, primitives, padding_, density, parallel_for);
}

Hit UniformGrid::closest_own(const Ray& ray) const noexcept {
    Hit best;
    best.t = ray.t_max;
    if (has_planes_) best = begin_query(PreparedRay(ray, magnitude_), *geometry_);
    if (!cells_.levels.empty()) kernels_->closest(view(), ray, best);
    return best;
}

bool UniformGrid::occluded_by_own(const Ray& ray) const noexcept {
    if (has_planes_ && begin_query(PreparedRay(ray, magnitude_), *geometry_).found()) return true;
    return !cells_.levels.empty() && kernels_->occluded(view(), ray);
}

Hit UniformGrid::closest_hit(const Ray& ray) const noexcept {
    Hit best = closest_own(ray);
    if (instances_ != nullptr) instances_->closest_hit(ray, best);
    return best;
}

bool UniformGrid::occluded(const Ray& ray) const noexcept {
    return occluded_by_own(ray) || (instances_ != nullptr && instances_->occluded(ray));
}

void UniformGrid::closest_hits(const RayBatch& rays, HitBatch& hits) const noexcept {
    for (int i = 0; i < rays.count; ++i) hits.set(i, closest_own(rays[i]));
    if (instances_ != nullptr) instances_->closest_hits(rays, hits);
}

void UniformGrid::occluded(const RayBatch& rays, OccludedBatch& result) const noexcept {
    for (int i = 0; i < rays.count; ++i) result[static_cast<std::size_t>(i)] = occluded_by_own(rays[i]);
    if (instances_ != nullptr) instances_->occluded(rays, result);
}

GridView UniformGrid::view() const noexcept {
    GridView v;
    v.blocks.units = blocks_.units.front().bytes;
    v.blocks.geometry = geometry_.get();
    v.blocks.magnitude = magnitude_;
    v.levels = cells_.levels.data();
    v.cells = cells_.cells.data();
    v.lists = cells_.lists.data();
    v.large = large_.empty() ? nullptr : large_.data();
    v.near_origin = near_origin_;
    v.padding = padding_;
    return v;
}

std::size_t UniformGrid::memory_bytes() const {
    const std::size_t of_instances = instances_ != nullptr ? instances_->memory_bytes() : 0;
    return of_instances + blocks_.units.capacity() * kBvhUnit + cells_.levels.capacity() * sizeof(GridLevel) +
           (cells_.cells.capacity() + cells_.lists.capacity() + large_.capacity()) * sizeof(std::uint32_t);
}

glm::ivec3 UniformGrid::resolution() const {
    if (cells_.levels.empty()) return glm::ivec3(0);
    const auto& n = cells_.levels.front().n;
    return {n[0], n[1], n[2]};
}

glm::dvec3 UniformGrid::corner(glm::ivec3 cell) const {
    glm::dvec3 p(0.0);
    if (cells_.levels.empty()) return p;
    const GridLevel& top = cells_.levels.front();
    for (int i = 0; i < 3; ++i) p[i] = static_cast<double>(top.lo[i]) + cell[i] * static_cast<double>(top.size[i]);
    return p;
}

TraversalCounts UniformGrid::count_traversal(const RayBatch& rays) const noexcept {
    TraversalCounts counts;
    for (int i = 0; i < rays.count && !cells_.levels.empty(); ++i) kernels_->count_closest(view(), rays[i], counts);
    for (int i = 0; i < rays.count && instances_ != nullptr; ++i)
        instances_->count_traversal(rays[i], closest_own(rays[i]), counts);
    return counts;
}

}  // namespace glint
