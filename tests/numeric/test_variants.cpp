#include "tests/numeric/test_variants.h"

#include <chrono>

#include "accel/primitive.h"
#include "tests/accel/random.h"
#include "tests/numeric/formulas.h"

namespace glint::numeric {
namespace {

struct Triangle3 {
    glm::vec3 v[3];
};

// A ray, what it is aimed at, and the true t.
template <class P>
struct Case {
    Ray ray;
    PreparedRay prepared;  // glint's; once a ray, so no part of a test
    P primitive;
    long double truth;
};

// Shapes of size 1 at random places near zero, in other proportions each time.
Triangle3 make(Random& random, Triangle3) {
    const glm::dvec3 at = random.unit();
    return {{glm::vec3(at + random.unit()), glm::vec3(at + random.unit()), glm::vec3(at + random.unit())}};
}
Sphere make(Random& random, Sphere) { return {glm::vec3(random.unit()), random.uniform(0.5f, 1.0f)}; }
Box make(Random& random, Box) {
    const glm::vec3 half(random.uniform(0.3f, 1.0f), random.uniform(0.3f, 1.0f), random.uniform(0.3f, 1.0f));
    const glm::vec3 at(random.unit());
    return {at - half, at + half};
}
Cone make(Random& random, Cone) {
    const glm::vec3 at(random.unit()), half(0.7 * random.unit());
    return {at - half, random.uniform(0.5f, 1.0f), at + half, random.uniform(0.0f, 0.5f)};
}
Plane make(Random& random, Plane) { return {random.unit(), random.uniform()}; }

// How far from there rays are aimed at most, so that about half of them hit.
template <class P>
constexpr double kAim = 1.2;
template <>
constexpr double kAim<Triangle3> = 0.4;

glm::dvec3 middle(const Triangle3& t) { return (glm::dvec3(t.v[0]) + glm::dvec3(t.v[1]) + glm::dvec3(t.v[2])) / 3.0; }
glm::dvec3 middle(const Sphere& s) { return glm::dvec3(s.center); }
glm::dvec3 middle(const Box& b) { return 0.5 * (glm::dvec3(b.lo) + glm::dvec3(b.hi)); }
glm::dvec3 middle(const Cone& c) { return 0.5 * (glm::dvec3(c.base) + glm::dvec3(c.apex)); }
glm::dvec3 middle(const Plane& p) { return -p.offset * p.normal; }

template <class P, class Truth>
std::vector<Case<P>> cases_of(int count, std::uint64_t seed, Truth&& truth) {
    Random random(seed);
    std::vector<Case<P>> cases;
    cases.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        const P primitive = make(random, P());
        const glm::dvec3 at = middle(primitive);
        const glm::vec3 eye(at + static_cast<double>(random.power_of_ten(0.3f, 4.0f)) * random.unit());
        const glm::dvec3 d = at + kAim<P> * std::cbrt(random.uniform()) * random.unit() - glm::dvec3(eye);
        const Ray ray{eye, glm::vec3(d / std::sqrt(glm::dot(d, d)))};
        cases.push_back({ray, PreparedRay(ray, 4.0f), primitive, truth(ray, primitive)});
    }
    return cases;
}

double ulps(float t, long double truth) {
    const float near = static_cast<float>(truth);
    const long double ulp = static_cast<long double>(std::nextafter(near, kInfinity)) - static_cast<long double>(near);
    return static_cast<double>(std::abs(static_cast<long double>(t) - truth) / ulp);
}

template <class P, class Test>
Variant measure(PrimitiveKind kind, const char* name, bool ours, const std::vector<Case<P>>& cases, int repeats, Test&& test) {
    Variant v{kind, name, ours};
    std::vector<double> errors;
    for (const Case<P>& c : cases) {
        const auto t = static_cast<float>(test(c));
        if ((t > 0.0f) != (c.truth > 0.0L)) ++v.wrong;
        if (t > 0.0f && c.truth > 0.0L) errors.push_back(ulps(t, c.truth));
    }
    std::sort(errors.begin(), errors.end());
    v.hits = static_cast<int>(errors.size());
    if (!errors.empty()) {
        v.median = errors[errors.size() / 2];
        v.p99 = errors[errors.size() * 99 / 100];
        v.most = errors.back();
    }
    const std::size_t timed = std::min<std::size_t>(cases.size(), 2048);  // they stay in the caches
    v.nanoseconds = 1e9;
    volatile float sink = 0.0f;
    for (int round = 0; round < repeats; ++round) {
        const auto start = std::chrono::steady_clock::now();
        float sum = 0.0f;
        for (int again = 0; again < 20; ++again) {
            for (std::size_t i = 0; i < timed; ++i) sum += static_cast<float>(test(cases[i]));
        }
        const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
        sink = sink + sum;
        v.nanoseconds = std::min(v.nanoseconds, took.count() / (20.0 * static_cast<double>(timed)));
    }
    return v;
}

void add_triangles(std::vector<Variant>& out, int count, int repeats) {
    const auto kind = PrimitiveKind::triangle;
    using C = Case<Triangle3>;
    const auto cases =
        cases_of<Triangle3>(count, 1, [](const Ray& r, const Triangle3& t) { return moeller_trumbore<long double>(r, t.v); });
    const auto add = [&](const char* name, bool ours, auto&& test) {
        out.push_back(measure(kind, name, ours, cases, repeats, test));
    };
    add("M\u00f6ller\u2013Trumbore, float", false, [](const C& c) { return moeller_trumbore<float>(c.ray, c.primitive.v); });
    add("M\u00f6ller\u2013Trumbore, double", false, [](const C& c) { return moeller_trumbore<double>(c.ray, c.primitive.v); });
    add("Woop, float and double", false, [](const C& c) { return woop(c.ray, c.primitive.v); });
    add("glint: watertight", true, [](const C& c) {
        TriangleHit hit{};
        const auto& v = c.primitive.v;
        return intersect_triangle(c.prepared, v[0], v[1], v[2], kInfinity, hit) ? hit.t : 0.0f;
    });
}

void add_spheres(std::vector<Variant>& out, int count, int repeats) {
    const auto kind = PrimitiveKind::sphere;
    using C = Case<Sphere>;
    const auto cases =
        cases_of<Sphere>(count, 2, [](const Ray& r, const Sphere& s) { return perpendicular_sphere<long double>(r, s); });
    const auto add = [&](const char* name, bool ours, auto&& test) {
        out.push_back(measure(kind, name, ours, cases, repeats, test));
    };
    add("quadratic, float", false, [](const C& c) { return quadratic_sphere<float>(c.ray, c.primitive); });
    add("perpendicular, float", false, [](const C& c) { return perpendicular_sphere<float>(c.ray, c.primitive); });
    add("quadratic, double", false, [](const C& c) { return quadratic_sphere<double>(c.ray, c.primitive); });
    add("glint: perpendicular, double", true, [](const C& c) { return intersect_sphere(c.prepared, c.primitive, kInfinity); });
}

void add_boxes(std::vector<Variant>& out, int count, int repeats) {
    const auto kind = PrimitiveKind::box;
    using C = Case<Box>;
    const auto cases = cases_of<Box>(count, 3, [](const Ray& r, const Box& b) { return slabs<long double>(r, b); });
    const auto add = [&](const char* name, bool ours, auto&& test) {
        out.push_back(measure(kind, name, ours, cases, repeats, test));
    };
    add("slabs, float", false, [](const C& c) { return slabs<float>(c.ray, c.primitive); });
    add("slabs, double", false, [](const C& c) { return slabs<double>(c.ray, c.primitive); });
    add("glint: slabs with faces, double", true, [](const C& c) {
        int face = 0;
        return intersect_box(c.prepared, c.primitive, kInfinity, face);
    });
}

void add_cones(std::vector<Variant>& out, int count, int repeats) {
    const auto kind = PrimitiveKind::cone;
    using C = Case<Cone>;
    const auto cases = cases_of<Cone>(count, 4, [](const Ray& r, const Cone& k) { return cone<long double>(r, k); });
    const auto add = [&](const char* name, bool ours, auto&& test) {
        out.push_back(measure(kind, name, ours, cases, repeats, test));
    };
    add("quadratic, float", false, [](const C& c) { return cone<float>(c.ray, c.primitive); });
    add("quadratic, double", false, [](const C& c) { return cone<double>(c.ray, c.primitive); });
    add("glint: shifted, double", true, [](const C& c) { return intersect_cone(c.prepared, c.primitive, kInfinity); });
}

void add_planes(std::vector<Variant>& out, int count, int repeats) {
    const auto kind = PrimitiveKind::plane;
    using C = Case<Plane>;
    const auto cases = cases_of<Plane>(count, 5, [](const Ray& r, const Plane& p) { return plane<long double>(r, p); });
    const auto add = [&](const char* name, bool ours, auto&& test) {
        out.push_back(measure(kind, name, ours, cases, repeats, test));
    };
    add("float", false, [](const C& c) { return plane<float>(c.ray, c.primitive); });
    add("glint: double", true, [](const C& c) { return intersect_plane(c.prepared, c.primitive, kInfinity); });
}

}  // namespace

std::vector<Variant> measure_variants(int cases, int repeats) {
    std::vector<Variant> variants;
    add_triangles(variants, cases, repeats);
    add_spheres(variants, cases, repeats);
    add_boxes(variants, cases, repeats);
    add_cones(variants, cases, repeats);
    add_planes(variants, cases, repeats);
    return variants;
}

}  // namespace glint::numeric
