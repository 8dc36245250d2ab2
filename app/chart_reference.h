// References: pictures that are far closer to the truth than what is judged by them, with their own error, kept in files.
// Knows no figure. Invariants: a reference is the mean, in double, of replicates with different seeds and a sampler of another
// family than what it judges; nothing in it is cut off or clamped beyond what its settings say.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/error_metrics.h"

namespace glint::chart {

struct Reference {
    int width = 0, height = 0;
    int replicates = 0, spp = 0;       // spp: of one replicate
    std::vector<glm::dvec3> mean;      // linear radiance, top row first
    std::vector<glm::dvec3> variance;  // squared standard error of the mean, from the scatter of the replicates

    [[nodiscard]] double samples() const { return static_cast<double>(replicates) * spp; }
    // mean variance / relative_scale(mean): what the reference's own noise adds to every relMSE against it.
    [[nodiscard]] double relative_variance() const;
};

// The denominator of relMSE (Rousselle, Knaus & Zwicker 2011).
[[nodiscard]] inline double relative_scale(double reference) { return reference * reference + kRelativeFloor; }
// relMSE of a picture of the same size, what the reference's noise adds taken off: near the reference it may fall below 0.
[[nodiscard]] double relative_error(const Image& image, const Reference& reference);
// Half the mean squared relative difference of two pictures with equal settings: the relMSE of either, without a reference.
[[nodiscard]] double relative_error_of_pair(const Image& a, const Image& b);

// Adds up replicates until `enough` says so of the reference so far; at least two, at most `most`.
[[nodiscard]] Reference average(int spp, int most, const std::function<Image(int replicate)>& replicate,
                                const std::function<bool(const Reference&)>& enough);

// A file holds a reference, and as text everything that decided it. What was written under another key, by another version,
// cut off or changed is not read.
void write_reference(const std::filesystem::path& path, const std::string& key, const Reference& reference);
// Nothing, and the reason in `why`, when the file is not to be used; `why` is empty when there is no file.
[[nodiscard]] std::optional<Reference> read_reference(const std::filesystem::path& path, const std::string& key,
                                                      std::string& why);

// 64 bits of all bytes (FNV-1a).
[[nodiscard]] std::uint64_t digest(std::string_view bytes, std::uint64_t start = 0xcbf29ce484222325u);

}  // namespace glint::chart
