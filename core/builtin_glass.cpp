// Four pieces of glass on a chequered floor under a clear sky: a ball lens, a slab, water in glass, a hollow shell.
// A stack of media decides what a ray enters: the inner surface of a nested pair is a smaller ball of another material.
#include <array>
#include <cstddef>

#include "core/builtin.h"

namespace glint::builtin {
namespace {

constexpr float kRadius = 0.7f;
constexpr float kGlass = 1.5f, kWater = 1.33f;
constexpr float kGap = 0.002f;   // air below the slab: where two faces coincide, chance decides which one a ray meets
constexpr float kMarks = -2.2f;  // z of what stands behind the pieces

Material clear(float ior) {
    Material m;
    m.diffuse = glm::vec3(0.0f);
    m.specular = glm::vec3(0.4f);
    m.shininess = 400.0f;
    m.glass = true;
    m.ior = ior;
    return m;
}

Material matte(glm::vec3 albedo) {
    Material m;
    m.diffuse = albedo;
    m.specular = glm::vec3(0.0f);
    return m;
}

// Tiles share their corners, so the floor has no cracks.
void add_floor(SceneBuilder& builder) {
    constexpr int kTiles = 64;
    constexpr float kTile = 0.5f;
    constexpr glm::vec3 kLight(0.56f, 0.48f, 0.37f), kDark(0.12f, 0.15f, 0.18f);
    const std::array<std::uint32_t, 2> material{builder.add_material(matte(kLight)), builder.add_material(matte(kDark))};
    std::array<std::uint32_t, kTiles + 1> row{}, next{};
    for (int j = 0; j <= kTiles; ++j) {
        for (int i = 0; i <= kTiles; ++i) {
            const auto at = static_cast<std::size_t>(i);
            next[at] = builder.add_vertex(
                {kTile * static_cast<float>(i - kTiles / 2), 0.0f, kTile * static_cast<float>(j - kTiles / 2)});
            if (i == 0 || j == 0) continue;
            const std::uint32_t tile = material[static_cast<std::size_t>((i + j) & 1)];
            builder.add_triangle(row[at - 1], next[at - 1], next[at], tile);
            builder.add_triangle(next[at], row[at], row[at - 1], tile);
        }
        row = next;
    }
    // Beyond the tiles and a little below them, ground of their mean colour runs to the horizon.
    builder.add(Plane{{0.0, 1.0, 0.0}, 0.02}, builder.add_material(matte(0.5f * (kLight + kDark))));
}

// What is seen through a piece: red stands on the left and blue on the right, so a picture that is turned round shows it.
void add_marks(SceneBuilder& builder, float x) {
    const std::uint32_t red = builder.add_material(matte({0.75f, 0.10f, 0.07f}));
    const std::uint32_t blue = builder.add_material(matte({0.06f, 0.22f, 0.70f}));
    const std::uint32_t white = builder.add_material(matte({0.80f, 0.78f, 0.72f}));
    constexpr float kPole = 0.05f, kTop = 1.9f;
    builder.add(Sphere{{x - 0.62f, 0.3f, kMarks}, 0.3f}, red);
    builder.add(Sphere{{x + 0.62f, 0.3f, kMarks}, 0.3f}, blue);
    builder.add(Cone{{x, 0.0f, kMarks}, kPole, {x, kTop, kMarks}, kPole}, white);
    builder.add(Sphere{{x, kTop, kMarks}, kPole}, white);
}

void add_piece(SceneBuilder& builder, GlassPiece what, float x) {
    const glm::vec3 center(x, kRadius, 0.0f);
    const std::uint32_t glass = builder.add_material(clear(kGlass));
    switch (what) {
        case GlassPiece::all: return;
        case GlassPiece::ball: builder.add(Sphere{center, kRadius}, glass); return;
        case GlassPiece::slab: builder.add(Box{{x - 0.6f, kGap, -0.25f}, {x + 0.6f, 1.4f, 0.25f}}, glass); return;
        case GlassPiece::nested:
            builder.add(Sphere{center, kRadius}, glass);
            builder.add(Sphere{center, 0.8f * kRadius}, builder.add_material(clear(kWater)));
            return;
        case GlassPiece::shell:
            builder.add(Sphere{center, kRadius}, glass);
            builder.add(Sphere{center, 0.93f * kRadius}, builder.add_material(clear(1.0f)));
            return;
    }
}

// Lights without falloff: a small bright sun, and the sky as a large square overhead that softens its shadows.
void add_daylight(SceneBuilder& builder) {
    const glm::vec3 sun_direction = glm::normalize(glm::vec3(-0.55f, 0.75f, 0.35f));
    Light sun;
    sun.shape = Light::Shape::quad;
    const glm::vec3 side = glm::normalize(glm::cross(glm::vec3(0.0f, 1.0f, 0.0f), sun_direction));
    const glm::vec3 rise = glm::cross(sun_direction, side);
    // So far away that the ground is lit alike up to the horizon.
    constexpr float kAway = 1.0e7f, kSize = 4.0e5f;
    sun.edge1 = kSize * side;
    sun.edge2 = -kSize * rise;
    sun.position = kAway * sun_direction - 0.5f * (sun.edge1 + sun.edge2);
    sun.emission = {0.95f, 0.88f, 0.76f};
    Light sky;
    sky.shape = Light::Shape::quad;
    sky.position = {-6.0e6f, 4.5e6f, -6.0e6f};
    sky.edge1 = {1.2e7f, 0.0f, 0.0f};
    sky.edge2 = {0.0f, 0.0f, 1.2e7f};
    sky.emission = {0.34f, 0.40f, 0.50f};
    builder.scene().lights = {sun, sky};

    Environment& environment = builder.scene().environment;
    environment.kind = Environment::Kind::sky;
    environment.color = environment.horizon;
    environment.sun_direction = sun_direction;
    environment.sun = {20.0f, 18.0f, 15.0f};
}

}  // namespace

SceneBuilder glass(GlassPiece what) {
    constexpr std::array<GlassPiece, 4> kPieces{GlassPiece::ball, GlassPiece::slab, GlassPiece::nested, GlassPiece::shell};
    SceneBuilder builder;
    add_daylight(builder);
    add_floor(builder);
    const bool all = what == GlassPiece::all;
    CameraPose pose;
    pose.eye = {0.0f, 1.7f, all ? 7.6f : 4.2f};
    pose.target = {0.0f, 0.75f, 0.0f};
    pose.view_angle = 33.0f;
    builder.scene().cameras.push_back(pose);
    for (std::size_t i = 0; i < kPieces.size(); ++i) {
        if (!all && kPieces[i] != what) continue;
        const float x = all ? 1.75f * (static_cast<float>(i) - 1.5f) : 0.0f;
        // Straight behind the piece as the camera sees it.
        add_marks(builder, pose.eye.x + (x - pose.eye.x) * (pose.eye.z - kMarks) / pose.eye.z);
        add_piece(builder, kPieces[i], x);
    }
    return builder;
}

}  // namespace glint::builtin
