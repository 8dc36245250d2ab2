#include "core/image.h"

#include <stb/stb_image.h>
#include <stb/stb_image_write.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>

#include <fmt/format.h>

#include "core/display_bytes.h"
#include "core/exr.h"
#include "core/picture_size.h"
#include "core/rgbe.h"

namespace glint {
namespace {

std::uint32_t crc32(const std::string& bytes) {
    std::uint32_t crc = 0xffffffffu;
    for (const char c : bytes) {
        crc ^= static_cast<std::uint8_t>(c);
        for (int k = 0; k < 8; ++k) crc = (crc >> 1) ^ (crc & 1u ? 0xedb88320u : 0u);
    }
    return ~crc;
}

std::string big_endian(std::uint32_t x) {
    return {static_cast<char>(x >> 24), static_cast<char>(x >> 16), static_cast<char>(x >> 8), static_cast<char>(x)};
}

std::string png_chunk(const std::string& type, const std::string& data) {
    return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + big_endian(crc32(type + data));
}

Image read_pfm(std::istream& in, std::size_t bytes, const std::string& path) {
    std::string magic;
    std::int64_t width = 0, height = 0;
    double scale = 0.0;
    in >> magic >> width >> height >> scale;
    in.get();
    if (!in || (magic != "PF" && magic != "Pf") || width < 1 || height < 1 || width > kMaxImagePixels / height || scale == 0.0) {
        throw ImageError(path + ": not a PFM picture");
    }
    const std::size_t channels = magic == "PF" ? 3 : 1;
    if (bytes / (sizeof(float) * channels) < static_cast<std::size_t>(width * height)) {
        throw ImageError(path + ": the picture is cut short");
    }
    Image image{static_cast<int>(width), static_cast<int>(height), {}};
    image.pixels.resize(static_cast<std::size_t>(width * height));
    std::vector<float> row(static_cast<std::size_t>(width) * channels);
    for (int y = image.height - 1; y >= 0; --y) {
        if (!in.read(reinterpret_cast<char*>(row.data()), static_cast<std::streamsize>(row.size() * sizeof(float)))) {
            throw ImageError(path + ": the picture is cut short");
        }
        for (float& f : row) {
            auto bits = std::bit_cast<std::uint32_t>(f);
            if (scale > 0.0) bits = __builtin_bswap32(bits);
            f = std::bit_cast<float>(bits);
        }
        for (int x = 0; x < image.width; ++x) {
            const float* p = &row[static_cast<std::size_t>(x) * channels];
            image.at(x, y) = channels == 3 ? glm::vec3(p[0], p[1], p[2]) : glm::vec3(p[0]);
        }
    }
    return image;
}

}  // namespace

Image8 to_display(const Image& image, const DisplaySettings& display) {
    Image8 out{image.width, image.height, {}};
    out.rgb.resize(image.pixels.size() * 3);
    const float scale = std::exp2(display.exposure_ev);
    const DisplayBytes& bytes = DisplayBytes::of(display.transfer);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const glm::vec3 p = image.pixels[i];
        if (std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z)) {
            out.rgb[3 * i] = out.rgb[3 * i + 2] = 255;  // magenta
            continue;
        }
        for (int c = 0; c < 3; ++c) out.rgb[3 * i + static_cast<std::size_t>(c)] = bytes.byte_of(p[c] * scale);
    }
    return out;
}

std::string encode_png(const Image8& image, Transfer transfer) {
    std::string png;
    const auto append = [](void* context, void* data, int size) {
        static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
    };
    if (stbi_write_png_to_func(append, &png, image.width, image.height, 3, image.rgb.data(), image.width * 3) == 0) {
        throw ImageError("out of memory while encoding a PNG");
    }
    // Colour chunks go right behind the header (8 bytes of signature, 25 of IHDR). The course's pictures hold linear
    // numbers but are meant to be shown as they are, so they carry no colour chunk at all.
    if (transfer == Transfer::srgb) png.insert(33, png_chunk("sRGB", std::string(1, '\0')));
    return png;
}

std::string encode_pfm(const Image& image) {
    std::string out = fmt::format("PF\n{} {}\n-1.0\n", image.width, image.height);
    for (int y = image.height - 1; y >= 0; --y) {
        for (int x = 0; x < image.width; ++x) {
            const glm::vec3 p = image.at(x, y);
            for (int c = 0; c < 3; ++c) {
                const auto bits = std::bit_cast<std::array<char, 4>>(p[c]);
                out.append(bits.data(), bits.size());
            }
        }
    }
    return out;
}

void write_file_atomically(const std::filesystem::path& path, const std::string& bytes) {
    const auto refuse = [&](const std::string& why) {
        return ImageError(fmt::format("{}: cannot write: {}", path.string(), why));
    };
    // A device or pipe cannot be replaced by renaming, and need not be.
    std::error_code ignored;
    const auto status = std::filesystem::status(path, ignored);
    if (std::filesystem::is_directory(status)) throw refuse("it is a folder");
    const bool direct = std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
    std::filesystem::path target = path;
    if (!direct) target += fmt::format(".{}.part", getpid());
    errno = 0;
    std::ofstream out(target, std::ios::binary | std::ios::trunc);
    if (!out) throw refuse(std::strerror(errno));
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    const std::string why = std::strerror(errno);
    if (!out) {
        if (!direct) std::filesystem::remove(target, ignored);
        throw refuse(why);
    }
    if (direct) return;
    std::error_code error;
    std::filesystem::rename(target, path, error);
    if (error) {
        std::filesystem::remove(target, ignored);
        throw refuse(error.message());
    }
}

StoredImage read_stored_image(const std::filesystem::path& path) {
    const std::string name = path.string();
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) throw ImageError(name + ": no such picture");
    std::ifstream in(path, std::ios::binary);
    std::stringstream contents;
    contents << in.rdbuf();
    const std::string bytes = contents.str();
    if (bytes.starts_with("PF") || bytes.starts_with("Pf")) return {read_pfm(contents, bytes.size(), name), true};
    if (is_rgbe(bytes)) return {decode_rgbe(bytes, name), true};
    if (is_exr(bytes)) return {decode_exr(bytes, name), true};
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    int width = 0, height = 0, channels = 0;
    if (bytes.size() > std::size_t{1} << 30 ||
        !stbi_info_from_memory(data, static_cast<int>(bytes.size()), &width, &height, &channels)) {
        throw ImageError(name + ": not a PNG, JPEG, PFM, Radiance or OpenEXR picture");
    }
    if (std::int64_t{width} * height > kMaxImagePixels) throw ImageError(name + ": the picture is too large");
    if (!can_hold(bytes.size(), width, height) || !chunks_fit(bytes))
        throw ImageError(name + ": the file is too short for its picture");
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
        stbi_load_from_memory(data, static_cast<int>(bytes.size()), &width, &height, &channels, 3), &stbi_image_free);
    if (pixels == nullptr) throw ImageError(name + ": the picture is broken");
    Image image{width, height, {}};
    image.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const stbi_uc* p = pixels.get() + 3 * i;
        image.pixels[i] = glm::vec3(p[0], p[1], p[2]) / 255.0f;
    }
    return {std::move(image), false};
}

Image read_image(const std::filesystem::path& path) { return read_stored_image(path).image; }

ImageDifference difference(const Image& a, const Image& b) {
    if (a.width != b.width || a.height != b.height) {
        throw ImageError(fmt::format("the pictures differ in size: {}x{} and {}x{}", a.width, a.height, b.width, b.height));
    }
    ImageDifference d;
    d.pixels = a.pixels.size();
    double sum = 0.0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        bool differs = false;
        for (int c = 0; c < 3; ++c) {
            const double e = std::abs(static_cast<double>(a.pixels[i][c]) - static_cast<double>(b.pixels[i][c]));
            // Written so that a NaN counts as a difference.
            differs = differs || !(e == 0.0);
            sum += e * e;
            d.max = e <= d.max ? d.max : e;
        }
        d.differing += differs ? 1 : 0;
    }
    d.rmse = d.pixels > 0 ? std::sqrt(sum / (3.0 * static_cast<double>(d.pixels))) : 0.0;
    return d;
}

}  // namespace glint
