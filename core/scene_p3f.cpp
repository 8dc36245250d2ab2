#include <algorithm>

#include <fmt/format.h>

#include "core/contained_path.h"
#include "core/p3f_reader.h"
#include "core/scene_io.h"
#include "core/scene_origin.h"

namespace glint {
namespace {

using namespace p3f;

const Statement* find_statement(std::string_view word) {
    for (const auto& statements : {shape_statements(), mesh_statements(), light_statements(), surface_statements()}) {
        const auto at = std::find_if(statements.begin(), statements.end(), [&](const Statement& s) { return s.word == word; });
        if (at != statements.end()) return &*at;
    }
    return nullptr;
}

bool opens_view(std::string_view word) { return word == "v" || word == "camera"; }

// True where reading can go on after an unknown word. At the start of a line any statement's word will do; inside a line only
// when its argument follows, for loose labels ("Wall at the left") are full of short words.
bool starts_statement(const Reader& r, const Token& token) {
    if (token.end()) return true;
    const bool known = find_statement(token.text) != nullptr || opens_view(token.text);
    if (token.first_on_line && known) return true;
    const Token argument = r.in.peek();
    if (known || is_view_word(token.text)) {
        if (to_number(argument.text)) return true;
        if (token.text == "light") return argument.text == "punctual" || argument.text == "quad";
        if (opens_view(token.text)) return is_view_word(argument.text);
        return r.view_open && token.first_on_line;
    }
    // Another unknown word on a line of its own deserves a warning of its own.
    return token.first_on_line && !to_number(token.text);
}

void skip_unknown(Reader& r, const Token& word) {
    const bool number = to_number(word.text).has_value();
    r.messages.warn(word.line,
                    fmt::format("{} {}, skipped", number ? "unexpected number" : "unknown word", in_quotes(word.text)));
    for (;;) {
        const Lexer before = r.in;
        const Token token = r.in.next();
        if (!starts_statement(r, token)) continue;
        r.in = before;
        return;
    }
}

// Reads one statement; false when the word was none.
bool read_statement(Reader& r, const Token& word) {
    if (is_view_word(word.text) && (r.view_open || r.in.number_follows())) {
        read_view_word(r.view, r.in, r.messages, word);
        return true;
    }
    if (opens_view(word.text)) {
        r.view = View{};
        r.view.line = word.line;
        r.view_open = true;
        r.renamed_dialect = r.renamed_dialect || word.text == "camera";
        return true;
    }
    if (const Statement* statement = find_statement(word.text)) {
        r.view_open = false;
        statement->read(r, word);
        return true;
    }
    skip_unknown(r, word);
    return false;
}

void load_sky_box(Reader& r) {
    const auto skip = [&](std::string_view why) {
        r.messages.warn(r.environment_line,
                        fmt::format("env {}: {}, the background colour is used", in_quotes(r.environment), why));
    };
    const auto folder = path_below(r.folder, r.environment);
    if (!folder) return skip("no such folder below the scene's own");
    try {
        const auto files = cube_files(*folder);
        // A picture may itself be a link to somewhere else.
        const bool inside = std::all_of(files.begin(), files.end(), [&](const auto& file) { return path_below(r.folder, file); });
        if (!inside) return skip("a picture lies outside the scene's folder");
        load_cube(r.builder.scene().environment, *folder);
    } catch (const SceneError& e) {
        skip(e.what());
    }
}

// Control bytes tell a picture or an archive from a scene at once; text in any encoding but UTF-16 has none.
void refuse_binary(std::string_view text, const Messages& messages) {
    const std::size_t at = text.find('\0');
    if (at == std::string_view::npos) return;
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    messages.fail(static_cast<std::size_t>(line), "not a text file (a zero byte)");
}

void read_statements(Reader& r) {
    std::size_t statements = 0;
    std::string first_unknown;
    std::size_t first_line = 0;
    for (Token word = r.in.next(); !word.end(); word = r.in.next()) {
        if (read_statement(r, word)) {
            ++statements;
        } else if (first_line == 0) {
            first_unknown = in_quotes(word.text);
            first_line = word.line;
        }
    }
    if (statements > 0) return;
    if (first_line == 0) r.messages.fail(r.in.line(), "the file holds no statement");
    r.messages.fail(first_line, fmt::format("not a P3F or NFF file: {} is no statement, and no other follows", first_unknown));
}

// Planes lie everywhere: without anything else the view tells where their scene is.
Aabb extent_of(const Reader& r) {
    Aabb extent = r.builder.extent();
    if (extent.empty() && r.view.eye && r.view.target) {
        for (const glm::dvec3 p : {*r.view.eye, *r.view.target}) extent.grow(r.builder.scene().local(p));
    }
    return extent;
}

// What is left when all statements were read.
void finish_reading(Reader& r, const LoadOptions& options) {
    Scene& scene = r.builder.scene();
    finish_view(r.view, r.renamed_dialect || r.view.renamed, r.builder, r.messages);
    if (!r.environment.empty() && options.load_environment && options.environment.empty()) load_sky_box(r);

    const Geometry& geometry = r.builder.geometry();
    if (geometry.bounded_count() == 0 && geometry.planes.empty()) r.messages.warn("no shape: only the background is seen");
    const bool glows = std::any_of(scene.materials.begin(), scene.materials.end(),
                                   [](const Material& m) { return m.emission != glm::vec3(0.0f); });
    if (scene.lights.empty() && !glows) r.messages.warn("no light: surfaces stay black but for what they mirror");
    scene.warnings = r.messages.take();
}

}  // namespace

std::shared_ptr<const Scene> reader::read_p3f(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                                              const LoadOptions& options) {
    for (SceneOrigin origin;;) {
        Messages messages(name);
        refuse_binary(text, messages);
        Lexer lexer(text, messages);
        SceneBuilder builder(origin.world());
        builder.scene().name = name;
        builder.scene().transfer = Transfer::linear;

        Reader r{messages, lexer, builder, folder};
        read_statements(r);
        if (!origin.suits(extent_of(r))) continue;
        finish_reading(r, options);
        return builder.finish();
    }
}

}  // namespace glint
