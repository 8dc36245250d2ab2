// The dielectrics a ray is inside of, innermost last, by material index: nested media without priorities.
// Knows no geometry; the surface says whether a ray enters or leaves. Invariant: what was never entered cannot be left;
// leaving it leads to air. Beyond kMaxNesting levels a medium is not remembered.
#pragma once

#include <array>
#include <cstdint>

namespace glint {

class MediumStack {
public:
    static constexpr std::uint32_t kAir = 0xffffffffu;
    static constexpr std::size_t kMaxNesting = 6;

    [[nodiscard]] std::uint32_t top() const { return size_ == 0 ? kAir : materials_[size_ - 1]; }
    void enter(std::uint32_t material) {
        if (size_ < kMaxNesting) materials_[size_++] = material;
    }
    // Removes the innermost `material`; if it is not inside, everything is forgotten: outside is air.
    void leave(std::uint32_t material) {
        for (std::size_t i = size_; i > 0; --i) {
            if (materials_[i - 1] != material) continue;
            for (; i < size_; ++i) materials_[i - 1] = materials_[i];
            --size_;
            return;
        }
        size_ = 0;
    }
    [[nodiscard]] bool contains(std::uint32_t material) const {
        for (std::size_t i = 0; i < size_; ++i) {
            if (materials_[i] == material) return true;
        }
        return false;
    }

private:
    std::array<std::uint32_t, kMaxNesting> materials_{};
    std::size_t size_ = 0;
};

}  // namespace glint
