// `glint` run in a shell of its own, as a stranger calls it: for tests of whole commands.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>

namespace glint {

namespace fs = std::filesystem;

struct Outcome {
    int code = -1;
    std::string out, err;
};

class CommandLine : public testing::Test {
protected:
    void SetUp() override {
        folder = fs::temp_directory_path() / fmt::format("glint-cli-{}", getpid());
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }

    [[nodiscard]] std::string path(const std::string& name) const { return (folder / name).string(); }
    [[nodiscard]] std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(folder / name, std::ios::binary) << text;
        return path(name);
    }
    static std::string contents(const std::string& name) {
        std::ifstream in(name, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    // Runs `glint ARGUMENTS` in a shell, after the shell's commands `before`.
    [[nodiscard]] Outcome glint(const std::string& arguments, const std::string& before = "") const {
        const std::string out = path("stdout"), err = path("stderr");
        const std::string command = fmt::format("{} '{}' {} >'{}' 2>'{}' </dev/null", before, GLINT_BINARY, arguments, out, err);
        const int status = std::system(command.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : 256 + WTERMSIG(status), contents(out), contents(err)};
    }
    void expect_refused(const std::string& arguments, int code, const std::string& part, const std::string& before = "") const {
        const Outcome r = glint(arguments, before);
        EXPECT_EQ(r.code, code) << arguments << "\n" << r.err;
        EXPECT_NE(r.err.find(part), std::string::npos) << arguments << "\n" << r.err;
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << arguments << "\n" << r.err;
        EXPECT_EQ(r.out, "") << arguments;
    }

    fs::path folder;
    const std::string quick = "render builtin:balls,level=1 --resolution 32x24 --spp 2 ";
};

}  // namespace glint
