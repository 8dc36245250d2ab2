// A scene as loaded: geometry, materials, lights, environment, cameras, and what the file asked of the renderer.
// Knows no settings, window or accelerator. Immutable once built; shared as shared_ptr<const Scene>.
// Invariant: material_of[kind] has one entry below materials.size() for each primitive of that kind, in the world and in each
// prototype.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "accel/geometry.h"
#include "core/camera.h"
#include "core/environment.h"
#include "core/light.h"
#include "core/material.h"

namespace glint {

enum class Transfer { linear, srgb };

// What the primitives of one Geometry look like, by its ids.
struct Surfaces {
    // Per vertex, for smooth shading; empty, or as long as the geometry's vertices, (0,0,0) where a vertex has none.
    std::vector<glm::vec3> normals;
    std::array<std::vector<std::uint32_t>, kPrimitiveKinds> material_of;

    [[nodiscard]] std::uint32_t material(PrimitiveId id) const {
        return material_of[static_cast<std::size_t>(kind_of(id))][index_of(id)];
    }
};

// Its own surfaces are those of the world's primitives.
struct Scene : Surfaces {
    std::string name;  // file name or builtin:NAME, for titles and reports
    std::shared_ptr<const Geometry> geometry = std::make_shared<Geometry>();
    std::vector<Surfaces> prototypes;  // of geometry->prototypes
    std::vector<Material> materials;
    std::vector<Light> lights;
    Environment environment;
    std::vector<CameraPose> cameras;  // at least one
    std::optional<glm::vec3> up;      // where the format fixes it (glTF: +y); else see world_up()
    int width = 1280, height = 720;   // what the file asks for
    int spp = 0;                      // 0 = the file says nothing
    std::string accelerator;          // "none", "grid", "bvh" or empty
    Transfer transfer = Transfer::srgb;
    std::vector<std::string> warnings;  // one line each: path:line: what was skipped

    // The scene's up, unit length: as the format says, or that of its first camera.
    [[nodiscard]] glm::vec3 world_up() const { return glm::normalize(up.value_or(cameras.front().up)); }
    [[nodiscard]] const Surfaces& surfaces(const Located& at) const {
        return at.instance != nullptr ? prototypes[at.instance->prototype] : *this;
    }
    [[nodiscard]] const Material& material(PrimitiveId id) const {
        const Located at = geometry->locate(id);
        return materials[surfaces(at).material(at.id)];
    }
};

// A scene that cannot be used, with the user's file to blame: `path:line: reason`, one line.
class SceneError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// Collects primitives with the current material, drops invalid ones, and hands out the finished Scene.
class SceneBuilder {
public:
    std::uint32_t add_material(const Material& m);
    // Each returns false when the primitive is degenerate and was dropped (the caller words the warning).
    bool add(const Sphere& s, std::uint32_t material);
    bool add(const Box& b, std::uint32_t material);
    bool add(const Cone& c, std::uint32_t material);
    bool add(const Plane& p, std::uint32_t material);
    // Vertices are appended once and shared by triangles; returns the new vertex's index.
    std::uint32_t add_vertex(glm::vec3 position, glm::vec3 normal = glm::vec3(0.0f));
    bool add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material);
    // Room for that many more, where a reader knows: growing step by step would double the peak of memory.
    void reserve(std::size_t vertices, std::size_t triangles);
    // What is added between the two, without planes, is stored once and seen only where place() puts it. Returns its number.
    void begin_prototype();
    std::uint32_t end_prototype();
    // False where the map has no inverse to rely on (see Geometry::place()). Throws SceneError when the ids run out.
    bool place(std::uint32_t prototype, const glm::dmat4& world_from_object);
    // What has been added so far; between begin_prototype() and end_prototype() that of the prototype.
    [[nodiscard]] const Geometry& geometry() const { return geometry_; }
    // Fills geometry, normals, materials and material_of of scene(); the builder is empty afterwards.
    [[nodiscard]] std::shared_ptr<const Scene> finish();
    // Everything else of the scene is set here directly.
    Scene& scene() { return scene_; }

private:
    Scene scene_;
    // Of the world, or of the prototype that is being added.
    Geometry geometry_;
    Surfaces surfaces_;
    bool any_normal_ = false;
    // The world's, while a prototype is being added.
    struct World;
    std::shared_ptr<World> world_;

    void close();
};

}  // namespace glint
