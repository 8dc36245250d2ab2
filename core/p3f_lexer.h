// Words, numbers, line numbers and messages of the P3F/NFF text format; the PLY reader shares the messages.
// Knows no statement of the format. Line breaks mean nothing except to comments, which run from '#' to the end of the line.
// Invariant: a number handed out is finite and survives the conversion to float; counts fit into what is left of the file.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace glint::p3f {

// What is said about one file. Errors end the reading, warnings are collected, up to a limit that keeps a wrong file readable.
class Messages {
public:
    explicit Messages(std::string name) : name_(std::move(name)) {}
    // Throws SceneError `name:line: reason`.
    [[noreturn]] void fail(std::size_t line, std::string_view reason) const;
    void warn(std::size_t line, std::string_view reason);
    // About the file as a whole.
    void warn(std::string_view reason);
    // All warnings, the last one telling how many were left out.
    [[nodiscard]] std::vector<std::string> take();

private:
    void add(std::string line);

    std::string name_;
    std::vector<std::string> warnings_;
    std::size_t left_out_ = 0;
};

struct Token {
    std::string_view text;  // empty at the end of the file
    std::size_t line = 1;
    bool first_on_line = false;

    [[nodiscard]] bool end() const { return text.empty(); }
};

// The word as it may be printed: one line, no control bytes, short.
[[nodiscard]] std::string in_quotes(std::string_view word);
// Anything strtod takes in the C locale but hexadecimal; nullopt for other words. May be infinite or NaN.
[[nodiscard]] std::optional<double> to_number(std::string_view word);

class Lexer {
public:
    // Both must outlive the lexer.
    Lexer(std::string_view text, const Messages& messages);

    [[nodiscard]] Token next();
    [[nodiscard]] Token peek() const { return Lexer(*this).next(); }
    [[nodiscard]] bool number_follows() const;
    // Line of the last token handed out: where something is missing when the next token is not what was expected.
    [[nodiscard]] std::size_t line() const { return last_line_; }
    void skip_line();

    // `what` is named in messages, for example "'s'". All throw SceneError.
    template <std::size_t N>
    [[nodiscard]] std::array<double, N> numbers(std::string_view what) {
        std::array<double, N> values{};
        read(values, what);
        return values;
    }
    void read(std::span<double> values, std::string_view what);
    // All numbers up to the next word, at most `most`.
    [[nodiscard]] std::vector<double> numbers_until_word(std::size_t most);
    [[nodiscard]] std::int64_t integer(std::string_view what);
    // A count of records of at least `numbers_each` numbers, checked against what the rest of the file can hold.
    [[nodiscard]] std::uint32_t count(std::string_view what, std::uint64_t numbers_each);
    // A file or folder name on the same line.
    [[nodiscard]] std::string_view name(std::string_view what);

private:
    struct Cursor {
        std::size_t offset = 0;
        std::size_t line = 1;
        bool line_start = true;
    };

    void skip_blank();
    [[noreturn]] void missing(std::string_view what, std::size_t needed, std::size_t found) const;
    [[nodiscard]] double checked(double value, const Token& token) const;

    std::string_view text_;
    const Messages* messages_;
    Cursor cursor_;
    std::size_t last_line_ = 1;
};

}  // namespace glint::p3f
