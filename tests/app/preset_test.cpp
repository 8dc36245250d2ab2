// Presets: a few words for settings, which what is given beside them overrules in either order.
#include <gtest/gtest.h>

#include "app/options.h"

namespace glint {
namespace {

Options parsed(std::vector<std::string> words) {
    words.insert(words.begin(), {"render", "s.p3f", "-o", "x.png"});
    return *parse_options(words);
}

TEST(Preset, SetsSamplesDepthAndCutoff) {
    EXPECT_EQ(parsed({"--preset", "draft"}).spp, 4);
    EXPECT_EQ(parsed({"--preset", "draft"}).settings.cutoff, 0.1f);
    EXPECT_EQ(parsed({"--preset", "good"}).spp, 64);
    EXPECT_EQ(parsed({"--preset", "good"}).settings.cutoff, 0.01f);
    EXPECT_EQ(parsed({"--preset", "good"}).settings.sampler, SamplerKind::joint);
    EXPECT_EQ(parsed({"--preset", "good", "--sampler", "random"}).settings.sampler, SamplerKind::random);
    EXPECT_TRUE(parsed({"--preset", "good"}).settings.adaptive);
    EXPECT_FALSE(parsed({"--preset", "good", "--no-adaptive"}).settings.adaptive);
    const Options reference = parsed({"--preset", "reference"});
    EXPECT_EQ(reference.spp, 1024);
    EXPECT_EQ(reference.settings.depth, 16);
    EXPECT_EQ(reference.settings.cutoff, 0.0f);  // settings that could be biased are never part of a reference
    EXPECT_FALSE(reference.settings.adaptive);
    EXPECT_EQ(parsed({}).settings, RenderSettings());
}

TEST(Preset, GivesWayToWhatIsGivenBesideIt) {
    for (const auto& words : {std::vector<std::string>{"--preset", "good", "--spp", "7", "--depth", "2", "--cutoff", "0"},
                              std::vector<std::string>{"--spp", "7", "--depth", "2", "--cutoff", "0", "--preset", "good"}}) {
        const Options o = parsed(words);
        EXPECT_EQ(o.spp, 7);
        EXPECT_EQ(o.settings.depth, 2);
        EXPECT_EQ(o.settings.cutoff, 0.0f);
    }
}

TEST(Preset, AnUnknownOneIsRefused) { EXPECT_THROW((void)parsed({"--preset", "goood"}), UsageError); }

}  // namespace
}  // namespace glint
