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
    constexpr std::size_t kMany = 3 * Sampler::kRun, kAsked = kMany - 3;
    for (std::size_t i = 0; i < kSamplerNames.size(); ++i) {
        const auto kind = static_cast<SamplerKind>(i);
        std::uint32_t pixel[kMany], index[kMany], dimension[kMany];
        for (std::uint32_t k = 0; k < kMany; ++k) {
            pixel[k] = Sampler(kind, 17 + k / 5, 29, 0, 123456789012345u).pixel();
            index[k] = k % 5 + (k < 12 ? 0u : 4093u);
            dimension[k] = k % 4 == 0 ? 0u : hash(k, 3);
        }
        float x[kMany], y[kMany];
        Sampler::squares(kind, pixel, index, dimension, kAsked, x, y);
        for (std::uint32_t k = 0; k < kAsked; ++k) {
            const Sampler alone(kind, 17 + k / 5, 29, index[k], 123456789012345u);
            EXPECT_EQ(glm::vec2(x[k], y[k]), alone.square(dimension[k])) << kSamplerNames[i] << ' ' << k;
        }
        Sampler::squares(kind, pixel, index, 3, kAsked, x, y);
        for (std::uint32_t k = 0; k < kAsked; ++k) {
            EXPECT_EQ(glm::vec2(x[k], y[k]), Sampler(kind, pixel[k], index[k]).square(3)) << kSamplerNames[i] << ' ' << k;
        }
    }
}

TEST_P(RunOfSamples, HasTheCamerasRays) {
    CameraPose pose;
    pose.eye = {3.0f, -7.0f, 1e4f};
    pose.target = {0.1f, 0.2f, -0.3f};
    const Camera camera(pose, 1000, 601);
    constexpr std::uint32_t kMany = 200, kAsked = kMany - 5;
    float x[kMany], y[kMany];
    for (std::uint32_t k = 0; k < kMany; ++k) {
        x[k] = static_cast<float>(hash(k, 1) >> 8) * 0x1p-24f * 1000.0f;
        y[k] = static_cast<float>(hash(1, k) >> 8) * 0x1p-24f * 601.0f;
    }
    RayBatch rays;
    camera.pinhole_rays(x, y, kAsked, rays);
    ASSERT_EQ(rays.count, static_cast<int>(kAsked));
    for (int k = 0; k < rays.count; ++k) {
        const Ray alone = camera.ray(x[k], y[k], glm::vec2(0.0f));
        EXPECT_EQ(rays[k].origin, alone.origin);
        EXPECT_EQ(rays[k].direction, alone.direction);
        EXPECT_EQ(rays[k].t_max, kInfinity);
    }
}

INSTANTIATE_TEST_SUITE_P(Sets, RunOfSamples, testing::Values(Isa::baseline, Isa::avx2, Isa::avx512),
                         [](const auto& set) { return std::string(kIsaNames[static_cast<std::size_t>(set.param)]); });

}  // namespace
}  // namespace glint
