#include "app/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/picture_format.h"
#include "core/error_metrics.h"
#include "core/flip.h"

namespace glint {
namespace {

struct Comparison {
    ErrorMetrics error;
    std::optional<Flip> flip;  // empty where it was not asked for, or one picture holds radiance and the other display bytes
};

std::optional<Flip> flip_of(const StoredImage& image, const StoredImage& reference) {
    if (image.radiance != reference.radiance) return std::nullopt;
    return image.radiance ? flip_of_radiance(image.image, reference.image) : flip_of_display(image.image, reference.image);
}

double value_of(const Comparison& c, Metric metric) {
    switch (metric) {
        case Metric::rmse: return c.error.rmse;
        case Metric::relmse: return c.error.relmse;
        case Metric::mae: return c.error.mae;
        case Metric::psnr: return c.error.psnr;
        case Metric::flip: return c.flip ? c.flip->mean : std::numeric_limits<double>::quiet_NaN();
    }
    return std::numeric_limits<double>::quiet_NaN();
}

bool within(const Comparison& c, const Options& o) {
    return c.error.non_finite == 0 && within_threshold(o, value_of(c, o.metric));
}

// What is not finite becomes null, since JSON has no word for it.
nlohmann::json values(const Comparison& c, const Options& o) {
    nlohmann::json json{{"metric", kMetricNames[static_cast<std::size_t>(o.metric)]},
                        {"within", within(c, o)},
                        {"rmse", c.error.rmse},
                        {"relmse", c.error.relmse},
                        {"mae", c.error.mae},
                        {"psnr", c.error.psnr},
                        {"bias", c.error.bias},
                        {"bias_z", c.error.bias_z},
                        {"p99", c.error.p99},
                        {"max", c.error.max},
                        {"non_finite_pixels", c.error.non_finite},
                        {"differing_pixels", c.error.differing},
                        {"pixels", c.error.pixels}};
    if (o.threshold) json["threshold"] = *o.threshold;
    if (c.flip) json["flip"] = c.flip->mean;
    return json;
}

// 0..1 in display bytes: black, violet, red, orange, almost white, a quarter apart. No shade of it is the magenta of a NaN.
std::array<std::uint8_t, 3> heat(float x) {
    if (!std::isfinite(x)) return {255, 0, 255};
    constexpr std::array<glm::vec3, 5> kColors{
        {{0.0f, 0.0f, 0.0f}, {60.0f, 15.0f, 110.0f}, {190.0f, 50.0f, 85.0f}, {250.0f, 150.0f, 30.0f}, {255.0f, 255.0f, 210.0f}}};
    const float at = std::clamp(x, 0.0f, 1.0f) * 4.0f;
    const auto below = static_cast<std::size_t>(std::min(at, 3.0f));
    const glm::vec3 c = glm::mix(kColors[below], kColors[below + 1], at - static_cast<float>(below)) + 0.5f;
    return {static_cast<std::uint8_t>(c.x), static_cast<std::uint8_t>(c.y), static_cast<std::uint8_t>(c.z)};
}

// Differences over four decades: 0.0001 and below black, 0.01 red, 1 and above almost white.
float shown_difference(glm::vec3 d) {
    const float worst = std::max({d.x, d.y, d.z});
    // max() may drop a NaN.
    return std::isfinite(d.x + d.y + d.z) ? 1.0f + std::log10(worst) / 4.0f : std::numeric_limits<float>::quiet_NaN();
}

Image8 as_heat(const Image& error, bool is_flip) {
    Image8 out{error.width, error.height, {}};
    out.rgb.reserve(3 * error.pixels.size());
    for (const glm::vec3 p : error.pixels) {
        // The logarithm of no difference is no finite number, but black.
        const bool none = p == glm::vec3(0.0f);
        const auto color = heat(is_flip ? p.x : none ? 0.0f : shown_difference(p));
        out.rgb.insert(out.rgb.end(), color.begin(), color.end());
    }
    return out;
}

Image error_image(const StoredImage& a, const StoredImage& b, const Comparison& c, Metric metric) {
    if (metric != Metric::flip || !c.flip) return absolute_difference(a.image, b.image);
    Image map{a.image.width, a.image.height, {}};
    for (const float f : c.flip->map) map.pixels.emplace_back(f);
    return map;
}

}  // namespace

bool within_threshold(const Options& o, double value) {
    if (o.metric == Metric::psnr) return value >= o.threshold.value_or(std::numeric_limits<double>::infinity());
    return value <= o.threshold.value_or(0.0);
}

int run_compare(const Options& o) {
    std::optional<PictureFormat> format;
    if (!o.output.empty()) format = format_of(o.output);
    if (o.output == "-") throw UsageError("-o -: stdout carries the metrics; name a file for the error image");
    const StoredImage a = read_stored_image(o.arguments[0]), b = read_stored_image(o.arguments[1]);
    const Comparison c{error_metrics(a.image, b.image), flip_of(a, b)};
    if (o.metric == Metric::flip && !c.flip) {
        throw UsageError("--metric flip: one picture holds radiance, the other display bytes; FLIP compares two of a kind");
    }
    if (format) {
        const Image error = error_image(a, b, c, o.metric);
        write_file_atomically(o.output, *format == PictureFormat::png
                                            ? encode_png(as_heat(error, o.metric == Metric::flip), Transfer::srgb)
                                            : encode(error, *format, {}));
    }
    if (o.stats_json) {
        std::cout << values(c, o).dump(2) << "\n";
    } else {
        const ErrorMetrics& e = c.error;
        fmt::print("rmse {:.6g}\nrelmse {:.6g}\nmae {:.6g}\npsnr {:.6g}\nbias {:.6g}\nbias_z {:.6g}\np99 {:.6g}\nmax {:.6g}\n",
                   e.rmse, e.relmse, e.mae, e.psnr, e.bias, e.bias_z, e.p99, e.max);
        if (c.flip) fmt::print("flip {:.6g}\n", c.flip->mean);
        fmt::print("non_finite_pixels {}\ndiffering_pixels {} of {}\n", e.non_finite, e.differing, e.pixels);
    }
    return within(c, o) ? 0 : 1;
}

Reference::Reference(const Options& options, int width, int height)
    : options_(options), stored_(read_stored_image(options.reference)) {
    if (stored_.image.width == width && stored_.image.height == height) return;
    throw ImageError(fmt::format("{}: the reference is {}x{}, the picture {}x{}", options.reference, stored_.image.width,
                                 stored_.image.height, width, height));
}

StoredImage Reference::like_stored(const Image& rendered, const DisplaySettings& display) const {
    StoredImage picture{rendered, stored_.radiance};
    if (!stored_.radiance) {
        const Image8 shown = to_display(rendered, display);
        for (std::size_t i = 0; i < picture.image.pixels.size(); ++i) {
            picture.image.pixels[i] = glm::vec3(shown.rgb[3 * i], shown.rgb[3 * i + 1], shown.rgb[3 * i + 2]) / 255.0f;
        }
    }
    return picture;
}

double Reference::relrmse(const Image& rendered, const DisplaySettings& display) const {
    return std::sqrt(error_metrics(like_stored(rendered, display).image, stored_.image).relmse);
}

Reference::Verdict Reference::check(const Image& rendered, const DisplaySettings& display, nlohmann::json& stats) const {
    const StoredImage picture = like_stored(rendered, display);
    Comparison c{error_metrics(picture.image, stored_.image), {}};
    if (options_.metric == Metric::flip) c.flip = flip_of(picture, stored_);
    stats["reference"] = values(c, options_);
    stats["reference"]["file"] = options_.reference;
    return {within(c, options_), value_of(c, options_.metric)};
}

}  // namespace glint
