#include "app/chart_reference.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include "core/scene_io.h"

namespace glint::chart {
namespace {

constexpr std::string_view kMagic = "glint reference 1\n";
constexpr std::size_t kMostKey = 1 << 16;

// The means so far and, by Welford's update (1962), the scatter around them.
struct Scatter {
    std::vector<glm::dvec3> mean, squares;
    int n = 0;

    void add(const Image& image) {
        ++n;
        mean.resize(image.pixels.size(), glm::dvec3(0.0));
        squares.resize(image.pixels.size(), glm::dvec3(0.0));
        for (std::size_t i = 0; i < mean.size(); ++i) {
            const glm::dvec3 value(image.pixels[i]), before = value - mean[i];
            mean[i] += before / static_cast<double>(n);
            squares[i] += before * (value - mean[i]);
        }
    }
};

template <class T>
void append(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string header_of(const std::string& key, const Reference& r) {
    return fmt::format("{}{}\n{} {} {} {} {}\n", kMagic, key.size(), r.width, r.height, r.replicates, r.spp, key);
}

}  // namespace

double Reference::relative_variance() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < mean.size(); ++i) {
        for (int c = 0; c < 3; ++c) sum += variance[i][c] / relative_scale(mean[i][c]);
    }
    return sum / (3.0 * static_cast<double>(mean.size()));
}

double relative_error(const Image& image, const Reference& reference) {
    if (image.pixels.size() != reference.mean.size()) throw std::logic_error("picture and reference differ in size");
    double sum = 0.0;
    for (std::size_t i = 0; i < reference.mean.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const double off = static_cast<double>(image.pixels[i][c]) - reference.mean[i][c];
            sum += (off * off - reference.variance[i][c]) / relative_scale(reference.mean[i][c]);
        }
    }
    return sum / (3.0 * static_cast<double>(reference.mean.size()));
}

double relative_error_of_pair(const Image& a, const Image& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const double x = a.pixels[i][c], y = b.pixels[i][c];
            sum += 0.5 * (x - y) * (x - y) / relative_scale(0.5 * (x + y));
        }
    }
    return sum / (3.0 * static_cast<double>(a.pixels.size()));
}

Reference average(int spp, int most, const std::function<Image(int)>& replicate,
                  const std::function<bool(const Reference&)>& enough) {
    Scatter scatter;
    Reference r;
    r.spp = spp;
    for (int i = 0; i < std::max(2, most); ++i) {
        const Image image = replicate(i);
        scatter.add(image);
        r.width = image.width;
        r.height = image.height;
        r.replicates = scatter.n;
        if (scatter.n < 2) continue;
        r.mean = scatter.mean;
        r.variance = scatter.squares;
        // Of the mean of n: sum of squares / (n - 1) / n.
        for (glm::dvec3& v : r.variance) v /= static_cast<double>(scatter.n) * (scatter.n - 1);
        if (enough(r)) break;
    }
    return r;
}

std::uint64_t digest(std::string_view bytes, std::uint64_t hash) {
    for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return hash;
}

void write_reference(const std::filesystem::path& path, const std::string& key, const Reference& r) {
    std::string bytes = header_of(key, r);
    for (const auto* plane : {&r.mean, &r.variance}) {
        for (const glm::dvec3& v : *plane) append(bytes, v.x), append(bytes, v.y), append(bytes, v.z);
    }
    append(bytes, digest(bytes));
    write_file_atomically(path, bytes);
}

std::optional<Reference> read_reference(const std::filesystem::path& path, const std::string& key, std::string& why) {
    why.clear();
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return std::nullopt;
    std::string bytes;
    try {
        bytes = reader::read_file(path);
    } catch (const std::exception&) {
        why = "cannot be read";
        return std::nullopt;
    }
    const auto refuse = [&](const char* reason) {
        why = reason;
        return std::nullopt;
    };
    if (!bytes.starts_with(kMagic)) return refuse("is no reference of this version");
    std::uint64_t stored = 0;
    if (bytes.size() < kMagic.size() + sizeof stored) return refuse("is cut off");
    std::memcpy(&stored, bytes.data() + bytes.size() - sizeof stored, sizeof stored);
    bytes.resize(bytes.size() - sizeof stored);
    if (digest(bytes) != stored) return refuse("is damaged");
    // The digest vouches for what follows, but not for who wrote it: sizes are believed only where the length agrees.
    Reference r;
    std::size_t key_size = 0;
    int used = 0;
    if (std::sscanf(bytes.c_str() + kMagic.size(), "%zu\n%d %d %d %d %n", &key_size, &r.width, &r.height, &r.replicates, &r.spp,
                    &used) != 5 ||
        key_size > kMostKey || r.width < 1 || r.height < 1 || r.width > 65535 || r.height > 65535 || r.replicates < 2 ||
        r.spp < 1) {
        return refuse("is damaged");
    }
    const std::string header = header_of(key, r);
    if (!bytes.starts_with(header)) return refuse("belongs to another scene, setting or version");
    const std::size_t pixels = static_cast<std::size_t>(r.width) * static_cast<std::size_t>(r.height);
    if (bytes.size() != header.size() + pixels * 6 * sizeof(double)) return refuse("has another size than it says");
    const char* at = bytes.data() + header.size();
    for (auto* plane : {&r.mean, &r.variance}) {
        plane->resize(pixels);
        for (glm::dvec3& v : *plane) {
            double xyz[3];
            std::memcpy(xyz, at, sizeof xyz);
            v = {xyz[0], xyz[1], xyz[2]};
            at += sizeof xyz;
        }
    }
    return r;
}

}  // namespace glint::chart
