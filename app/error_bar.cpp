#include "app/error_bar.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace glint {

std::string error_text(const ErrorEstimate& e) {
    if (e.kind == ErrorEstimate::Kind::exact) return "exact";
    if (e.kind == ErrorEstimate::Kind::unknown) return {};
    const double half = 0.5 * (e.high - e.low);
    if (!(half > 0.0)) return fmt::format("relRMSE {:.3g}", e.relrmse);
    // Two digits of the interval, one where that is the usual 0.0004; the estimate to as many places.
    const int places = std::clamp(1 - static_cast<int>(std::floor(std::log10(half))), 0, 12);
    return fmt::format("relRMSE {:.{}f} \u00b1 {:.{}f}", e.relrmse, places, half, places);
}

Forecast forecast(const ErrorEstimate& e, const Progress& p, std::size_t pixels, double target) {
    Forecast f{target, predicted_samples(e, pixels, target), 0.0};
    const double taken = static_cast<double>(p.rays.camera) / static_cast<double>(std::max<std::size_t>(1, pixels));
    if (f.spp > 0 && taken > 0.0) f.seconds = p.seconds * std::max(1.0, f.spp / taken);
    return f;
}

double next_target(const ErrorEstimate& e) {
    if (!(e.cautious > 0.0)) return 0.0;
    const double decade = std::pow(10.0, std::ceil(std::log10(e.cautious)));
    for (const double step : {2.0, 5.0, 10.0, 20.0})
        if (decade / step < e.cautious) return decade / step;
    return 0.0;
}

nlohmann::json error_json(const ErrorEstimate& e, const Forecast& f) {
    if (e.kind == ErrorEstimate::Kind::unknown)
        return {{"relrmse", nullptr}, {"low", nullptr}, {"high", nullptr},
                {"slope", nullptr},   {"spp", e.spp},   {"predicted", nullptr}};
    nlohmann::json json{{"relrmse", e.relrmse}, {"low", e.low}, {"high", e.high}, {"spp", e.spp}};
    json["slope"] = e.kind == ErrorEstimate::Kind::exact ? nlohmann::json() : nlohmann::json(e.slope);
    json["predicted"] = nullptr;
    if (f.spp > 0) json["predicted"] = {{"target", f.target}, {"spp", f.spp}, {"seconds", f.seconds}};
    return json;
}

}  // namespace glint
