#include "accel/accelerator.h"

#include <utility>

namespace glint {

std::shared_ptr<const AnyAccelerator> build_accelerator(AcceleratorKind kind, std::shared_ptr<const Geometry> geometry,
                                                        const ParallelFor& parallel_for, BuildQuality quality) {
    switch (kind) {
        case AcceleratorKind::none: return std::make_shared<const AnyAccelerator>(BruteForce(std::move(geometry)));
        case AcceleratorKind::grid: return std::make_shared<const AnyAccelerator>(UniformGrid(std::move(geometry), parallel_for));
        case AcceleratorKind::bvh: break;
    }
    return std::make_shared<const AnyAccelerator>(Bvh(std::move(geometry), parallel_for, isa_in_use(), quality));
}

std::optional<AcceleratorKind> accelerator_named(std::string_view name) {
    for (std::size_t i = 0; i < kAcceleratorNames.size(); ++i) {
        if (kAcceleratorNames[i] == name) return static_cast<AcceleratorKind>(i);
    }
    return std::nullopt;
}

Hit closest_hit(const AnyAccelerator& accelerator, const Ray& ray) noexcept {
    return std::visit([&](const auto& a) { return a.closest_hit(ray); }, accelerator);
}

bool occluded(const AnyAccelerator& accelerator, const Ray& ray) noexcept {
    return std::visit([&](const auto& a) { return a.occluded(ray); }, accelerator);
}

std::size_t memory_bytes(const AnyAccelerator& accelerator) {
    return std::visit([](const auto& a) { return a.memory_bytes(); }, accelerator);
}

}  // namespace glint
