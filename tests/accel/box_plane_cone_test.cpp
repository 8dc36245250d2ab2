#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "accel/accelerator.h"
#include "tests/accel/adversarial_scenes.h"
#include "tests/accel/hit_report.h"

namespace glint {
namespace {

template <class T>
std::shared_ptr<const Geometry> alone(std::vector<T> Geometry::*kind, const T& primitive) {
    auto geometry = std::make_shared<Geometry>();
    ((*geometry).*kind).push_back(primitive);
    return geometry;
}

Hit hit_of(const Ray& ray, const Box& box) { return BruteForce(alone(&Geometry::boxes, box)).closest_hit(ray); }
float t_of(const Ray& ray, const Plane& plane) { return intersect_plane(PreparedRay(ray, 0.0f), plane, ray.t_max); }

TEST(Box, S_BOX_01_ZeroTimesInfinityOnEveryFace) {
    const Box box{glm::vec3(0.0f), glm::vec3(1.0f)};
    for (int along = 0; along < 3; ++along) {
        for (const int across : {(along + 1) % 3, (along + 2) % 3}) {
            for (const float face : {0.0f, 1.0f, std::nextafter(1.0f, 2.0f)}) {
                for (const float zero : {0.0f, -0.0f}) {
                    Ray ray{glm::vec3(0.5f), glm::vec3(zero)};
                    ray.origin[along] = -1.0f;
                    ray.origin[across] = face;
                    ray.direction[along] = 1.0f;
                    const Hit hit = hit_of(ray, box);
                    ASSERT_EQ(hit.found(), face <= 1.0f) << text(ray);
                    if (!hit.found()) continue;
                    EXPECT_EQ(hit.t, 1.0f) << text(ray);
                    EXPECT_EQ(hit.u, static_cast<float>(2 * along)) << text(ray);
                }
            }
        }
    }
}

TEST(Box, S_BOX_02_FlatBoxesAreFoundThroughTheirBounds) {
    for (int axis = 0; axis < 3; ++axis) {
        auto geometry = std::make_shared<Geometry>(scenes::flat(axis));
        Box sheet{glm::vec3(-20.0f), glm::vec3(20.0f)};
        sheet.lo[axis] = sheet.hi[axis] = 1.0f;
        geometry->boxes = {sheet};
        for (const auto kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh}) {
            const auto accelerator = build_accelerator(kind, geometry);
            Random random(2);
            for (int i = 0; i < 3000; ++i) {
                // To an inner corner of the tiles, from either side: a tile or the sheet before it.
                glm::vec3 target(0.0f), origin = random.in_cube(-19.0f, 19.0f);
                for (int k = 1; k < 3; ++k) target[(axis + k) % 3] = static_cast<float>(random.below(39)) - 19.0f;
                origin[axis] = i % 2 == 0 ? random.uniform(-9.0f, -1.0f) : random.uniform(2.0f, 9.0f);
                const Ray ray{origin, target - origin};
                const Hit hit = closest_hit(*accelerator, ray);
                ASSERT_TRUE(hit.found()) << text(ray);
                ASSERT_EQ(kind_of(hit.primitive), i % 2 == 0 ? PrimitiveKind::triangle : PrimitiveKind::box) << text(ray);
            }
        }
    }
}

TEST(Box, S_BOX_04_AnEmptyBoxIsNeverEnteredAndAnInvertedOneIsRejected) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(valid(Box{glm::vec3(1.0f), glm::vec3(0.0f)}));
    EXPECT_FALSE(valid(Box{glm::vec3(0.0f, nan, 0.0f), glm::vec3(1.0f)}));
    EXPECT_FALSE(valid(Box{glm::vec3(0.0f), glm::vec3(kInfinity)}));
    EXPECT_FALSE(valid(Box{glm::vec3(-1.0e30f), glm::vec3(1.0f)}));
    EXPECT_TRUE(valid(Box{glm::vec3(0.0f), glm::vec3(0.0f)}));
    Random random(4);
    for (int i = 0; i < 100000; ++i) {
        Ray ray{random.in_cube(-1.0f, 1.0f) * random.power_of_ten(-30.0f, 30.0f),
                random.direction() * random.power_of_ten(-30.0f, 30.0f)};
        if (i % 2 == 0) ray.direction[static_cast<int>(random.below(3))] = 0.0f;
        const PreparedRay prepared(ray, random.power_of_ten(-30.0f, 18.0f));
        ASSERT_TRUE(!prepared.usable || slab_interval(prepared, Aabb()).empty()) << text(ray);
    }
}

TEST(Box, S_BOX_05_FromInsideTheExitFace) {
    const Box box{glm::vec3(-1.0f, -2.0f, -3.0f), glm::vec3(1.0f, 2.0f, 3.0f)};
    for (int axis = 0; axis < 3; ++axis) {
        for (const int side : {0, 1}) {
            glm::vec3 d(0.0f);
            d[axis] = side == 0 ? -1.0f : 1.0f;
            const Hit inside = hit_of({glm::vec3(0.0f), d}, box);
            EXPECT_EQ(inside.t, box.hi[axis]);
            EXPECT_EQ(inside.u, static_cast<float>(2 * axis + side));
            const Hit outside = hit_of({-10.0f * d, d}, box);
            EXPECT_EQ(outside.t, 10.0f - box.hi[axis]);
            EXPECT_EQ(outside.u, static_cast<float>(2 * axis + 1 - side));
            const Hit leaving = hit_of({d * box.hi, d}, box);
            EXPECT_FALSE(leaving.found()) << "starts on the face, outwards";
            EXPECT_EQ(hit_of({d * box.hi, -d}, box).t, 2.0f * box.hi[axis]) << "starts on the face, inwards";
        }
    }
    // Through corners: some face that meets there, and the same each time.
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p(corner & 1 ? 1.0f : -1.0f, corner & 2 ? 2.0f : -2.0f, corner & 4 ? 3.0f : -3.0f);
        for (const Ray& ray : {Ray{2.0f * p, -p}, Ray{glm::vec3(0.0f), p}}) {
            const Hit hit = hit_of(ray, box);
            ASSERT_EQ(hit.t, 1.0f) << text(ray);
            const auto face = static_cast<int>(hit.u);
            EXPECT_EQ(face & 1, p[face / 2] > 0.0f ? 1 : 0) << text(ray);
            EXPECT_TRUE(same(hit, hit_of(ray, box)));
        }
    }
}

// The oracle looks at each face by itself, in long double.
TEST(Box, S_BOX_05_AgreesWithAllSixFaces) {
    Random random(5);
    int found = 0;
    for (int i = 0; i < 100000; ++i) {
        const glm::vec3 lo = random.in_cube(-1.0f, 0.5f);
        const Box box{lo, lo + random.in_cube(0.1f, 1.0f)};
        const glm::vec3 origin = random.in_cube(-2.0f, 2.0f);
        const Ray ray{origin, random.in_cube(-1.0f, 1.0f) - origin};
        long double nearest = std::numeric_limits<long double>::infinity();
        for (int face = 0; face < 6; ++face) {
            const int axis = face / 2;
            const long double plane = (face & 1) != 0 ? box.hi[axis] : box.lo[axis];
            const long double t =
                (plane - static_cast<long double>(ray.origin[axis])) / static_cast<long double>(ray.direction[axis]);
            bool within = t > 0.0L && t < nearest;
            for (int k = 0; k < 3; ++k) {
                const long double x = static_cast<long double>(ray.origin[k]) + t * static_cast<long double>(ray.direction[k]);
                within = within &&
                         (k == axis || (x >= static_cast<long double>(box.lo[k]) && x <= static_cast<long double>(box.hi[k])));
            }
            if (within) nearest = t;
        }
        const Hit hit = hit_of(ray, box);
        ASSERT_EQ(hit.found(), std::isfinite(nearest)) << text(ray);
        if (!hit.found()) continue;
        ++found;
        ASSERT_FLOAT_EQ(hit.t, static_cast<float>(nearest)) << text(ray);
        const auto face = static_cast<int>(hit.u);
        const double reached =
            static_cast<double>(ray.origin[face / 2]) + static_cast<double>(hit.t) * static_cast<double>(ray.direction[face / 2]);
        ASSERT_NEAR(reached, (face & 1) != 0 ? box.hi[face / 2] : box.lo[face / 2], 1.0e-6) << text(ray);
    }
    EXPECT_GT(found, 10000);
}

TEST(Plane, S_PLN_01_ParallelRaysMiss) {
    const Plane floor{glm::dvec3(0.0, 1.0, 0.0), 0.0};
    EXPECT_EQ(t_of({glm::vec3(0.0f, 1.0f, 0.0f), glm::vec3(1.0f, 0.0f, 0.0f)}, floor), 0.0f);
    EXPECT_EQ(t_of({glm::vec3(0.0f), glm::vec3(1.0f, 0.0f, 0.0f)}, floor), 0.0f) << "in the plane";
    EXPECT_EQ(t_of({glm::vec3(0.0f), glm::vec3(0.0f, -1.0f, 0.0f)}, floor), 0.0f) << "starts on the plane";
    EXPECT_FLOAT_EQ(t_of({glm::vec3(0.0f, 1.0f, 0.0f), glm::vec3(1.0f, -1.0e-30f, 0.0f)}, floor), 1.0e30f);
    EXPECT_EQ(t_of({glm::vec3(0.0f, 1.0f, 0.0f), glm::vec3(1.0f, -1.0e-40f, 0.0f)}, floor), 0.0f) << "beyond what float can say";
    EXPECT_EQ(t_of({glm::vec3(0.0f, 1.0f, 0.0f), glm::vec3(1.0f, 1.0e-30f, 0.0f)}, floor), 0.0f) << "rises";
    EXPECT_FLOAT_EQ(t_of({glm::vec3(0.0f, 3.0f, 0.0f), glm::vec3(0.0f, -2.0f, 0.0f)}, floor), 1.5f) << "from above";
    EXPECT_FLOAT_EQ(t_of({glm::vec3(0.0f, -3.0f, 0.0f), glm::vec3(0.0f, 2.0f, 0.0f)}, floor), 1.5f) << "from below";
    EXPECT_FALSE(valid(plane_through(glm::dvec3(0.0), glm::dvec3(1.0), glm::dvec3(2.0)))) << "three points on a line";
}

TEST(Plane, S_PLN_03_APlaneStaysOutsideTheAccelerators) {
    auto geometry = std::make_shared<Geometry>();
    geometry->spheres = {{glm::vec3(0.0f, 1.0f, 0.0f), 0.5f}};
    geometry->planes = {{glm::dvec3(0.0, 1.0, 0.0), 0.0}, plane_through({0, 0, -9}, {1, 0, -9}, {0, 1, -9})};
    EXPECT_LE(geometry->bounds().magnitude(), 2.0f);
    EXPECT_EQ(geometry->bounded_ids().size(), 1u);
    const BruteForce truth(geometry);
    for (const auto kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh}) {
        const auto accelerator = build_accelerator(kind, geometry);
        Random random(3);
        int on_plane = 0;
        for (int i = 0; i < 20000; ++i) {
            const Ray ray{random.in_cube(-3.0f, 3.0f), random.direction(), i % 2 == 0 ? kInfinity : random.uniform(0.0f, 5.0f)};
            const Hit expected = truth.closest_hit(ray), hit = closest_hit(*accelerator, ray);
            ASSERT_TRUE(same(hit, expected)) << text(ray) << text(hit) << text(expected);
            ASSERT_EQ(occluded(*accelerator, ray), expected.found()) << text(ray);
            on_plane += expected.found() && kind_of(expected.primitive) == PrimitiveKind::plane ? 1 : 0;
        }
        EXPECT_GT(on_plane, 1000);
    }
}

}  // namespace
}  // namespace glint
