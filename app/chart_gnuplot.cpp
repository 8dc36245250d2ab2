// How gnuplot is run, and what its SVG needs to stand in a page.
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <regex>

#include <fmt/format.h>

#include "app/chart_figure.h"
#include "core/image.h"
#include "core/scene_io.h"

extern char** environ;  // NOLINT: POSIX gives no other way

namespace glint::chart {
namespace {

namespace fs = std::filesystem;

// Its exit code; 127 when there is none to run. What it says is not the user's business: scripts are ours.
int run_gnuplot(const fs::path& script) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    std::string name = "gnuplot", path = script.string();
    char* argv[] = {name.data(), path.data(), nullptr};
    pid_t pid = 0;
    const int error = posix_spawnp(&pid, "gnuplot", &actions, nullptr, argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) return 127;
    int status = 0;
    while (waitpid(pid, &status, 0) < 0) {
        if (errno != EINTR) return 1;
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

// The colours that scripts use for ink, grid and marks become those of the page around; prolog and name spaces go, since
// inside HTML they only look like addresses.
std::string for_page(const std::string& svg) {
    std::string s = svg.substr(std::min(svg.size(), svg.find("<svg")));
    s = std::regex_replace(s, std::regex("\\s*xmlns(:xlink)?=\"[^\"]*\""), "");
    s = std::regex_replace(s, std::regex("<title>[^<]*</title>|<desc>[^<]*</desc>"), "");
    s = std::regex_replace(s, std::regex("rgb\\( *1, *2, *3\\)"), "var(--soft)");
    s = std::regex_replace(s, std::regex("rgb\\( *4, *5, *6\\)"), "var(--line)");
    s = std::regex_replace(s, std::regex("rgb\\( *7, *8, *9\\)"), "var(--soft)");
    return s;
}

// For a picture that stands alone.
std::string on_white(std::string script) {
    script = std::regex_replace(script, std::regex("#010203"), "#333333");
    script = std::regex_replace(script, std::regex("#040506"), "#dddddd");
    return std::regex_replace(script, std::regex("#070809"), "#777777");
}

}  // namespace

std::optional<std::string> Plotter::run(const std::string& id, const std::string& script) {
    if (!works_) return std::nullopt;
    const fs::path gp = folder_ / (id + ".gp"), svg = folder_ / (id + ".svg"), png = folder_ / (id + ".png");
    // gnuplot reads file names as quoted text, too; ids are plain, and it runs beside the others' folder.
    const auto output = [](const fs::path& path) {
        std::string name;
        for (const char c : path.string()) name += c == '\'' ? std::string("''") : std::string(1, c);
        return fmt::format("set output '{}'\n", name);
    };
    const auto terminal = [&](const char* name, const fs::path& path, const std::string& drawing) {
        return fmt::format("set terminal {}\n{}{}", name, output(path), drawing);
    };
    const std::string text =
        terminal("svg size 620,350 dynamic noenhanced font 'DejaVu Sans,13'", svg, script) + "reset\n" +
        terminal("pngcairo size 1240,700 noenhanced font 'DejaVu Sans,12' fontscale 2 linewidth 2 pointscale 2", png,
                 on_white(script));
    write_file_atomically(gp, text);
    const int code = run_gnuplot(gp);
    std::error_code ignored;
    fs::remove(gp, ignored);
    if (code == 127) {
        works_ = false;
        return std::nullopt;
    }
    std::optional<std::string> drawn;
    if (code == 0 && fs::exists(svg, ignored)) drawn = for_page(reader::read_file(svg));
    fs::remove(svg, ignored);
    return drawn;
}

std::optional<std::string> Plotter::draw(const Figure& figure) { return run(figure.id, plot_script(figure)); }
std::optional<std::string> Plotter::draw(const WinnerMap& map) { return run(map.id, plot_script(map)); }

}  // namespace glint::chart
