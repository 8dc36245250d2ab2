// What the pages of the tests share: a head with one style, for paper and dark screens, nothing fetched from anywhere.
// Knows no content. Invariant: the same title gives the same bytes.
#pragma once

#include <string>

namespace glint::gallery {

// Up to the opened <main>; the page ends with kPageEnd.
[[nodiscard]] std::string page_head(const std::string& title);
inline constexpr const char* kPageEnd = "</main>\n</body>\n</html>\n";

}  // namespace glint::gallery
