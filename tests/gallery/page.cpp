#include "tests/gallery/page.h"

#include <algorithm>
#include <cctype>

#include "tests/gallery/stage.h"

namespace glint::gallery {
namespace {

const char* const kHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>glint: a gallery of failures</title>
<style>
:root { color-scheme: light dark; --paper: #fbfaf7; --ink: #22221f; --soft: #6c6a63; --line: #dedbd2; --code: #f1efe8;
        --bad: #a8321c; --good: #2a6b3c; --link: #1f4f82; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #191a1c; --ink: #e4e2dc; --soft: #9a978e; --line: #37383b; --code: #232427; --bad: #f0876f; --good: #86c795;
          --link: #8fbce8; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 17px/1.55 Charter, "Bitstream Charter", "Iowan Old Style",
       Georgia, "DejaVu Serif", serif; }
main { max-width: 1080px; margin: 0 auto; padding: 3rem 1.2rem 5rem; }
h1 { font-size: 2.3rem; line-height: 1.15; font-weight: 600; margin: 0 0 .8rem; letter-spacing: -.01em; }
h2 { font-size: 1.5rem; line-height: 1.25; font-weight: 600; margin: 0 0 .6rem; }
p { max-width: 44em; margin: .4rem 0 .8rem; hyphens: auto; }
a { color: var(--link); text-decoration: none; } a:hover { text-decoration: underline; }
.id { font: 500 .8rem/1 "DejaVu Sans Mono", ui-monospace, Menlo, Consolas, monospace; color: var(--soft); letter-spacing: .03em; }
nav ol { columns: 3 17em; column-gap: 2.2rem; padding: 0; margin: 1.4rem 0 0; list-style: none; font-size: .95rem; }
nav li { break-inside: avoid; padding: .16rem 0; display: flex; gap: .7em; align-items: baseline; }
nav .id { flex: 0 0 5.6em; }
section { border-top: 1px solid var(--line); margin-top: 3.2rem; padding-top: 1.6rem; }
section > .id { margin: 0 0 .5rem; }
.pair { display: grid; grid-template-columns:minmax(0,1fr) minmax(0,1fr); gap: .4rem 1.25rem; margin: 1.2rem 0 0; }
figure { margin: 0; }
.scroll { overflow-x: auto; }
img { display: block; max-width: 100%; image-rendering: pixelated; background: #777; }
figcaption { font-size: .9rem; line-height: 1.4; color: var(--soft); padding: .45rem 0 .2rem; }
figcaption b { color: var(--ink); font-weight: 600; }
.count { font-variant-numeric: tabular-nums; }
.bad { color: var(--bad); } .good { color: var(--good); }
pre { margin: .3rem 0 0; padding: .7rem .9rem; background: var(--code); font: .78rem/1.5 "DejaVu Sans Mono", ui-monospace, Menlo,
      Consolas, monospace; overflow-x: auto; border-left: 3px solid var(--line); }
.textbook pre { border-color: var(--bad); } .ours pre { border-color: var(--good); }
.plot svg { width: 100%; max-width: 640px; height: auto; margin: .8rem 0 0; display: block; }
svg text { fill: var(--soft); font: 12px "DejaVu Sans", sans-serif; } svg .axis { stroke: var(--line); }
svg .bad { stroke: var(--bad); } svg .good { stroke: var(--good); } svg text.bad { fill: var(--bad); stroke: none; }
svg text.good { fill: var(--good); stroke: none; }
footer { border-top: 1px solid var(--line); margin-top: 3.2rem; padding-top: 1rem; color: var(--soft); font-size: .9rem; }
@media (max-width: 720px) { .pair { grid-template-columns: 1fr; } body { font-size: 16px; } h1 { font-size: 1.8rem; } }
@media print { section { break-inside: avoid; } }
</style>
</head>
<body>
<main>
<h1>A gallery of failures</h1>
<p>Ray tracing fits on a page of a textbook, and the page is wrong in places that only some scenes show. Each exhibit renders one
scene twice: on the left by the textbook&rsquo;s method, on the right by glint. Camera, scene and shading are the same; one method
differs. The numbers are counted as the pictures are made, against an oracle that is neither of the two.</p>
)";

const char* const kFoot = R"(<footer>Made by <code>tests/gallery/run</code>. The codes are those of the failure catalogue that the
tests of glint carry in their names. Each screen pixel block is one pixel of the picture.</footer>
</main>
</body>
</html>
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
    std::string page = kHead;
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
    return page + kFoot;
}

}  // namespace glint::gallery
