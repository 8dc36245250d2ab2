#include "core/p3f_lexer.h"

#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/scene.h"

namespace glint::p3f {
namespace {

constexpr std::size_t kMostWarnings = 20;
constexpr std::size_t kLongestQuote = 40;
// A number needs a digit and a blank: the densest text a count can be honest about.
constexpr std::uint64_t kBytesPerNumber = 2;

bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

}  // namespace

void Messages::fail(std::size_t line, std::string_view reason) const {
    throw SceneError(fmt::format("{}:{}: {}", name_, line, reason));
}

void Messages::warn(std::size_t line, std::string_view reason) { add(fmt::format("{}:{}: {}", name_, line, reason)); }

void Messages::warn(std::string_view reason) { add(fmt::format("{}: {}", name_, reason)); }

void Messages::add(std::string line) {
    if (warnings_.size() < kMostWarnings) {
        warnings_.push_back(std::move(line));
    } else {
        ++left_out_;
    }
}

std::vector<std::string> Messages::take() {
    if (left_out_ > 0) warnings_.push_back(fmt::format("{}: {} further warnings", name_, left_out_));
    left_out_ = 0;
    return std::exchange(warnings_, {});
}

std::string in_quotes(std::string_view word) {
    std::string out = "'";
    for (const char c : word.substr(0, kLongestQuote)) out += c >= ' ' && c <= '~' ? c : '?';
    return out + (word.size() > kLongestQuote ? "...'" : "'");
}

std::optional<double> to_number(std::string_view word) {
    // from_chars knows no leading plus, and no locale: "0,5" is no number whatever the user's language.
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
    const char* const end = word.data() + word.size();
    double value = 0.0;
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    if (error == std::errc::invalid_argument || stop != end) return std::nullopt;
    if (error != std::errc::result_out_of_range) return value;
    // Out of range is said of huge and of tiny numbers alike; the wider type tells which.
    long double wide = 0.0L;
    if (std::from_chars(word.data(), end, wide).ec != std::errc()) return std::numeric_limits<double>::infinity();
    return static_cast<double>(wide);
}

Lexer::Lexer(std::string_view text, const Messages& messages) : text_(text), messages_(&messages) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text_.starts_with(kByteOrderMark)) text_.remove_prefix(kByteOrderMark.size());
}

void Lexer::skip_blank() {
    bool comment = false;
    while (cursor_.offset < text_.size()) {
        const char c = text_[cursor_.offset];
        if (!comment && c != '#' && !is_blank(c)) return;
        comment = comment || c == '#';
        // A carriage return alone ends a line too (old Macintosh files); before a line feed it is part of it.
        const bool pair = c == '\r' && cursor_.offset + 1 < text_.size() && text_[cursor_.offset + 1] == '\n';
        if (c == '\n' || (c == '\r' && !pair)) {
            ++cursor_.line;
            cursor_.line_start = true;
            comment = false;
        }
        ++cursor_.offset;
    }
}

Token Lexer::next() {
    skip_blank();
    const std::size_t begin = cursor_.offset;
    while (cursor_.offset < text_.size() && text_[cursor_.offset] != '#' && !is_blank(text_[cursor_.offset])) ++cursor_.offset;
    const Token token{text_.substr(begin, cursor_.offset - begin), cursor_.line, cursor_.line_start};
    if (!token.end()) {
        cursor_.line_start = false;
        last_line_ = token.line;
    }
    return token;
}

bool Lexer::number_follows() const { return to_number(peek().text).has_value(); }

void Lexer::skip_line() {
    while (cursor_.offset < text_.size() && text_[cursor_.offset] != '\n' && text_[cursor_.offset] != '\r') ++cursor_.offset;
}

void Lexer::missing(std::string_view what, std::size_t needed, std::size_t found) const {
    const Token token = peek();
    const std::string where = token.end() ? "the end of the file" : in_quotes(token.text);
    messages_->fail(last_line_,
                    fmt::format("{} needs {} number{}, found {} before {}", what, needed, needed == 1 ? "" : "s", found, where));
}

double Lexer::checked(double value, const Token& token) const {
    if (!std::isfinite(value)) messages_->fail(token.line, fmt::format("{} is not a finite number", in_quotes(token.text)));
    if (std::abs(value) > static_cast<double>(std::numeric_limits<float>::max())) {
        messages_->fail(token.line, fmt::format("{} is too large", in_quotes(token.text)));
    }
    return value;
}

void Lexer::read(std::span<double> values, std::string_view what) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        const Lexer before = *this;
        const Token token = next();
        const std::optional<double> value = to_number(token.text);
        if (!value) before.missing(what, values.size(), i);
        values[i] = checked(*value, token);
    }
}

std::vector<double> Lexer::numbers_until_word(std::size_t most) {
    std::vector<double> values;
    while (values.size() < most) {
        const Token token = peek();
        const std::optional<double> value = to_number(token.text);
        if (!value) break;
        values.push_back(checked(*value, next()));
    }
    return values;
}

std::int64_t Lexer::integer(std::string_view what) {
    constexpr double kLargestExact = 9007199254740992.0;  // 2^53: beyond it a double no longer counts
    const double value = numbers<1>(what)[0];
    if (value != std::trunc(value) || std::abs(value) > kLargestExact) {
        messages_->fail(last_line_, fmt::format("{} needs a whole number, found {}", what, value));
    }
    return static_cast<std::int64_t>(value);
}

std::uint32_t Lexer::count(std::string_view what, std::uint64_t numbers_each) {
    const std::int64_t announced = integer(what);
    if (announced < 0) messages_->fail(last_line_, fmt::format("{} announces {}", what, announced));
    // Checked before anything is allocated. The last number of a file needs no blank behind it, hence the + 1.
    const std::uint64_t room = (text_.size() - cursor_.offset + 1) / (kBytesPerNumber * numbers_each);
    if (static_cast<std::uint64_t>(announced) > room || announced > std::numeric_limits<std::uint32_t>::max()) {
        messages_->fail(last_line_, fmt::format("{} announces {}, more than the file can hold", what, announced));
    }
    return static_cast<std::uint32_t>(announced);
}

std::string_view Lexer::name(std::string_view what) {
    const Token token = peek();
    if (token.end() || token.first_on_line) messages_->fail(last_line_, fmt::format("{} needs a name", what));
    return next().text;
}

}  // namespace glint::p3f
