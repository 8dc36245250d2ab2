#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/p3f_reader.h"

namespace glint::p3f {
namespace {

void warn_dropped(Reader& r, const Token& word, std::string_view why) {
    r.messages.warn(word.line, fmt::format("{} {}, dropped", in_quotes(word.text), why));
}

// A negative radius means "seen from inside" in NFF; surfaces here have two sides, so only its size matters.
void add_sphere(Reader& r, const Token& word, glm::vec3 center, double radius) {
    const Sphere sphere{center, static_cast<float>(std::abs(radius))};
    if (!r.builder.add(sphere, r.current_material())) warn_dropped(r, word, "has no size or lies too far out");
}

void read_sphere(Reader& r, const Token& word) {
    const auto [x, y, z, radius] = r.in.numbers<4>("'s'");
    add_sphere(r, word, r.point(x, y, z), radius);
}

// Corners in any order: the 2019 files write `aabb` so, and a swapped pair can mean nothing else.
void read_box(Reader& r, const Token& word) {
    const auto v = r.in.numbers<6>(in_quotes(word.text));
    const glm::vec3 a = r.point(v[0], v[1], v[2]);
    const glm::vec3 b = r.point(v[3], v[4], v[5]);
    if (!r.builder.add(Box{glm::min(a, b), glm::max(a, b)}, r.current_material())) warn_dropped(r, word, "lies too far out");
}

void read_plane_through(Reader& r, const Token& word) {
    const auto v = r.in.numbers<9>("'pl'");
    // Taken from doubles as they stand: a plane's place is a double.
    const glm::dvec3 o = r.builder.scene().origin;
    const Plane plane =
        plane_through(glm::dvec3(v[0], v[1], v[2]) - o, glm::dvec3(v[3], v[4], v[5]) - o, glm::dvec3(v[6], v[7], v[8]) - o);
    if (!r.builder.add(plane, r.current_material())) warn_dropped(r, word, "has its three points on a line");
}

void read_plane(Reader& r, const Token& word) {
    r.renamed_dialect = true;
    const auto [x, y, z, d] = r.in.numbers<4>("'npl'");
    const glm::dvec3 normal(x, y, z);
    const double length = glm::length(normal);
    // N.x + d = 0 holds for any length of N; dividing both keeps the place.
    // Where coordinates begin at o, N.(x + o) + d = 0.
    const double here = glm::dot(normal, r.builder.scene().origin) + d;
    const Plane plane = length > 0.0 ? Plane{normal / length, here / length} : Plane{normal, d};
    if (!r.builder.add(plane, r.current_material())) warn_dropped(r, word, "has no normal");
}

// NFF wants the smaller radius at the apex and lets both be negative for a view from inside; neither matters here.
void read_cone(Reader& r, const Token& word) {
    const auto v = r.in.numbers<8>("'c'");
    const Cone cone{r.point(v[0], v[1], v[2]), static_cast<float>(std::abs(v[3])), r.point(v[4], v[5], v[6]),
                    static_cast<float>(std::abs(v[7]))};
    if (!r.builder.add(cone, r.current_material())) warn_dropped(r, word, "has no length or no radius");
}

// Two positions, then `r`, `r t0 t1` or `t0 t1 r`: students differ. Times that run backwards tell the last from the second.
void read_moving_sphere(Reader& r, const Token& word) {
    const std::vector<double> v = r.in.numbers_until_word(9);
    const std::string what = in_quotes(word.text);
    if (v.size() != 7 && v.size() != 9) {
        r.messages.fail(r.in.line(), fmt::format("{} needs 7 or 9 numbers, found {}", what, v.size()));
    }
    const bool radius_last = v.size() == 9 && (v[8] < v[7] || v[6] == 0.0);
    r.messages.warn(word.line, fmt::format("{} does not move, its first position is used", what));
    add_sphere(r, word, r.point(v[0], v[1], v[2]), radius_last ? v[8] : v[6]);
}

void skip_animation(Reader& r, const Token& word) {
    (void)r.in.numbers_until_word(7);
    r.messages.warn(word.line, "'a' animates the next sphere, skipped");
}

constexpr std::array<Statement, 9> kStatements{{{"s", read_sphere},
                                                {"box", read_box},
                                                {"aabb", read_box},
                                                {"pl", read_plane_through},
                                                {"npl", read_plane},
                                                {"c", read_cone},
                                                {"ms", read_moving_sphere},
                                                {"sm", read_moving_sphere},
                                                {"a", skip_animation}}};

}  // namespace

std::span<const Statement> shape_statements() { return kStatements; }

}  // namespace glint::p3f
