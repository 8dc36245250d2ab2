// A scene as loaded: geometry, materials, lights, environment, cameras, and what the file asked of the renderer.
// Knows no settings, window or accelerator. Immutable once built; shared as shared_ptr<const Scene>.
// Invariants: geometry, lights and cameras are relative to `origin`; directions and lengths are those of the world.
// material_of[kind] has one entry below materials.size() for each primitive of that kind, in the world and in each
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
    // The point of the world that coordinates are counted from; zero unless the scene lies far out (SceneOrigin).
    glm::dvec3 origin{0.0};
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

    // A point of the world in the scene's coordinates: the one rounding that positions get.
    [[nodiscard]] glm::vec3 local(glm::dvec3 world) const { return glm::vec3(world - origin); }
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
    // All that is added counts from `origin`; readers bring positions through scene().local().
    explicit SceneBuilder(glm::dvec3 origin = glm::dvec3(0.0)) { scene_.origin = origin; }
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
    // A point that counts for where the scene lies (extent()), though nothing could be added there.
    void mark(glm::vec3 point);
    // What is added between the two, without planes, is stored once and seen only where place() puts it. Returns its number.
    void begin_prototype();
    std::uint32_t end_prototype();
    // False where the map has no inverse to rely on (see Geometry::place()). Throws SceneError when the ids run out.
    bool place(std::uint32_t prototype, const glm::dmat4& world_from_object);
    // What has been added so far; between begin_prototype() and end_prototype() that of the prototype.
    [[nodiscard]] const Geometry& geometry() const { return geometry_; }
    // Where it lies, as SceneOrigin wants to know it; corners of triangles that were dropped count too.
    [[nodiscard]] Aabb extent() const;
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
    Aabb marked_;
    // Of each prototype: the point of its own space that it is stored relative to.
    std::vector<glm::dvec3> prototype_origins_;
    // The world's, while a prototype is being added.
    struct World;
    std::shared_ptr<World> world_;

    void close();
};

}  // namespace glint
