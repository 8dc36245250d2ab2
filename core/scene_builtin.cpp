// The table of built-in scenes and the reading of what stands behind `builtin:`.
#include <algorithm>
#include <charconv>
#include <span>

#include <fmt/format.h>

#include "core/builtin.h"
#include "core/mountain.h"
#include "core/scene_io.h"
#include "core/sphereflake.h"
#include "core/torus_knot.h"

namespace glint {
namespace {

// A whole number from lo to hi, or, where there are words, the index of one of them.
struct Parameter {
    std::string_view key;
    int lo = 0, hi = 0, fallback = 0;
    std::span<const std::string_view> words = {};
};

struct Recipe {
    BuiltinScene scene;
    Parameter parameter;  // without a key: the scene has none
    SceneBuilder (*make)(int value);
};

constexpr int kMaxSoupTriangles = 10000000;
constexpr int kMaxCrowd = 150000;  // as many as there are ids for
constexpr std::string_view kPieces[] = {"all", "ball", "slab", "nested", "shell"};

const std::vector<Recipe>& recipes() {
    static const std::vector<Recipe> table{
        {{"balls", "level=0..6 (4)", "sphereflake: 1, 10, 91, 820, 7381, 66430 or 597871 mirror balls"},
         {"level", 0, kMaxSphereflakeLevel, 4},
         builtin::balls},
        {{"mount", "level=1..7 (6)", "fractal mountain of 2*4^level triangles behind four glass balls"},
         {"level", 1, kMaxMountainLevel, 6},
         builtin::mount},
        {{"balls_box", "", "90 aluminium balls around a copper box"}, {}, [](int) { return builtin::balls_box(); }},
        {{"dof", "", "seven balls in a row before a wide lens"}, {}, [](int) { return builtin::dof(); }},
        {{"cornell", "", "a small room under an area light: a block, a mirror ball, a glass ball"},
         {},
         [](int) { return builtin::cornell(); }},
        {{"glass", "what=all|ball|slab|nested|shell (all)", "a ball lens, a slab, water in glass and a hollow shell"},
         {"what", 0, 4, 0, kPieces},
         [](int piece) { return builtin::glass(static_cast<builtin::GlassPiece>(piece)); }},
        {{"knot", "n=10000..10000000 (868870)", "a rough torus knot of n triangles, closed, on a floor"},
         {"n", kMinKnotTriangles, kMaxKnotTriangles, 868870},
         builtin::knot},
        {{"stadium", "n=10000..10000000 (100000)", "a knot of n triangles, a thousandth of the field it lies in"},
         {"n", kMinKnotTriangles, kMaxKnotTriangles, 100000},
         builtin::stadium},
        {{"soup", "n=1..10000000 (100000)", "n triangles of random place, size and orientation in a cube"},
         {"n", 1, kMaxSoupTriangles, 100000},
         builtin::soup},
        {{"crowd", "n=1..150000 (1000)", "n knots as a sunflower's seeds: five meshes of 10000 triangles, stored once"},
         {"n", 1, kMaxCrowd, 1000},
         builtin::crowd},
    };
    return table;
}

[[noreturn]] void refuse(const std::string& spec, const std::string& reason) {
    throw SceneError(fmt::format("builtin:{}: {}", spec, reason));
}

const Recipe& find_recipe(std::string_view name, const std::string& spec) {
    std::string names;
    for (const Recipe& recipe : recipes()) {
        if (recipe.scene.name == name) return recipe;
        names += fmt::format("{}{}", names.empty() ? "" : ", ", recipe.scene.name);
    }
    refuse(spec, fmt::format("unknown scene; there are {}", names));
}

// The value of "key=value" for the recipe's one parameter.
int read_argument(std::string_view argument, const Recipe& recipe, const std::string& spec) {
    const Parameter& parameter = recipe.parameter;
    if (parameter.key.empty()) refuse(spec, fmt::format("{} takes no parameters", recipe.scene.name));
    const auto expected = [&] { return fmt::format("{} takes {}", recipe.scene.name, recipe.scene.parameters); };
    const std::size_t equals = argument.find('=');
    const std::string_view key = argument.substr(0, equals);
    if (equals == std::string_view::npos || key != parameter.key) refuse(spec, fmt::format("unknown '{}'; {}", key, expected()));
    const std::string_view text = argument.substr(equals + 1);
    if (!parameter.words.empty()) {
        const auto word = std::find(parameter.words.begin(), parameter.words.end(), text);
        if (word == parameter.words.end()) refuse(spec, fmt::format("bad value '{}'; {}", text, expected()));
        return static_cast<int>(word - parameter.words.begin());
    }
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = error == std::errc() && end == text.data() + text.size();
    if (!whole || value < parameter.lo || value > parameter.hi) refuse(spec, fmt::format("bad value '{}'; {}", text, expected()));
    return value;
}

}  // namespace

const std::vector<BuiltinScene>& builtin_scenes() {
    static const std::vector<BuiltinScene> scenes = [] {
        std::vector<BuiltinScene> list;
        for (const Recipe& recipe : recipes()) list.push_back(recipe.scene);
        return list;
    }();
    return scenes;
}

std::shared_ptr<const Scene> reader::make_builtin(const std::string& spec) {
    const std::string_view whole = spec;
    const std::size_t comma = whole.find(',');
    const Recipe& recipe = find_recipe(whole.substr(0, comma), spec);
    int value = recipe.parameter.fallback;
    std::size_t start = comma;
    while (start != std::string_view::npos) {
        const std::size_t end = whole.find(',', start + 1);
        value = read_argument(whole.substr(start + 1, end == std::string_view::npos ? end : end - start - 1), recipe, spec);
        start = end;
    }
    SceneBuilder builder = recipe.make(value);
    builder.scene().name = "builtin:" + spec;
    return builder.finish();
}

}  // namespace glint
