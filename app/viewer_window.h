// One GLFW window with a current OpenGL 3.3 core context, as an owner. Knows no picture and no keys.
// Invariant: at most one exists at a time, and only the thread that made it uses it (GLFW's rule).
#pragma once

#include <stdexcept>
#include <string>

struct GLFWwindow;

namespace glint {

// No display, or no OpenGL; the message is one line.
class WindowError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

struct Extent {
    int width = 0, height = 0;
};

class ViewerWindow {
public:
    // fit: a size larger than the monitor is made smaller, its shape kept. Throws WindowError.
    ViewerWindow(Extent wanted, bool fit, const std::string& title);
    ~ViewerWindow();
    ViewerWindow(const ViewerWindow&) = delete;
    ViewerWindow& operator=(const ViewerWindow&) = delete;

    [[nodiscard]] GLFWwindow* handle() const { return window_; }
    [[nodiscard]] Extent framebuffer() const;  // pixels, which on some displays differ from window units
    [[nodiscard]] bool should_close() const;
    void close();
    void set_title(const std::string& title);  // does nothing when the title is this one
    void swap();
    void wait_events(double seconds);

private:
    GLFWwindow* window_ = nullptr;
    std::string title_;
};

}  // namespace glint
