#include "core/ply_header.h"

#include <algorithm>
#include <array>
#include <charconv>

#include <fmt/format.h>

#include "core/p3f_lexer.h"

namespace glint::ply {
namespace {

using p3f::in_quotes;

constexpr std::size_t kMostHeaderBytes = std::size_t{1} << 20;
constexpr std::size_t kMostProperties = 1000;  // of all elements

struct TypeName {
    std::string_view name;
    Type type;
};
constexpr std::array<TypeName, 16> kTypeNames{{{"char", Type::int8},
                                               {"uchar", Type::uint8},
                                               {"short", Type::int16},
                                               {"ushort", Type::uint16},
                                               {"int", Type::int32},
                                               {"uint", Type::uint32},
                                               {"float", Type::float32},
                                               {"double", Type::float64},
                                               {"int8", Type::int8},
                                               {"uint8", Type::uint8},
                                               {"int16", Type::int16},
                                               {"uint16", Type::uint16},
                                               {"int32", Type::int32},
                                               {"uint32", Type::uint32},
                                               {"float32", Type::float32},
                                               {"float64", Type::float64}}};

class HeaderReader {
public:
    HeaderReader(std::string_view text, const std::string& name)
        : text_(text.substr(0, kMostHeaderBytes)), cut_(text.size() > kMostHeaderBytes), messages_(name) {}

    Header read() {
        next_line();
        if (word(0) != "ply") messages_.fail(1, "not a PLY file: expected 'ply'");
        bool format = false;
        while (next_line()) {
            if (words_.empty() || word(0) == "comment" || word(0) == "obj_info") continue;
            if (word(0) == "end_header") {
                if (!format) messages_.fail(line_, "not a PLY file: the header has no 'format'");
                header_.body = at_;
                header_.body_line = line_ + 1;
                return std::move(header_);
            }
            if (word(0) == "format") {
                read_format();
                format = true;
            } else if (word(0) == "element") {
                read_element();
            } else if (word(0) == "property") {
                read_property();
            } else {
                messages_.fail(line_, fmt::format("{} is no word of a PLY header", in_quotes(word(0))));
            }
        }
        messages_.fail(line_, cut_ ? "the header is longer than 1 MiB" : "the header has no 'end_header'");
    }

private:
    // Splits the next line into words; lines end with "\n", "\r\n" or, from old Macintoshes, "\r". False at the end.
    bool next_line() {
        words_.clear();
        if (at_ == text_.size()) return false;
        ++line_;
        const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
        std::string_view line = text_.substr(at_, end - at_);
        at_ = end;
        if (at_ < text_.size()) at_ += text_.substr(at_).starts_with("\r\n") ? 2 : 1;
        constexpr std::string_view kBlank = " \t\v\f";
        // More words than any statement has are of no interest.
        while (words_.size() < 6) {
            const std::size_t start = line.find_first_not_of(kBlank);
            if (start == std::string_view::npos) break;
            line.remove_prefix(start);
            const std::size_t length = std::min(line.find_first_of(kBlank), line.size());
            words_.push_back(line.substr(0, length));
            line.remove_prefix(length);
        }
        return true;
    }

    [[nodiscard]] std::string_view word(std::size_t i) const { return i < words_.size() ? words_[i] : std::string_view(); }

    void read_format() {
        if (word(1) == "ascii") {
            header_.format = Format::ascii;
        } else if (word(1) == "binary_little_endian") {
            header_.format = Format::binary_little_endian;
        } else if (word(1) == "binary_big_endian") {
            header_.format = Format::binary_big_endian;
        } else {
            messages_.fail(line_, fmt::format("unknown format {}, expected ascii, binary_little_endian or binary_big_endian",
                                              in_quotes(word(1))));
        }
    }

    void read_element() {
        const std::string_view name = word(1), count = word(2);
        std::uint64_t announced = 0;
        const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), announced);
        if (name.empty() || count.empty() || error == std::errc::invalid_argument || end != count.data() + count.size()) {
            messages_.fail(line_, fmt::format("{} announces {}, expected a count", in_quotes(name), in_quotes(count)));
        }
        if (error == std::errc::result_out_of_range) announced = ~std::uint64_t{0};
        header_.elements.push_back({std::string(name), announced, line_, {}});
    }

    Type type(std::string_view name) const {
        const auto* const at =
            std::find_if(kTypeNames.begin(), kTypeNames.end(), [&](const TypeName& t) { return t.name == name; });
        if (at == kTypeNames.end()) messages_.fail(line_, fmt::format("unknown type {}", in_quotes(name)));
        return at->type;
    }

    void read_property() {
        if (header_.elements.empty()) messages_.fail(line_, "'property' before any 'element'");
        if (++properties_ > kMostProperties) messages_.fail(line_, fmt::format("more than {} properties", kMostProperties));
        Property property;
        const bool list = word(1) == "list";
        if (list) {
            property.length = type(word(2));
            if (!is_integer(*property.length)) messages_.fail(line_, "the length of a list must be an integer");
        }
        property.type = type(word(list ? 3 : 1));
        property.name = word(list ? 4 : 2);
        if (property.name.empty()) messages_.fail(line_, "'property' needs a name");
        header_.elements.back().properties.push_back(std::move(property));
    }

    std::string_view text_;
    bool cut_;
    p3f::Messages messages_;
    std::size_t at_ = 0, line_ = 0, properties_ = 0;
    std::vector<std::string_view> words_;  // of the current line
    Header header_;
};

}  // namespace

std::size_t size_of(Type type) {
    constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
    return kSizes[static_cast<std::size_t>(type)];
}

std::optional<std::size_t> Element::find(std::string_view property) const {
    const auto at = std::find_if(properties.begin(), properties.end(), [&](const Property& p) { return p.name == property; });
    if (at == properties.end()) return std::nullopt;
    return static_cast<std::size_t>(at - properties.begin());
}

std::size_t Element::least_bytes(Format format) const {
    std::size_t bytes = 0;
    // As text a number needs a digit and a blank.
    for (const Property& p : properties) bytes += format == Format::ascii ? 2 : size_of(p.length.value_or(p.type));
    return bytes;
}

Header read_header(std::string_view text, const std::string& name) { return HeaderReader(text, name).read(); }

}  // namespace glint::ply
