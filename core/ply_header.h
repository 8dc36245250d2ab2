// The header of a PLY file (Turk 1994): which elements follow, made of which properties, in which format.
// Knows no mesh and reads no data. Invariant: all types are known, a list's length has an integer type, and the header's
// size is bounded, so that its description is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace glint::ply {

enum class Format { ascii, binary_little_endian, binary_big_endian };
enum class Type : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

[[nodiscard]] std::size_t size_of(Type type);
[[nodiscard]] inline bool is_integer(Type type) { return type < Type::float32; }

struct Property {
    std::string name;
    Type type = Type::float32;
    std::optional<Type> length;  // of a list
};

struct Element {
    std::string name;
    std::uint64_t announced = 0;
    std::size_t line = 1;  // of the announcement
    std::vector<Property> properties;

    [[nodiscard]] std::optional<std::size_t> find(std::string_view property) const;
    // The fewest bytes that one record can take.
    [[nodiscard]] std::size_t least_bytes(Format format) const;
};

struct Header {
    Format format = Format::ascii;
    std::vector<Element> elements;
    std::size_t body = 0;       // offset of the first byte behind the header
    std::size_t body_line = 1;  // its line
};

// Throws SceneError `name:line: reason`.
[[nodiscard]] Header read_header(std::string_view text, const std::string& name);

}  // namespace glint::ply
