// `glint chart` as a whole, small; and what its drawings and page do with names that mean harm.
#include <map>
#include <sstream>

#include <nlohmann/json.hpp>

#include "app/chart_files.h"
#include "app/chart_page.h"
#include "app/chart_statistics.h"
#include "tests/app/command_line.h"

namespace glint::chart {
namespace {

const std::string kHostile = "a'b\"c<script>&`rm -rf`$(x);\\n{/=30 x}_^@\n.p3f";

Figure small_figure() {
    Figure f;
    f.id = "small";
    f.title = f.caption = kHostile;
    f.x = {kHostile, true};
    f.y = {"relMSE", true};
    f.extra = {"spp"};
    f.series.push_back({kHostile,
                        "note",
                        "glint render x",
                        0,
                        Series::Look::curve,
                        {{1.0, 0.5, 0.4, 0.6, {1.0}}, {2.0, -0.1, -0.2, 0.1, {2.0}}, {4.0, 0.01, 0.009, 0.02, {4.0}}}});
    f.series.push_back({"front", "", "", 1, Series::Look::front, {{1.0, 0.5}, {4.0, 0.01}}});
    f.series.push_back({"dots", "", "", 2, Series::Look::dots, {{2.0, 0.1}}});
    f.series.push_back({"nothing to show", "", "", 3, Series::Look::curve, {}});
    return f;
}

bool has_gnuplot() { return std::system("gnuplot --version >/dev/null 2>&1") == 0; }

TEST(ChartFigure, NamesCannotLeaveTheirQuotesInGnuplot) {
    std::istringstream script(plot_script(small_figure()));
    for (std::string line; std::getline(script, line);) {
        EXPECT_EQ(std::count(line.begin(), line.end(), '\'') % 2, 0) << line;
        // Outside of single quotes there is neither a back quote nor a semicolon: nothing runs.
        bool inside = false;
        for (const char c : line) {
            inside ^= c == '\'';
            EXPECT_TRUE(inside || (c != '`' && c != ';' && c != '!')) << line;
        }
    }
}

TEST(ChartFigure, GnuplotDrawsWhatItIsTold) {
    if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
    const fs::path folder = fs::temp_directory_path() / fmt::format("glint-plot 'x-{}", getpid());
    fs::create_directories(folder);
    Plotter plotter(folder);
    const auto svg = plotter.draw(small_figure());
    ASSERT_TRUE(svg);
    EXPECT_TRUE(svg->starts_with("<svg"));
    EXPECT_EQ(svg->find("http"), std::string::npos);
    EXPECT_EQ(svg->find("<script"), std::string::npos);
    EXPECT_NE(svg->find("var(--soft)"), std::string::npos) << "ink takes the page's colour";
    EXPECT_TRUE(fs::exists(folder / "small.png"));
    EXPECT_FALSE(fs::exists(folder / "small.gp"));
    WinnerMap map{"map",
                  "m",
                  "c",
                  {"primitives", true},
                  {"rays", true},
                  {1.0, 4.0},
                  {1.0, 10.0},
                  {"none", "bvh"},
                  {0, 1, 0, 1},
                  {2.0, 2.0, 2.0, 2.0},
                  ""};
    EXPECT_TRUE(plotter.draw(map));
    EXPECT_TRUE(plotter.works());
    fs::remove_all(folder);
}

TEST(ChartPage, TextIsEscapedAndNothingIsFetched) {
    Chart c;
    c.title = c.command = c.machine = kHostile;
    c.notes = {kHostile};
    c.sections.push_back({"s", kHostile, kHostile, {small_figure()}, {}, {{"t", kHostile, kHostile, {kHostile}, {{kHostile}}}}});
    const fs::path folder = fs::temp_directory_path() / fmt::format("glint-page-{}", getpid());
    fs::create_directories(folder);
    Plotter plotter(folder);
    const std::string page = page_of(c, plotter);
    EXPECT_EQ(page.find("<script"), std::string::npos);
    EXPECT_NE(page.find("&lt;script&gt;"), std::string::npos);
    for (const char* fetch : {"http://", "https://", "src=", "@import", "url("})
        EXPECT_EQ(page.find(fetch), std::string::npos) << fetch;
    write_data(c, folder);
    EXPECT_TRUE(fs::exists(folder / "small.csv"));
    fs::remove_all(folder);
}

TEST(ChartFiles, NumbersThatAreNoneStayEmpty) {
    const std::string csv = csv_of(small_figure());
    EXPECT_NE(csv.find("\"a'b\"\"c<script>"), std::string::npos) << csv;
    EXPECT_NE(csv.find("front,1,0.5,,,\n"), std::string::npos) << csv;
}

class ChartCommand : public CommandLine {
protected:
    // The columns of a CSV of curves, by series.
    [[nodiscard]] std::map<std::string, std::vector<XY>> curves(const std::string& name) const {
        std::map<std::string, std::vector<XY>> read;
        std::istringstream csv(contents(path(name)));
        std::string line;
        std::getline(csv, line);
        while (std::getline(csv, line)) {
            std::istringstream cells(line);
            std::string series, x, y;
            std::getline(cells, series, ',');
            std::getline(cells, x, ',');
            std::getline(cells, y, ',');
            read[series].push_back({std::stod(x), std::stod(y)});
        }
        return read;
    }
    const std::string tiny = "chart builtin:balls,level=1 --quick --resolution 20x15 --spp 64 ";
};

TEST_F(ChartCommand, C_02_ATinyChartShowsTheSamplersInTheOrderOfTheory) {
    // Drawing takes longest and is tested above.
    const Outcome first = glint(tiny + "-o " + path("c"), "PATH=/nowhere");
    ASSERT_EQ(first.code, 0) << first.err;
    EXPECT_NE(first.err.find("gnuplot is missing"), std::string::npos) << first.err;
    auto samplers = curves("c/samplers-balls_level_1-spp.csv");
    ASSERT_EQ(samplers.size(), 5u);
    const auto slope = [&](const char* name) { return log_log_slope(samplers.at(name)).value().slope; };
    // Slopes of relMSE, the square: 1 for random, about 1.5 for what is stratified, in pixels with one edge.
    EXPECT_NEAR(slope("random"), -1.0, 0.1);
    EXPECT_LE(slope("sobol"), slope("jittered"));
    EXPECT_LE(slope("jittered"), slope("random"));
    EXPECT_LT(slope("sobol"), -1.3);
    EXPECT_LT(samplers.at("sobol").back().y, 0.5 * samplers.at("random").back().y);
    // The same error from every accelerator.
    auto accelerators = curves("c/accelerators-balls_level_1-seconds.csv");
    ASSERT_EQ(accelerators.size(), 3u);
    for (std::size_t i = 0; i < accelerators.at("bvh").size(); ++i) {
        EXPECT_EQ(accelerators.at("none")[i].y, accelerators.at("bvh")[i].y);
        EXPECT_EQ(accelerators.at("grid")[i].y, accelerators.at("bvh")[i].y);
    }
    const std::string page = contents(path("c/index.html"));
    EXPECT_NE(page.find("glint render builtin:balls,level=1 -o out.pfm --resolution 20x15 --spp 64"), std::string::npos);
    EXPECT_EQ(page.find("http://"), std::string::npos);
    EXPECT_EQ(page.find("https://"), std::string::npos);
    const auto json = nlohmann::json::parse(contents(path("c/chart.json")));
    EXPECT_EQ(json["sections"][0]["id"], "samplers");

    // A second run takes the references as they are, unless they were touched.
    const std::string reference = path("c/references/balls_level_1-jittered-20x15.ref");
    const std::string good = contents(reference);
    std::ofstream(reference, std::ios::binary) << good.substr(0, good.size() / 2);
    const Outcome again = glint(tiny + "-o " + path("c"), "PATH=/nowhere");
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_NE(again.err.find("is damaged: rendered anew"), std::string::npos) << again.err;
    EXPECT_EQ(again.err.find("sobol reference"), std::string::npos) << "kept: " << again.err;
    EXPECT_EQ(contents(reference), good) << "the same reference, byte for byte";
}

TEST_F(ChartCommand, BadUseIsRefusedBeforeAnythingIsMeasured) {
    expect_refused("chart", 2, "-o DIR");
    expect_refused("chart -o " + path("c") + " --spp 3", 2, "--spp");
    expect_refused("chart -o " + path("c") + " --resolution 4000x4000", 2, "2^20 pixels");
    expect_refused("chart -o " + path("c") + " --noise 1", 2, "unknown option '--noise'");
    expect_refused("chart builtin:bals -o " + path("c"), 3, "bals");
    EXPECT_FALSE(fs::exists(folder / "c"));
    expect_refused("chart --quick -o /dev/null/c", 5, "cannot write");
    expect_refused("chart --quick -o " + write("file", ""), 5, "cannot write");
}

TEST_F(ChartCommand, InterruptedItWritesWhatItHas) {
    const Outcome r =
        glint("chart builtin:cornell --resolution 512x512 --quiet -o " + path("c"),
              "PATH=$PATH timeout --foreground --preserve-status -s INT 1");  // one signal: a second ends it at once
    EXPECT_EQ(r.code, 130) << r.err;
    EXPECT_NE(contents(path("c/index.html")).find("The run was stopped"), std::string::npos);
    EXPECT_TRUE(nlohmann::json::accept(contents(path("c/chart.json"))));
}

}  // namespace
}  // namespace glint::chart
