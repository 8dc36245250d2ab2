#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

#include "accel/bvh.h"
#include "accel/bvh_split.h"

namespace glint {
namespace {

// Nodes below this level are halved by count, which ends within 30 more levels.
constexpr int kSahLevels = 32;
// Sets up to this size are built by one task each; larger ones are cut by all threads together.
constexpr std::uint32_t kTaskSize = 1u << 14;

using Units = BvhTree::Units;
using Ids = std::array<PrimitiveId, kBvhWidth>;

constexpr std::size_t units_of(std::size_t bytes) { return bytes / kBvhUnit; }

// A child to be: a leaf, or a set with the cut that would divide it.
struct Candidate {
    BuildRange range;
    Split split;
    float area = 0.0f;
    bool leaf = false;
};

class Builder {
public:
    Builder(const Geometry& geometry, std::span<BuildRef> refs, const ParallelFor& parallel_for)
        : geometry_(geometry), refs_(refs), parallel_for_(parallel_for) {}

    BvhTree build(const BuildRange& all) {
        Part top;
        const std::size_t root = append<BvhNode>(top.units);
        Candidate whole = examine(all, 1, parallel_for_);
        fill_node(top, root, whole, 1, true);
        parts_.resize(tasks_.size());
        parallel_for_(tasks_.size(), [this](std::size_t i) {
            Part& part = parts_[i];
            const std::size_t node = append<BvhNode>(part.units);
            fill_node(part, node, tasks_[i].candidate, tasks_[i].level, false);
        });
        return join(std::move(top));
    }

private:
    struct Part {
        Units units;
        std::size_t nodes = 0, leaves = 0;
        int depth = 0;
        double leaf_area = 0.0, leaf_area_times_extent = 0.0;
    };
    struct Task {
        Candidate candidate;
        int level;
        std::size_t node, child;  // of the top part: where the reference to the result goes
    };

    template <class T>
    static std::size_t append(Units& units) {
        const std::size_t at = units.size();
        if (at + units_of(sizeof(T)) > kUnitMask) throw std::length_error("too many primitives for one BVH");
        units.resize(at + units_of(sizeof(T)));
        return at;
    }
    template <class T>
    static T& at(Units& units, std::size_t i) {
        return *reinterpret_cast<T*>(units[i].bytes);
    }

    // Decides whether a set becomes a leaf; if not, how it would be cut.
    Candidate examine(const BuildRange& range, int level, const ParallelFor& parallel_for) {
        Candidate c;
        c.range = range;
        c.area = range.bounds.half_area();
        if (level < kSahLevels && range.count > 1) c.split = best_split(refs_, range, parallel_for);
        if (range.count <= kBvhWidth && of_one_kind(range)) {
            // A node visit costs 1, a full block 1: never is a flat or tiny set worse as a leaf.
            const float as_leaf = leaf_cost(range.count, true) * c.area;
            c.leaf = !(c.area + c.split.cost < as_leaf);
        }
        return c;
    }

    [[nodiscard]] bool of_one_kind(const BuildRange& range) const {
        const std::span<const BuildRef> members = refs_.subspan(range.first, range.count);
        return std::ranges::all_of(members, [&](const BuildRef& r) { return kind_of(r.id) == kind_of(members.front().id); });
    }

    void cut(const Candidate& c, int level, const ParallelFor& parallel_for, Candidate& left, Candidate& right) {
        BuildRange l, r;
        if (c.split.axis >= 0) {
            partition(refs_, c.range, c.split, l, r);
        } else if (c.range.count > kBvhWidth || !partition_by_kind(refs_, c.range, l, r)) {
            partition_median(refs_, c.range, l, r);
        }
        left = examine(l, level, parallel_for);
        right = examine(r, level, parallel_for);
    }

    void fill_node(Part& part, std::size_t node, const Candidate& whole, int level, bool top) {
        ++part.nodes;
        part.depth = std::max(part.depth, level);
        const ParallelFor serial = serial_for;
        std::array<Candidate, kBvhWidth> children;
        children[0] = whole;
        std::size_t n = 1;
        while (n < kBvhWidth) {
            std::size_t widest = n;
            for (std::size_t i = 0; i < n; ++i) {
                if (!children[i].leaf && (widest == n || children[i].area > children[widest].area)) widest = i;
            }
            if (widest == n) break;
            const Candidate open = children[widest];
            cut(open, level + 1, top ? parallel_for_ : serial, children[widest], children[n]);
            ++n;
        }
        write_bounds(at<BvhNode>(part.units, node), std::span(children.data(), n));
        for (std::size_t i = 0; i < n; ++i) {
            if (!children[i].leaf) continue;
            const BvhRef leaf = append_leaf(part, children[i].range);
            at<BvhNode>(part.units, node).child[i] = leaf;
        }
        for (std::size_t i = 0; i < n; ++i) {
            if (children[i].leaf) continue;
            if (top && children[i].range.count <= kTaskSize) {
                tasks_.push_back({children[i], level + 1, node, i});
                continue;
            }
            const std::size_t below = append<BvhNode>(part.units);
            at<BvhNode>(part.units, node).child[i] = static_cast<BvhRef>(below);
            fill_node(part, below, children[i], level + 1, top);
        }
    }

    static void write_bounds(BvhNode& node, std::span<const Candidate> children) {
        std::array<std::array<float, kBvhWidth>, 4> key{};  // of octants 0 to 3 (bit 2 clear); the others are their reverses
        for (std::size_t i = 0; i < kBvhWidth; ++i) {
            const Box4 box = i < children.size() ? children[i].range.bounds : Box4();
            alignas(16) float lo[4], hi[4];
            _mm_store_ps(lo, box.lo);
            _mm_store_ps(hi, box.hi);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                node.bounds[2 * axis][i] = lo[axis];
                node.bounds[2 * axis + 1][i] = hi[axis];
            }
            node.child[i] = node.order[i] = 0;
            for (std::size_t octant = 0; octant < 4 && i < children.size(); ++octant) {
                const float x = lo[0] + hi[0], y = lo[1] + hi[1], z = lo[2] + hi[2];
                key[octant][i] = ((octant & 1u) != 0 ? x : -x) + ((octant & 2u) != 0 ? y : -y) - z;
            }
        }
        for (unsigned octant = 0; octant < 4; ++octant) {
            std::array<std::uint32_t, kBvhWidth> far_first{0, 1, 2, 3, 4, 5, 6, 7};
            const auto n = static_cast<std::ptrdiff_t>(children.size());
            for (std::ptrdiff_t i = 1; i < n; ++i) {
                for (auto k = static_cast<std::size_t>(i); k > 0 && key[octant][far_first[k]] > key[octant][far_first[k - 1]];
                     --k)
                    std::swap(far_first[k], far_first[k - 1]);
            }
            for (std::size_t i = 0; i < kBvhWidth; ++i) {
                const std::size_t reversed = i < children.size() ? children.size() - 1 - i : i;
                node.order[i] |= far_first[i] << (3 * octant);
                node.order[i] |= far_first[reversed] << (3 * (7 - octant));
            }
        }
    }

    BvhRef append_leaf(Part& part, const BuildRange& range) {
        ++part.leaves;
        alignas(16) float side[4];
        _mm_store_ps(side, _mm_sub_ps(range.bounds.hi, range.bounds.lo));
        const double area = static_cast<double>(range.bounds.half_area());
        part.leaf_area += area;
        part.leaf_area_times_extent += area * static_cast<double>(std::max(side[0], std::max(side[1], side[2])));
        Ids ids;
        for (std::size_t i = 0; i < kBvhWidth; ++i) ids[i] = refs_[range.first + std::min<std::size_t>(i, range.count - 1)].id;
        // Ascending ids make equal trees equal in memory, whatever order the threads left.
        std::ranges::sort(std::span<PrimitiveId>(ids).first(std::min<std::size_t>(range.count, kBvhWidth)));
        std::fill(ids.begin() + range.count, ids.end(), ids[range.count - 1]);
        const PrimitiveKind kind = kind_of(ids[0]);
        std::size_t unit = 0;
        switch (kind) {
            case PrimitiveKind::triangle: unit = append_block<TriangleBlock>(part, ids); break;
            case PrimitiveKind::sphere: unit = append_block<SphereBlock>(part, ids); break;
            case PrimitiveKind::box: unit = append_block<BoxBlock>(part, ids); break;
            default: unit = append_block<ConeBlock>(part, ids); break;
        }
        return kLeafBit | static_cast<BvhRef>(kind) << 29 | static_cast<BvhRef>(unit);
    }

    template <class Block>
    std::size_t append_block(Part& part, const Ids& ids) const {
        const std::size_t unit = append<Block>(part.units);
        Block& block = at<Block>(part.units, unit);
        for (std::size_t i = 0; i < kBvhWidth; ++i) {
            block.id[i] = ids[i];
            write_primitive(block, i, index_of(ids[i]));
        }
        return unit;
    }
    void write_primitive(TriangleBlock& block, std::size_t lane, std::uint32_t index) const {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const glm::vec3& v = geometry_.vertices[geometry_.triangles[index][corner]];
            for (int axis = 0; axis < 3; ++axis) block.v[3 * corner + static_cast<std::size_t>(axis)][lane] = v[axis];
        }
    }
    void write_primitive(SphereBlock& block, std::size_t lane, std::uint32_t index) const {
        const Sphere& s = geometry_.spheres[index];
        for (int axis = 0; axis < 3; ++axis) block.center[axis][lane] = s.center[axis];
        block.radius[lane] = s.radius;
    }
    void write_primitive(BoxBlock& block, std::size_t lane, std::uint32_t index) const {
        const Box& b = geometry_.boxes[index];
        for (int axis = 0; axis < 3; ++axis) block.lo[axis][lane] = b.lo[axis], block.hi[axis][lane] = b.hi[axis];
    }
    void write_primitive(ConeBlock&, std::size_t, std::uint32_t) const {}

    // The parts behind one another, their references moved.
    BvhTree join(Part top) {
        BvhTree tree;
        std::vector<std::size_t> offsets(parts_.size());
        std::size_t size = top.units.size();
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            offsets[i] = size;
            size += parts_[i].units.size();
            at<BvhNode>(top.units, tasks_[i].node).child[tasks_[i].child] = static_cast<BvhRef>(offsets[i]);
        }
        if (size > kUnitMask) throw std::length_error("too many primitives for one BVH");
        tree.units.resize(size);
        std::copy(top.units.begin(), top.units.end(), tree.units.begin());
        parallel_for_(parts_.size(), [&](std::size_t i) {
            Part& part = parts_[i];
            move_references(part.units, 0, static_cast<BvhRef>(offsets[i]));
            std::copy(part.units.begin(), part.units.end(), tree.units.begin() + static_cast<std::ptrdiff_t>(offsets[i]));
            part.units = Units();
        });
        tree.nodes = top.nodes, tree.leaves = top.leaves, tree.depth = top.depth;
        for (const Part& part : parts_) {
            top.leaf_area += part.leaf_area;
            top.leaf_area_times_extent += part.leaf_area_times_extent;
            tree.nodes += part.nodes;
            tree.leaves += part.leaves;
            tree.depth = std::max(tree.depth, part.depth);
        }
        if (top.leaf_area > 0.0) tree.leaf_extent = static_cast<float>(top.leaf_area_times_extent / top.leaf_area);
        return tree;
    }
    static void move_references(Units& units, std::size_t node, BvhRef by) {
        for (std::size_t i = 0; i < kBvhWidth; ++i) {
            BvhNode& n = at<BvhNode>(units, node);
            if (!(n.bounds[0][i] <= n.bounds[1][i])) continue;
            const BvhRef child = n.child[i];
            n.child[i] += by;
            if ((child & kLeafBit) == 0) move_references(units, child, by);
        }
    }

    const Geometry& geometry_;
    std::span<BuildRef> refs_;
    const ParallelFor& parallel_for_;
    std::vector<Task> tasks_;
    std::vector<Part> parts_;
};

}  // namespace

BvhTree build_bvh(const Geometry& geometry, const ParallelFor& parallel_for) {
    std::vector<BuildRef> refs;
    refs.reserve(geometry.bounded_count());
    for (const PrimitiveId id : geometry.bounded_ids()) {
        const Aabb box = geometry.bounds(id);
        refs.push_back({{box.lo.x, box.lo.y, box.lo.z}, id, {box.hi.x, box.hi.y, box.hi.z}, 0});
    }
    if (refs.empty()) return {};
    const BuildRange all = measure(refs, 0, static_cast<std::uint32_t>(refs.size()));
    BvhTree tree = Builder(geometry, refs, parallel_for).build(all);
    alignas(16) float lo[4], hi[4];
    _mm_store_ps(lo, all.bounds.lo);
    _mm_store_ps(hi, all.bounds.hi);
    tree.bounds = {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
    return tree;
}

}  // namespace glint
