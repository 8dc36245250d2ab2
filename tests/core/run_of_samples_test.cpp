// Samples of a pixel that are made together are those made one by one, to the bit, in every instruction set.
#include <gtest/gtest.h>

#include "accel/isa.h"
#include "core/camera.h"
#include "core/sampler.h"

namespace glint {
namespace {

class RunOfSamples : public testing::TestWithParam<Isa> {
protected:
    void SetUp() override {
        if (!supported(GetParam())) GTEST_SKIP() << "not supported by this machine";
        use_isa(GetParam());
    }
    void TearDown() override { use_isa(best_isa()); }
};

TEST_P(RunOfSamples, HasTheSamplersSquares) {
    for (std::size_t kind = 0; kind < kSamplerNames.size(); ++kind) {
        for (const std::uint32_t first : {0u, 1u, 8u, 60u, 4093u}) {
            const Sampler pixel(static_cast<SamplerKind>(kind), 17, 29, 0, 123456789012345u);
            float x[Sampler::kRun], y[Sampler::kRun];
            pixel.at(first).squares(3, x, y);
            for (std::uint32_t k = 0; k < Sampler::kRun; ++k) {
                const Sampler alone(static_cast<SamplerKind>(kind), 17, 29, first + k, 123456789012345u);
                EXPECT_EQ(glm::vec2(x[k], y[k]), alone.square(3)) << kSamplerNames[kind] << ' ' << first << ' ' << k;
            }
        }
    }
}

TEST_P(RunOfSamples, HasTheCamerasRays) {
    CameraPose pose;
    pose.eye = {3.0f, -7.0f, 1e4f};
    pose.target = {0.1f, 0.2f, -0.3f};
    const Camera camera(pose, 1000, 601);
    for (std::uint32_t i = 0; i < 200; ++i) {
        float x[Camera::kRunOfRays], y[Camera::kRunOfRays], d[3][Camera::kRunOfRays];
        for (std::uint32_t k = 0; k < Camera::kRunOfRays; ++k) {
            x[k] = static_cast<float>(hash(i, k) >> 8) * 0x1p-24f * 1000.0f;
            y[k] = static_cast<float>(hash(k, i) >> 8) * 0x1p-24f * 601.0f;
        }
        camera.pinhole_rays(x, y, d);
        for (int k = 0; k < Camera::kRunOfRays; ++k) {
            const Ray alone = camera.ray(x[k], y[k], glm::vec2(0.0f));
            EXPECT_EQ(alone.origin, camera.eye());
            EXPECT_EQ(alone.direction, glm::vec3(d[0][k], d[1][k], d[2][k]));
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Sets, RunOfSamples, testing::Values(Isa::baseline, Isa::avx2, Isa::avx512),
                         [](const auto& set) { return std::string(kIsaNames[static_cast<std::size_t>(set.param)]); });

}  // namespace
}  // namespace glint
