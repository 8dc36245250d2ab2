// Instruction sets that the traversal is compiled for, and the one in use.
// Invariant: every one gives the same bits, so the choice is about speed alone.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace glint {

enum class Isa { baseline, avx2, avx512 };
constexpr std::array<std::string_view, 3> kIsaNames{"baseline", "avx2", "avx512"};

// Whether this machine can run it (avx2 includes FMA; avx512 means F, VL, DQ and BW).
[[nodiscard]] bool supported(Isa isa) noexcept;
[[nodiscard]] Isa best_isa() noexcept;
[[nodiscard]] std::optional<Isa> isa_named(std::string_view name);

// What accelerators built from now on use; at start the best. Set once, before the first build.
void use_isa(Isa isa) noexcept;
[[nodiscard]] Isa isa_in_use() noexcept;

}  // namespace glint
