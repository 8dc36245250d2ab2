// The vertices that a viewer sees: those of the world, and those of prototypes wherever they are placed. For framing.
// Knows no camera. Invariant: all points lie within Geometry::bounds() up to rounding, and the extreme ones are among them.
#pragma once

#include "accel/geometry.h"

namespace glint {

// Calls visit(vertex). Of crowds with more than 2^24 vertices it visits the corners of each instance's box instead.
template <class Visit>
void for_each_seen_vertex(const Geometry& geometry, Visit&& visit) {
    for (const glm::vec3 v : geometry.vertices) visit(v);
    std::size_t vertices = 0;
    for (const Instance& i : geometry.instances) vertices += geometry.prototypes[i.prototype].geometry->vertices.size();
    const bool all = vertices <= std::size_t{1} << 24;
    for (const Instance& i : geometry.instances) {
        if (all) {
            const AffineMap world_from_object = inverse(i.object_from_world);
            for (const glm::vec3 v : geometry.prototypes[i.prototype].geometry->vertices)
                visit(glm::vec3(world_from_object.point(glm::dvec3(v))));
            continue;
        }
        const Aabb box = geometry.instance_bounds(i);
        for (unsigned corner = 0; corner < 8; ++corner) {
            visit(glm::vec3((corner & 1u) != 0 ? box.hi.x : box.lo.x, (corner & 2u) != 0 ? box.hi.y : box.lo.y,
                            (corner & 4u) != 0 ? box.hi.z : box.lo.z));
        }
    }
}

}  // namespace glint
