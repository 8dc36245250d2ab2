#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/p3f_reader.h"

namespace glint::p3f {
namespace {

constexpr std::int64_t kMostSamples = std::int64_t{1} << 24;

// The numbers after `f` or `mat`, whatever the dialect.
struct Surface {
    glm::dvec3 diffuse{0.0}, specular{1.0};
    double kd = 0.0, ks = 0.0, shine = 0.0, transmittance = 0.0, ior = 1.0, roughness = 0.0;
    glm::dvec3 emission{0.0};
};

Surface surface_of(std::span<const double> v) {
    Surface s;
    s.diffuse = {v[0], v[1], v[2]};
    s.kd = v[3];
    if (v.size() == 8) {
        // One colour: the specular colour is white.
        s.ks = v[4];
        s.shine = v[5];
        s.transmittance = v[6];
        s.ior = v[7];
        return s;
    }
    s.specular = {v[4], v[5], v[6]};
    s.ks = v[7];
    s.shine = v[8];
    s.transmittance = v[9];
    s.ior = v[10];
    if (v.size() == 12) s.roughness = v[11];
    if (v.size() == 14) s.emission = {v[11], v[12], v[13]};
    return s;
}

void read_material(Reader& r, const Token& word) {
    r.renamed_dialect = r.renamed_dialect || word.text == "mat";
    const std::string what = in_quotes(word.text);
    std::vector<double> v = r.in.numbers_until_word(14);
    if (v.size() != 8 && v.size() != 11 && v.size() != 12 && v.size() != 14) {
        r.messages.fail(r.in.line(), fmt::format("{} needs 8, 11, 12 or 14 numbers, found {}", what, v.size()));
    }
    if (std::any_of(v.begin(), v.end(), [](double x) { return x < 0.0; })) {
        r.messages.warn(word.line, fmt::format("{}: negative numbers are taken as 0", what));
        for (double& x : v) x = std::max(x, 0.0);
    }
    const Surface s = surface_of(v);
    Material m;
    m.diffuse = glm::vec3(s.diffuse * s.kd);
    m.specular = glm::vec3(s.specular * s.ks);
    m.shininess = static_cast<float>(s.shine);
    m.roughness = static_cast<float>(s.roughness);
    m.emission = glm::vec3(s.emission);
    // The size of T says nothing beyond "glass": the files of most years write 1. Ks serves highlight and mirror alike.
    m.glass = s.transmittance > 0.0;
    if (!m.glass) {
        m.mirror = m.specular;
    } else if (s.ior > 0.0) {
        m.ior = static_cast<float>(s.ior);
    } else {
        r.messages.warn(word.line, fmt::format("{} lets light through with an index of refraction of 0, 1 is used", what));
    }
    // Each factor fits a float, their product need not.
    if (!valid_vertex(m.diffuse) || !valid_vertex(m.specular))
        r.messages.fail(r.in.line(), fmt::format("{} is too bright", what));
    r.material = m;
    r.material_index.reset();
}

void read_background(Reader& r, const Token& word) {
    const auto [red, green, blue] = r.in.numbers<3>(in_quotes(word.text));
    if (std::min({red, green, blue}) < 0.0) r.messages.warn(word.line, "a negative background colour is taken as 0");
    r.builder.scene().environment.color = glm::max(glm::vec3(glm::dvec3(red, green, blue)), glm::vec3(0.0f));
}

void read_environment(Reader& r, const Token& word) {
    r.environment = r.in.name(in_quotes(word.text));
    r.environment_line = word.line;
}

void read_accelerator(Reader& r, const Token& word) {
    const Token kind = r.in.next();
    std::string& accelerator = r.builder.scene().accelerator;
    const bool named = kind.text == "none" || kind.text == "grid" || kind.text == "bvh";
    r.renamed_dialect = r.renamed_dialect || named;
    if (named) {
        accelerator = kind.text;
    } else if (kind.text == "0" || kind.text == "1" || kind.text == "2") {
        accelerator = kind.text == "0" ? "none" : kind.text == "1" ? "grid" : "bvh";
    } else if (kind.end()) {
        r.messages.fail(word.line, "'accel' needs none, grid, bvh, 0, 1 or 2");
    } else {
        r.messages.warn(kind.line, fmt::format("unknown accelerator {}, skipped", in_quotes(kind.text)));
    }
}

void read_samples(Reader& r, const Token& word) {
    const std::int64_t samples = r.in.integer("'spp'");
    if (samples < 0 || samples > kMostSamples) {
        r.messages.fail(r.in.line(), fmt::format("spp {} is out of range: 0 to {}", samples, kMostSamples));
    }
    // In a Scene 0 means "the file says nothing".
    if (samples == 0) r.messages.warn(word.line, "spp 0 asks for one centred sample: 1 sample; turn `aa` off to centre it");
    r.builder.scene().spp = static_cast<int>(std::max<std::int64_t>(samples, 1));
}

constexpr std::array<Statement, 8> kStatements{{{"f", read_material},
                                                {"mat", read_material},
                                                {"b", read_background},
                                                {"bclr", read_background},
                                                {"env", read_environment},
                                                {"fire", read_environment},
                                                {"accel", read_accelerator},
                                                {"spp", read_samples}}};

}  // namespace

std::span<const Statement> surface_statements() { return kStatements; }

}  // namespace glint::p3f
