#include "accel/isa.h"

#include <cpuid.h>

#include <atomic>
#include <cassert>

namespace glint {
namespace {

std::atomic<Isa>& chosen() {
    static std::atomic<Isa> isa{best_isa()};
    return isa;
}

// clang 14 does not know this feature by its name.
bool counts_leading_zeros() noexcept {
    unsigned a = 0, b = 0, c = 0, d = 0;
    return __get_cpuid(0x80000001u, &a, &b, &c, &d) != 0 && (c & 1u << 5) != 0;
}

}  // namespace

bool supported(Isa isa) noexcept {
    switch (isa) {
        case Isa::baseline: return true;
        case Isa::avx2:
            return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
                   __builtin_cpu_supports("bmi2") && counts_leading_zeros();
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
