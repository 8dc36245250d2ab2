#include "core/scene.h"

#include <utility>

#include <glm/gtc/matrix_transform.hpp>

#include "core/scene_origin.h"

namespace glint {
namespace {

constexpr std::size_t slot(PrimitiveKind kind) { return static_cast<std::size_t>(kind); }

// A kind's ids end where the tag bits begin.
void check_room(std::size_t count) {
    if (count >= kMaxPrimitivesPerKind) throw SceneError("more than 536870911 primitives of one kind");
}

// Planes and instances stay where they are: prototypes have none.
void move(Geometry& geometry, glm::dvec3 by) {
    if (by == glm::dvec3(0.0)) return;
    const auto shift = [by](glm::vec3& p) { p = glm::vec3(glm::dvec3(p) + by); };
    for (glm::vec3& v : geometry.vertices) shift(v);
    for (Sphere& s : geometry.spheres) shift(s.center);
    for (Box& b : geometry.boxes) shift(b.lo), shift(b.hi);
    for (Cone& c : geometry.cones) shift(c.base), shift(c.apex);
}

// What no primitive is made of must not show: a rough mirror among it would decide how rough all other mirrors are, and glass
// would bring in the glass kernel. Indices stay as they are.
void forget_unused_materials(Scene& scene) {
    std::vector<bool> used(scene.materials.size());
    const auto mark = [&](const Surfaces& surfaces) {
        for (const auto& of_kind : surfaces.material_of) {
            for (const std::uint32_t material : of_kind) used[material] = true;
        }
    };
    mark(scene);
    for (const Surfaces& prototype : scene.prototypes) mark(prototype);
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (!used[i]) scene.materials[i] = Material();
    }
}

}  // namespace

std::uint32_t SceneBuilder::add_material(const Material& m) {
    // Files repeat a material before each object; only the neighbour is compared, so this stays O(1).
    if (scene_.materials.empty() || !(scene_.materials.back() == m)) scene_.materials.push_back(m);
    return static_cast<std::uint32_t>(scene_.materials.size() - 1);
}

bool SceneBuilder::add(const Sphere& s, std::uint32_t material) {
    if (!valid(s)) return false;
    check_room(geometry_.spheres.size());
    geometry_.spheres.push_back(s);
    surfaces_.material_of[slot(PrimitiveKind::sphere)].push_back(material);
    return true;
}

bool SceneBuilder::add(const Box& b, std::uint32_t material) {
    if (!valid(b)) return false;
    check_room(geometry_.boxes.size());
    geometry_.boxes.push_back(b);
    surfaces_.material_of[slot(PrimitiveKind::box)].push_back(material);
    return true;
}

bool SceneBuilder::add(const Cone& c, std::uint32_t material) {
    if (!valid(c)) return false;
    check_room(geometry_.cones.size());
    geometry_.cones.push_back(c);
    surfaces_.material_of[slot(PrimitiveKind::cone)].push_back(material);
    return true;
}

bool SceneBuilder::add(const Plane& p, std::uint32_t material) {
    if (!valid(p)) return false;
    check_room(geometry_.planes.size());
    geometry_.planes.push_back(p);
    surfaces_.material_of[slot(PrimitiveKind::plane)].push_back(material);
    return true;
}

void SceneBuilder::reserve(std::size_t vertices, std::size_t triangles) {
    geometry_.vertices.reserve(geometry_.vertices.size() + vertices);
    surfaces_.normals.reserve(surfaces_.normals.size() + vertices);
    geometry_.triangles.reserve(geometry_.triangles.size() + triangles);
    auto& materials = surfaces_.material_of[slot(PrimitiveKind::triangle)];
    materials.reserve(materials.size() + triangles);
}

std::uint32_t SceneBuilder::add_vertex(glm::vec3 position, glm::vec3 normal) {
    check_room(geometry_.vertices.size());
    any_normal_ = any_normal_ || normal != glm::vec3(0.0f);
    geometry_.vertices.push_back(position);
    surfaces_.normals.push_back(normal);
    return static_cast<std::uint32_t>(geometry_.vertices.size() - 1);
}

bool SceneBuilder::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material) {
    const auto& v = geometry_.vertices;
    if (!valid_triangle(v[a], v[b], v[c])) {
        // Far from zero all corners of a fine mesh may round to one point.
        for (const std::uint32_t corner : {a, b, c}) mark(v[corner]);
        return false;
    }
    check_room(geometry_.triangles.size());
    geometry_.triangles.push_back({a, b, c});
    surfaces_.material_of[slot(PrimitiveKind::triangle)].push_back(material);
    return true;
}

void SceneBuilder::mark(glm::vec3 point) {
    if (valid_vertex(point)) marked_.grow(point);
}

Aabb SceneBuilder::extent() const { return extent_of(geometry_, marked_); }

struct SceneBuilder::World {
    Geometry geometry;
    Surfaces surfaces;
    bool any_normal;
    Aabb marked;
};

void SceneBuilder::close() {
    if (!any_normal_) surfaces_.normals.clear();
    surfaces_.normals.shrink_to_fit();
    geometry_.vertices.shrink_to_fit();
}

void SceneBuilder::begin_prototype() {
    world_ = std::make_shared<World>(World{std::exchange(geometry_, {}), std::exchange(surfaces_, {}), any_normal_, marked_});
    any_normal_ = false;
    marked_ = Aabb();
}

std::uint32_t SceneBuilder::end_prototype() {
    close();
    // Positions of a prototype are floats as the file has them, so that taking a point near them away is exact.
    prototype_origins_.push_back(origin_shift(extent()));
    move(geometry_, -prototype_origins_.back());
    Geometry prototype = std::exchange(geometry_, std::move(world_->geometry));
    scene_.prototypes.push_back(std::exchange(surfaces_, std::move(world_->surfaces)));
    any_normal_ = world_->any_normal;
    marked_ = world_->marked;
    world_.reset();
    geometry_.prototypes.emplace_back(std::make_shared<const Geometry>(std::move(prototype)));
    return static_cast<std::uint32_t>(geometry_.prototypes.size() - 1);
}

bool SceneBuilder::place(std::uint32_t prototype, const glm::dmat4& world_from_object) {
    const glm::dmat4 world_from_stored = glm::translate(world_from_object, prototype_origins_[prototype]);
    try {
        return geometry_.place(prototype, affine_map(world_from_stored));
    } catch (const std::length_error&) {
        throw SceneError("more than 1610612735 primitives in instances");
    }
}

std::shared_ptr<const Scene> SceneBuilder::finish() {
    if (scene_.materials.empty()) scene_.materials.emplace_back();
    if (scene_.cameras.empty()) scene_.cameras.emplace_back();
    close();
    static_cast<Surfaces&>(scene_) = std::move(surfaces_);
    scene_.geometry = std::make_shared<const Geometry>(std::move(geometry_));
    forget_unused_materials(scene_);
    auto scene = std::make_shared<const Scene>(std::move(scene_));
    *this = SceneBuilder();
    return scene;
}

}  // namespace glint
