// A scene whose point is that meshes are stored once: any number of knots in the pattern of a sunflower's head.
#include <array>
#include <cmath>

#include "core/builtin.h"
#include "core/mesh_stage.h"
#include "core/torus_knot.h"

namespace glint::builtin {
namespace {

// The golden angle, pi (3 - sqrt 5), as a turn in the plane: no sine of a library's taste.
constexpr double kCosGolden = -0.7373688780783197, kSinGolden = 0.6754902942615238;

std::uint32_t add_knot(SceneBuilder& builder, const KnotMesh& mesh, glm::vec3 albedo) {
    Material m = clay(albedo);
    m.specular = glm::vec3(0.25f);
    const std::uint32_t material = builder.add_material(m);
    builder.begin_prototype();
    builder.reserve(mesh.vertices.size(), mesh.triangles.size());
    for (const glm::vec3& v : mesh.vertices) builder.add_vertex(v);
    for (const auto& t : mesh.triangles) builder.add_triangle(t[0], t[1], t[2], material);
    return builder.end_prototype();
}

}  // namespace

// Vogel 1979, "A better way to construct the sunflower head": the i-th seed at radius sqrt(i), a golden angle on.
SceneBuilder crowd(int n) {
    SceneBuilder builder;
    const KnotMesh mesh = torus_knot(kMinKnotTriangles);
    constexpr std::array<glm::vec3, 5> kColours{
        {{0.86f, 0.62f, 0.16f}, {0.80f, 0.40f, 0.13f}, {0.62f, 0.22f, 0.14f}, {0.30f, 0.16f, 0.12f}, {0.42f, 0.46f, 0.16f}}};
    std::array<std::uint32_t, kColours.size()> knots;
    for (std::size_t i = 0; i < knots.size(); ++i) knots[i] = add_knot(builder, mesh, kColours[i]);

    // Neighbours are about 1.9 apart and a knot is 75 wide, so it is scaled to touch them.
    constexpr double kWidth = 2.9;
    // They lie on a ball of which a cap shows, this high and as wide as the whole head, whose radius is 1.
    constexpr double kCap = 0.34, kBall = (1.0 + kCap * kCap) / (2.0 * kCap);
    const double edge = std::sqrt(static_cast<double>(n));
    glm::dvec2 turn(1.0, 0.0), spin(1.0, 0.0);
    for (int i = 0; i < n; ++i) {
        const double r = std::sqrt(i + 0.5), t = r / edge;
        // In the ball's surface, turned about its normal by ever other angles.
        const glm::dvec3 out(turn.x, 0.0, turn.y), aside(-turn.y, 0.0, turn.x);
        const double slope = t / kBall, rise = std::sqrt(1.0 - slope * slope);
        const glm::dvec3 along = rise * out - glm::dvec3(0.0, slope, 0.0), up = glm::cross(aside, along);
        const double size = kWidth * (0.75 + 0.25 * t) / 100.0;
        const glm::dvec3 x = spin.x * along + spin.y * aside, y = spin.x * aside - spin.y * along;
        // Every second one is the knot of the other hand.
        const double hand = i % 2 == 0 ? 1.0 : -1.0;
        const glm::dvec3 position = r * out + glm::dvec3(0.0, edge * (kCap - kBall * (1.0 - rise)), 0.0);
        glm::dmat4 place(1.0);
        place[0] = glm::dvec4(hand * size * x, 0.0);
        place[1] = glm::dvec4(size * y, 0.0);
        place[2] = glm::dvec4(size * up, 0.0);
        place[3] = glm::dvec4(position, 1.0);
        const std::size_t ring = t < 0.35 ? 3 : t < 0.62 ? 2 : t < 0.9 ? (i % 13 < 5 ? 1 : 0) : 4;
        builder.place(knots[ring], place);
        turn = {turn.x * kCosGolden - turn.y * kSinGolden, turn.x * kSinGolden + turn.y * kCosGolden};
        spin = {spin.x * kSinGolden - spin.y * kCosGolden, spin.x * kCosGolden + spin.y * kSinGolden};
        if (i % 64 == 63) turn = glm::normalize(turn), spin = glm::normalize(spin);
    }
    set_stage(builder);
    const double below = 0.12 * kWidth;  // half a knot's height
    builder.add(
        Sphere{glm::vec3(0.0f, static_cast<float>(edge * (kCap - kBall)), 0.0f), static_cast<float>(edge * kBall - below)},
        builder.add_material(clay(glm::vec3(0.16f, 0.13f, 0.10f))));
    // Nearer and from higher up than a stage is seen, so that the spirals fill the picture.
    CameraPose& pose = builder.scene().cameras.front();
    pose.target = glm::vec3(glm::dvec3(0.0, 0.0, 0.1) * edge);
    pose.eye = glm::vec3(glm::dvec3(0.63, 2.35, 2.05) * edge);
    return builder;
}

}  // namespace glint::builtin
