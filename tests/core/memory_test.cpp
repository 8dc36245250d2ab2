// Memory that runs out in the middle of things: what was asked for fails and says so, everything else goes on.
#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/resource.h>

#include <fstream>

#include "tests/core/render_picture.h"

namespace glint {
namespace {

// While one lives, the process gets no more than `megabytes` of further addresses.
class MemoryLimit {
public:
    explicit MemoryLimit(std::size_t megabytes) {
        malloc_trim(0);  // what was freed but kept would go beyond the limit
        getrlimit(RLIMIT_AS, &before_);
        std::size_t pages = 0;
        std::ifstream("/proc/self/statm") >> pages;
        rlimit limit = before_;
        limit.rlim_cur = static_cast<rlim_t>(pages * 4096 + (megabytes << 20));
        setrlimit(RLIMIT_AS, &limit);
    }
    ~MemoryLimit() { setrlimit(RLIMIT_AS, &before_); }
    MemoryLimit(const MemoryLimit&) = delete;
    MemoryLimit& operator=(const MemoryLimit&) = delete;

private:
    rlimit before_{};
};

class OutOfMemory : public testing::Test {
protected:
    void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
        GTEST_SKIP() << "sanitizers need all the addresses there are";
#endif
        mallopt(M_ARENA_MAX, 1);  // each further one reserves 64 MB that no limit set later takes back
    }
};

TEST_F(OutOfMemory, AnAcceleratorFailsAndTheOthersAreStillBuilt) {
    const auto scene = load_scene("builtin:knot,n=1000000");
    for (const int threads : {1, 2}) {
        AcceleratorCache cache(scene, threads);
        {
            const MemoryLimit limit(24);
            EXPECT_THROW((void)cache.wait(AcceleratorKind::bvh), SceneError);
            EXPECT_TRUE(cache.failed(AcceleratorKind::bvh));
            EXPECT_EQ(cache.request(AcceleratorKind::bvh), nullptr);
            EXPECT_NE(cache.wait(AcceleratorKind::none), nullptr);
        }
        EXPECT_NE(cache.wait(AcceleratorKind::grid), nullptr);
        EXPECT_FALSE(cache.failed(AcceleratorKind::grid));
        try {
            (void)cache.wait(AcceleratorKind::bvh);
            FAIL() << "it was built after all";
        } catch (const SceneError& e) {
            EXPECT_STREQ(e.what(), "builtin:knot,n=1000000: no accelerator bvh: not enough memory");
        }
    }
}

TEST_F(OutOfMemory, APictureThatIsTooLargeEndsAndTheNextOneIsRendered) {
    const auto scene = load_scene("builtin:balls,level=1");
    Picture p;
    const Image expected = render_picture(scene, p);
    for (const bool preview : {false, true}) {
        Renderer renderer(3, preview);
        Frame large = frame_of(scene, p);
        large.width = large.height = 4096;
        Image image;
        {
            const MemoryLimit limit(32);
            const std::uint64_t generation = renderer.restart(large);
            renderer.wait(1e9, nullptr);
            EXPECT_TRUE(renderer.progress().out_of_memory);
            EXPECT_FALSE(renderer.progress().finished);
            EXPECT_EQ(renderer.progress().generation, generation);
            EXPECT_FALSE(renderer.resolve(image));
            EXPECT_EQ(renderer.resolve_pass(image), 0);
        }
        renderer.restart(frame_of(scene, p));
        renderer.wait(1e9, nullptr);
        EXPECT_TRUE(renderer.progress().finished);
        EXPECT_FALSE(renderer.progress().out_of_memory);
        ASSERT_TRUE(renderer.resolve(image));
        EXPECT_EQ(differing_pixels(expected, image), 0u);
    }
}

TEST_F(OutOfMemory, ASceneIsRefused) {
    const MemoryLimit limit(16);
    EXPECT_THROW((void)load_scene("builtin:soup,n=5000000"), SceneError);
    EXPECT_EQ(load_scene("builtin:balls,level=1")->geometry->spheres.size(), 10u);
}

}  // namespace
}  // namespace glint
