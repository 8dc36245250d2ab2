#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/p3f_reader.h"

namespace glint::p3f {
namespace {

glm::vec3 light_color(Reader& r, const Token& word, glm::dvec3 color) {
    if (glm::min(glm::min(color.x, color.y), color.z) < 0.0) {
        r.messages.warn(word.line, fmt::format("{}: a negative colour is taken as 0", in_quotes(word.text)));
    }
    return glm::vec3(glm::max(color, glm::dvec3(0.0)));
}

void add_light(Reader& r, const Token& word, const Light& light) {
    if (!valid_vertex(light.position) || !valid_vertex(light.edge1) || !valid_vertex(light.edge2)) {
        r.messages.fail(word.line, fmt::format("{} lies too far out", in_quotes(word.text)));
    }
    r.builder.scene().lights.push_back(light);
}

// The sheets call the colour optional, white without.
void read_point(Reader& r, const Token& word) {
    const std::vector<double> v = r.in.numbers_until_word(6);
    if (v.size() != 3 && v.size() != 6) {
        r.messages.fail(r.in.line(), fmt::format("{} needs 3 or 6 numbers, found {}", in_quotes(word.text), v.size()));
    }
    Light light;
    light.position = r.point(v[0], v[1], v[2]);
    light.emission = v.size() == 6 ? light_color(r, word, {v[3], v[4], v[5]}) : glm::vec3(1.0f);
    add_light(r, word, light);
}

// A rectangle or parallelogram; without an extent it is a point, which needs no sampling.
void add_quad(Reader& r, const Token& word, glm::dvec3 corner, glm::dvec3 edge1, glm::dvec3 edge2, glm::vec3 emission) {
    Light light;
    light.emission = emission;
    light.position = r.builder.scene().local(corner);
    if (edge1 == glm::dvec3(0.0) && edge2 == glm::dvec3(0.0)) {
        r.messages.warn(word.line, fmt::format("{} has no extent, taken as a point", in_quotes(word.text)));
    } else {
        light.shape = Light::Shape::quad;
        light.edge1 = glm::vec3(edge1);
        light.edge2 = glm::vec3(edge2);
    }
    add_light(r, word, light);
}

// Corner, colour, the two neighbouring corners, and a grid size that only mattered for one sample per pixel.
void read_quad(Reader& r, const Token& word) {
    const std::vector<double> v = r.in.numbers_until_word(13);
    if (v.size() < 12) r.messages.fail(r.in.line(), fmt::format("'light quad' needs 13 numbers, found {}", v.size()));
    const glm::dvec3 corner(v[0], v[1], v[2]);
    const glm::vec3 color = light_color(r, word, {v[3], v[4], v[5]});
    add_quad(r, word, corner, glm::dvec3(v[6], v[7], v[8]) - corner, glm::dvec3(v[9], v[10], v[11]) - corner, color);
}

void read_light(Reader& r, const Token& word) {
    r.renamed_dialect = true;
    const Token kind = r.in.peek();
    if (kind.text == "punctual" || kind.text == "quad") {
        (void)r.in.next();
        (kind.text == "quad" ? read_quad : read_point)(r, word);
    } else if (r.in.number_follows()) {
        read_point(r, word);
    } else {
        r.messages.warn(word.line, fmt::format("unknown light {}, skipped", in_quotes(kind.text)));
        if (!kind.end() && !kind.first_on_line) (void)r.in.next();
        while (r.in.number_follows()) (void)r.in.next();
    }
}

// Centre, facing, width, height, colour. Which way the width runs is not said: level, for light that does not face up or down.
void read_area_light(Reader& r, const Token& word) {
    const auto v = r.in.numbers<11>("'al'");
    const glm::dvec3 facing(v[3], v[4], v[5]);
    const double length = glm::length(facing);
    if (!(length > 0.0)) r.messages.fail(r.in.line(), "'al' faces nowhere");
    const glm::dvec3 n = facing / length;
    const glm::dvec3 axis = n.x == 0.0 && n.z == 0.0 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(0.0, 1.0, 0.0);
    const glm::dvec3 across = glm::normalize(glm::cross(axis, n));
    const glm::dvec3 edge1 = across * std::abs(v[6]);
    const glm::dvec3 edge2 = glm::cross(n, across) * std::abs(v[7]);
    const glm::dvec3 corner = glm::dvec3(v[0], v[1], v[2]) - 0.5 * (edge1 + edge2);
    add_quad(r, word, corner, edge1, edge2, light_color(r, word, {v[8], v[9], v[10]}));
}

constexpr std::array<Statement, 3> kStatements{{{"l", read_point}, {"light", read_light}, {"al", read_area_light}}};

}  // namespace

std::span<const Statement> light_statements() { return kStatements; }

}  // namespace glint::p3f
