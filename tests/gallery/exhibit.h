// One exhibit of the gallery: a failure as pairs of pictures, what is seen, and the code of both methods.
// Knows no page and no file. Invariant: a defect is counted by an oracle that is neither of the two methods.
#pragma once

#include <string>
#include <vector>

#include "core/image.h"

namespace glint::gallery {

struct Side {
    Image8 picture;
    std::string caption;  // may hold HTML
    double defects = 0.0;
};

struct Pair {
    std::string name;  // of the files: letters, digits, dashes
    Side textbook, ours;
};

struct Exhibit {
    std::string id, title;      // id: of the failure catalogue
    std::string seen, instead;  // a sentence each; may hold HTML
    std::string defect;         // what is counted
    std::string textbook_code, our_code;
    std::vector<Pair> pairs;
    std::string plot;      // an SVG, may be empty
    double allowed = 0.0;  // defects that ours may have: above 0 only where they are a measured error, not a count
};

// width: of a picture, a multiple of 8. Each function makes one exhibit.
Exhibit shadow_acne(int width);
Exhibit horizon_acne(int width);
Exhibit leaking_edges(int width);
Exhibit lost_triangles(int width);
Exhibit far_spheres(int width);
Exhibit floor_sphere(int width);
Exhibit false_shadows(int width);
Exhibit early_exit(int width);
Exhibit fresnel_slip(int width);
Exhibit zoomed_refraction(int width);
Exhibit light_before_occluder(int width);
Exhibit centre_times_fraction(int width);
Exhibit correlated_strata(int width);
Exhibit stalled_sums(int width);
Exhibit terminator(int width);

}  // namespace glint::gallery
