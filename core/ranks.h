// Which of up to kRayBatch numbers go on, and closing their ranks, array by array, in place and in their order.
// Knows nothing of what they are. Invariant: an array is read up to the next multiple of kRun and holds the kept() first after
// close(); what lies behind them there has no meaning.
#pragma once

#include <cstddef>
#include <cstdint>

#include "accel/ray_batch.h"

namespace glint {

class Ranks {
public:
    static constexpr std::size_t kRun = 8;
    static_assert(kRayBatch % kRun == 0);

    // n numbers of which those go on whose flag is not 0; flags are read up to the next multiple of kRun.
    Ranks(const std::uint32_t* flags, std::size_t n) noexcept;

    [[nodiscard]] std::size_t kept() const { return kept_; }
    // Bit i is for number kRun * run + i.
    [[nodiscard]] unsigned mask(std::size_t run) const { return masks_[run]; }
    void close(float* row) const noexcept;
    void close(std::uint32_t* row) const noexcept;

private:
    std::uint8_t masks_[kRayBatch / kRun];
    std::size_t runs_ = 0, kept_ = 0;
};

}  // namespace glint
