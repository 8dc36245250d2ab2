// Names of random dimensions: what a random number of a sample is for. Knows no sampler.
#pragma once

#include <cstdint>

namespace glint {

constexpr std::uint32_t kCameraPath = 1;  // the name of a camera ray in the tree of a sample's rays

// Random dimensions of a camera ray; those of a path node are hash(path, purpose) with the purposes below.
namespace dimension {
constexpr std::uint32_t pixel = 0, lens = 1;
constexpr std::uint32_t fuzz_direction = 0x80000000u, fuzz_radius = 0x80000001u;
constexpr std::uint32_t glass_branch = 0x80000002u;  // lights take their index
}  // namespace dimension

}  // namespace glint
