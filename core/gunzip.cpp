#include "core/gunzip.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>
#include <libdeflate.h>

#include "core/scene.h"

namespace glint {
namespace {

constexpr std::size_t kAlwaysAllowed = std::size_t{1} << 26, kMostBytes = std::size_t{1} << 31, kMostRatio = 64;
// No code of deflate stands for more than 258 bytes per two bits.
constexpr std::size_t kDeflateRatio = 1032;

// What the last four bytes say about the size of the last member, modulo 2^32: a hint, as likely a lie.
std::size_t announced_size(std::string_view packed) {
    if (packed.size() < 4) return 0;
    std::size_t size = 0;
    for (std::size_t i = 0; i < 4; ++i) size |= std::size_t{static_cast<unsigned char>(packed[packed.size() - 4 + i])} << (8 * i);
    return size;
}

}  // namespace

bool is_gzip(std::string_view packed) { return packed.starts_with("\x1f\x8b"); }

UnpackedBytes gunzip(std::string_view packed, const std::string& name) {
    const auto refuse = [&](std::string_view reason) { throw SceneError(fmt::format("{}: {}", name, reason)); };
    const std::size_t limit = std::min(
        kMostBytes, std::max(kAlwaysAllowed, packed.size() <= kMostBytes / kMostRatio ? kMostRatio * packed.size() : kMostBytes));
    const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor(
        libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
    if (!decompressor) throw std::bad_alloc();
    std::size_t capacity = std::min({limit, announced_size(packed), kDeflateRatio * packed.size()});
    UnpackedBytes out{std::make_unique_for_overwrite<char[]>(capacity), 0};
    while (!packed.empty()) {
        std::size_t consumed = 0, produced = 0;
        const libdeflate_result result =
            libdeflate_gzip_decompress_ex(decompressor.get(), packed.data(), packed.size(), out.data.get() + out.size,
                                          capacity - out.size, &consumed, &produced);
        if (result == LIBDEFLATE_SUCCESS) {
            out.size += produced;
            packed.remove_prefix(consumed);
            continue;
        }
        if (result != LIBDEFLATE_INSUFFICIENT_SPACE) refuse("the gzip data are damaged or cut off");
        if (capacity >= limit) refuse(fmt::format("unpacks to more than {} bytes", limit));
        capacity = std::min(limit, std::max(2 * capacity, std::size_t{1} << 20));
        auto larger = std::make_unique_for_overwrite<char[]>(capacity);
        std::memcpy(larger.get(), out.data.get(), out.size);
        out.data = std::move(larger);
    }
    return out;
}

}  // namespace glint
