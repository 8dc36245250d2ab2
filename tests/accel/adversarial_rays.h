// Rays that break accelerators, drawn for a given scene: through vertices and edges, along faces, from far away, ...
// Knows geometry but no accelerator; cell corners of a grid come in as plain points.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "accel/geometry.h"
#include "tests/accel/random.h"

namespace glint {

class AdversarialRays {
public:
    // cell_corners: points where cells of a grid meet, possibly none.
    AdversarialRays(const Geometry& geometry, std::span<const glm::dvec3> cell_corners, std::uint64_t seed)
        : geometry_(geometry), ids_(geometry.bounded_ids()), corners_(cell_corners), random_(seed) {
        bounds_ = geometry.bounds();
        if (bounds_.empty()) bounds_ = Aabb{glm::vec3(-1.0f), glm::vec3(1.0f)};
        for (const Prototype& prototype : geometry.prototypes)
            in_prototypes_.emplace_back(*prototype.geometry, cell_corners, seed);
    }

    // Goes through the kinds in turn; every fourth ray gets a finite t_max, every third another length of direction.
    // Where there are instances, three of four rays are aimed in the space of one of them.
    Ray next() {
        if (geometry_.instances.empty() || random_.below(4) == 0) return next_in_world();
        const Instance& instance = geometry_.instances[random_.below(geometry_.instances.size())];
        const AffineMap out = inverse(instance.object_from_world);
        const Ray ray = in_prototypes_[instance.prototype].next_in_world();
        return {glm::vec3(out.point(glm::dvec3(ray.origin))), glm::vec3(out.vector(glm::dvec3(ray.direction))), ray.t_max};
    }

private:
    Ray next_in_world() {
        static constexpr std::array kKinds{
            &AdversarialRays::anywhere,        &AdversarialRays::through_vertex, &AdversarialRays::through_edge,
            &AdversarialRays::along_axis,      &AdversarialRays::from_face,      &AdversarialRays::grazing,
            &AdversarialRays::negative_zero,   &AdversarialRays::from_inside,    &AdversarialRays::from_far_away,
            &AdversarialRays::past_the_bounds, &AdversarialRays::from_cell_face};
        Ray ray = (this->*kKinds[count_ % kKinds.size()])();
        if (count_ % 4 == 3) ray.t_max = diagonal() * random_.uniform(0.0f, 1.5f) / glm::length(ray.direction);
        if (count_ % 3 == 2) {
            const auto k = static_cast<int>(random_.below(41)) - 20;
            ray.direction *= std::ldexp(1.0f, k);
            ray.t_max = std::ldexp(ray.t_max, -k);
        }
        ++count_;
        return ray;
    }
    [[nodiscard]] float diagonal() const { return glm::length(bounds_.size()); }
    bool coin() { return random_.below(2) == 0; }
    PrimitiveId any_id() { return ids_[random_.below(ids_.size())]; }
    glm::vec3 in_bounds() { return mix(random_.in_cube(0.0f, 1.0f)); }
    [[nodiscard]] glm::vec3 mix(glm::vec3 w) const { return bounds_.lo + w * bounds_.size(); }
    // Around the scene up to one diagonal away, or within its bounds.
    glm::vec3 viewpoint() { return coin() ? bounds_.center() + diagonal() * random_.in_cube(-1.0f, 1.0f) : in_bounds(); }

    static Ray aimed(glm::vec3 origin, glm::vec3 target) {
        const glm::dvec3 d = glm::dvec3(target) - glm::dvec3(origin);
        const double length = std::sqrt(glm::dot(d, d));
        return {origin, length > 0.0 ? glm::vec3(d / length) : glm::vec3(0.0f, 0.0f, 1.0f)};
    }

    // A corner, the end of a diameter, the centre of an end disk.
    glm::vec3 vertex() {
        if (ids_.empty()) return in_bounds();
        const PrimitiveId id = any_id();
        const std::uint32_t i = index_of(id);
        switch (kind_of(id)) {
            case PrimitiveKind::triangle: return geometry_.vertices[geometry_.triangles[i][random_.below(3)]];
            case PrimitiveKind::cone: return coin() ? geometry_.cones[i].base : geometry_.cones[i].apex;
            default: break;
        }
        const Aabb box = geometry_.bounds(id);
        glm::vec3 p = kind_of(id) == PrimitiveKind::sphere ? geometry_.spheres[i].center : box.lo;
        if (kind_of(id) == PrimitiveKind::sphere) {
            const auto axis = static_cast<int>(random_.below(3));
            p[axis] = coin() ? box.lo[axis] : box.hi[axis];
            return p;
        }
        for (int axis = 0; axis < 3; ++axis) p[axis] = coin() ? box.lo[axis] : box.hi[axis];
        return p;
    }

    // A point of an edge (or of the surface where there are none) and a direction along the surface there.
    void edge(glm::vec3& point, glm::vec3& tangent) {
        point = in_bounds();
        tangent = random_.direction();
        if (ids_.empty()) return;
        const PrimitiveId id = any_id();
        const std::uint32_t i = index_of(id);
        const float w = random_.uniform(0.0f, 1.0f);
        switch (kind_of(id)) {
            case PrimitiveKind::triangle: {
                const auto& t = geometry_.triangles[i];
                const glm::vec3 a = geometry_.vertices[t[0]], b = geometry_.vertices[t[1]], c = geometry_.vertices[t[2]];
                point = a + w * (b - a);
                tangent = random_.uniform(-1.0f, 1.0f) * (b - a) + random_.uniform(-1.0f, 1.0f) * (c - a);
                break;
            }
            case PrimitiveKind::sphere: {
                const glm::dvec3 n = random_.unit();
                point = glm::vec3(glm::dvec3(geometry_.spheres[i].center) + static_cast<double>(geometry_.spheres[i].radius) * n);
                tangent = glm::vec3(glm::cross(n, random_.unit()));
                break;
            }
            case PrimitiveKind::cone: {
                const Cone& cone = geometry_.cones[i];
                const glm::dvec3 axis = glm::normalize(glm::dvec3(cone.apex) - glm::dvec3(cone.base));
                const glm::dvec3 side = glm::normalize(glm::cross(axis, random_.unit()));
                const glm::vec3 a = cone.base + glm::vec3(static_cast<double>(cone.base_radius) * side);
                const glm::vec3 b = cone.apex + glm::vec3(static_cast<double>(cone.apex_radius) * side);
                point = a + w * (b - a);
                tangent = b - a;
                break;
            }
            default: {
                const Aabb box = geometry_.bounds(id);
                const auto axis = static_cast<int>(random_.below(3));
                for (int k = 0; k < 3; ++k) point[k] = coin() ? box.lo[k] : box.hi[k];
                point[axis] = box.lo[axis] + w * box.size()[axis];
                tangent[axis] = 0.0f;
            }
        }
        const float length = glm::length(tangent);
        tangent = length > 0.0f ? tangent / length : glm::vec3(0.0f, 0.0f, 1.0f);
    }

    Ray anywhere() { return {viewpoint(), random_.direction()}; }
    Ray through_vertex() { return aimed(viewpoint(), vertex()); }
    Ray through_edge() {
        glm::vec3 point, tangent;
        edge(point, tangent);
        return aimed(viewpoint(), point);
    }
    Ray along_axis() {
        const auto axis = static_cast<int>(random_.below(3));
        const float sign = coin() ? 1.0f : -1.0f;
        glm::vec3 origin = coin() ? vertex() : in_bounds(), direction(0.0f);
        origin[axis] -= sign * diagonal() * random_.uniform(0.0f, 1.5f);
        direction[axis] = sign;
        return {origin, direction};
    }
    // Starts on a face of the scene's bounds or of a primitive's, towards anywhere or along the face.
    Ray from_face() {
        const Aabb box = ids_.empty() || coin() ? bounds_ : geometry_.bounds(any_id());
        const auto axis = static_cast<int>(random_.below(3));
        glm::vec3 origin = box.lo + random_.in_cube(0.0f, 1.0f) * box.size(), direction = random_.direction();
        origin[axis] = coin() ? box.lo[axis] : box.hi[axis];
        if (coin()) direction[axis] = 0.0f;
        return {origin, direction};
    }
    Ray grazing() {
        glm::vec3 point, tangent;
        edge(point, tangent);
        return {point - diagonal() * random_.uniform(0.0f, 1.0f) * tangent, tangent};
    }
    Ray negative_zero() {
        const auto axis = static_cast<int>(random_.below(3));
        const glm::vec3 target = vertex();
        glm::vec3 origin = viewpoint();
        origin[axis] = target[axis];
        Ray ray = aimed(origin, target);
        ray.direction[axis] = coin() ? -0.0f : 0.0f;
        if (coin()) ray.direction[(axis + 1) % 3] *= 1.0e-30f;
        return ray;
    }
    Ray from_inside() {
        const Aabb box = ids_.empty() ? bounds_ : geometry_.bounds(any_id());
        return {box.center(), random_.direction()};
    }
    // Beyond any cell padding: from 65 to 10^6 times the geometry's largest coordinate.
    Ray from_far_away() {
        const float distance = std::max(bounds_.magnitude(), 1.0e-30f) * random_.power_of_ten(1.82f, 6.0f);
        return aimed(vertex() + distance * random_.direction(), coin() ? vertex() : in_bounds());
    }
    // Through the edges of the scene's bounds, from near and far: what a clipped walk drops first.
    Ray past_the_bounds() {
        const auto axis = static_cast<int>(random_.below(3));
        glm::vec3 w(coin() ? 0.0f : 1.0f, coin() ? 0.0f : 1.0f, coin() ? 0.0f : 1.0f);
        w[axis] = random_.uniform(0.0f, 1.0f);
        const glm::vec3 target = mix(w);
        return aimed(target + diagonal() * random_.power_of_ten(-2.0f, 4.0f) * random_.direction(), target);
    }
    // Along a face, an edge or the diagonal of a grid's cells, or out of a corner.
    Ray from_cell_face() {
        if (corners_.empty()) return anywhere();
        glm::vec3 origin(corners_[random_.below(corners_.size())]), direction = random_.direction();
        switch (random_.below(4)) {
            case 0: direction[static_cast<int>(random_.below(3))] = coin() ? 0.0f : -0.0f; break;
            case 1: direction = glm::vec3(0.0f), direction[static_cast<int>(random_.below(3))] = coin() ? 1.0f : -1.0f; break;
            case 2: direction = glm::vec3(corners_[random_.below(corners_.size())] - glm::dvec3(origin)); break;
            default: break;
        }
        if (!(glm::dot(direction, direction) > 0.0f)) direction = glm::vec3(1.0f);
        if (coin()) origin -= diagonal() * random_.uniform(0.0f, 1.0f) * direction / glm::length(direction);
        return {origin, direction};
    }

    const Geometry& geometry_;
    std::vector<PrimitiveId> ids_;
    std::span<const glm::dvec3> corners_;
    Random random_;
    Aabb bounds_;
    std::size_t count_ = 0;
    std::vector<AdversarialRays> in_prototypes_;
};

}  // namespace glint
