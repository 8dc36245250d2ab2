// References of charts: their own error, and that nothing but the right file is ever taken for one.
#include "app/chart_reference.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

#include <fmt/format.h>

#include "app/chart_subjects.h"

namespace glint::chart {
namespace {

namespace fs = std::filesystem;

class ChartReference : public testing::Test {
protected:
    void SetUp() override {
        folder = fs::temp_directory_path() / fmt::format("glint-reference-{}", getpid());
        fs::create_directories(folder);
        reference = average(
            4, 3, [](int i) { return flat(0.5f + 0.1f * static_cast<float>(i)); }, [](const Reference&) { return false; });
        write_reference(path(), "a key\nof two lines", reference);
    }
    void TearDown() override { fs::remove_all(folder); }

    static Image flat(float value) { return {3, 2, std::vector<glm::vec3>(6, glm::vec3(value))}; }
    [[nodiscard]] fs::path path() const { return folder / "x.ref"; }
    [[nodiscard]] std::string bytes() const {
        std::ifstream in(path(), std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    void expect_refused(const std::string& content, const std::string& reason) const {
        std::ofstream(path(), std::ios::binary) << content;
        std::string why;
        EXPECT_FALSE(read_reference(path(), "a key\nof two lines", why));
        EXPECT_NE(why.find(reason), std::string::npos) << why;
    }

    fs::path folder;
    Reference reference;
};

TEST_F(ChartReference, IsTheMeanOfItsReplicatesAndKnowsItsError) {
    EXPECT_EQ(reference.replicates, 3);
    EXPECT_EQ(reference.samples(), 12.0);
    // 0.5, 0.6, 0.7: mean 0.6, variance 0.01, of the mean 0.01 / 3.
    EXPECT_NEAR(reference.mean.front().x, 0.6, 1e-7);
    EXPECT_NEAR(reference.variance.front().y, 0.01 / 3.0, 1e-8);
    EXPECT_NEAR(reference.relative_variance(), 0.01 / 3.0 / (0.36 + 0.01), 1e-7);
    // (0.8 - 0.6)^2 less the reference's own error.
    EXPECT_NEAR(relative_error(flat(0.8f), reference), (0.04 - 0.01 / 3.0) / 0.37, 1e-6);
}

TEST_F(ChartReference, WithoutNoiseErrorsAreThoseOfCompare) {
    const Image truth{2, 1, {{0.1f, 0.4f, 2.0f}, {0.0f, 0.02f, 0.7f}}}, image{2, 1, {{0.15f, 0.3f, 2.5f}, {0.01f, 0.0f, 0.9f}}};
    const Reference exact = average(
        1, 2, [&](int) { return truth; }, [](const Reference&) { return false; });
    EXPECT_NEAR(relative_error(image, exact), error_metrics(image, truth).relmse, 1e-12);
}

TEST_F(ChartReference, C_01_ErrorsAreFreeOfTheReferencesOwnNoise) {
    std::mt19937 random(1);
    const auto noisy = [&](double sigma) {
        std::normal_distribution<float> draw(1.0f, static_cast<float>(sigma));
        Image image{60, 50, std::vector<glm::vec3>(3000)};
        for (glm::vec3& p : image.pixels) p = {draw(random), draw(random), draw(random)};
        return image;
    };
    // A reference as noisy as the picture: without the correction the error would come out twice too large.
    const Reference r = average(
        1, 8, [&](int) { return noisy(0.28); }, [](const Reference&) { return false; });
    EXPECT_NEAR(relative_error(noisy(0.1), r), 0.01 / 1.01, 0.0015);
    EXPECT_NEAR(relative_error_of_pair(noisy(0.1), noisy(0.1)), 0.01 / 1.01, 0.0006);
}

TEST_F(ChartReference, ReadsBackWhatWasWritten) {
    std::string why = "?";
    const auto read = read_reference(path(), "a key\nof two lines", why);
    ASSERT_TRUE(read) << why;
    EXPECT_EQ(why, "");
    EXPECT_EQ(read->width, 3);
    EXPECT_EQ(read->height, 2);
    EXPECT_EQ(read->spp, 4);
    EXPECT_EQ(read->replicates, 3);
    EXPECT_EQ(read->mean, reference.mean);
    EXPECT_EQ(read->variance, reference.variance);
}

TEST_F(ChartReference, AMissingFileIsNoFault) {
    std::string why = "?";
    EXPECT_FALSE(read_reference(folder / "none.ref", "", why));
    EXPECT_EQ(why, "");
}

TEST_F(ChartReference, AnotherKeyIsStale) {
    std::string why;
    EXPECT_FALSE(read_reference(path(), "a key\nof two linez", why));
    EXPECT_NE(why.find("another scene, setting or version"), std::string::npos) << why;
    EXPECT_FALSE(read_reference(path(), "a key\nof two lines\nand more", why));
    EXPECT_FALSE(read_reference(path(), "", why));
}

TEST_F(ChartReference, DamageIsSeenWhereverItIs) {
    const std::string good = bytes();
    for (std::size_t i = 0; i < good.size(); ++i) {
        std::string bad = good;
        bad[i] = static_cast<char>(bad[i] ^ 1);
        std::ofstream(path(), std::ios::binary) << bad;
        std::string why;
        ASSERT_FALSE(read_reference(path(), "a key\nof two lines", why)) << "byte " << i;
        ASSERT_NE(why, "");
    }
    for (const std::size_t length : {std::size_t{0}, std::size_t{5}, std::size_t{25}, good.size() / 2, good.size() - 1}) {
        std::ofstream(path(), std::ios::binary) << good.substr(0, length);
        std::string why;
        EXPECT_FALSE(read_reference(path(), "a key\nof two lines", why)) << length;
        EXPECT_NE(why, "") << length;
    }
    expect_refused("PNG", "version");
}

TEST_F(ChartReference, SizesThatTheLengthBeliesAreNotBelieved) {
    // A file whose digest is right but whose header claims more than it holds must not be allocated.
    const std::string good = bytes();
    for (const char* claim : {"65535 65535", "3 3", "-3 2", "3 0", "99999999999 2"}) {
        std::string bad = good.substr(0, good.size() - 8);
        const std::size_t at = bad.find("\n3 2 3 4 ");
        ASSERT_NE(at, std::string::npos);
        bad.replace(at + 1, 3, claim);
        const std::uint64_t hash = digest(bad);
        bad.append(reinterpret_cast<const char*>(&hash), sizeof hash);
        expect_refused(bad, "");
    }
}

TEST_F(ChartReference, TheKeyTellsScenesSettingsSizesAndSamplesApart) {
    const std::atomic<bool> stop{false};
    const auto key = [&](const char* spec, auto change, int spp = 64) {
        Options o;
        o.arguments = {spec};
        o.width = 16;
        o.height = 12;
        Subject s = subjects_of(o).front();
        change(s);
        Bench bench(s, 1, stop);
        return reference_key(bench, s.settings, spp);
    };
    const auto as_it_is = [](Subject&) {};
    const std::string plain = key("builtin:balls,level=1", as_it_is);
    EXPECT_EQ(plain, key("builtin:balls,level=1", as_it_is));
    EXPECT_NE(plain, key("builtin:balls,level=2", as_it_is));
    EXPECT_NE(plain, key("builtin:balls,level=1", as_it_is, 128));
    EXPECT_NE(plain, key("builtin:balls,level=1", [](Subject& s) { s.width = 17; }));
    EXPECT_NE(plain, key("builtin:balls,level=1", [](Subject& s) { s.settings.depth = 4; }));
    EXPECT_NE(plain, key("builtin:balls,level=1", [](Subject& s) { s.settings.sampler = SamplerKind::random; }));
    EXPECT_NE(plain, key("builtin:balls,level=1", [](Subject& s) { s.settings.features.set(Feature::soft, true); }));
    // A file of the same name with other content: only the bytes of the samples can tell.
    EXPECT_NE(plain, key("builtin:balls,level=1", [](Subject& s) {
                  auto other = std::make_shared<Scene>(*s.scene);
                  other->materials.front().diffuse.x += 0.01f;
                  s.scene = other;
              }));
    EXPECT_NE(plain, key("builtin:balls,level=1", [](Subject& s) {
                  auto other = std::make_shared<Scene>(*s.scene);
                  other->cameras.front().eye.x += 0.01f;
                  s.scene = other;
              }));
}

}  // namespace
}  // namespace glint::chart
