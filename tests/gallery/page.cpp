#include "tests/gallery/page.h"

#include <algorithm>
#include <cctype>

#include "tests/gallery/page_frame.h"
#include "tests/gallery/stage.h"

namespace glint::gallery {
namespace {

const char* const kIntroduction = R"(<h1>A gallery of failures</h1>
<p>Ray tracing fits on a page of a textbook, and the page is wrong in places that only some scenes show. Each exhibit renders one
scene twice: on the left by the textbook&rsquo;s method, on the right by glint. Camera, scene and shading are the same; one method
differs. The numbers are counted as the pictures are made, against an oracle that is neither of the two.</p>
)";

const char* const kFoot = R"(<footer>Made by <code>tests/gallery/run</code>. The codes are those of the failure catalogue that the
tests of glint carry in their names. Each screen pixel block is one pixel of the picture.</footer>
)";

// Code as text of a page.
std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '&')
            out += "&amp;";
        else
            out += c;
    }
    return out;
}

std::string anchor(const Exhibit& e) {
    std::string s = e.pairs.empty() ? e.id : e.pairs.front().name;
    std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return s;
}

std::string number(double x) { return x == std::floor(x) ? grouped(x) : fmt::format("{:.3g}", x); }

// A picture is enlarged by a whole number, so that its pixels stay squares of one size.
std::string figure(const Exhibit& e, const Side& side, bool ours, int column) {
    const int zoom = std::max(1, column / side.picture.width);
    const bool none = side.defects <= e.allowed;
    return fmt::format(
        "<figure class=\"{}\"><img width=\"{}\" height=\"{}\" alt=\"{}: {}\" src=\"data:image/png;base64,{}\">"
        "<figcaption><b>{}.</b> {}. <span class=\"count {}\">{} {}.</span></figcaption></figure>\n",
        ours ? "ours" : "textbook", side.picture.width * zoom, side.picture.height * zoom, e.title,
        ours ? "glint" : "the textbook", base64(encode_png(side.picture, Transfer::srgb)), ours ? "glint" : "Textbook",
        side.caption, none ? "good" : "bad", number(side.defects), e.defect);
}

}  // namespace

std::string base64(const std::string& bytes) {
    static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        }
        for (std::size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63u] : '=';
    }
    return out;
}

std::string page_of(const std::vector<Exhibit>& exhibits) {
    std::string page = page_head("glint: a gallery of failures") + kIntroduction;
    page += "<nav><ol>\n";
    for (const Exhibit& e : exhibits) {
        page += fmt::format("<li><span class=\"id\">{}</span><a href=\"#{}\">{}</a></li>\n", e.id, anchor(e), e.title);
    }
    page += "</ol></nav>\n";
    for (const Exhibit& e : exhibits) {
        page += fmt::format("<section id=\"{}\">\n<p class=\"id\">{}</p>\n<h2>{}</h2>\n<p>{}</p>\n<p>{}</p>\n", anchor(e), e.id,
                            e.title, e.seen, e.instead);
        if (!e.plot.empty()) page += "<div class=\"plot\">" + e.plot + "</div>\n";
        for (const Pair& p : e.pairs) {
            page += "<div class=\"pair\">\n" + figure(e, p.textbook, false, 512) + figure(e, p.ours, true, 512) + "</div>\n";
        }
        page += fmt::format(
            "<div class=\"pair\"><div class=\"textbook\"><pre>{}</pre></div><div "
            "class=\"ours\"><pre>{}</pre></div></div>\n</section>\n",
            escaped(e.textbook_code), escaped(e.our_code));
    }
    return page + kFoot + kPageEnd;
}

}  // namespace glint::gallery
