// Measures numeric accuracy: numeric -o DIR [--rays N] [--cases N] [--repeats N]. Writes DIR/index.html with its figures inside,
// offsets.csv, tests.csv and numeric.json. Exits with 1 when glint's own rows are not what they claim, or a textbook's rule has
// stopped failing, which would mean that nothing is measured.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "core/image.h"
#include "tests/numeric/report.h"

namespace glint::numeric {
namespace {

bool complain(const OffsetCell& c, const char* what) {
    std::fprintf(stderr, "numeric: %s: %s at %s 1e%d: %d self-hits of %d, %d leaks of %d\n", what,
                 kPrimitiveNames[static_cast<std::size_t>(c.primitive)], c.axis == Axis::distance ? "distance" : "scale",
                 c.exponent, c.self_hits, c.rays, c.leaks, c.walled);
    return false;
}

// No self-hit up to 10^5 sizes away and at every scale; recentred at any distance, and no leak either.
bool holds(const Measured& m) {
    bool good = true;
    for (const OffsetRule& rule : kOffsetRules) {
        const bool ours = rule.start == rules::bounded;
        bool fails = false;
        for (const OffsetCell& c : m.offsets) {
            if (c.rule != &rule) continue;
            fails = fails || c.self_hits > 0 || c.leaks > 0;
            if (!ours) continue;
            const bool claimed = rule.recentred || c.axis == Axis::scale || c.exponent <= 5;
            if (claimed && c.rays == 0) good = complain(c, "nothing was measured");
            if (claimed && (c.self_hits > 0 || c.leaks > 0)) good = complain(c, rule.name);
        }
        if (!ours && !fails) {
            std::fprintf(stderr, "numeric: %s never fails\n", rule.name);
            good = false;
        }
    }
    return good;
}

int run(const std::filesystem::path& folder, int rays, int cases, int repeats) {
    const Measured m{rays, cases, measure_offsets(rays), measure_variants(cases, repeats)};
    std::filesystem::create_directories(folder);
    write_file_atomically(folder / "offsets.csv", offsets_csv(m));
    write_file_atomically(folder / "tests.csv", variants_csv(m));
    write_file_atomically(folder / "numeric.json", json(m));
    write_file_atomically(folder / "index.html", page(m));
    return holds(m) ? 0 : 1;
}

}  // namespace
}  // namespace glint::numeric

int main(int argc, char** argv) {
    std::string folder;
    int rays = 40000, cases = 200000, repeats = 30;
    for (int i = 1; i + 1 < argc; i += 2) {
        const std::string_view option = argv[i];
        if (option == "-o") folder = argv[i + 1];
        if (option == "--rays") rays = std::atoi(argv[i + 1]);
        if (option == "--cases") cases = std::atoi(argv[i + 1]);
        if (option == "--repeats") repeats = std::atoi(argv[i + 1]);
    }
    if (folder.empty() || rays < 100 || rays > 100000000 || cases < 100 || cases > 10000000 || repeats < 1 || repeats > 1000) {
        std::fprintf(stderr, "usage: numeric -o DIR [--rays N] [--cases N] [--repeats N]\n");
        return 2;
    }
    try {
        return glint::numeric::run(folder, rays, cases, repeats);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "numeric: %s\n", e.what());
        return 1;
    }
}
