// One ray through the cells of a grid: a 3-D DDA (Amanatides & Woo 1987) for rays from near, slices of cells for rays from so
// far away that their own rounding error is wider than what the cells are padded by.
// Invariant: every block that holds a hit is tested before the walk ends. A computed hit lies within kReach of its primitive's
// bounds, cells list what comes within twice that of them, and double arithmetic errs by a millionth of the difference.
#pragma once

#include "accel/bvh_leaves.h"
#include "accel/grid_layout.h"

namespace glint::GLINT_ISA {

// How far from its primitive's bounds a hit is looked for, in units of origin and geometry: twice the padding of every test.
constexpr double kReach = 1.5 * static_cast<double>(kPadding);

inline double least(double a, double b) noexcept { return a < b ? a : b; }
inline double most(double a, double b) noexcept { return a > b ? a : b; }
// The cell of a coordinate counted in cells; what lies outside counts to the first or last.
inline int cell_at(double x, int n) noexcept { return static_cast<int>(least(most(x, 0.0), static_cast<double>(n - 1))); }

template <bool any, class Visit>
class GridWalk {
public:
    GridWalk(const GridView& grid, const Ray& ray, const RayScalars& scalars, Hit& best, Visit visit) noexcept
        : grid_(grid), leaf_ray_(ray, scalars, grid.blocks), best_(best), visit_(visit), dominant_(scalars.kz) {
        double farthest = 0.0;
        for (int i = 0; i < 3; ++i) {
            o_[i] = static_cast<double>((&ray.origin.x)[i]);
            d_[i] = static_cast<double>((&ray.direction.x)[i]);
            // Parallel to a slab: its planes are met long before or long after everything.
            inverse_[i] = d_[i] != 0.0 ? 1.0 / d_[i] : 1.0e300;
            farthest = most(farthest, __builtin_fabs(o_[i]));
        }
        const double magnitude = static_cast<double>(grid.blocks.magnitude);
        reach_ = farthest <= static_cast<double>(grid.near_origin) ? 0.0 : kReach * (farthest + magnitude) - grid.padding;
        for (BvhRef& ref : recent_) ref = kLastOfList;
    }

    void run() noexcept {
        if (grid_.large != nullptr && meet_list(grid_.large)) return;
        if (reach_ > 0.0) {
            walk_slices(grid_.levels[0]);
        } else {
            walk(grid_.levels[0], 0.0, static_cast<double>(best_.t));
        }
    }

private:
    struct Clip {
        double in, out;
    };
    // Where the ray is inside the level grown by `margin`, at most [in, out].
    [[nodiscard]] Clip clip(const GridLevel& level, double margin, Clip c) const noexcept {
        for (int i = 0; i < 3; ++i) {
            const double lo = static_cast<double>(level.lo[i]) - o_[i], hi = lo + level.n[i] * static_cast<double>(level.size[i]);
            const double a = (lo - margin) * inverse_[i], b = (hi + margin) * inverse_[i];
            c.in = most(c.in, least(a, b));
            c.out = least(c.out, most(a, b));
        }
        return c;
    }

    // These three return true when the query is over.
    bool meet(BvhRef ref) noexcept {
        ref &= ~kLastOfList;
        BvhRef& recent = recent_[(ref ^ ref >> 4) % kRecent];
        if (recent == ref) return false;
        recent = ref;
        visit_(ref, true);
        meet_leaf<any>(ref, leaf_ray_, best_);
        return any && best_.primitive != kNoPrimitive;
    }
    bool meet_list(const BvhRef* list) noexcept {
        for (;; ++list) {
            if (meet(*list)) return true;
            if ((*list & kLastOfList) != 0) return false;
        }
    }
    bool walk(const GridLevel& level, double t_in, double t_out) noexcept {
        // What rounding keeps out of this level's box by a hair may have been sent here all the same.
        const Clip c = clip(level, 0.25 * grid_.padding, {t_in, t_out});
        if (!(c.in <= c.out)) return false;
        double exit[3], step[3];
        std::uint32_t stride[3] = {1, level.n[0], std::uint32_t{level.n[0]} * level.n[1]};
        int remaining[3];
        std::uint32_t at = level.first;
        for (int i = 0; i < 3; ++i) {
            const double lo = static_cast<double>(level.lo[i]) - o_[i], size = static_cast<double>(level.size[i]);
            const int cell = cell_at((c.in * d_[i] - lo) * static_cast<double>(level.inverse[i]), level.n[i]);
            const bool forward = inverse_[i] > 0.0;
            exit[i] = (lo + (cell + (forward ? 1 : 0)) * size) * inverse_[i];
            step[i] = size * __builtin_fabs(inverse_[i]);
            at += static_cast<std::uint32_t>(cell) * stride[i];
            remaining[i] = forward ? level.n[i] - 1 - cell : cell;
            if (!forward) stride[i] = 0u - stride[i];
        }
        double entry = c.in;
        for (;;) {
            // The axis of the nearest exit from a table of x <= y, y <= z, x <= z: a branch would be mispredicted.
            static constexpr unsigned char kAxis[8] = {2, 2, 1, 1, 2, 0, 1, 0};
            const int axis =
                kAxis[(exit[0] <= exit[1] ? 1u : 0u) | (exit[1] <= exit[2] ? 2u : 0u) | (exit[0] <= exit[2] ? 4u : 0u)];
            const double leaves = exit[axis];
            visit_(at, false);
            const GridCell cell = grid_.cells[at];
            if (cell != 0 && enter(cell, entry, least(leaves, c.out))) return true;
            // A hit beyond this cell may be beaten by a primitive of a later cell, so only a hit before its exit ends the walk.
            if (leaves > c.out || (!any && static_cast<double>(best_.t) <= leaves) || remaining[axis]-- == 0) return false;
            at += stride[axis];
            entry = leaves;
            exit[axis] += step[axis];
        }
    }
    bool enter(GridCell cell, double t_in, double t_out) noexcept {
        if ((cell & kListBit) == 0) return meet(cell);
        if ((cell & kLevelBit) == 0) return meet_list(grid_.lists + (cell & kIndexMask));
        return walk(grid_.levels[cell & kIndexMask], t_in, t_out);
    }

    // All cells within reach of the ray, in slices across its dominant axis.
    bool walk_slices(const GridLevel& level) noexcept {
        const Clip c = clip(level, reach_ + 0.25 * grid_.padding, {0.0, static_cast<double>(best_.t)});
        if (!(c.in <= c.out)) return false;
        const int k = dominant_;
        const bool forward = d_[k] > 0.0;
        const double ahead = forward ? reach_ : -reach_;
        int slice = cell_on(level, k, c.in, -ahead);
        const int last = cell_on(level, k, c.out, ahead), step = forward ? 1 : -1;
        const double lo = static_cast<double>(level.lo[k]) - o_[k], size = static_cast<double>(level.size[k]);
        for (;; slice += step) {
            const double near_side = lo + (slice + (forward ? 0 : 1)) * size, far_side = lo + (slice + (forward ? 1 : 0)) * size;
            const double in = most(c.in, (near_side - ahead) * inverse_[k]), out = least(c.out, (far_side + ahead) * inverse_[k]);
            if (in <= out && meet_slice(level, slice, in, out)) return true;
            // What the slices left may hold lies beyond this slice less the reach.
            const bool done = !any && static_cast<double>(best_.t) < (far_side - ahead) * inverse_[k];
            if (done || slice == last) return false;
        }
    }
    [[nodiscard]] int cell_on(const GridLevel& level, int i, double t, double shift) const noexcept {
        const double x = t * d_[i] - (static_cast<double>(level.lo[i]) - o_[i]) + shift;
        return cell_at(x * static_cast<double>(level.inverse[i]), level.n[i]);
    }
    bool meet_slice(const GridLevel& level, int slice, double in, double out) noexcept {
        int first[3], last[3];
        for (int i = 0; i < 3; ++i) {
            const bool forward = d_[i] >= 0.0;
            first[i] = cell_on(level, i, forward ? in : out, -reach_);
            last[i] = cell_on(level, i, forward ? out : in, reach_);
        }
        first[dominant_] = last[dominant_] = slice;
        for (int z = first[2]; z <= last[2]; ++z) {
            for (int y = first[1]; y <= last[1]; ++y) {
                for (int x = first[0]; x <= last[0]; ++x) {
                    const std::uint32_t at = level.first + static_cast<std::uint32_t>((z * level.n[1] + y) * level.n[0] + x);
                    visit_(at, false);
                    const GridCell cell = grid_.cells[at];
                    if (cell == 0) continue;
                    if ((cell & kListBit) == 0) {
                        if (meet(cell)) return true;
                    } else if ((cell & kLevelBit) == 0) {
                        if (meet_list(grid_.lists + (cell & kIndexMask))) return true;
                    } else if (walk_slices(grid_.levels[cell & kIndexMask])) {
                        return true;
                    }
                }
            }
        }
        return false;
    }

    static constexpr std::uint32_t kRecent = 16;
    const GridView& grid_;
    const LeafRay leaf_ray_;
    Hit& best_;
    Visit visit_;
    int dominant_;
    double o_[3], d_[3], inverse_[3];
    double reach_;            // beyond the padding of cells; 0 where that suffices
    BvhRef recent_[kRecent];  // blocks tested lately: a block lies in several cells in a row
};

// Improves `best`; with `any` it must start without a hit, and the first ends the walk. `visit(index, block)` hears of every
// cell and block.
template <bool any, class Visit>
inline void walk_grid(const GridView& grid, const Ray& ray, Hit& best, Visit visit) noexcept {
    const RayScalars scalars = prepare(&ray.origin.x, &ray.direction.x, grid.blocks.magnitude, ray.t_max);
    if (!scalars.usable) return;
    GridWalk<any, Visit>(grid, ray, scalars, best, visit).run();
}

}  // namespace glint::GLINT_ISA
