// The accelerators by name, and one of them as a value. All three answer every query with the same bits.
// Knows only geometry. A type is an accelerator when it offers, const and noexcept:
//   Hit  closest_hit(const Ray&)  the hit of smallest t, the lower id at equal t; not found() = miss
//   bool occluded(const Ray&)     whether closest_hit() would find anything
//   void closest_hits(const RayBatch&, HitBatch&), occluded(const RayBatch&, OccludedBatch&)  the same for many rays
#pragma once

#include <array>
#include <concepts>
#include <memory>
#include <optional>
#include <string_view>
#include <variant>

#include "accel/brute_force.h"
#include "accel/bvh.h"
#include "accel/parallel.h"
#include "accel/uniform_grid.h"

namespace glint {

template <class T>
concept Accelerator = requires(const T& a, const Ray& ray, const RayBatch& rays, HitBatch& hits, OccludedBatch& occluded) {
    { a.closest_hit(ray) }
    noexcept->std::same_as<Hit>;
    { a.occluded(ray) }
    noexcept->std::same_as<bool>;
    { a.closest_hits(rays, hits) }
    noexcept;
    { a.occluded(rays, occluded) }
    noexcept;
    { a.memory_bytes() } -> std::convertible_to<std::size_t>;
};
static_assert(Accelerator<BruteForce> && Accelerator<UniformGrid> && Accelerator<Bvh>);

enum class AcceleratorKind { none, grid, bvh };
constexpr std::array<std::string_view, 3> kAcceleratorNames{"none", "grid", "bvh"};
using AnyAccelerator = std::variant<BruteForce, UniformGrid, Bvh>;  // in the order of AcceleratorKind

// Throws std::bad_alloc when memory does not suffice, std::length_error when ids do not, and what parallel_for throws.
[[nodiscard]] std::shared_ptr<const AnyAccelerator> build_accelerator(AcceleratorKind kind,
                                                                      std::shared_ptr<const Geometry> geometry,
                                                                      const ParallelFor& parallel_for = serial_for,
                                                                      BuildQuality quality = BuildQuality::quality);
[[nodiscard]] std::optional<AcceleratorKind> accelerator_named(std::string_view name);
[[nodiscard]] Hit closest_hit(const AnyAccelerator& accelerator, const Ray& ray) noexcept;
[[nodiscard]] bool occluded(const AnyAccelerator& accelerator, const Ray& ray) noexcept;
[[nodiscard]] inline AcceleratorKind kind_of(const AnyAccelerator& a) { return static_cast<AcceleratorKind>(a.index()); }
[[nodiscard]] std::size_t memory_bytes(const AnyAccelerator& accelerator);

}  // namespace glint
