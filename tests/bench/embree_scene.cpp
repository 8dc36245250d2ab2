#include "embree_scene.h"

#include <chrono>
#include <stdexcept>

#include <fmt/core.h>

namespace glint::bench {
namespace {

bool count_bytes(void* counter, ssize_t bytes, bool) {
    *static_cast<std::atomic<std::ptrdiff_t>*>(counter) += bytes;
    return true;
}

}  // namespace

EmbreeInput::EmbreeInput(const Geometry& geometry) : geometry_(geometry), vertices_(geometry.vertices) {
    vertices_.emplace_back(0.0f);
    vertices_.emplace_back(0.0f);
}

EmbreeScene::EmbreeScene(std::shared_ptr<const EmbreeInput> input, const EmbreeBuild& build)
    : input_(std::move(input)), build_(build) {
    const std::string options =
        fmt::format("threads={},user_threads=0,set_affinity=0{}", build.threads, build.avx512 ? ",frequency_level=simd512" : "");
    device_ = rtcNewDevice(options.c_str());
    if (device_ == nullptr) throw std::runtime_error("Embree gave no device");
    rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &bytes_);
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, build.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(scene_, build.quality);
    attach_triangles();
    attach_spheres();
    const auto start = std::chrono::steady_clock::now();
    rtcCommitScene(scene_);
    build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) throw std::runtime_error("Embree could not build the scene");
}

EmbreeScene::~EmbreeScene() {
    rtcReleaseScene(scene_);
    // The device frees the last bytes as it goes and counts them.
    rtcReleaseDevice(device_);
}

void EmbreeScene::attach_triangles() {
    const Geometry& g = input_->geometry_;
    if (g.triangles.empty()) return;
    RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(mesh, build_.quality);
    rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, input_->vertices_.data(), 0, sizeof(glm::vec3),
                               g.vertices.size());
    rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, g.triangles.data(), 0, sizeof(g.triangles[0]),
                               g.triangles.size());
    rtcCommitGeometry(mesh);
    rtcAttachGeometryByID(scene_, mesh, static_cast<unsigned>(PrimitiveKind::triangle));
    rtcReleaseGeometry(mesh);
}

void EmbreeScene::attach_spheres() {
    const Geometry& g = input_->geometry_;
    if (g.spheres.empty()) return;
    RTCGeometry spheres = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    rtcSetGeometryBuildQuality(spheres, build_.quality);
    rtcSetSharedGeometryBuffer(spheres, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, g.spheres.data(), 0, sizeof(Sphere),
                               g.spheres.size());
    rtcCommitGeometry(spheres);
    rtcAttachGeometryByID(scene_, spheres, static_cast<unsigned>(PrimitiveKind::sphere));
    rtcReleaseGeometry(spheres);
}

bool EmbreeScene::has_streams() const { return rtcGetDeviceProperty(device_, RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED) != 0; }

}  // namespace glint::bench
