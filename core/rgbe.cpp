#include "core/rgbe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <vector>

#include <fmt/format.h>

namespace glint {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

constexpr int kShift = 136;                         // 128, and 8 bits of mantissa
constexpr int kLargestExponent = 127;               // of std::frexp, where the stored byte is 255
constexpr int kLeastWidth = 8, kMostWidth = 32767;  // rows that may be run-length coded
constexpr std::size_t kLongestRun = 127, kLongestDump = 128, kLeastRun = 4;

Rgbe pack(glm::vec3 p) {
    // Clears NaN, too.
    std::array<float, 3> v{};
    for (int c = 0; c < 3; ++c)
        v[static_cast<std::size_t>(c)] = p[c] > 0.0f ? std::min(p[c], std::ldexp(255.0f, kLargestExponent - 8)) : 0.0f;
    const float largest = std::max({v[0], v[1], v[2]});
    int exponent = 0;
    (void)std::frexp(largest, &exponent);
    const auto mantissa = [&](float x) { return std::lround(std::ldexp(x, 8 - exponent)); };
    // Rounded up to the next power of two.
    if (mantissa(largest) > 255) ++exponent;
    if (largest == 0.0f || exponent + kShift - 8 < 1) return {0, 0, 0, 0};
    Rgbe out{};
    for (std::size_t c = 0; c < 3; ++c) out[c] = static_cast<std::uint8_t>(mantissa(v[c]));
    out[3] = static_cast<std::uint8_t>(exponent + kShift - 8);
    return out;
}

glm::vec3 unpack(const Rgbe& p) {
    if (p[3] == 0) return glm::vec3(0.0f);
    const auto value = [&](std::size_t c) { return std::ldexp(static_cast<float>(p[c]), int{p[3]} - kShift); };
    return {value(0), value(1), value(2)};
}

// The length of equal bytes from `at`, at most what a run can hold.
std::size_t run_at(const std::vector<std::uint8_t>& row, std::size_t at) {
    std::size_t n = 1;
    while (n < kLongestRun && at + n < row.size() && row[at + n] == row[at]) ++n;
    return n;
}

void append_coded(const std::vector<std::uint8_t>& row, std::string& out) {
    std::size_t at = 0;
    while (at < row.size()) {
        std::size_t end = at, run = 0;
        while (end < row.size() && end - at < kLongestDump && (run = run_at(row, end)) < kLeastRun) ++end;
        if (end > at) {
            out += static_cast<char>(end - at);
            for (; at < end; ++at) out += static_cast<char>(row[at]);
        } else {
            out += static_cast<char>(128 + run);
            out += static_cast<char>(row[at]);
            at += run;
        }
    }
}

// The bytes behind the header, taken one after the other.
class Reader {
public:
    Reader(const std::string& bytes, std::size_t at, const std::string& name) : bytes_(bytes), at_(at), name_(name) {}
    std::uint8_t next() {
        if (at_ >= bytes_.size()) throw ImageError(name_ + ": the picture is cut short");
        return static_cast<std::uint8_t>(bytes_[at_++]);
    }
    Rgbe pixel() {
        Rgbe p{};
        for (std::uint8_t& b : p) b = next();
        return p;
    }
    [[nodiscard]] ImageError broken() const { return ImageError(name_ + ": the Radiance picture is broken"); }

    void coded_channel(std::vector<Rgbe>& row, std::size_t channel) {
        for (std::size_t x = 0; x < row.size();) {
            const std::size_t code = next();
            const bool is_run = code > 128;
            const std::size_t count = is_run ? code - 128 : code;
            // A count of nothing would never end at the end of a damaged file.
            if (count == 0 || count > row.size() - x) throw broken();
            std::uint8_t value = 0;
            for (std::size_t i = 0; i < count; ++i) {
                if (i == 0 || !is_run) value = next();
                row[x++][channel] = value;
            }
        }
    }
    void row(std::vector<Rgbe>& row) {
        const Rgbe first = pixel();
        const auto width = static_cast<int>(row.size());
        const bool may_be_coded = width >= kLeastWidth && width <= kMostWidth;
        if (may_be_coded && first[0] == 2 && first[1] == 2 && first[2] < 128) {
            if (first[2] * 256 + first[3] != width) throw broken();
            for (std::size_t c = 0; c < 4; ++c) coded_channel(row, c);
            return;
        }
        row[0] = first;
        for (std::size_t x = 1; x < row.size(); ++x) {
            row[x] = pixel();
            if (row[x][0] == 1 && row[x][1] == 1 && row[x][2] == 1) throw broken();
        }
    }

private:
    const std::string& bytes_;
    std::size_t at_;
    const std::string& name_;
};

struct Header {
    std::int64_t width = 0, height = 0;
    float exposure = 1.0f;
    std::size_t end = 0;  // where the pixels begin
};

Header read_header(const std::string& bytes, const std::string& name) {
    Header h;
    std::istringstream in(bytes.substr(0, std::min<std::size_t>(bytes.size(), 1 << 16)));
    std::string line;
    while (std::getline(in, line) && !line.empty()) {
        if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe") {
            throw ImageError(fmt::format("{}: Radiance pictures of {} are not read", name, line));
        }
        if (line.starts_with("EXPOSURE=")) h.exposure *= std::strtof(line.c_str() + 9, nullptr);
    }
    std::string y, x, rest;
    std::getline(in, line);
    std::istringstream size(line);
    const bool read = static_cast<bool>(size >> y >> h.height >> x >> h.width) && !(size >> rest);
    if (!in || !read || h.width < 1 || h.height < 1 || !(h.exposure > 0.0f) || !std::isfinite(h.exposure)) {
        throw ImageError(name + ": the Radiance picture is broken");
    }
    if (y != "-Y" || x != "+X") throw ImageError(fmt::format("{}: rows in the order {} {} are not read", name, y, x));
    h.end = static_cast<std::size_t>(in.tellg());
    if (h.width > kMaxImagePixels / h.height) throw ImageError(name + ": the picture is too large");
    // A byte of a run stands for 127/2 values at most, four to a pixel: what claims more has no such rows.
    if (h.width * h.height > 16 * static_cast<std::int64_t>(bytes.size() - h.end)) {
        throw ImageError(name + ": the picture is cut short");
    }
    return h;
}

}  // namespace

bool is_rgbe(const std::string& bytes) { return bytes.starts_with("#?RADIANCE\n") || bytes.starts_with("#?RGBE\n"); }

Image decode_rgbe(const std::string& bytes, const std::string& name) {
    const Header h = read_header(bytes, name);
    Image image{static_cast<int>(h.width), static_cast<int>(h.height), {}};
    image.pixels.reserve(static_cast<std::size_t>(h.width * h.height));
    Reader reader(bytes, h.end, name);
    std::vector<Rgbe> row(static_cast<std::size_t>(h.width));
    for (int y = 0; y < image.height; ++y) {
        reader.row(row);
        for (const Rgbe& p : row) image.pixels.push_back(unpack(p) / h.exposure);
    }
    return image;
}

std::string encode_rgbe(const Image& image) {
    std::string out = fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", image.height, image.width);
    const bool coded = image.width >= kLeastWidth && image.width <= kMostWidth;
    std::array<std::vector<std::uint8_t>, 4> channels;
    for (int y = 0; y < image.height; ++y) {
        for (auto& channel : channels) channel.clear();
        for (int x = 0; x < image.width; ++x) {
            const Rgbe p = pack(image.at(x, y));
            for (std::size_t c = 0; c < 4; ++c) {
                if (coded) {
                    channels[c].push_back(p[c]);
                } else {
                    out += static_cast<char>(p[c]);
                }
            }
        }
        if (!coded) continue;
        out += {2, 2, static_cast<char>(image.width >> 8), static_cast<char>(image.width & 255)};
        for (const auto& channel : channels) append_coded(channel, out);
    }
    return out;
}

}  // namespace glint
