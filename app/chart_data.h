// What a chart consists of, as plain data between those who measure and those who draw or write: figures of curves, maps of
// winners, tables, and sections of them. Knows neither renderer nor file format. Texts are plain: whoever prints escapes them.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace glint::chart {

struct Point {
    double x = 0.0, y = 0.0;
    double low = std::numeric_limits<double>::quiet_NaN(), high = low;  // the 95 % band; NaN = none
    std::vector<double> extra = {};                                     // one for each of Figure::extra
};

struct Series {
    enum class Look { curve, dots, front };  // front: a staircase without dots
    std::string name;
    std::string note;     // stands behind the name in the picture, for example a slope
    std::string command;  // makes the picture of one of the points; empty = see the section
    int colour = 0;       // of the palette
    Look look = Look::curve;
    std::vector<Point> points;
};

struct Axis {
    std::string label;
    bool logarithmic = true;
    std::vector<std::string> places = {};  // of a y axis: names of y = 1, 2 … from the top; empty = it has numbers
};

struct Figure {
    std::string id;  // of files: letters, digits, - and _
    std::string title, caption;
    Axis x, y;
    std::vector<std::string> extra;  // names of the further columns
    std::vector<Series> series;
    std::vector<double> levels;  // horizontal marks: targets
};

// Which of a few candidates is best at each place of a grid.
struct WinnerMap {
    std::string id, title, caption;
    Axis x, y;
    std::vector<double> xs, ys;           // rising, evenly spaced in the logarithm
    std::vector<std::string> candidates;  // colours of the palette in this order
    std::vector<std::size_t> winner;      // xs.size() * ys.size(), x running first
    std::vector<double> margin;           // the second best over the best, as many
    std::string command;
};

struct Table {
    std::string id, title, caption;
    std::vector<std::string> head;
    std::vector<std::vector<std::string>> rows;
};

struct Section {
    std::string id, title, text;
    std::vector<Figure> figures;
    std::vector<WinnerMap> maps;
    std::vector<Table> tables;
};

struct Chart {
    std::string title, command, machine, version, date;
    bool numeric = false;            // numeric/index.html lies beside the page: the chart of arithmetic
    std::vector<std::string> notes;  // how it was measured, sentence by sentence
    std::vector<Section> sections;
};

}  // namespace glint::chart
