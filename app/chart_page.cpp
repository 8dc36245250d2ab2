#include "app/chart_page.h"

#include <fmt/format.h>

namespace glint::chart {
namespace {

constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; --paper: #fbfaf7; --ink: #22221f; --soft: #66645d; --line: #dedbd2; --code: #f1efe8; --link: #1f4f82; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #191a1c; --ink: #e4e2dc; --soft: #a3a097; --line: #37383b; --code: #232427; --link: #8fbce8; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 17px/1.55 Charter, "Bitstream Charter", "Iowan Old Style",
       Georgia, "DejaVu Serif", serif; }
main { max-width: 1320px; margin: 0 auto; padding: 3rem 1.4rem 5rem; }
h1 { font-size: 2.3rem; line-height: 1.15; font-weight: 600; margin: 0 0 .8rem; letter-spacing: -.01em; }
h2 { font-size: 1.5rem; line-height: 1.25; font-weight: 600; margin: 0 0 .5rem; }
h3 { font-size: 1.02rem; font-weight: 600; margin: 0 0 .1rem; }
p { max-width: 46em; margin: .4rem 0 .8rem; }
a { color: var(--link); text-decoration: none; } a:hover { text-decoration: underline; }
.meta { color: var(--soft); font-size: .93rem; }
nav { display: flex; flex-wrap: wrap; gap: .3rem 1.5rem; margin: 1.2rem 0 0; font-size: .97rem; }
section { border-top: 1px solid var(--line); margin-top: 2.8rem; padding-top: 1.5rem; }
.grid { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 520px), 1fr)); gap: 1.9rem 2rem; margin: 1.3rem 0 0; }
figure { margin: 0; min-width: 0; }
figcaption { font-size: .92rem; line-height: 1.42; color: var(--soft); padding: .15rem 0 0; max-width: 40em; }
svg { width: 100%; height: auto; display: block; }
svg text { font-family: "DejaVu Sans", Verdana, "Segoe UI", sans-serif; }
details { font-size: .86rem; color: var(--soft); margin: .25rem 0 0; }
summary { cursor: pointer; }
pre { margin: .3rem 0 0; padding: .6rem .8rem; background: var(--code); color: var(--ink); overflow-x: auto;
      font: .74rem/1.55 "DejaVu Sans Mono", ui-monospace, Menlo, Consolas, monospace; }
code { font: .86em "DejaVu Sans Mono", ui-monospace, Menlo, Consolas, monospace; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums; margin: .5rem 0 .3rem; }
th, td { padding: .22rem .8rem .22rem 0; text-align: right; white-space: nowrap; border-bottom: 1px solid var(--line); }
th { color: var(--soft); font-weight: 500; } th:first-child, td:first-child { text-align: left; }
footer { border-top: 1px solid var(--line); margin-top: 3rem; padding-top: 1rem; color: var(--soft); font-size: .9rem; }
@media print { figure { break-inside: avoid; } }
)";

std::string commands(const std::vector<std::string>& lines, const std::string& csv) {
    std::string text;
    for (const std::string& line : lines) {
        if (!line.empty()) text += escaped(line) + "\n";
    }
    const std::string numbers = fmt::format("<a href=\"{0}\">{0}</a>", csv);
    if (text.empty()) return fmt::format("<details><summary>numbers</summary>{}</details>\n", numbers);
    return fmt::format("<details><summary>numbers and command lines</summary>{}<pre>{}</pre></details>\n", numbers, text);
}

template <class Drawing>
std::string figure(const Drawing& d, Plotter& plotter, const std::vector<std::string>& lines) {
    const auto svg = plotter.draw(d);
    const std::string picture = svg ? *svg : fmt::format("<p class=\"meta\">Not drawn: gnuplot is missing.</p>");
    return fmt::format("<figure id=\"{}\">\n<h3>{}</h3>\n{}\n<figcaption>{}</figcaption>\n{}</figure>\n", d.id, escaped(d.title),
                       picture, escaped(d.caption), commands(lines, d.id + ".csv"));
}

std::string table(const Table& t) {
    std::string html = fmt::format("<h3 id=\"{}\">{}</h3>\n<div class=\"scroll\"><table>\n<thead><tr>", t.id, escaped(t.title));
    for (const std::string& cell : t.head) html += fmt::format("<th>{}</th>", escaped(cell));
    html += "</tr></thead>\n<tbody>\n";
    for (const auto& row : t.rows) {
        html += "<tr>";
        for (const std::string& cell : row) html += fmt::format("<td>{}</td>", escaped(cell));
        html += "</tr>\n";
    }
    return html + fmt::format("</tbody></table></div>\n<p class=\"meta\">{} <a href=\"{}.csv\">{}.csv</a></p>\n",
                              escaped(t.caption), t.id, t.id);
}

std::string section(const Section& s, Plotter& plotter) {
    std::string html = fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n<p>{}</p>\n", s.id, escaped(s.title), escaped(s.text));
    if (!s.figures.empty() || !s.maps.empty()) html += "<div class=\"grid\">\n";
    for (const Figure& f : s.figures) {
        std::vector<std::string> lines;
        for (const Series& series : f.series) lines.push_back(series.command);
        html += figure(f, plotter, lines);
    }
    for (const WinnerMap& m : s.maps) html += figure(m, plotter, {m.command});
    if (!s.figures.empty() || !s.maps.empty()) html += "</div>\n";
    for (const Table& t : s.tables) html += table(t);
    return html + "</section>\n";
}

}  // namespace

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '<': out += "&lt;"; break;
            case '>': out += "&gt;"; break;
            case '&': out += "&amp;"; break;
            case '"': out += "&quot;"; break;
            case '\'': out += "&#39;"; break;
            default: out += c;
        }
    }
    return out;
}

std::string page_of(const Chart& chart, Plotter& plotter) {
    std::string html = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
        "content=\"width=device-width, "
        "initial-scale=1\">\n<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<main>\n<h1>{0}</h1>\n",
        escaped(chart.title), kStyle);
    html += fmt::format("<p class=\"meta\">{} · {} · glint {}<br><code>{}</code></p>\n", escaped(chart.date),
                        escaped(chart.machine), escaped(chart.version), escaped(chart.command));
    for (const std::string& note : chart.notes) html += fmt::format("<p>{}</p>\n", escaped(note));
    html += "<nav>\n";
    for (const Section& s : chart.sections) html += fmt::format("<a href=\"#{}\">{}</a>\n", s.id, escaped(s.title));
    html += "</nav>\n";
    for (const Section& s : chart.sections) html += section(s, plotter);
    html +=
        chart.numeric
            ? "<p>How exact the arithmetic itself is: <a href=\"numeric/index.html\">the numeric chart</a>.</p>\n"
            : "<p>How exact the arithmetic itself is: <code>tests/numeric/run -o DIR/numeric</code> draws the numeric chart, and "
              "the next run of this command links it.</p>\n";
    return html +
           "<footer>All numbers: <a href=\"chart.json\">chart.json</a>. Each figure also lies beside this page as PNG and "
           "CSV.</footer>\n"
           "</main>\n</body>\n</html>\n";
}

}  // namespace glint::chart
