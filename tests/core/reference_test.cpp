// Pictures of the course's own renderer as oracles: what they prove, and to which measure.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "tests/core/render_picture.h"

namespace glint {
namespace {

const std::string kScenes = GLINT_SHARED "/scenes/p3f/";
const std::string kReferences = GLINT_SHARED "/reference/";

struct Comparison {
    std::size_t pixels = 0, equal = 0, within_one = 0, off_silhouette = 0;
    [[nodiscard]] double percent(std::size_t n) const { return 100.0 * static_cast<double>(n) / static_cast<double>(pixels); }
};

std::shared_ptr<const Scene> load(const std::string& name, bool environment) {
    LoadOptions options;
    options.load_environment = environment;
    return load_scene(kScenes + name, options);
}

// The primitive each pixel's centre ray hits first.
std::vector<PrimitiveId> visible_ids(const Scene& scene) {
    const auto bvh = build_accelerator(AcceleratorKind::bvh, scene.geometry);
    const Camera camera(scene.cameras.front(), scene.width, scene.height);
    std::vector<PrimitiveId> ids;
    for (int y = 0; y < scene.height; ++y) {
        for (int x = 0; x < scene.width; ++x) {
            const Ray ray = camera.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, {0, 0});
            ids.push_back(closest_hit(*bvh, ray).primitive);
        }
    }
    return ids;
}

bool at_silhouette(const std::vector<PrimitiveId>& ids, int width, int height, int x, int y) {
    const auto id = [&](int i, int j) { return ids[static_cast<std::size_t>(j * width + i)]; };
    for (int j = std::max(0, y - 1); j <= std::min(height - 1, y + 1); ++j) {
        for (int i = std::max(0, x - 1); i <= std::min(width - 1, x + 1); ++i) {
            if (id(i, j) != id(x, y)) return true;
        }
    }
    return false;
}

// Largest channel difference in display bytes.
int byte_distance(const Image8& a, const Image& reference, std::size_t pixel) {
    int worst = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto theirs = static_cast<int>(std::lround(reference.pixels[pixel][static_cast<int>(c)] * 255.0f));
        worst = std::max(worst, std::abs(static_cast<int>(a.rgb[3 * pixel + c]) - theirs));
    }
    return worst;
}

FeatureSet features(std::initializer_list<Feature> list) {
    FeatureSet set;
    for (const Feature f : list) set.set(f, true);
    return set;
}

Image8 display(const Image& image) { return to_display(image, {0.0f, Transfer::linear}); }

// As the course renders: one centred ray, three bounces.
Image8 whitted_picture(const std::shared_ptr<const Scene>& scene) {
    Picture p;
    p.width = scene->width;
    p.height = scene->height;
    p.settings.features = FeatureSet::whitted();
    p.settings.depth = 3;
    return display(render_picture(scene, p));
}

Comparison compare_balls_medium(FeatureSet set, const std::string& reference_name) {
    const auto scene = load("balls_medium.p3f", false);
    const Image reference = read_image(kReferences + reference_name);
    Picture p;
    p.width = scene->width;
    p.height = scene->height;
    p.settings.features = set;
    p.settings.background = Background::color;
    const Image8 ours = display(render_picture(scene, p));
    const auto ids = visible_ids(*scene);
    Comparison c;
    c.pixels = reference.pixels.size();
    for (std::size_t i = 0; i < c.pixels; ++i) {
        const int d = byte_distance(ours, reference, i);
        c.equal += d == 0;
        c.within_one += d <= 1;
        if (d > 1 && !at_silhouette(ids, p.width, p.height, static_cast<int>(i) % p.width, static_cast<int>(i) / p.width)) {
            ++c.off_silhouette;
        }
    }
    std::cout << reference_name << ": " << c.percent(c.equal) << " % byte-equal, " << c.percent(c.within_one) << " % within 1, "
              << c.pixels - c.within_one << " further off, " << c.off_silhouette << " of those not at a silhouette\n";
    return c;
}

class Reference : public testing::Test {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(kReferences)) GTEST_SKIP() << "no " << kReferences;
    }
};

void expect_course_measure(const Comparison& c) {
    EXPECT_GE(c.percent(c.equal), 99.3);
    EXPECT_GE(c.percent(c.within_one), 99.98);
    EXPECT_LE(c.pixels - c.within_one, 20u);
    EXPECT_EQ(c.off_silhouette, 0u);
}

TEST_F(Reference, BallsMediumDiffuseEqualsTheCoursesPicture) {
    expect_course_measure(compare_balls_medium(FeatureSet{}, "RT_Output0.png"));
}

TEST_F(Reference, BallsMediumWithHighlightsEqualsTheCoursesPicture) {
    expect_course_measure(compare_balls_medium(features({Feature::specular}), "RT_Output1.png"));
}

TEST_F(Reference, MountLowIsByteEqualWhereverTheBallsAreNotSeenDirectly) {
    const auto scene = load("mount_low.p3f", false);
    const Image reference = read_image(kReferences + "mount_low.png");
    const Image8 ours = whitted_picture(scene);
    const auto ids = visible_ids(*scene);
    std::size_t outside = 0, different = 0;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (ids[i] != kNoPrimitive && kind_of(ids[i]) == PrimitiveKind::sphere) continue;
        ++outside;
        different += byte_distance(ours, reference, i) != 0;
    }
    std::cout << "mount_low.png: " << outside - different << " of " << outside << " pixels outside the balls byte-equal\n";
    EXPECT_EQ(different, 0u);
}

// Their highlights, deep bounces and glass differ, so only the floor in the open and the sky box are compared.
TEST_F(Reference, DragonFloorAndSkyAgree) {
    const auto scene = load("dragon.p3f", true);
    ASSERT_EQ(scene->environment.kind, Environment::Kind::cube);
    const Image reference = read_image(kReferences + "dragon.png");
    const Image8 ours = whitted_picture(scene);
    const auto ids = visible_ids(*scene);
    std::size_t sky = 0, sky_equal = 0, sky_within_2 = 0, sky_within_8 = 0, floor = 0, floor_equal = 0, floor_within_1 = 0;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const int d = byte_distance(ours, reference, i);
        if (ids[i] == kNoPrimitive) {
            ++sky;
            sky_equal += d == 0;
            sky_within_2 += d <= 2;
            sky_within_8 += d <= 8;
        } else if (kind_of(ids[i]) == PrimitiveKind::triangle && index_of(ids[i]) < 2) {
            ++floor;
            floor_equal += d == 0;
            floor_within_1 += d <= 1;
        }
    }
    std::cout << "dragon.png: sky " << sky << " pixels, " << sky_equal << " equal, " << sky_within_2 << " within 2, "
              << sky_within_8 << " within 8; floor " << floor << " pixels, " << floor_equal << " equal, " << floor_within_1
              << " within 1\n";
    EXPECT_GE(static_cast<double>(sky_within_8), 0.999 * static_cast<double>(sky));
    EXPECT_GE(static_cast<double>(floor_equal), 0.995 * static_cast<double>(floor));
}

}  // namespace
}  // namespace glint
