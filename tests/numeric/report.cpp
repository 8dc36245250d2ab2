#include "tests/numeric/report.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "tests/gallery/page_frame.h"
#include "tests/numeric/plot.h"

namespace glint::numeric {
namespace {

const char* name_of(Axis axis) { return axis == Axis::distance ? "distance" : "scale"; }
const char* name_of(PrimitiveKind kind) { return kPrimitiveNames[static_cast<std::size_t>(kind)]; }

double rate(int part, int whole) {
    return whole > 0 ? static_cast<double>(part) / whole : std::numeric_limits<double>::quiet_NaN();
}

std::string styles() {
    // Colours after Okabe & Ito 2008, readable for the colour-blind; ours is drawn last and thick.
    static constexpr const char* kColors[] = {"#e69f00", "#56b4e9", "#cc79a7", "#d55e00", "#0072b2", "#999999"};
    std::string s =
        "<style>.grid { display: grid; grid-template-columns: repeat(auto-fill, minmax(330px, 1fr)); gap: 1rem 1.2rem; }\n"
        ".grid svg { width: 100%; height: auto; } svg path { fill: none; stroke-width: 1.6; } svg .title { font-weight: 600; }\n"
        "sup { line-height: 0; }\n"
        ".key { display: flex; flex-wrap: wrap; gap: .3rem 1.4rem; padding: 0; list-style: none; font-size: .9rem; }\n"
        ".key svg { width: 34px; height: 12px; margin-right: .5em; vertical-align: middle; }\n"
        ".other { color: #d55e00; } .ours { color: var(--good); } .other path, .ours path { stroke: currentColor; }\n"
        ".other circle, .ours circle { fill: currentColor; } svg .other text, svg .ours text { fill: currentColor; }\n"
        "table { border-collapse: collapse; font-size: .88rem; font-variant-numeric: tabular-nums; }\n"
        "td, th { padding: .15rem .8rem .15rem 0; text-align: right; border-bottom: 1px solid var(--line); }\n"
        "td:first-child, td:nth-child(2), th:first-child, th:nth-child(2) { text-align: left; }\n";
    std::size_t i = 0;
    for (const OffsetRule& rule : kOffsetRules) {
        const bool ours = rule.start == rules::bounded;
        const char* color = ours ? "var(--good)" : kColors[i++];
        s += fmt::format(".{0} path {{ stroke: {1};{2}{3} }} .{0} circle {{ fill: {1}; }}\n", rule.name, color,
                         ours ? " stroke-width: 2.6;" : "", rule.recentred ? " stroke-dasharray: 5 4;" : "");
    }
    return s + "</style>\n";
}

std::string key() {
    std::string s = "<ul class=\"key\">";
    for (const OffsetRule& rule : kOffsetRules) {
        s += fmt::format(
            "<li><svg viewBox=\"0 0 34 12\" class=\"{}\"><path d=\"M0 6H34\"/><circle cx=\"17\" cy=\"6\" "
            "r=\"3\"/></svg>{}</li>",
            rule.name, rule.label);
    }
    return s + "</ul>\n";
}

// One figure a primitive: self-hits, or leaks.
std::string figures(const Measured& m, Axis axis, bool leaks) {
    const Range x = axis == Axis::distance ? Range{0, 7} : Range{-8, 8};
    const Range y{-static_cast<int>(std::floor(std::log10(m.rays))), 0};
    std::string s = "<div class=\"grid\">\n";
    for (std::uint32_t kind = 0; kind < kPrimitiveKinds; ++kind) {
        std::vector<Series> series;
        for (const OffsetRule& rule : kOffsetRules) {
            Series line{rule.name, {}, {}};
            for (const OffsetCell& c : m.offsets) {
                if (c.axis != axis || c.primitive != static_cast<PrimitiveKind>(kind) || c.rule != &rule) continue;
                line.x.push_back(std::pow(10.0, c.exponent));
                line.y.push_back(leaks ? rate(c.leaks, c.walled) : rate(c.self_hits, c.rays));
            }
            series.push_back(std::move(line));
        }
        s += line_plot(kPrimitiveNames[kind], x, y, axis == Axis::distance ? 1 : 4, series);
    }
    return s + "</div>\n";
}

std::string section(const Measured& m, const char* title, const char* text, Axis axis, bool leaks) {
    return fmt::format("<section><h2>{}</h2>\n<p>{}</p>\n{}{}</section>\n", title, text, key(), figures(m, axis, leaks));
}

std::string costs(const Measured& m) {
    std::string s =
        "<section><h2>What a digit costs</h2>\n<p>Error of the reported distance in units in its last place, against long "
        "double, "
        "over the time of one test. The dot is the error that one hit in a hundred exceeds, its line ends at the largest. "
        "Rays from 2 to 10<sup>4</sup> sizes away, aimed near the primitive; a ray&rsquo;s own preparation is not counted."
        " All is scalar code of the baseline instruction set, where glint&rsquo;s triangles call libm for their fused products; "
        "its kernels do "
        "the same arithmetic for 8 or 16 at once."
        "</p>\n<div class=\"grid\">\n";
    for (std::uint32_t kind = 0; kind < kPrimitiveKinds; ++kind) {
        std::vector<Mark> marks;
        for (const Variant& v : m.variants) {
            if (v.primitive == static_cast<PrimitiveKind>(kind)) marks.push_back({v.name, v.ours, v.nanoseconds, v.p99, v.most});
        }
        s += point_plot(fmt::format("{}: error (ulp) over time (ns)", kPrimitiveNames[kind]), {0, 2}, {-1, 8}, marks);
    }
    s += "</div>\n<table><tr><th>primitive</th><th>test</th><th>ns</th><th>median ulp</th><th>99 % ulp</th><th>largest ulp</th>"
         "<th>wrong answers</th><th>hits</th></tr>\n";
    for (const Variant& v : m.variants) {
        s += fmt::format(
            "<tr{}><td>{}</td><td>{}</td><td>{:.1f}</td><td>{:.2g}</td><td>{:.3g}</td><td>{:.3g}</td><td>{}</td>"
            "<td>{}</td></tr>\n",
            v.ours ? " class=\"ours\"" : "", name_of(v.primitive), v.name, v.nanoseconds, v.median, v.p99, v.most, v.wrong,
            v.hits);
    }
    return s + "</table></section>\n";
}

}  // namespace

std::string offsets_csv(const Measured& m) {
    std::string s = "axis,value,primitive,rule,rays,self_hits,walled_rays,leaks,mean_offset_in_sizes\n";
    for (const OffsetCell& c : m.offsets) {
        s += fmt::format("{},1e{},{},{},{},{},{},{},{:.6g}\n", name_of(c.axis), c.exponent, name_of(c.primitive), c.rule->name,
                         c.rays, c.self_hits, c.walled, c.leaks, c.offset);
    }
    return s;
}

std::string variants_csv(const Measured& m) {
    std::string s = "primitive,test,glint,nanoseconds,median_ulp,p99_ulp,largest_ulp,wrong_answers,hits,cases\n";
    for (const Variant& v : m.variants) {
        s += fmt::format("{},\"{}\",{},{:.4g},{:.6g},{:.6g},{:.6g},{},{},{}\n", name_of(v.primitive), v.name, v.ours ? 1 : 0,
                         v.nanoseconds, v.median, v.p99, v.most, v.wrong, v.hits, m.cases);
    }
    return s;
}

std::string json(const Measured& m) {
    std::string s = fmt::format("{{\n  \"rays\": {}, \"cases\": {},\n  \"offsets\": [\n", m.rays, m.cases);
    for (const OffsetCell& c : m.offsets) {
        s += fmt::format(
            "    {{\"axis\": \"{}\", \"value\": 1e{}, \"primitive\": \"{}\", \"rule\": \"{}\", \"rays\": {}, "
            "\"self_hits\": {}, \"walled_rays\": {}, \"leaks\": {}, \"mean_offset_in_sizes\": {:.6g}}}{}\n",
            name_of(c.axis), c.exponent, name_of(c.primitive), c.rule->name, c.rays, c.self_hits, c.walled, c.leaks, c.offset,
            &c == &m.offsets.back() ? "" : ",");
    }
    s += "  ],\n  \"tests\": [\n";
    for (const Variant& v : m.variants) {
        s += fmt::format(
            "    {{\"primitive\": \"{}\", \"test\": \"{}\", \"glint\": {}, \"nanoseconds\": {:.4g}, \"median_ulp\": "
            "{:.6g}, \"p99_ulp\": {:.6g}, \"largest_ulp\": {:.6g}, \"wrong_answers\": {}, \"hits\": {}}}{}\n",
            name_of(v.primitive), v.name, v.ours ? "true" : "false", v.nanoseconds, v.median, v.p99, v.most, v.wrong, v.hits,
            &v == &m.variants.back() ? "" : ",");
    }
    return s + "  ]\n}\n";
}

std::string page(const Measured& m) {
    std::string s = gallery::page_head("glint: numeric accuracy") + styles();
    s += fmt::format(
        "<h1>Numeric accuracy</h1>\n<p>Where a ray may start that leaves a surface, and how exact a hit is. Every point below is "
        "{} rays of a fixed seed, counted against geometry: all five primitives are convex, so a ray that leaves one outwards "
        "can "
        "never meet it again (a <b>self-hit</b>, seen as acne), and must meet a wall that stands close before it (else a "
        "<b>leak</b>). The rules differ in the start alone; the intersection is glint&rsquo;s for all. Lines end where floats "
        "can "
        "no longer hold the primitive, or the wall before it.</p>\n",
        m.rays);
    s += section(m, "Self-hits over distance from zero",
                 "A primitive of size 1, moved away. A fixed distance drowns once the spacing of floats (2<sup>-23</sup> of the "
                 "coordinate) exceeds it.",
                 Axis::distance, false);
    s += section(
        m, "Leaks over distance from zero",
        "The wall is 10<sup>-3</sup> sizes away, or 24 roundings of the coordinates where that is more. A rule that grows "
        "too fast steps over it.",
        Axis::distance, true);
    s += section(m, "Self-hits over scale", "A primitive of that size, its own size away from zero: units must not matter.",
                 Axis::scale, false);
    s += section(m, "Leaks over scale", "The same wall, 10<sup>-3</sup> sizes away.", Axis::scale, true);
    s += costs(m);
    return s +
           "<footer>Made by <code>tests/numeric/run -o DIR</code>, with the numbers beside it: <code>offsets.csv</code>, "
           "<code>tests.csv</code>, <code>numeric.json</code>.</footer>\n" +
           gallery::kPageEnd;
}

}  // namespace glint::numeric
