// Reads scene texts in tests: as the file "t.p3f" of a folder, with or without a view and a light in front.
// Knows no test. The preamble has no line break, so that line numbers in messages are those of the text.
#pragma once

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "core/scene_io.h"

namespace glint {

constexpr std::string_view kPreamble = "v from 0 0 5 at 0 0 0 up 0 1 0 angle 45 hither 1 resolution 64 32 l 9 9 9 1 1 1 ";

inline std::shared_ptr<const Scene> read_text(std::string_view text, const std::filesystem::path& folder = {},
                                              const LoadOptions& options = {}) {
    return reader::read_p3f(text, "t.p3f", folder, options);
}

inline std::shared_ptr<const Scene> read_body(std::string_view text, const std::filesystem::path& folder = {},
                                              const LoadOptions& options = {}) {
    return read_text(std::string(kPreamble) + std::string(text), folder, options);
}

// The message of the SceneError, or what happened instead.
inline std::string refusal(std::string_view text) {
    try {
        (void)read_text(text);
    } catch (const SceneError& e) {
        return e.what();
    }
    return "accepted";
}

// A folder of the running test's own, removed afterwards.
class TestFolder {
public:
    TestFolder() {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        std::string name = std::string("glint_") + info->test_suite_name() + "_" + info->name();
        for (char& c : name) c = c == '/' ? '_' : c;
        path_ = std::filesystem::path(testing::TempDir()) / name;
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~TestFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TestFolder(const TestFolder&) = delete;
    TestFolder& operator=(const TestFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    void write(const std::filesystem::path& name, std::string_view content) const {
        std::filesystem::create_directories((path_ / name).parent_path());
        std::ofstream(path_ / name, std::ios::binary) << content;
    }

private:
    std::filesystem::path path_;
};

// Six binary PNM pictures under the names of a sky box (they are known by content, not by ending): one colour each.
inline void write_sky_box(const TestFolder& folder, const std::filesystem::path& name) {
    int shade = 10;
    for (const char* face : {"right", "left", "top", "bottom", "front", "back"}) {
        const char byte = static_cast<char>(shade);
        folder.write(name / (std::string(face) + ".png"), std::string("P6 1 1 255\n") + byte + byte + byte);
        shade += 10;
    }
}

}  // namespace glint
