#include "accel/uniform_grid.h"

#include <algorithm>
#include <utility>

namespace glint {
namespace {

// Rays from farther than this many times the geometry's largest coordinate see the grid under less than two degrees.
constexpr double kFarOrigin = 32.0;
// Twice the padding that PreparedRay gives a ray from there.
constexpr double kCellPadding = 2.0 * static_cast<double>(kPadding) * (kFarOrigin + 1.0);
// About the course's density (m = 2: eight cells a primitive), halved until the references fit.
constexpr double kCellsPerPrimitive = 8.0;
constexpr std::size_t kMaxReferencesPerPrimitive = 16;
constexpr double kMaxCells = 1.0e8;
constexpr int kMaxCellsPerAxis = 1 << 14;
// As many of the largest primitives may stay outside the grid and be tested for every ray.
constexpr std::size_t kMaxLarge = 16;
// Primitive tests a ray costs in a grid that fits its contents.
constexpr double kTestsInFittingGrid = 10.0;

struct Bounded {
    Aabb bounds;
    PrimitiveId id;
};

double diagonal2(const Aabb& box) {
    const glm::dvec3 d = glm::dvec3(box.hi) - glm::dvec3(box.lo);
    return glm::dot(d, d);
}

// The sides with none below a thousandth of the widest, so that flat contents have a volume.
glm::dvec3 solid(glm::dvec3 size) { return glm::max(size, glm::dvec3(std::max(size.x, std::max(size.y, size.z)) * 0x1p-10)); }

// How many of the first primitives (the largest, in descending order) to keep out. A floor under a small model would
// stretch the cells until the model fills a few of them: tests per ray grow with the volume per cell to the power 2/3.
std::size_t count_large(const std::vector<Bounded>& primitives) {
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
        const double cost = static_cast<double>(k) + kTestsInFittingGrid * std::cbrt(stretch * stretch);
        if (cost <= best_cost) best_cost = cost, best = k;
    }
    return best;
}

}  // namespace

UniformGrid::UniformGrid(std::shared_ptr<const Geometry> geometry) : geometry_(std::move(geometry)), brute_force_(geometry_) {
    std::vector<Bounded> primitives;
    primitives.reserve(geometry_->bounded_count());
    Aabb all;
    for (const PrimitiveId id : geometry_->bounded_ids()) {
        primitives.push_back({geometry_->bounds(id), id});
        all.grow(primitives.back().bounds);
    }
    if (primitives.empty()) return;
    magnitude_ = all.magnitude();
    const auto front = primitives.begin() + static_cast<std::ptrdiff_t>(std::min(kMaxLarge, primitives.size()));
    std::partial_sort(primitives.begin(), front, primitives.end(), [](const Bounded& a, const Bounded& b) {
        const double da = diagonal2(a.bounds), db = diagonal2(b.bounds);
        return da != db ? da > db : a.id < b.id;
    });
    const std::size_t large = count_large(primitives);
    Aabb inside;
    std::vector<PrimitiveId> ids;
    std::vector<Aabb> bounds;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        if (i < large) {
            large_.push_back(primitives[i].id);
            continue;
        }
        ids.push_back(primitives[i].id);
        bounds.push_back(primitives[i].bounds);
        inside.grow(bounds.back());
    }
    const double padding = kCellPadding * magnitude_;
    lo_ = glm::dvec3(inside.lo) - padding;
    hi_ = glm::dvec3(inside.hi) + padding;
    // Long primitives among many small ones would be listed in nearly every cell: coarsen until they fit.
    double density = kCellsPerPrimitive;
    choose_resolution(ids.size(), density);
    while (count_references(bounds) > kMaxReferencesPerPrimitive * ids.size() + 4096 && resolution_ != glm::ivec3(1)) {
        density *= 0.5;
        choose_resolution(ids.size(), density);
    }
    fill(ids, bounds);
}

void UniformGrid::choose_resolution(std::size_t primitives, double cells_per_primitive) {
    const glm::dvec3 size = hi_ - lo_;
    const glm::dvec3 sides = solid(size);
    const double cells = std::min(cells_per_primitive * static_cast<double>(primitives), kMaxCells);
    const double per_length = std::cbrt(cells / (sides.x * sides.y * sides.z));
    for (int i = 0; i < 3; ++i) {
        resolution_[i] =
            static_cast<int>(std::clamp(std::ceil(size[i] * per_length), 1.0, static_cast<double>(kMaxCellsPerAxis)));
        cell_[i] = size[i] / resolution_[i];
    }
}

void UniformGrid::cell_range(const Aabb& box, glm::ivec3& first, glm::ivec3& last) const {
    const double padding = kCellPadding * magnitude_;
    for (int i = 0; i < 3; ++i) {
        const double a = std::floor((box.lo[i] - padding - lo_[i]) / cell_[i]);
        const double b = std::floor((box.hi[i] + padding - lo_[i]) / cell_[i]);
        first[i] = static_cast<int>(std::clamp(a, 0.0, resolution_[i] - 1.0));
        last[i] = static_cast<int>(std::clamp(b, 0.0, resolution_[i] - 1.0));
    }
}

std::size_t UniformGrid::cell_index(glm::ivec3 c) const {
    return (static_cast<std::size_t>(c.z) * static_cast<std::size_t>(resolution_.y) + static_cast<std::size_t>(c.y)) *
               static_cast<std::size_t>(resolution_.x) +
           static_cast<std::size_t>(c.x);
}

std::size_t UniformGrid::count_references(const std::vector<Aabb>& bounds) const {
    std::size_t total = 0;
    for (const Aabb& box : bounds) {
        glm::ivec3 first, last;
        cell_range(box, first, last);
        const glm::ivec3 n = last - first + 1;
        total += static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y) * static_cast<std::size_t>(n.z);
    }
    return total;
}

void UniformGrid::fill(const std::vector<PrimitiveId>& ids, const std::vector<Aabb>& bounds) {
    const auto for_each_cell = [this](const Aabb& box, auto&& visit) {
        glm::ivec3 first, last;
        cell_range(box, first, last);
        for (int z = first.z; z <= last.z; ++z)
            for (int y = first.y; y <= last.y; ++y)
                for (int x = first.x; x <= last.x; ++x) visit(cell_index({x, y, z}));
    };
    const std::size_t cells = cell_index(resolution_ - 1) + 1;
    offsets_.assign(cells + 1, 0);
    for (const Aabb& box : bounds) for_each_cell(box, [this](std::size_t c) { ++offsets_[c + 1]; });
    for (std::size_t c = 0; c < cells; ++c) offsets_[c + 1] += offsets_[c];
    ids_.resize(offsets_[cells]);
    std::vector<std::uint32_t> next(offsets_.begin(), offsets_.end() - 1);
    for (std::size_t i = 0; i < ids.size(); ++i) for_each_cell(bounds[i], [&](std::size_t c) { ids_[next[c]++] = ids[i]; });
}

template <bool any>
Hit UniformGrid::traverse(const Ray& ray) const noexcept {
    const PreparedRay prepared(ray, magnitude_);
    Hit best = begin_query(prepared, *geometry_);
    if (!prepared.usable || ids_.empty()) return best;
    for (const PrimitiveId id : large_) intersect(prepared, *geometry_, id, best);
    if (any && best.found()) return best;

    // Before clipping: seen from there, what brute force hits may lie outside the padded grid by more than its padding.
    const glm::dvec3 o(ray.origin), d(ray.direction);
    const double distance = std::max(std::abs(o.x), std::max(std::abs(o.y), std::abs(o.z)));
    if (distance > kFarOrigin * magnitude_) {
        const bool beside = slab_interval(prepared, Aabb{glm::vec3(lo_), glm::vec3(hi_)}).empty();
        return beside ? best : brute_force_.closest_hit(ray);
    }

    // Clip to the grid in double. A ray parallel to a slab either stays in it or never enters.
    double t_in = 0.0, t_out = best.t;
    for (int i = 0; i < 3; ++i) {
        if (d[i] == 0.0) {
            if (o[i] < lo_[i] || o[i] > hi_[i]) return best;
            continue;
        }
        const double t0 = (lo_[i] - o[i]) / d[i], t1 = (hi_[i] - o[i]) / d[i];
        t_in = std::max(t_in, std::min(t0, t1));
        t_out = std::min(t_out, std::max(t0, t1));
    }
    if (!(t_in <= t_out)) return best;

    glm::ivec3 cell, step, end;
    const glm::dvec3 entry = o + t_in * d;
    for (int i = 0; i < 3; ++i) {
        cell[i] = static_cast<int>(std::clamp(std::floor((entry[i] - lo_[i]) / cell_[i]), 0.0, resolution_[i] - 1.0));
        step[i] = d[i] > 0.0 ? 1 : d[i] < 0.0 ? -1 : 0;
        end[i] = d[i] > 0.0 ? resolution_[i] : -1;
    }
    // The exit from cell c along axis i comes from c itself, not from a running sum: no drift however many cells.
    const auto exit_along = [&](int i) {
        return step[i] == 0 ? static_cast<double>(kInfinity)
                            : (lo_[i] + (cell[i] + (step[i] > 0 ? 1 : 0)) * cell_[i] - o[i]) / d[i];
    };
    glm::dvec3 exit(exit_along(0), exit_along(1), exit_along(2));
    for (;;) {
        const std::size_t c = cell_index(cell);
        for (std::uint32_t i = offsets_[c]; i < offsets_[c + 1]; ++i) {
            intersect(prepared, *geometry_, ids_[i], best);
            if (any && best.found()) return best;
        }
        const int axis = exit.x <= exit.y ? (exit.x <= exit.z ? 0 : 2) : (exit.y <= exit.z ? 1 : 2);
        // A hit beyond this cell may be beaten by a primitive of a later cell, so only a hit before its exit ends the walk.
        if (best.t <= exit[axis] || exit[axis] > t_out) return best;
        cell[axis] += step[axis];
        if (cell[axis] == end[axis]) return best;
        exit[axis] = exit_along(axis);
    }
}

Hit UniformGrid::closest_hit(const Ray& ray) const noexcept { return traverse<false>(ray); }
bool UniformGrid::occluded(const Ray& ray) const noexcept { return traverse<true>(ray).found(); }

std::size_t UniformGrid::memory_bytes() const {
    return offsets_.capacity() * sizeof(std::uint32_t) + ids_.capacity() * sizeof(PrimitiveId);
}

}  // namespace glint
