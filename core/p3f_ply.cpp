#include "core/p3f_ply.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "core/p3f_lexer.h"
#include "core/polygon.h"

namespace glint::p3f {
namespace {

struct Property {
    std::string_view name;
    bool list = false;
};

struct Element {
    std::string_view name;
    std::int64_t announced = 0;
    std::size_t line = 1;  // of the announcement
    std::vector<Property> properties;

    [[nodiscard]] std::optional<std::size_t> find(std::string_view property) const {
        const auto at = std::find_if(properties.begin(), properties.end(), [&](const Property& p) { return p.name == property; });
        if (at == properties.end()) return std::nullopt;
        return static_cast<std::size_t>(at - properties.begin());
    }
};

class PlyReader {
public:
    PlyReader(std::string_view text, const std::string& name) : size_(text.size()), messages_(name), in_(text, messages_) {}

    PlyMesh read() {
        read_header();
        for (const Element& element : elements_) {
            // Each property is at least a digit and a blank, so a lie about the count is found before anything is allocated.
            const auto properties = std::max<std::size_t>(element.properties.size(), 1);
            if (element.announced < 0 || static_cast<std::uint64_t>(element.announced) > (size_ + 1) / (2 * properties)) {
                messages_.fail(element.line, fmt::format("{} announces {}, more than the file can hold", in_quotes(element.name),
                                                         element.announced));
            }
            read_element(element);
        }
        if (mesh_.positions.empty()) messages_.fail(in_.line(), "the file has no vertices");
        return std::move(mesh_);
    }

private:
    void expect(std::string_view word) {
        const Token token = in_.next();
        if (token.text != word) messages_.fail(in_.line(), fmt::format("not an ASCII PLY file: expected '{}'", word));
    }

    void read_header() {
        expect("ply");
        for (;;) {
            const Token token = in_.next();
            if (token.end()) messages_.fail(in_.line(), "the header has no 'end_header'");
            if (token.text == "end_header") return;
            if (token.text == "format") {
                expect("ascii");
            } else if (token.text == "element") {
                const std::string_view name = in_.name("'element'");
                elements_.push_back({name, in_.integer("'element'"), token.line, {}});
            } else if (token.text == "property" && !elements_.empty()) {
                read_property();
            }
            // `comment`, `obj_info` and whatever else: the header goes by lines.
            in_.skip_line();
        }
    }

    void read_property() {
        const bool list = in_.name("'property'") == "list";
        if (list) {
            (void)in_.name("'property'");
            (void)in_.name("'property'");
        }
        elements_.back().properties.push_back({in_.name("'property'"), list});
    }

    void read_element(const Element& element) {
        const bool vertices = element.name == "vertex";
        const auto list = element.find("vertex_indices") ? element.find("vertex_indices") : element.find("vertex_index");
        if (vertices && !(element.find("x") && element.find("y") && element.find("z"))) {
            messages_.fail(element.line, "'vertex' has no x, y, z");
        }
        // Two such elements could disagree about normals, which would then no longer run beside the positions.
        if (vertices && !mesh_.positions.empty()) messages_.fail(element.line, "a second element 'vertex'");
        if (element.properties.empty()) return;
        values_.assign(element.properties.size(), 0.0);
        for (std::int64_t i = 0; i < element.announced; ++i) {
            for (std::size_t k = 0; k < element.properties.size(); ++k) {
                if (!element.properties[k].list) {
                    values_[k] = in_.numbers<1>(in_quotes(element.properties[k].name))[0];
                } else {
                    read_list(element.name == "face" && k == list);
                }
            }
            if (vertices) add_vertex(element);
        }
    }

    void read_list(bool face) {
        const std::uint32_t n = in_.count("a list", 1);
        if (face && (n < 3 || n > kMaxPolygonCorners)) {
            messages_.fail(in_.line(), fmt::format("a face of {} vertices, expected 3 to {}", n, kMaxPolygonCorners));
        }
        if (face) mesh_.corners.push_back(n);
        for (std::uint32_t i = 0; i < n; ++i) {
            if (!face) {
                (void)in_.numbers<1>("a list");
                continue;
            }
            const std::int64_t corner = in_.integer("a face");
            if (corner < 0 || corner >= static_cast<std::int64_t>(mesh_.positions.size())) {
                messages_.fail(in_.line(), fmt::format("index {} is out of range: the file has {} vertices so far", corner,
                                                       mesh_.positions.size()));
            }
            mesh_.corners.push_back(static_cast<std::uint32_t>(corner));
        }
    }

    void add_vertex(const Element& element) {
        const auto value = [&](std::string_view name) { return static_cast<float>(values_[*element.find(name)]); };
        mesh_.positions.emplace_back(value("x"), value("y"), value("z"));
        if (element.find("nx") && element.find("ny") && element.find("nz")) {
            mesh_.normals.emplace_back(value("nx"), value("ny"), value("nz"));
        }
    }

    std::size_t size_;
    Messages messages_;
    Lexer in_;
    std::vector<Element> elements_;
    std::vector<double> values_;  // of the record being read
    PlyMesh mesh_;
};

}  // namespace

PlyMesh read_ply(std::string_view text, const std::string& name) { return PlyReader(text, name).read(); }

}  // namespace glint::p3f
