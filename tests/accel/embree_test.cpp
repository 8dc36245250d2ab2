// Another program's answers: Embree in its robust mode sees the same primitive, off the edges. Only where its library is.
#include <gtest/gtest.h>

#include "accel/accelerator.h"
#include "tests/accel/adversarial_scenes.h"
#include "tests/accel/hit_report.h"
#include "tests/long.h"

#ifdef GLINT_EMBREE
#include <embree3/rtcore.h>
#endif

namespace glint {
namespace {

#ifdef GLINT_EMBREE

// A scene of triangles and spheres in Embree; geometry 0 and 1.
class Peer {
public:
    explicit Peer(const Geometry& g) : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        attach(RTC_GEOMETRY_TYPE_TRIANGLE, 0, g.triangles.size(), [&](RTCGeometry mesh) {
            copy(mesh, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, g.vertices);
            copy(mesh, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, g.triangles);
        });
        attach(RTC_GEOMETRY_TYPE_SPHERE_POINT, 1, g.spheres.size(),
               [&](RTCGeometry balls) { copy(balls, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, g.spheres); });
        rtcCommitScene(scene_);
    }
    ~Peer() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    Peer(const Peer&) = delete;
    Peer& operator=(const Peer&) = delete;

    [[nodiscard]] Hit closest_hit(const Ray& ray) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit r{};
        r.ray.org_x = ray.origin.x, r.ray.org_y = ray.origin.y, r.ray.org_z = ray.origin.z;
        r.ray.dir_x = ray.direction.x, r.ray.dir_y = ray.direction.y, r.ray.dir_z = ray.direction.z;
        r.ray.tfar = ray.t_max, r.ray.mask = ~0u;
        r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &context, &r);
        if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
        return {r.ray.tfar, r.hit.u, r.hit.v,
                make_id(r.hit.geomID == 0 ? PrimitiveKind::triangle : PrimitiveKind::sphere, r.hit.primID)};
    }

private:
    template <class Fill>
    void attach(RTCGeometryType type, unsigned id, std::size_t count, const Fill& fill) {
        if (count == 0) return;
        RTCGeometry geometry = rtcNewGeometry(device_, type);
        fill(geometry);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene_, geometry, id);
        rtcReleaseGeometry(geometry);
    }
    template <class T>
    static void copy(RTCGeometry geometry, RTCBufferType type, RTCFormat format, const std::vector<T>& from) {
        auto* to = static_cast<T*>(rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(T), from.size()));
        std::copy(from.begin(), from.end(), to);
    }

    RTCDevice device_;
    RTCScene scene_;
};

// Between the ray and the surface's normal, as an absolute value.
double cosine(const Geometry& g, const Ray& ray, const Hit& h) {
    const glm::dvec3 d(ray.direction);
    glm::dvec3 n;
    if (kind_of(h.primitive) == PrimitiveKind::triangle) {
        const auto& corners = g.triangles[index_of(h.primitive)];
        const glm::dvec3 a(g.vertices[corners[0]]), b(g.vertices[corners[1]]), c(g.vertices[corners[2]]);
        n = glm::cross(b - a, c - a);
    } else {
        n = glm::dvec3(ray.origin) + static_cast<double>(h.t) * d - glm::dvec3(g.spheres[index_of(h.primitive)].center);
    }
    return std::abs(glm::dot(n, d)) / (glm::length(n) * glm::length(d));
}

// Whether the hit lies so close to the primitive's border that programs may see it or not.
bool at_the_border(const Geometry& g, const Ray& ray, const Hit& h) {
    if (kind_of(h.primitive) == PrimitiveKind::triangle) return std::min({h.u, h.v, 1.0f - h.u - h.v}) < 1e-4f;
    return cosine(g, ray, h) < 0.02;
}

void expect_same_ids(const Geometry& geometry, const char* name, float viewpoint) {
    const auto shared = std::make_shared<const Geometry>(geometry);
    const Bvh ours(shared);
    const Peer theirs(geometry);
    const Aabb box = geometry.bounds();
    Random random(1);
    const int rays = scale(100000, 5000000);
    int found = 0, border = 0;
    for (int i = 0; i < rays; ++i) {
        const glm::vec3 target = box.lo + random.in_cube(0.0f, 1.0f) * box.size();
        const glm::vec3 origin = box.center() + viewpoint * glm::length(box.size()) * random.direction();
        const Ray ray{origin, glm::normalize(target - origin)};
        const Hit a = ours.closest_hit(ray), b = theirs.closest_hit(ray);
        found += a.found() ? 1 : 0;
        if (a.primitive == b.primitive) {
            if (!a.found()) continue;
            // Both round across the surface; a grazing ray meets that from far along.
            const double across = 2e-6 * static_cast<double>(a.t + box.magnitude());
            ASSERT_NEAR(a.t, b.t, across / cosine(geometry, ray, a)) << name << ' ' << text(ray);
            continue;
        }
        // The nearer of two answers was seen by one alone.
        const Hit& nearer = a.t <= b.t ? a : b;
        const bool one_surface = a.found() && b.found() && std::abs(a.t - b.t) <= 1e-5f * (a.t + box.magnitude());
        ++border;
        EXPECT_TRUE(one_surface || at_the_border(geometry, ray, nearer)) << name << ' ' << text(ray) << "\n"
                                                                         << text(a) << "\n"
                                                                         << text(b);
    }
    testing::Test::RecordProperty(std::string(name) + "_at_borders", border);
    EXPECT_GT(found, rays / 5) << name;
    EXPECT_LT(border, rays / 1000) << name;
}

TEST(Embree, O_INT_01_SeesTheSamePrimitiveOffTheEdges) {
    expect_same_ids(scenes::triangle_soup(), "triangle_soup", 0.8f);
    expect_same_ids(scenes::triangle_soup(), "triangle_soup_inside", 0.1f);
    expect_same_ids(scenes::closed_ball(), "closed_ball", 1.0f);
    expect_same_ids(scenes::sphereflake(), "sphereflake", 0.8f);
}

#else

TEST(Embree, O_INT_01_SeesTheSamePrimitiveOffTheEdges) { GTEST_SKIP() << "built without Embree (libembree-dev)"; }

#endif

}  // namespace
}  // namespace glint
