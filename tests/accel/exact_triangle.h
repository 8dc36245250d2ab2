// Whether the line of a ray meets a triangle, decided by rational arithmetic: nothing rounds, however thin the triangle.
// Knows no accelerator and no tolerance.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>

#include "accel/ray.h"

namespace glint {

// Signs of the determinants |d, p - o, q - o| for the edges pq = bc, ca, ab.
struct ExactTriangle {
    using Rational = boost::multiprecision::cpp_rational;
    int u, v, w;

    ExactTriangle(const Ray& ray, glm::vec3 a, glm::vec3 b, glm::vec3 c)
        : u(edge(ray, b, c)), v(edge(ray, c, a)), w(edge(ray, a, b)) {}

    // The border belongs to the triangle; a line in its plane misses.
    [[nodiscard]] bool hit() const {
        const bool in_plane = u == 0 && v == 0 && w == 0;
        return !in_plane && ((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0));
    }

private:
    static int edge(const Ray& ray, glm::vec3 p, glm::vec3 q) {
        Rational d[3], e[3], f[3];
        for (int k = 0; k < 3; ++k) {
            const Rational o(ray.origin[k]);
            d[k] = Rational(ray.direction[k]);
            e[k] = Rational(p[k]) - o;
            f[k] = Rational(q[k]) - o;
        }
        const Rational det =
            d[0] * (e[1] * f[2] - e[2] * f[1]) + d[1] * (e[2] * f[0] - e[0] * f[2]) + d[2] * (e[0] * f[1] - e[1] * f[0]);
        return det.sign();
    }
};

}  // namespace glint
