// The numbers of a PLY file's body, one after the other: as text, or as bytes of either order.
// Knows no elements. Both classes answer to the same calls, so that one reader serves the three formats.
// Invariant: nothing is read behind the end; real() is as it stands in the file, finite or not.
#pragma once

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "core/p3f_lexer.h"
#include "core/ply_header.h"
#include "core/scene.h"

namespace glint::ply {

class TextValues {
public:
    TextValues(std::string_view text, const Header& header, const std::string& name)
        : begin_(text.data() + header.body), at_(begin_), end_(text.data() + text.size()), line_(header.body_line), name_(name) {}

    [[nodiscard]] double real(Type type) {
        start_word();
        const char* const from = at_ + (*at_ == '+' ? 1 : 0);
        double value = 0.0;
        // Numbers that are floats in binary are read as floats here, and doubles as doubles: the three formats agree.
        const auto [stop, error] = type == Type::float32 ? narrow_real(from, value) : std::from_chars(from, end_, value);
        if (error == std::errc::invalid_argument || !ends_word(stop)) fail(fmt::format("{} is not a number", word()));
        // Too large, or too small: the general reader tells which.
        if (error == std::errc::result_out_of_range) {
            value = p3f::to_number({from, static_cast<std::size_t>(stop - from)}).value_or(HUGE_VAL);
        }
        at_ = stop;
        return value;
    }

    [[nodiscard]] std::int64_t integer(Type) {
        start_word();
        const char* const from = at_ + (*at_ == '+' ? 1 : 0);
        // Digits by hand: half of a mesh's time goes here. Up to 18 of them cannot overflow.
        const bool negative = from < end_ && *from == '-';
        const char* p = from + (negative ? 1 : 0);
        const char* const first = p;
        const char* const last = end_ - p > 18 ? p + 18 : end_;
        std::int64_t value = 0;
        for (; p < last && *p >= '0' && *p <= '9'; ++p) value = 10 * value + (*p - '0');
        if (p == first || !ends_word(p)) fail(fmt::format("{} is not an integer", word()));
        at_ = p;
        return negative ? -value : value;
    }

    void skip(Type, std::uint64_t count = 1) {
        for (; count > 0; --count) {
            start_word();
            while (at_ < end_ && !blank(*at_)) ++at_;
        }
    }

    // Whether `count` more numbers can follow.
    [[nodiscard]] bool has_room(Type, std::uint64_t count) const { return count <= (remaining() + 1) / 2; }
    [[nodiscard]] std::uint64_t remaining() const { return static_cast<std::uint64_t>(end_ - at_); }

    // Blames the line of the last number that was read, or of the one being read.
    [[noreturn]] void fail(std::string_view reason) const {
        const auto line = line_ + static_cast<std::size_t>(std::count(begin_, at_, '\n'));
        throw SceneError(fmt::format("{}:{}: {}", name_, line, reason));
    }

private:
    static bool blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
    [[nodiscard]] bool ends_word(const char* p) const { return p == end_ || blank(*p); }

    void start_word() {
        const char* p = at_;
        while (p < end_ && blank(*p)) ++p;
        if (p == end_) fail("the file ends too early");
        at_ = p;
    }

    std::from_chars_result narrow_real(const char* from, double& value) const {
        float narrow = 0.0f;
        const std::from_chars_result result = std::from_chars(from, end_, narrow);
        value = static_cast<double>(narrow);
        return result;
    }

    [[nodiscard]] std::string word() const {
        const char* p = at_;
        while (p < end_ && !blank(*p) && p - at_ < 100) ++p;
        return p3f::in_quotes({at_, static_cast<std::size_t>(p - at_)});
    }

    const char *begin_, *at_, *end_;
    std::size_t line_;  // of begin_
    const std::string& name_;
};

template <bool kSwapped>
class BinaryValues {
public:
    BinaryValues(std::string_view bytes, const Header& header, const std::string& name)
        : bytes_(bytes), at_(header.body), name_(name) {}

    [[nodiscard]] double real(Type type) {
        if (type == Type::float32) return static_cast<double>(std::bit_cast<float>(take<std::uint32_t>()));
        if (type == Type::float64) return std::bit_cast<double>(take<std::uint64_t>());
        return static_cast<double>(integer(type));
    }

    [[nodiscard]] std::int64_t integer(Type type) {
        switch (type) {
            case Type::int8: return static_cast<std::int8_t>(take<std::uint8_t>());
            case Type::uint8: return take<std::uint8_t>();
            case Type::int16: return static_cast<std::int16_t>(take<std::uint16_t>());
            case Type::uint16: return take<std::uint16_t>();
            case Type::int32: return static_cast<std::int32_t>(take<std::uint32_t>());
            default: return take<std::uint32_t>();
        }
    }

    void skip(Type type, std::uint64_t count = 1) {
        if (!has_room(type, count)) fail("the file ends too early");
        at_ += static_cast<std::size_t>(count) * size_of(type);
    }

    [[nodiscard]] bool has_room(Type type, std::uint64_t count) const { return count <= remaining() / size_of(type); }
    [[nodiscard]] std::uint64_t remaining() const { return bytes_.size() - at_; }

    [[noreturn]] void fail(std::string_view reason) const { throw SceneError(fmt::format("{}:byte {}: {}", name_, at_, reason)); }

private:
    template <class Unsigned>
    Unsigned take() {
        if (remaining() < sizeof(Unsigned)) fail("the file ends too early");
        Unsigned value = 0;
        if constexpr (kSwapped) {
            for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
                const auto byte = static_cast<unsigned char>(bytes_[at_ + i]);
                value = static_cast<Unsigned>(static_cast<std::uint64_t>(value) << 8 | byte);
            }
        } else {
            std::memcpy(&value, bytes_.data() + at_, sizeof(Unsigned));
        }
        at_ += sizeof(Unsigned);
        return value;
    }

    std::string_view bytes_;
    std::size_t at_;
    const std::string& name_;
};

}  // namespace glint::ply
