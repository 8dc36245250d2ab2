#include "core/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace glint {
namespace {

// The library's view of bytes in memory.
class Source : public Imf::IStream {
public:
    explicit Source(const std::string& bytes) : IStream("memory"), bytes_(bytes) {}
    bool read(char to[], int n) override {
        if (n < 0 || static_cast<std::uint64_t>(n) > bytes_.size() - at_) throw Iex::InputExc("cut short");
        std::memcpy(to, bytes_.data() + at_, static_cast<std::size_t>(n));
        at_ += static_cast<std::uint64_t>(n);
        return at_ < bytes_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t to) override {
        if (to > bytes_.size()) throw Iex::InputExc("cut short");
        at_ = to;
    }

private:
    const std::string& bytes_;
    std::uint64_t at_ = 0;
};

class Sink : public Imf::OStream {
public:
    Sink() : OStream("memory") {}
    void write(const char from[], int n) override {
        const auto size = static_cast<std::uint64_t>(n);
        if (at_ + size > bytes.size()) bytes.resize(at_ + size);
        std::memcpy(bytes.data() + at_, from, size);
        at_ += size;
    }
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t to) override { at_ = to; }

    std::string bytes;

private:
    std::uint64_t at_ = 0;
};

// A channel of pixels that lie 12 bytes apart; `base` is where pixel (0, 0) of the file's coordinates would be.
Imf::Slice slice(float* first, int width, const Imath::Box2i& window) {
    constexpr std::size_t kStep = sizeof(glm::vec3);
    return Imf::Slice::Make(Imf::FLOAT, first, window.min, width, window.max.y - window.min.y + 1, kStep,
                            kStep * static_cast<std::size_t>(width), 1, 1, 0.0);
}

// Types whose attributes the library reads by their kind, whatever size the file says.
constexpr std::pair<std::string_view, std::size_t> kFixedSizes[]{{"box2f", 16},
                                                                 {"box2i", 16},
                                                                 {"chromaticities", 32},
                                                                 {"compression", 1},
                                                                 {"deepImageState", 1},
                                                                 {"double", 8},
                                                                 {"envmap", 1},
                                                                 {"float", 4},
                                                                 {"int", 4},
                                                                 {"keycode", 28},
                                                                 {"lineOrder", 1},
                                                                 {"m33d", 72},
                                                                 {"m33f", 36},
                                                                 {"m44d", 128},
                                                                 {"m44f", 64},
                                                                 {"rational", 8},
                                                                 {"tiledesc", 9},
                                                                 {"timecode", 8},
                                                                 {"v2d", 16},
                                                                 {"v2f", 8},
                                                                 {"v2i", 8},
                                                                 {"v3d", 24},
                                                                 {"v3f", 12},
                                                                 {"v3i", 12}};

// Little-endian, at a place that need not be within.
std::uint32_t word_at(std::string_view bytes, std::size_t at) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 4 && at + k < bytes.size(); ++k) {
        word |= std::uint32_t{static_cast<std::uint8_t>(bytes[at + k])} << (8 * k);
    }
    return word;
}

// Whether the library, which goes by what it finds in an attribute's value, comes to the value's end and not beyond.
bool value_fits(std::string_view type, std::string_view value) {
    for (const auto& [name, size] : kFixedSizes) {
        if (type == name) return value.size() == size;
    }
    if (type == "floatvector") return value.size() % 4 == 0;
    if (type == "preview") {
        const std::uint64_t pixels = std::uint64_t{word_at(value, 0)} * word_at(value, 4);
        return value.size() >= 8 && value.size() % 4 == 0 && pixels == value.size() / 4 - 2;
    }
    std::size_t at = 0;
    if (type == "stringvector") {
        while (at < value.size()) at += 4 + std::size_t{word_at(value, at)};
    } else if (type == "chlist") {
        constexpr std::size_t kChannel = 16;  // type, linear, sampling; behind a name and its zero
        while (at < value.size() && value[at] != '\0') at = std::min(value.find('\0', at), value.size()) + 1 + kChannel;
        ++at;
    } else {
        at = value.size();
    }
    return at == value.size();
}

// Whether each attribute of the headers lies within the file, where the library will look for it: it takes the memory that one
// claims before it reads it.
bool attributes_fit(std::string_view bytes) {
    std::size_t at = 8;
    const bool several_parts = bytes.size() > at && (bytes[5] & 0x10) != 0;
    do {
        while (at < bytes.size() && bytes[at] != '\0') {
            const std::size_t type = bytes.find('\0', at) + 1;  // npos + 1 is 0
            const std::size_t end = type == 0 ? std::string_view::npos : bytes.find('\0', type);
            if (end == std::string_view::npos || end + 5 > bytes.size()) return false;
            at = end + 5;
            const std::size_t size = word_at(bytes, end + 1);
            if (size > bytes.size() - at || !value_fits(bytes.substr(type, end - type), bytes.substr(at, size))) return false;
            at += size;
        }
        ++at;
    } while (several_parts && at < bytes.size() && bytes[at] != '\0');
    return at <= bytes.size();
}

constexpr int kMaxSide = 65535;
// Deflate, the strongest of the format's codes, makes 1032 bytes of one.
constexpr std::int64_t kMostExpansion = 1100;

}  // namespace

bool is_exr(const std::string& bytes) { return bytes.starts_with("\x76\x2f\x31\x01"); }

Image decode_exr(const std::string& bytes, const std::string& name) try {
    if (!attributes_fit(bytes)) throw ImageError(name + ": the EXR picture is broken: its header is cut short");
    // Asked before the library allocates what a header claims: a table of all lines.
    Imf::Header::setMaxImageSize(kMaxSide, kMaxSide);
    Source source(bytes);
    Imf::InputFile file(source, 0);
    const Imath::Box2i window = file.header().dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1,
                       height = std::int64_t{window.max.y} - window.min.y + 1;
    if (width < 1 || height < 1 || width > kMaxImagePixels / height) throw ImageError(name + ": the picture is too large");
    if (width * height > kMostExpansion * static_cast<std::int64_t>(bytes.size())) {
        throw ImageError(name + ": the picture is cut short");
    }
    const Imf::ChannelList& channels = file.header().channels();
    const bool grey = channels.findChannel("R") == nullptr && channels.findChannel("Y") != nullptr;
    Image image{static_cast<int>(width), static_cast<int>(height), {}};
    image.pixels.resize(static_cast<std::size_t>(width * height));
    Imf::FrameBuffer target;
    for (int c = 0; c < (grey ? 1 : 3); ++c) {
        const char* channel = grey ? "Y" : c == 0 ? "R" : c == 1 ? "G" : "B";
        const Imf::Channel* found = channels.findChannel(channel);
        if (found == nullptr) throw ImageError(fmt::format("{}: no channel {} in the EXR picture", name, channel));
        if (found->xSampling != 1 || found->ySampling != 1) throw ImageError(name + ": subsampled EXR pictures are not read");
        target.insert(channel, slice(&image.pixels.front()[c], image.width, window));
    }
    file.setFrameBuffer(target);
    file.readPixels(window.min.y, window.max.y);
    if (grey) {
        for (glm::vec3& p : image.pixels) p = glm::vec3(p.x);
    }
    return image;
} catch (const Iex::BaseExc& e) {
    std::string reason = e.what();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    throw ImageError(fmt::format("{}: the EXR picture is broken: {}", name, reason));
}

std::string encode_exr(const Image& image) {
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    const Imath::Box2i window = header.dataWindow();
    Imf::addChromaticities(header, Imf::Chromaticities());  // those of Rec. 709, which are sRGB's
    Imf::FrameBuffer from;
    // The library takes a pointer that it does not write through.
    auto* pixels = const_cast<glm::vec3*>(image.pixels.data());
    for (int c = 0; c < 3; ++c) {
        const char* channel = c == 0 ? "R" : c == 1 ? "G" : "B";
        header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
        from.insert(channel, slice(&(*pixels)[c], image.width, window));
    }
    Sink sink;
    {
        Imf::OutputFile file(sink, header, 0);
        file.setFrameBuffer(from);
        file.writePixels(image.height);
    }
    return std::move(sink.bytes);
}

}  // namespace glint
