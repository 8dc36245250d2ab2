#include "app/options.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "app/option_parser.h"
#include "app/option_values.h"

namespace glint {
namespace {

constexpr std::int64_t kMaxChartPixels = 1 << 20;  // several pictures' sums are kept at a time

}  // namespace

FeatureSet edit_features(std::string_view list, FeatureSet start, bool& whitted) {
    FeatureSet set = start;
    bool replaced = false;
    for (std::string_view word : split(list, ",")) {
        const char sign = word.empty() ? '?' : word.front();
        if (sign == '+' || sign == '-') {
            word.remove_prefix(1);
        } else if (!std::exchange(replaced, true)) {
            set = FeatureSet{};
        }
        if (sign != '+' && sign != '-' && (word == "all" || word == "whitted")) {
            whitted = whitted || word == "whitted";
            set.bits |= word == "all" ? FeatureSet::all().bits : FeatureSet::whitted().bits;
            continue;
        }
        set.set(static_cast<Feature>(choice("--features", word, kFeatureNames)), sign != '-');
    }
    return set;
}

std::optional<Isa> chosen_isa(std::string_view option, std::string_view value, bool (*has)(Isa) noexcept) {
    constexpr std::array<std::string_view, 4> names{"auto", "baseline", "avx2", "avx512"};
    const std::size_t i = choice(option, value, names);
    if (i == 0) return std::nullopt;
    const auto isa = static_cast<Isa>(i - 1);
    if (has(isa)) return isa;
    std::string known;
    for (std::size_t k = 0; k < kIsaNames.size(); ++k) {
        if (has(static_cast<Isa>(k))) known += fmt::format(" {}", kIsaNames[k]);
    }
    throw UsageError(fmt::format("{}: this machine does not support '{}', only{}", option, value, known));
}

std::optional<Options> parse_options(const std::vector<std::string>& words) {
    Options o;
    std::vector<std::string> rest = words;
    if (!rest.empty()) {
        const auto found = std::find(kCommandNames.begin(), kCommandNames.end(), rest.front());
        if (found != kCommandNames.end()) {
            o.command = static_cast<Command>(found - kCommandNames.begin());
            rest.erase(rest.begin());
        }
    }
    if (!fill_options(o, rest)) return std::nullopt;

    const auto expect = [&](std::size_t least, std::size_t most, std::string_view what) {
        const std::size_t n = o.arguments.size();
        if (n < least || n > most) {
            throw UsageError(fmt::format("glint {} takes {}{}", kCommandNames[static_cast<std::size_t>(o.command)], what,
                                         n > most ? fmt::format(", not also '{}'", o.arguments[most]) : ""));
        }
    };
    const auto needs_error = [&](bool given, std::string_view option) {
        if (given && o.settings.sampler == SamplerKind::regular)
            throw UsageError(
                fmt::format("{}: the sampler 'regular' errs the same way in every pixel and cannot tell by how much", option));
    };
    switch (o.command) {
        case Command::view:
            expect(0, 1, "one scene");
            needs_error(o.settings.adaptive, "--adaptive");
            break;
        case Command::render:
            expect(0, 1, "one scene");
            if (o.output.empty()) throw UsageError("glint render needs -o FILE");
            needs_error(o.noise > 0.0, "--noise");
            needs_error(o.settings.adaptive, "--adaptive");
            if (o.threshold && o.reference.empty()) throw UsageError("--reference-threshold needs --reference FILE");
            break;
        case Command::compare: expect(2, 2, "two pictures"); break;
        case Command::chart:
            if (o.output.empty()) throw UsageError("glint chart needs -o DIR");
            if (std::int64_t{o.width} * o.height > kMaxChartPixels)
                throw UsageError("--resolution: a chart takes at most 2^20 pixels");
            break;
        case Command::info: expect(1, 1, "one scene"); break;
        case Command::list: expect(0, 0, "no arguments"); break;
    }
    return o;
}

}  // namespace glint
