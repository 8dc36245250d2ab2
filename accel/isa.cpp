#include "accel/isa.h"

#include <atomic>
#include <cassert>

namespace glint {
namespace {

std::atomic<Isa>& chosen() {
    static std::atomic<Isa> isa{best_isa()};
    return isa;
}

}  // namespace

bool supported(Isa isa) noexcept {
    switch (isa) {
        case Isa::baseline: return true;
        case Isa::avx2:
            return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
                   __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("lzcnt");
        case Isa::avx512: break;
    }
    return supported(Isa::avx2) && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
}

Isa best_isa() noexcept { return supported(Isa::avx512) ? Isa::avx512 : supported(Isa::avx2) ? Isa::avx2 : Isa::baseline; }

std::optional<Isa> isa_named(std::string_view name) {
    for (std::size_t i = 0; i < kIsaNames.size(); ++i) {
        if (kIsaNames[i] == name) return static_cast<Isa>(i);
    }
    return std::nullopt;
}

void use_isa(Isa isa) noexcept {
    assert(supported(isa));
    chosen() = isa;
}

Isa isa_in_use() noexcept { return chosen(); }

}  // namespace glint
