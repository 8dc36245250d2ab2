// Closing ranks keeps those that go on, in their order, in every instruction set.
#include "core/ranks.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/sampler.h"
#include "tests/core/render_picture.h"

namespace glint {
namespace {

TEST(Ranks, KeepThoseThatGoOnInTheirOrder) {
    for_each_isa([](Isa) {
        for (const std::uint32_t n : {0u, 1u, 8u, 9u, 63u, 255u, 256u}) {
            for (std::uint32_t share = 0; share <= 4; ++share) {
                std::uint32_t flags[kRayBatch], numbers[kRayBatch];
                float floats[kRayBatch];
                std::vector<std::uint32_t> expected;
                for (std::uint32_t i = 0; i < kRayBatch; ++i) {
                    flags[i] = hash(i, share) % 4 < share ? ~0u : 0u;
                    numbers[i] = hash(i);
                    floats[i] = static_cast<float>(i);
                    if (i < n && flags[i] != 0) expected.push_back(i);
                }
                const Ranks ranks(flags, n);
                ranks.close(numbers);
                ranks.close(floats);
                ASSERT_EQ(ranks.kept(), expected.size());
                for (std::size_t k = 0; k < expected.size(); ++k) {
                    EXPECT_EQ(numbers[k], hash(expected[k]));
                    EXPECT_EQ(floats[k], static_cast<float>(expected[k]));
                }
            }
        }
    });
}

}  // namespace
}  // namespace glint
