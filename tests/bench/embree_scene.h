// A scene of Embree 3 made from glint's geometry, and what building it took.
// Knows no rays. Invariant: Embree's geometry ids are glint's primitive kinds, so that geomID << 29 | primID is a PrimitiveId.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include <embree3/rtcore.h>

#include "accel/geometry.h"

namespace glint::bench {

struct EmbreeBuild {
    RTCBuildQuality quality = RTC_BUILD_QUALITY_MEDIUM;
    bool robust = false;
    bool avx512 = false;  // Embree keeps to 256 bits unless told; packets and streams of 16 gain by it
    int threads = 2;      // that build

    bool operator==(const EmbreeBuild&) const = default;
};

// Vertices with the padding that Embree asks for: it reads 16 bytes of the last one.
class EmbreeInput {
public:
    explicit EmbreeInput(const Geometry& geometry);

private:
    friend class EmbreeScene;
    const Geometry& geometry_;
    std::vector<glm::vec3> vertices_;
};

class EmbreeScene {
public:
    EmbreeScene(std::shared_ptr<const EmbreeInput> input, const EmbreeBuild& build);
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    [[nodiscard]] RTCScene handle() const { return scene_; }
    [[nodiscard]] const EmbreeBuild& build() const { return build_; }
    // What Embree holds beyond the shared vertices and indices.
    [[nodiscard]] std::size_t memory_bytes() const { return static_cast<std::size_t>(bytes_.load()); }
    [[nodiscard]] double build_seconds() const { return build_seconds_; }
    [[nodiscard]] bool has_streams() const;

private:
    void attach_triangles();
    void attach_spheres();

    std::shared_ptr<const EmbreeInput> input_;
    EmbreeBuild build_;
    std::atomic<std::ptrdiff_t> bytes_{0};
    double build_seconds_ = 0.0;
    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
};

}  // namespace glint::bench
