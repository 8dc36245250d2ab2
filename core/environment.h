// What a ray sees that hits nothing: one colour, a cube of six pictures, or a procedural sky.
// Directions are world directions; the cube is always y-up, whatever the scene calls up.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace glint {

// One face of a cube map, 8 bits a channel, rows from the bottom up.
struct CubeFace {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
};

struct Environment {
    enum class Kind { color, cube, sky };

    Kind kind = Kind::color;
    glm::vec3 color{0.0f};          // seen everywhere (color), or wherever the background is forced to a colour
    std::array<CubeFace, 6> faces;  // right, left, top, bottom, front, back
    // sky: a clear-sky gradient between horizon and zenith with a ground colour below and a sun disk.
    glm::vec3 up{0.0f, 1.0f, 0.0f};
    glm::vec3 zenith{0.18f, 0.36f, 0.70f};
    glm::vec3 horizon{0.80f, 0.88f, 0.95f};
    glm::vec3 ground{0.30f, 0.28f, 0.25f};
    glm::vec3 sun_direction{0.0f, 1.0f, 0.0f};  // towards the sun, unit
    glm::vec3 sun{0.0f};                        // radiance of the disk; black = no disk
    float sun_cos = 0.9995f;                    // cosine of the disk's angular radius

    // Radiance from direction `d` (any length > 0).
    [[nodiscard]] glm::vec3 radiance(glm::vec3 d) const;
};

// The pictures right, left, top, bottom, front, back (.jpg, .jpeg or .png) in `folder`; SceneError when one is missing.
[[nodiscard]] std::array<std::filesystem::path, 6> cube_files(const std::filesystem::path& folder);

// Reads those pictures and makes the environment a cube.
// Throws SceneError naming the file that is missing or broken; `environment` is unchanged then.
void load_cube(Environment& environment, const std::filesystem::path& folder);

}  // namespace glint
