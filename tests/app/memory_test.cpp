// Too little memory ends in one line and the promised exit code, wherever it runs out: never in a signal or a hang.
#include "tests/app/command_line.h"

namespace glint {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitable = false;  // a sanitizer's shadow memory alone exceeds every limit
#else
constexpr bool kLimitable = true;
#endif

class LittleMemory : public CommandLine {
protected:
    void SetUp() override {
        CommandLine::SetUp();
        if (!kLimitable) GTEST_SKIP() << "sanitizers need all the addresses there are";
    }
    // For the shell: as many megabytes of addresses, and no longer than a minute.
    static std::string megabytes(int n) { return fmt::format("ulimit -v {}; timeout 60", n * 1024); }
};

TEST_F(LittleMemory, ForTheSceneRefusesIt) {
    for (const int n : {32, 40})
        expect_refused("render builtin:knot,n=10000000 -o x.png", 3, "n=10000000: not enough memory for this scene",
                       megabytes(n));
    expect_refused("info builtin:soup,n=10000000", 3, "not enough memory for this scene", megabytes(100));
    // A file of 24 MB.
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 3000000\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 0\nproperty list uchar int vertex_indices\nend_header\n";
    for (int i = 0; i < 3000000; ++i) text += "0 0 " + std::to_string(i % 1000) + "\n";
    expect_refused("render " + write("large.ply", text) + " -o x.png", 3, "large.ply: not enough memory for this scene",
                   megabytes(30));
}

TEST_F(LittleMemory, ForTheAcceleratorRefusesTheSceneOnAnyNumberOfThreads) {
    for (const int threads : {1, 2}) {
        for (const int n : {60, 90, 120}) {
            expect_refused(fmt::format("render builtin:knot,n=500000 --resolution 8x8 --spp 1 -o x.png --threads {}", threads), 3,
                           "n=500000: no accelerator bvh: not enough memory", megabytes(n));
        }
    }
    expect_refused("render builtin:knot,n=500000 --resolution 8x8 --spp 1 -o x.png --accel grid", 3,
                   "n=500000: no accelerator grid: not enough memory", megabytes(70));
}

TEST_F(LittleMemory, ForThePictureIsARenderFault) {
    for (const int threads : {1, 2, 8}) {
        expect_refused(fmt::format("render builtin:balls,level=1 --resolution 8192x8192 --spp 1 --quiet -o {} --threads {}",
                                   path("x.png"), threads),
                       4, "out of memory", megabytes(200));
        EXPECT_FALSE(fs::exists(folder / "x.png"));
    }
}

TEST_F(LittleMemory, EveryLimitEndsInAPictureOrInOneLine) {
    for (int n = 12; n <= 132; n += 12) {
        const Outcome r = glint(
            fmt::format("render builtin:knot,n=100000 --resolution 512x512 --spp 1 --threads 2 --quiet -o {}", path("x.png")),
            megabytes(n));
        EXPECT_TRUE(r.code == 0 || r.code == 3 || r.code == 4 || r.code == 5 || r.code == 127) << n << " MB: " << r.code << "\n"
                                                                                               << r.err;
        EXPECT_LE(std::count(r.err.begin(), r.err.end(), '\n'), 1) << n << " MB: " << r.err;
    }
}

}  // namespace
}  // namespace glint
