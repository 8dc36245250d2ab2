// The gallery as one page: HTML with its pictures inside, nothing fetched from anywhere.
// Knows no exhibit by name. Invariant: the same exhibits give the same bytes.
#pragma once

#include <string>
#include <vector>

#include "tests/gallery/exhibit.h"

namespace glint::gallery {

[[nodiscard]] std::string base64(const std::string& bytes);
// The whole page.
[[nodiscard]] std::string page_of(const std::vector<Exhibit>& exhibits);

}  // namespace glint::gallery
