// `glint compare` and `glint render --reference`: what is printed, what passes, what the error image shows; and the file formats.
#include <sstream>

#include <nlohmann/json.hpp>

#include "core/flip.h"
#include "core/image.h"
#include "tests/app/command_line.h"

namespace glint {
namespace {

class Compare : public CommandLine {
protected:
    // Two pixels: a - b is (1/2, 0, 1/4) and 0.
    void SetUp() override {
        CommandLine::SetUp();
        a = {2, 1, {glm::vec3(1.0f, 0.5f, 0.25f), glm::vec3(0.5f)}};
        b = {2, 1, {glm::vec3(0.5f, 0.5f, 0.0f), glm::vec3(0.5f)}};
        write_file_atomically(path("a.pfm"), encode_pfm(a));
        write_file_atomically(path("b.pfm"), encode_pfm(b));
    }
    [[nodiscard]] Outcome compare(const std::string& options) const {
        return glint("compare " + path("a.pfm") + " " + path("b.pfm") + " " + options);
    }
    Image a, b;
};

TEST_F(Compare, PrintsEveryMetricByName) {
    const Outcome r = compare("");
    EXPECT_EQ(r.code, 1);
    std::istringstream lines(r.out);
    std::string line, names;
    while (std::getline(lines, line)) names += line.substr(0, line.find(' ')) + " ";
    EXPECT_EQ(names, "rmse relmse mae psnr bias bias_z p99 max flip non_finite_pixels differing_pixels ");
    EXPECT_NE(r.out.find(fmt::format("rmse {:.6g}\n", std::sqrt(0.3125 / 6.0))), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("mae 0.125\n"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("max 0.5\n"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find(fmt::format("flip {:.6g}\n", flip_of_radiance(a, b).mean)), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("differing_pixels 1 of 2\n"), std::string::npos) << r.out;
    EXPECT_EQ(r.err, "");
}

TEST_F(Compare, TheMetricDecidesWhatTheThresholdIsFor) {
    // rmse 0.228, relmse (.25/.26 + .0625/.01)/6 = 1.20, mae 0.125, psnr 12.8.
    EXPECT_EQ(compare("--reference-threshold 0.229").code, 0);
    EXPECT_EQ(compare("--reference-threshold 0.228").code, 1);
    EXPECT_EQ(compare("--metric relmse --reference-threshold 1.21").code, 0);
    EXPECT_EQ(compare("--metric relmse --reference-threshold 1.19").code, 1);
    EXPECT_EQ(compare("--metric mae --reference-threshold 0.126").code, 0);
    EXPECT_EQ(compare("--metric mae --reference-threshold 0.124").code, 1);
    EXPECT_EQ(compare("--metric psnr --reference-threshold 12.8").code, 0);
    EXPECT_EQ(compare("--metric psnr --reference-threshold 12.9").code, 1);
    const double flip = flip_of_radiance(a, b).mean;
    EXPECT_EQ(compare(fmt::format("--metric flip --reference-threshold {}", flip + 1e-3)).code, 0);
    EXPECT_EQ(compare(fmt::format("--metric flip --reference-threshold {}", flip - 1e-3)).code, 1);
    // Without a threshold only equal pictures pass, by every metric.
    for (const char* metric : {"rmse", "relmse", "mae", "psnr", "flip"}) {
        EXPECT_EQ(compare(fmt::format("--metric {}", metric)).code, 1) << metric;
        EXPECT_EQ(glint(fmt::format("compare {0} {0} --metric {1}", path("a.pfm"), metric)).code, 0) << metric;
    }
}

TEST_F(Compare, APictureWithANanNeverPasses) {
    Image bad = a;
    bad.pixels[1].y = std::nanf("");
    write_file_atomically(path("bad.pfm"), encode_pfm(bad));
    const Outcome r = glint("compare " + path("bad.pfm") + " " + path("a.pfm") + " --reference-threshold 1000");
    EXPECT_EQ(r.code, 1);
    EXPECT_NE(r.out.find("rmse 0\n"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("non_finite_pixels 1\ndiffering_pixels 1 of 2\n"), std::string::npos) << r.out;
}

TEST_F(Compare, StatsAreOneObject) {
    const Outcome r = compare("--stats json --metric mae --reference-threshold 1");
    EXPECT_EQ(r.code, 0);
    const auto json = nlohmann::json::parse(r.out);
    EXPECT_EQ(json["metric"], "mae");
    EXPECT_EQ(json["threshold"], 1.0);
    EXPECT_EQ(json["within"], true);
    EXPECT_EQ(json["mae"], 0.125);
    EXPECT_EQ(json["differing_pixels"], 1);
    EXPECT_NEAR(json["flip"], flip_of_radiance(a, b).mean, 1e-12);
    // What is infinite is null.
    EXPECT_TRUE(nlohmann::json::parse(glint(fmt::format("compare {0} {0} --stats json", path("a.pfm"))).out)["psnr"].is_null());
}

TEST_F(Compare, TheErrorImageHoldsTheDifferenceOrTheFlipMap) {
    for (const char* ending : {"pfm", "exr"}) {
        EXPECT_EQ(compare("-o " + path("e.") + ending).code, 1);
        EXPECT_EQ(read_image(path("e.") + ending).pixels,
                  (std::vector<glm::vec3>{glm::vec3(0.5f, 0.0f, 0.25f), glm::vec3(0.0f)}));
    }
    EXPECT_EQ(compare("--metric flip -o " + path("f.exr")).code, 1);
    EXPECT_EQ(read_image(path("f.exr")).pixels[0], glm::vec3(flip_of_radiance(a, b).map[0]));
    // In a PNG black is nothing, red 0.01, magenta a NaN.
    const Image zero{3, 1, std::vector<glm::vec3>(3, glm::vec3(0.0f))};
    Image off = zero;
    off.pixels[1] = {0.0f, 0.01f, 0.001f};
    off.pixels[2] = glm::vec3(0.0f, std::nanf(""), 1.0f);
    write_file_atomically(path("zero.pfm"), encode_pfm(zero));
    write_file_atomically(path("off.pfm"), encode_pfm(off));
    EXPECT_EQ(glint(fmt::format("compare {} {} -o {}", path("off.pfm"), path("zero.pfm"), path("e.png"))).code, 1);
    const Image png = read_image(path("e.png"));
    EXPECT_EQ(png.pixels[0], glm::vec3(0.0f));
    EXPECT_NEAR(glm::distance(png.pixels[1] * 255.0f, glm::vec3(190.0f, 50.0f, 85.0f)), 0.0f, 1.5f);
    EXPECT_EQ(png.pixels[2], glm::vec3(1.0f, 0.0f, 1.0f));
}

TEST_F(Compare, BadUsageAndBadFilesAreOneLine) {
    const std::string both = "compare " + path("a.pfm") + " " + path("b.pfm") + " ";
    expect_refused(both + "--metric rms", 2, "did you mean 'rmse'?");
    expect_refused(both + "--reference-threshold nan", 2, "--reference-threshold");
    expect_refused(both + "-o -", 2, "stdout");
    expect_refused(both + "-o x.gif", 2, ".png, .pfm, .hdr or .exr");
    expect_refused(both + "-o " + path("no/such/x.png"), 5, "cannot write");
    write_file_atomically(path("c.pfm"), encode_pfm({1, 1, {glm::vec3(0.0f)}}));
    expect_refused("compare " + path("a.pfm") + " " + path("c.pfm"), 5, "2x1 and 1x1");
    write_file_atomically(path("c.png"), encode_png(to_display(a, {}), Transfer::srgb));
    expect_refused("compare " + path("a.pfm") + " " + path("c.png") + " --metric flip", 2, "two of a kind");
    EXPECT_EQ(glint("compare " + path("a.pfm") + " " + path("c.png")).out.find("flip"), std::string::npos);
    expect_refused(quick + "-o " + path("x.png") + " --reference-threshold 1", 2, "--reference FILE");
    expect_refused(quick + "-o " + path("x.png") + " --reference " + path("missing.exr"), 5, "missing.exr");
    expect_refused(quick + "-o " + path("x.png") + " --reference " + path("a.pfm"), 5, "2x1, the picture 32x24");
    EXPECT_FALSE(fs::exists(path("x.png")));
}

TEST_F(Compare, RenderComparesWithAReferenceOfItsOwnKind) {
    for (const char* ending : {"png", "pfm", "exr", "hdr"}) {
        const std::string reference = path("reference.") + ending;
        ASSERT_EQ(glint(quick + "--seed 1 -o " + reference).code, 0);
        // Another output format than the reference's: the picture is compared as the reference is stored. RGBE rounds.
        const std::string again = quick + "--stats json -o " + path("again.png") + " --reference " + reference;
        const bool rounds = std::string(ending) == "hdr";
        const Outcome same = glint(again + " --seed 1 --reference-threshold " + (rounds ? "0.01" : "0"));
        EXPECT_EQ(same.code, 0) << ending << same.err;
        const auto json = nlohmann::json::parse(same.out)["reference"];
        EXPECT_EQ(json["file"], reference);
        EXPECT_EQ(json["within"], true);
        EXPECT_EQ(json["differing_pixels"] == 0, !rounds) << ending;
        const Outcome other = glint(again + " --seed 2 --metric flip --reference-threshold 0.00001");
        EXPECT_EQ(other.code, 1) << ending;
        EXPECT_NE(other.err.find("not within the threshold"), std::string::npos) << other.err;
        EXPECT_GT(nlohmann::json::parse(other.out)["reference"]["flip"], 0.00001);
        EXPECT_TRUE(fs::exists(path("again.png")));
    }
}

TEST_F(Compare, ExposureAndTransferNeverTouchExrAndHdr) {
    for (const char* ending : {"exr", "hdr"}) {
        ASSERT_EQ(glint(quick + "-o " + path("x.") + ending).code, 0);
        ASSERT_EQ(glint(quick + "--exposure 2 --transfer srgb -o " + path("y.") + ending).code, 0);
        EXPECT_EQ(contents(path("x.") + ending), contents(path("y.") + ending));
    }
    ASSERT_EQ(glint(quick + "-o " + path("x.pfm")).code, 0);
    EXPECT_EQ(glint("compare " + path("x.exr") + " " + path("x.pfm")).code, 0);
    EXPECT_EQ(glint("compare " + path("x.hdr") + " " + path("x.pfm") + " --reference-threshold 0.003").code, 0);
}

}  // namespace
}  // namespace glint
