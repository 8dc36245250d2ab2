#include "accel/instance.h"

namespace glint {
namespace {

glm::dmat3 linear(const AffineMap& map) {
    glm::dmat3 m(0.0);
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) m[k][i] = map.row[i][k];
    }
    return m;
}

AffineMap assemble(const glm::dmat3& m, glm::dvec3 shift) {
    AffineMap map{};
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) map.row[i][k] = m[k][i];
        map.row[i][3] = shift[i];
    }
    return map;
}

bool finite(const AffineMap& map) {
    bool all = true;
    for (const auto& r : map.row) {
        for (const double x : r) all = all && std::isfinite(x);
    }
    return all;
}

// How far the product of two linear parts is from the identity.
double residual(const AffineMap& a, const AffineMap& b) {
    return assemble(linear(a) * linear(b) - glm::dmat3(1.0), glm::dvec3(0.0)).growth();
}

}  // namespace

glm::dvec3 AffineMap::vector(glm::dvec3 v) const {
    glm::dvec3 r;
    for (int i = 0; i < 3; ++i) r[i] = row[i][0] * v.x + row[i][1] * v.y + row[i][2] * v.z;
    return r;
}

glm::dvec3 AffineMap::point(glm::dvec3 p) const { return vector(p) + glm::dvec3(row[0][3], row[1][3], row[2][3]); }

glm::dvec3 AffineMap::normal_before(glm::dvec3 n) const {
    glm::dvec3 r;
    for (int k = 0; k < 3; ++k) r[k] = row[0][k] * n.x + row[1][k] * n.y + row[2][k] * n.z;
    return r;
}

double AffineMap::growth() const {
    double most = 0.0;
    for (const auto& r : row) most = std::max(most, std::abs(r[0]) + std::abs(r[1]) + std::abs(r[2]));
    return most;
}

double AffineMap::shift() const { return std::max(std::abs(row[0][3]), std::max(std::abs(row[1][3]), std::abs(row[2][3]))); }

bool AffineMap::is_identity() const {
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 4; ++k) {
            if (row[i][k] != (i == k ? 1.0 : 0.0)) return false;
        }
    }
    return true;
}

AffineMap affine_map(const glm::dmat4& m) { return assemble(glm::dmat3(m), glm::dvec3(m[3])); }

AffineMap inverse(const AffineMap& map) {
    const glm::dmat3 m = linear(map);
    // At size 1 no product of three entries overflows.
    const double size = map.growth();
    const glm::dmat3 s = m / size;
    const glm::dmat3 adjugate =
        glm::transpose(glm::dmat3(glm::cross(s[1], s[2]), glm::cross(s[2], s[0]), glm::cross(s[0], s[1])));
    const double determinant = glm::dot(s[0], glm::cross(s[1], s[2]));
    glm::dmat3 x = adjugate / determinant;
    // The determinant of a bent matrix cancels. Each step squares what is wrong (Schulz 1933).
    for (int step = 0; step < 2; ++step) x = x * (glm::dmat3(2.0) - s * x);
    x = x / size;
    const AffineMap turned = assemble(x, glm::dvec3(0.0));
    return assemble(x, -turned.vector({map.row[0][3], map.row[1][3], map.row[2][3]}));
}

std::optional<AffineMap> object_from_world(const AffineMap& world_from_object) {
    if (!finite(world_from_object) || !(world_from_object.growth() > 0.0)) return std::nullopt;
    const AffineMap there = inverse(world_from_object);
    if (!finite(there) || !(there.growth() * world_from_object.growth() <= kMaxBend)) return std::nullopt;
    // What is inverted again for shading must lead back to where the rays were.
    const AffineMap back = inverse(there);
    constexpr double kTolerance = 0x1p-28;  // a sixteenth of a unit of float
    const bool exact = residual(there, world_from_object) <= kTolerance && residual(there, back) <= kTolerance;
    return finite(back) && exact ? std::optional(there) : std::nullopt;
}

}  // namespace glint
