// Unpacks a gzip file (RFC 1952) in one go.
// Knows nothing of what is inside. Invariant: memory is bounded by the size of the packed file, never by what it claims.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace glint {

// Bytes that were never filled with zeros first, unlike a string's: tens of megabytes of a mesh.
struct UnpackedBytes {
    std::unique_ptr<char[]> data;
    std::size_t size = 0;

    [[nodiscard]] std::string_view view() const { return {data.get(), size}; }
};

[[nodiscard]] bool is_gzip(std::string_view packed);

// All members of the file, one after the other. SceneError `name: reason` when it is damaged, cut off, or unpacks to more
// than 2 GiB or, beyond 64 MiB, to more than 64 times its size: meshes shrink to a quarter, a bomb to a thousandth.
[[nodiscard]] UnpackedBytes gunzip(std::string_view packed, const std::string& name);

}  // namespace glint
