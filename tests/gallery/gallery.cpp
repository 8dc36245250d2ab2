// Renders the gallery of failures: gallery -o DIR [--width PIXELS] [--isa NAME]. Writes DIR/index.html, which holds everything,
// and the pictures beside it. Exits with 1 when an exhibit does not show what it says: equal pictures, no defect in the
// textbook's or one in ours; with 77 where the machine lacks the instruction set asked for.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>

#include "accel/isa.h"
#include "tests/gallery/page.h"
#include "tests/gallery/stage.h"

namespace glint::gallery {
namespace {

constexpr Exhibit (*kExhibits[])(int) = {shadow_acne,       horizon_acne,      leaking_edges,         lost_triangles,
                                         false_shadows,     far_spheres,       floor_sphere,          early_exit,
                                         fresnel_slip,      zoomed_refraction, light_before_occluder, centre_times_fraction,
                                         correlated_strata, terminator,        stalled_sums};

// Says on standard error what an exhibit fails to show.
bool shows(const Exhibit& e) {
    bool good = true;
    for (const Pair& p : e.pairs) {
        const bool differ = p.textbook.picture.rgb != p.ours.picture.rgb;
        std::printf("%-9s %-18s textbook %10g  ours %10g%s\n", e.id.c_str(), p.name.c_str(), p.textbook.defects, p.ours.defects,
                    differ ? "" : "  the pictures are equal");
        if (p.textbook.defects > 0.0 && !differ) good = false;
        if (p.ours.defects > e.allowed) good = false;
    }
    // Among the pairs of an exhibit there may be one where the textbook still works, to show from where on it does not.
    const auto fails = [&](const Pair& p) { return p.textbook.defects > e.allowed; };
    if (std::none_of(e.pairs.begin(), e.pairs.end(), fails)) good = false;
    if (!good) std::fprintf(stderr, "gallery: %s does not show what it says\n", e.id.c_str());
    return good;
}

int run(const std::filesystem::path& folder, int width) {
    std::filesystem::create_directories(folder);
    std::vector<Exhibit> exhibits;
    bool good = true;
    for (const auto make : kExhibits) {
        exhibits.push_back(make(width));
        const Exhibit& e = exhibits.back();
        good = shows(e) && good;
        for (const Pair& p : e.pairs) {
            write_file_atomically(folder / (p.name + "-textbook.png"), encode_png(p.textbook.picture, Transfer::srgb));
            write_file_atomically(folder / (p.name + "-glint.png"), encode_png(p.ours.picture, Transfer::srgb));
        }
    }
    write_file_atomically(folder / "index.html", page_of(exhibits));
    return good ? 0 : 1;
}

}  // namespace
}  // namespace glint::gallery

int main(int argc, char** argv) {
    std::string folder;
    int width = 256;
    std::optional<glint::Isa> isa = glint::isa_in_use();
    for (int i = 1; i + 1 < argc; i += 2) {
        const std::string_view option = argv[i];
        if (option == "-o") folder = argv[i + 1];
        if (option == "--width") width = std::atoi(argv[i + 1]);
        if (option == "--isa") isa = glint::isa_named(argv[i + 1]);
    }
    if (!isa || folder.empty() || width < 64 || width > 2048 || width % 16 != 0) {
        std::fprintf(stderr,
                     "usage: gallery -o DIR [--width PIXELS] [--isa baseline|avx2|avx512]   (a multiple of 16, 64 to 2048)\n");
        return 2;
    }
    if (!glint::supported(*isa)) return 77;
    glint::use_isa(*isa);
    try {
        return glint::gallery::run(folder, width);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "gallery: %s\n", e.what());
        return 1;
    }
}
