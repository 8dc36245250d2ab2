#include "core/polygon.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace glint {
namespace {

using Outline = std::vector<glm::dvec3>;

double shoelace(const Outline& p) {
    double area = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const glm::dvec3& a = p[i];
        const glm::dvec3& b = p[(i + 1) % p.size()];
        area += a.x * b.y - a.y * b.x;
    }
    return 0.5 * area;
}

// Sum of the triangles' signed areas, and of their absolute ones: equal only when no triangle is turned over.
std::pair<double, double> areas(const Outline& p, const Triangulation& cut) {
    double sum = 0.0;
    double absolute = 0.0;
    for (const auto& t : cut.triangles) {
        const double area = 0.5 * glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]).z;
        sum += area;
        absolute += std::abs(area);
    }
    return {sum, absolute};
}

void expect_exact_cover(const Outline& p) {
    const Triangulation cut = triangulate(p);
    EXPECT_TRUE(cut.simple);
    EXPECT_LE(cut.triangles.size(), p.size() - 2);
    const auto [sum, absolute] = areas(p, cut);
    const double size = std::abs(shoelace(p));
    EXPECT_NEAR(std::abs(sum), size, 1e-12 * size);
    EXPECT_NEAR(absolute, size, 1e-12 * size);
}

// A star: radii jump about, so about half of the corners are reflex ones.
Outline star(std::mt19937& random, int corners, double smallest) {
    std::uniform_real_distribution<double> radius(smallest, 1.0);
    Outline p;
    for (int i = 0; i < corners; ++i) {
        const double phi = 2.0 * std::numbers::pi * i / corners;
        const double r = radius(random);
        p.emplace_back(r * std::cos(phi), r * std::sin(phi), 0.0);
    }
    return p;
}

TEST(Polygon, StarsAreCoveredExactly) {
    std::mt19937 random(1);
    for (int corners = 4; corners <= 200; corners += 7) expect_exact_cover(star(random, corners, 0.05));
}

TEST(Polygon, ACombOfLongTeethIsCoveredExactly) {
    Outline comb{{0, 0, 0}, {40, 0, 0}};
    for (int tooth = 39; tooth >= 0; --tooth) {
        comb.emplace_back(tooth + 1, 10, 0);
        comb.emplace_back(tooth + 0.5, 1 + 0.2 * (tooth % 5), 0);
    }
    comb.emplace_back(0, 10, 0);
    expect_exact_cover(comb);
}

TEST(Polygon, AStaircaseWithStraightAndRepeatedCornersIsCoveredExactly) {
    Outline stairs{{0, 0, 0}, {5, 0, 0}, {10, 0, 0}, {20, 0, 0}};
    for (int step = 0; step < 20; ++step) {
        stairs.emplace_back(20 - step, step + 0.5, 0);
        stairs.emplace_back(20 - step, step + 1, 0);
        stairs.emplace_back(20 - step, step + 1, 0);
        stairs.emplace_back(19 - step, step + 1, 0);
    }
    expect_exact_cover(stairs);
}

TEST(Polygon, ASpiralIsCoveredExactly) {
    Outline spiral;
    const int turns = 300;
    for (int i = 0; i < turns; ++i) spiral.emplace_back((1 + 0.1 * i) * std::cos(0.2 * i), (1 + 0.1 * i) * std::sin(0.2 * i), 0);
    for (int i = turns; i-- > 0;) spiral.emplace_back((2 + 0.1 * i) * std::cos(0.2 * i), (2 + 0.1 * i) * std::sin(0.2 * i), 0);
    expect_exact_cover(spiral);
}

TEST(Polygon, AGearOf144CornersKeepsItsAreaOnAnyPlane) {
    Outline flat;
    for (int i = 0; i < 144; ++i) {
        const double phi = 2.0 * std::numbers::pi * i / 144.0;
        const double r = i % 4 < 2 ? 1.0 : 0.8;
        flat.emplace_back(r * std::cos(phi), r * std::sin(phi), 0.0);
    }
    const glm::dvec3 u = glm::normalize(glm::dvec3(1, 2, -3));
    const glm::dvec3 v = glm::normalize(glm::cross(glm::dvec3(0.3, -0.2, 0.9), u));
    Outline tilted;
    for (const auto& q : flat) tilted.push_back(glm::dvec3(100, -50, 20) + q.x * u + q.y * v);
    double area = 0.0;
    for (const auto& t : triangulate(tilted).triangles) {
        const glm::dvec3 n = 0.5 * glm::cross(tilted[t[1]] - tilted[t[0]], tilted[t[2]] - tilted[t[0]]);
        EXPECT_GT(glm::dot(n, glm::cross(u, v)), 0.0);
        area += glm::length(n);
    }
    EXPECT_NEAR(area, shoelace(flat), 1e-12);
}

TEST(Polygon, TheFirstThreeCornersDecideTheFront) {
    // An arrow head whose notch is the second corner: there the outline turns against its own sense.
    const Outline notch{{2, 1, 0}, {0, 0, 0}, {-2, 1, 0}, {0, -3, 0}};
    ASSERT_LT(glm::cross(notch[1] - notch[0], notch[2] - notch[0]).z * shoelace(notch), 0.0);
    for (const Outline& p : {notch, Outline{notch.rbegin(), notch.rend()}, Outline{notch[1], notch[2], notch[3], notch[0]}}) {
        const double first = glm::cross(p[1] - p[0], p[2] - p[0]).z;
        const auto [sum, absolute] = areas(p, triangulate(p));
        EXPECT_NEAR(absolute, std::abs(shoelace(p)), 1e-12);
        EXPECT_NEAR(sum, std::copysign(absolute, first), 1e-12);
    }
}

TEST(Polygon, AConvexPolygonOfMostCornersIsQuick) {
    Outline circle;
    for (std::size_t i = 0; i < kMaxPolygonCorners; ++i) {
        const double phi = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(kMaxPolygonCorners);
        circle.emplace_back(std::cos(phi), std::sin(phi), 0.0);
    }
    expect_exact_cover(circle);
}

TEST(Polygon, WithoutAreaNothingIsLeft) {
    EXPECT_TRUE(triangulate(Outline{}).triangles.empty());
    EXPECT_TRUE(triangulate(Outline{{0, 0, 0}, {1, 1, 1}}).triangles.empty());
    EXPECT_TRUE(triangulate(Outline{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}).triangles.empty());
    EXPECT_TRUE(triangulate(Outline(5, glm::dvec3(1.0))).triangles.empty());
}

TEST(Polygon, AnOutlineThatCrossesItselfIsToldAndEnds) {
    const Outline bow{{0, 0, 0}, {3, 2, 0}, {3, 0, 0}, {0, 1, 0}};
    EXPECT_FALSE(triangulate(bow).simple);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> at(-1.0, 1.0);
    for (int round = 0; round < 50; ++round) {
        Outline tangle;
        for (int i = 0; i < 200; ++i) tangle.emplace_back(at(random), at(random), 0.0);
        EXPECT_LE(triangulate(tangle).triangles.size(), tangle.size());
    }
}

}  // namespace
}  // namespace glint
