// prepare() for sixteen rays of a batch at once, one ray's share of it, and what asks memory for them beforehand.
// Invariant: the values of prepare(), operation for operation.
#pragma once

#include "accel/bvh_rays.h"

namespace glint::GLINT_ISA {

constexpr int kGroup = 16;

class PreparedRays {
public:
    // Rays first to first + 15 of the batch; what lies beyond its count is of no meaning.
    void prepare(const RayBatch& rays, int first, float magnitude) noexcept {
        rays_ = &rays;
        first_ = first;
        Float16 o[3], d[3], a[3];
        const Float16 zero = Float16::set(0.0f), most = Float16::set(3.402823466e38f);
        auto usable = lt(zero, Float16::load(rays.t_max + first));
        for (int i = 0; i < 3; ++i) {
            o[i] = Float16::load(rays.origin[i] + first);
            d[i] = Float16::load(rays.direction[i] + first);
            a[i] = abs(d[i]);
            usable = usable & le(abs(o[i] + d[i]), most);
        }
        // The dominant axis, at ties the first.
        const auto x_y = le(a[1], a[0]), x_z = le(a[2], a[0]), y_z = le(a[2], a[1]);
        const auto x = x_y & x_z, y = y_z - x_y;
        const auto dominant = [&](const Float16(&v)[3], int step) {
            const Float16 of_x = v[step], of_y = v[(1 + step) % 3], of_z = v[(2 + step) % 3];
            return select(x, of_x, select(y, of_y, of_z));
        };
        const Float16 inverse = Float16::set(1.0f) / dominant(d, 0);
        inverse.store(inverse_z_);
        (dominant(d, 1) * inverse).store(shear_x_);
        (dominant(d, 2) * inverse).store(shear_y_);
        axis_x_ = x.bits();
        axis_y_ = y.bits();
        const Float16 largest = dominant(a, 0);
        const Float16 size = max(max(abs(o[0]), abs(o[1])), abs(o[2])) + Float16::set(magnitude);
        usable_ = (usable & le(Float16::set(0x1p-86f), largest) & le(size, Float16::set(0x1p87f) * largest)).bits();
        const Float16 smallest = largest * Float16::set(0x1p-40f), padding = Float16::set(kPadding) * size;
        for (int i = 0; i < 3; ++i) {
            const Float16 r = Float16::set(1.0f) / copy_sign(max(a[i], smallest), d[i]);
            const Float16 slack = padding * abs(r), shift = o[i] * r;
            r.store(reciprocal_[i]);
            (shift + slack).store(near_offset_[i]);
            (shift - slack).store(far_offset_[i]);
            forward_[i] = lt(zero, r).bits();
        }
    }
    [[nodiscard]] bool usable(int lane) const noexcept { return (usable_ >> lane & 1u) != 0; }
    void share(int lane, RayScalars& s) const noexcept {
        for (int i = 0; i < 3; ++i) {
            s.reciprocal[i] = reciprocal_[i][lane];
            s.near_offset[i] = near_offset_[i][lane];
            s.far_offset[i] = far_offset_[i][lane];
        }
        const auto bit = [lane](unsigned bits) { return bits >> lane & 1u; };
        s.octant = bit(forward_[0]) | bit(forward_[1]) << 1 | bit(forward_[2]) << 2;
        s.shift = 3 * s.octant;
        for (unsigned i = 0; i < 3; ++i) s.near_row[i] = (2 * i + ((s.octant >> i & 1u) ^ 1u)) * kRow;
        s.shear_x = shear_x_[lane];
        s.shear_y = shear_y_[lane];
        s.inverse_z = inverse_z_[lane];
        s.kz = 2 - static_cast<int>(2 * bit(axis_x_) + bit(axis_y_));
        static constexpr unsigned char kNext[4] = {1, 2, 0, 1};
        s.kx = kNext[s.kz];
        s.ky = kNext[s.kz + 1];
        s.o[0] = rays_->origin[s.kx][first_ + lane];
        s.o[1] = rays_->origin[s.ky][first_ + lane];
        s.o[2] = rays_->origin[s.kz][first_ + lane];
        s.usable = true;
    }

private:
    alignas(64) float reciprocal_[3][kGroup], near_offset_[3][kGroup], far_offset_[3][kGroup];
    alignas(64) float shear_x_[kGroup], shear_y_[kGroup], inverse_z_[kGroup];
    const RayBatch* rays_ = nullptr;
    int first_ = 0;
    unsigned axis_x_ = 0, axis_y_ = 0, usable_ = 0, forward_[3] = {};
};

// Asks memory for rays first to first + count - 1, as far as there are any. A batch's arrays are too short for a processor to
// foresee that it will be read on.
inline void fetch_rays(const RayBatch& rays, int first, int count) noexcept {
    const int last = first + count < rays.count ? first + count : rays.count;
    for (int i = first; i < last; i += kGroup) {
        for (int axis = 0; axis < 3; ++axis) {
            __builtin_prefetch(rays.origin[axis] + i);
            __builtin_prefetch(rays.direction[axis] + i);
        }
        __builtin_prefetch(rays.t_max + i);
    }
}

// One ray of the batch.
inline void load(const RayBatch& rays, int i, Ray& ray) noexcept {
    for (int k = 0; k < 3; ++k) {
        (&ray.origin.x)[k] = rays.origin[k][i];
        (&ray.direction.x)[k] = rays.direction[k][i];
    }
    ray.t_max = rays.t_max[i];
}

}  // namespace glint::GLINT_ISA
