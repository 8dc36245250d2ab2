#include "app/chart_files.h"

#include <cmath>

#include <fmt/format.h>

#include "core/image.h"

namespace glint::chart {
namespace {

// RFC 4180.
std::string field(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"') out += '"';
        out += c;
    }
    return out + "\"";
}

std::string number(double x) { return std::isfinite(x) ? fmt::format("{:.9g}", x) : ""; }

nlohmann::json json_number(double x) { return std::isfinite(x) ? nlohmann::json(x) : nlohmann::json(nullptr); }

nlohmann::json json_of(const Figure& f) {
    nlohmann::json series = nlohmann::json::array();
    for (const Series& s : f.series) {
        nlohmann::json points = nlohmann::json::array();
        for (const Point& p : s.points) {
            nlohmann::json point{
                {"x", json_number(p.x)}, {"y", json_number(p.y)}, {"low", json_number(p.low)}, {"high", json_number(p.high)}};
            for (std::size_t i = 0; i < p.extra.size() && i < f.extra.size(); ++i) point[f.extra[i]] = json_number(p.extra[i]);
            points.push_back(point);
        }
        series.push_back({{"name", s.name}, {"note", s.note}, {"command", s.command}, {"points", points}});
    }
    return {{"id", f.id},     {"title", f.title},     {"caption", f.caption}, {"x", f.x.label},
            {"y", f.y.label}, {"places", f.y.places}, {"series", series}};
}

nlohmann::json json_of(const WinnerMap& m) {
    return {{"id", m.id},         {"title", m.title},   {"caption", m.caption}, {"x", m.x.label},
            {"y", m.y.label},     {"xs", m.xs},         {"ys", m.ys},           {"candidates", m.candidates},
            {"winner", m.winner}, {"margin", m.margin}, {"command", m.command}};
}

nlohmann::json json_of(const Table& t) {
    return {{"id", t.id}, {"title", t.title}, {"caption", t.caption}, {"head", t.head}, {"rows", t.rows}};
}

}  // namespace

std::string csv_of(const Figure& f) {
    std::string out = "series,x,y,low,high";
    for (const std::string& name : f.extra) out += fmt::format(",{}", field(name));
    out += f.y.places.empty() ? "\n" : ",place\n";
    for (const Series& s : f.series) {
        for (const Point& p : s.points) {
            out += fmt::format("{},{},{},{},{}", field(s.name), number(p.x), number(p.y), number(p.low), number(p.high));
            for (std::size_t i = 0; i < f.extra.size(); ++i)
                out += fmt::format(",{}", i < p.extra.size() ? number(p.extra[i]) : "");
            const auto place = static_cast<std::size_t>(p.y - 1.0);
            out += place < f.y.places.size() ? fmt::format(",{}\n", field(f.y.places[place])) : "\n";
        }
    }
    return out;
}

std::string csv_of(const WinnerMap& m) {
    std::string out = fmt::format("{},{},winner,second_over_best\n", field(m.x.label), field(m.y.label));
    for (std::size_t j = 0; j < m.ys.size(); ++j) {
        for (std::size_t i = 0; i < m.xs.size(); ++i) {
            const std::size_t at = j * m.xs.size() + i;
            out += fmt::format("{},{},{},{}\n", number(m.xs[i]), number(m.ys[j]), field(m.candidates[m.winner[at]]),
                               number(m.margin[at]));
        }
    }
    return out;
}

std::string csv_of(const Table& t) {
    std::string out;
    const auto line = [&](const std::vector<std::string>& cells) {
        for (std::size_t i = 0; i < cells.size(); ++i) out += fmt::format("{}{}", i > 0 ? "," : "", field(cells[i]));
        out += "\n";
    };
    line(t.head);
    for (const auto& row : t.rows) line(row);
    return out;
}

nlohmann::json json_of(const Chart& chart) {
    nlohmann::json sections = nlohmann::json::array();
    for (const Section& s : chart.sections) {
        nlohmann::json section{{"id", s.id},
                               {"title", s.title},
                               {"figures", nlohmann::json::array()},
                               {"maps", nlohmann::json::array()},
                               {"tables", nlohmann::json::array()}};
        for (const Figure& f : s.figures) section["figures"].push_back(json_of(f));
        for (const WinnerMap& m : s.maps) section["maps"].push_back(json_of(m));
        for (const Table& t : s.tables) section["tables"].push_back(json_of(t));
        sections.push_back(section);
    }
    return {{"title", chart.title}, {"command", chart.command}, {"machine", chart.machine}, {"version", chart.version},
            {"date", chart.date},   {"notes", chart.notes},     {"sections", sections}};
}

void write_data(const Chart& chart, const std::filesystem::path& folder) {
    for (const Section& s : chart.sections) {
        for (const Figure& f : s.figures) write_file_atomically(folder / (f.id + ".csv"), csv_of(f));
        for (const WinnerMap& m : s.maps) write_file_atomically(folder / (m.id + ".csv"), csv_of(m));
        for (const Table& t : s.tables) write_file_atomically(folder / (t.id + ".csv"), csv_of(t));
    }
    // Names of scenes are bytes of file names, which need not be UTF-8.
    write_file_atomically(folder / "chart.json",
                          json_of(chart).dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace glint::chart
