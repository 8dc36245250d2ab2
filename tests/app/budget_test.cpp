// What ends a render, and what is told of its error: --noise, --convergence, --stats.
#include <sstream>

#include <nlohmann/json.hpp>

#include "app/error_bar.h"
#include "tests/app/command_line.h"

namespace glint {
namespace {

class BudgetCommand : public CommandLine {
protected:
    const std::string small = "render builtin:cornell --resolution 40x30 --stats json --quiet ";
    [[nodiscard]] nlohmann::json stats(const std::string& arguments) const {
        const Outcome r = glint(small + arguments + " -o " + path("x.pfm"));
        EXPECT_EQ(r.code, 0) << r.err;
        return nlohmann::json::parse(r.out);
    }
};

TEST_F(BudgetCommand, NoiseStopsAtADoublingBelowTheTarget) {
    const nlohmann::json loose = stats("--noise 0.2"), fine = stats("--noise 0.01 --spp 100000");
    EXPECT_EQ(loose["stopped_by"], "noise");
    EXPECT_EQ(fine["stopped_by"], "noise");
    EXPECT_LE(fine["error"]["high"], 0.01);
    EXPECT_LT(fine["error"]["relrmse"], loose["error"]["relrmse"]);
    const int spp = fine["spp"];
    EXPECT_GT(spp, static_cast<int>(loose["spp"]));
    EXPECT_EQ(spp & (spp - 1), 0);
    EXPECT_EQ(fine["error"]["predicted"]["spp"], spp) << "a target that is reached is predicted where it was";
}

TEST_F(BudgetCommand, TheFirstBudgetReachedIsNamed) {
    EXPECT_EQ(stats("--noise 1e-6 --spp 48")["stopped_by"], "spp");
    EXPECT_EQ(stats("--noise 1e-6 --spp 48")["spp"], 48);
    EXPECT_EQ(stats("--noise 1e-6 --time 0.05")["stopped_by"], "time");
    EXPECT_EQ(stats("--spp 2")["stopped_by"], "spp");
    EXPECT_EQ(stats("--features whitted --noise 0.1")["error"]["relrmse"], 0.0);
    EXPECT_TRUE(stats("--spp 1")["error"]["relrmse"].is_null());
    EXPECT_TRUE(stats("--sampler regular --spp 64")["error"]["relrmse"].is_null());
    for (const char* bad : {"0", "-1", "nan", "x"})
        expect_refused("render builtin:cornell -o x.png --noise " + std::string(bad), 2, "--noise");
    expect_refused("render builtin:cornell -o x.png --noise 0.1 --sampler regular", 2, "--noise: the sampler 'regular'");
}

TEST_F(BudgetCommand, NoiseGivesTheSameBytesForEveryThreadCount) {
    std::string first;
    for (const int threads : {1, 2, 5}) {
        (void)stats(fmt::format("--noise 0.1 --threads {}", threads));
        const std::string bytes = contents(path("x.pfm"));
        if (first.empty()) first = bytes;
        EXPECT_EQ(bytes, first) << threads;
    }
}

TEST_F(BudgetCommand, ConvergenceIsARowPerDoubling) {
    const std::string reference = path("reference.pfm");
    ASSERT_EQ(glint("render builtin:cornell --resolution 40x30 --spp 1024 --seed 9 --quiet -o " + reference).code, 0);
    const Outcome r = glint(small + fmt::format("--spp 40 --convergence {} --reference {} --reference-threshold 100 -o {}",
                                                path("c.csv"), reference, path("x.pfm")));
    EXPECT_EQ(r.code, 0) << r.err;
    std::istringstream in(contents(path("c.csv")));
    std::string line;
    ASSERT_TRUE(std::getline(in, line));
    EXPECT_EQ(line, "spp,seconds,rays,estimate,low,high,slope,relrmse");
    std::vector<int> spp;
    double last = 0.0;
    while (std::getline(in, line)) {
        EXPECT_EQ(std::count(line.begin(), line.end(), ','), 7) << line;
        spp.push_back(std::stoi(line));
        last = std::stod(line.substr(line.rfind(',') + 1));
        EXPECT_GT(last, 0.0) << line;
    }
    EXPECT_EQ(spp, (std::vector<int>{1, 2, 4, 8, 16, 32, 40}));
    EXPECT_NEAR(last, std::sqrt(nlohmann::json::parse(r.out)["reference"]["relmse"].get<double>()), 1e-5);
    EXPECT_EQ(glint(small + "--convergence /nowhere/c.csv -o " + path("x.pfm")).code, 5);
}

TEST(ErrorText, HasAsManyPlacesAsTheIntervalDeserves) {
    ErrorEstimate e;
    EXPECT_EQ(error_text(e), "");
    e.kind = ErrorEstimate::Kind::estimated;
    e.relrmse = 0.01234, e.low = 0.01194, e.high = 0.01274;
    EXPECT_EQ(error_text(e), "relRMSE 0.01234 \u00b1 0.00040");
    e.relrmse = e.low = e.high = 0.0;
    EXPECT_EQ(error_text(e), "relRMSE 0");
    e.kind = ErrorEstimate::Kind::exact;
    EXPECT_EQ(error_text(e), "exact");
}

TEST(Forecast, GoesByTheFittedSlope) {
    ErrorEstimate e;
    e.kind = ErrorEstimate::Kind::estimated;
    e.spp = 64, e.relrmse = 0.04, e.cautious = 0.05, e.slope = 1.0;
    Progress p;
    p.rays.camera = 64 * 10000, p.seconds = 2.0;
    EXPECT_DOUBLE_EQ(next_target(e), 0.02);
    const Forecast f = forecast(e, p, 10000, 0.01);
    EXPECT_EQ(f.spp, 512) << "five times the samples, at the next doubling";
    EXPECT_DOUBLE_EQ(f.seconds, 16.0);
    EXPECT_EQ(forecast(e, p, 10000, 1e-9).spp, 0) << "never";
}

}  // namespace
}  // namespace glint
