// --isa: the choice of an instruction set, refused where the machine has not got it, and without a trace in the picture.
#include "accel/isa.h"

#include <nlohmann/json.hpp>

#include "app/options.h"
#include "tests/app/command_line.h"

namespace glint {
namespace {

std::string_view name_of(Isa isa) { return kIsaNames[static_cast<std::size_t>(isa)]; }

std::vector<Isa> supported_isas() {
    std::vector<Isa> list;
    for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
        if (supported(isa)) list.push_back(isa);
    }
    return list;
}

bool up_to_avx2(Isa isa) noexcept { return isa != Isa::avx512; }

TEST(IsaOption, NamesWhatTheMachineHasAndRefusesTheRest) {
    EXPECT_EQ(chosen_isa("--isa", "auto", up_to_avx2), std::nullopt);
    EXPECT_EQ(chosen_isa("--isa", "baseline", up_to_avx2), Isa::baseline);
    EXPECT_EQ(chosen_isa("--isa", "avx2", up_to_avx2), Isa::avx2);
    try {
        (void)chosen_isa("--isa", "avx512", up_to_avx2);
        FAIL() << "not refused";
    } catch (const UsageError& e) {
        EXPECT_STREQ(e.what(), "--isa: this machine does not support 'avx512', only baseline avx2");
    }
    EXPECT_THROW((void)chosen_isa("--isa", "avx", up_to_avx2), UsageError);
}

TEST(IsaOption, IsEmptyUnlessGiven) {
    EXPECT_EQ(parse_options({"render", "s.p3f", "-o", "x.png"})->isa, std::nullopt);
    EXPECT_EQ(parse_options({"render", "s.p3f", "-o", "x.png", "--isa", "baseline"})->isa, Isa::baseline);
    EXPECT_EQ(parse_options({"view", "s.p3f", "--isa", "baseline", "--isa", "auto"})->isa, std::nullopt);
    EXPECT_EQ(parse_options({"info", "s.p3f", "--isa", "baseline"})->isa, Isa::baseline);
}

TEST_F(CommandLine, IsaIsCheckedBeforeTheSceneIsLoaded) {
    expect_refused("render builtin:balls -o x.png --isa avx51", 2, "did you mean 'avx512'?");
    expect_refused("list --isa avx2", 2, "unknown option '--isa'");
    for (const Isa isa : {Isa::avx2, Isa::avx512}) {
        if (!supported(isa)) expect_refused(fmt::format("render no.p3f -o x.png --isa {}", name_of(isa)), 2, "does not support");
    }
}

TEST_F(CommandLine, OnePictureFromEveryInstructionSetAndTheStatsNameIt) {
    const std::string command =
        "render builtin:mount,level=4 --accel bvh --resolution 40x30 --spp 3 --features all --stats json -o " + path("a.png");
    std::string expected;
    for (const Isa isa : supported_isas()) {
        const Outcome r = glint(fmt::format("{} --isa {}", command, name_of(isa)));
        ASSERT_EQ(r.code, 0) << r.err;
        EXPECT_EQ(nlohmann::json::parse(r.out)["isa"], name_of(isa));
        if (expected.empty()) expected = contents(path("a.png"));
        EXPECT_EQ(contents(path("a.png")), expected) << name_of(isa);
    }
    EXPECT_EQ(nlohmann::json::parse(glint(command).out)["isa"], name_of(best_isa()));
    EXPECT_EQ(nlohmann::json::parse(glint(command + " --isa auto").out)["isa"], name_of(best_isa()));
}

TEST_F(CommandLine, ListAndInfoSayWhichInstructionSetIsUsed) {
    const std::string list = glint("list").out;
    for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
        const std::string_view state = isa == best_isa() ? "chosen"
                                       : supported(isa)  ? "supported"
                                                         : "not supported by this machine";
        EXPECT_NE(list.find(fmt::format("  {:<9} {}\n", name_of(isa), state)), std::string::npos) << list;
    }
    EXPECT_NE(glint("info builtin:balls,level=2").out.find(fmt::format("\nisa {} (the best", name_of(best_isa()))),
              std::string::npos);
    EXPECT_NE(glint("info builtin:balls,level=2 --isa baseline").out.find("\nisa baseline (as asked for)"), std::string::npos);
}

// The same tree, so the same bits, from however many threads build and render it.
TEST_F(CommandLine, OnePictureFromOneAndThreeThreadsOfALargeBuild) {
    std::string expected;
    for (const int threads : {1, 3}) {
        const Outcome r = glint(
            fmt::format("render builtin:knot,n=300000 --resolution 48x32 --spp 2 --threads {} -o {}", threads, path("a.pfm")));
        ASSERT_EQ(r.code, 0) << r.err;
        if (expected.empty()) expected = contents(path("a.pfm"));
        EXPECT_EQ(contents(path("a.pfm")), expected) << threads;
    }
}

}  // namespace
}  // namespace glint
