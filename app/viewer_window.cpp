#include "app/viewer_window.h"

#include <algorithm>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace glint {
namespace {

// GLFW tells reasons only through a callback; the last one is kept for the line that the user sees.
std::string& last_error() {
    static std::string error;
    return error;
}

void remember_error(int, const char* description) { last_error() = description; }

[[noreturn]] void fail(const std::string& what) {
    const std::string reason = last_error();
    glfwTerminate();
    throw WindowError(reason.empty() ? what : what + " (" + reason.substr(0, reason.find('\n')) + ")");
}

// Shrinks to nine tenths of the monitor at most, which leaves room for the frame and the title.
Extent fitted(Extent wanted) {
    GLFWmonitor* monitor = glfwGetPrimaryMonitor();
    if (monitor == nullptr) return wanted;
    int x = 0, y = 0, width = 0, height = 0;
    glfwGetMonitorWorkarea(monitor, &x, &y, &width, &height);
    if (width <= 0 || height <= 0) return wanted;
    const double scale = std::min({1.0, 0.9 * width / wanted.width, 0.9 * height / wanted.height});
    return {std::max(1, static_cast<int>(wanted.width * scale)), std::max(1, static_cast<int>(wanted.height * scale))};
}

}  // namespace

ViewerWindow::ViewerWindow(Extent wanted, bool fit, const std::string& title) : title_(title) {
    last_error().clear();
    glfwSetErrorCallback(remember_error);
    if (glfwInit() != GLFW_TRUE) fail("no display");
    const Extent size = fit ? fitted(wanted) : wanted;
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    // A flat picture needs neither; eight bits a channel and no sRGB framebuffer are GLFW's defaults.
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    glfwWindowHintString(GLFW_X11_CLASS_NAME, "glint");
    glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "glint");
    window_ = glfwCreateWindow(size.width, size.height, title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) fail("no OpenGL 3.3");
    glfwMakeContextCurrent(window_);
    // The viewer paces itself; waiting for the screen here could stop it for as long as the window is hidden.
    glfwSwapInterval(0);
}

ViewerWindow::~ViewerWindow() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

Extent ViewerWindow::framebuffer() const {
    Extent size;
    glfwGetFramebufferSize(window_, &size.width, &size.height);
    return size;
}

bool ViewerWindow::should_close() const { return glfwWindowShouldClose(window_) == GLFW_TRUE; }

void ViewerWindow::close() { glfwSetWindowShouldClose(window_, GLFW_TRUE); }

void ViewerWindow::set_title(const std::string& title) {
    if (title == title_) return;
    title_ = title;
    glfwSetWindowTitle(window_, title.c_str());
}

void ViewerWindow::swap() { glfwSwapBuffers(window_); }

void ViewerWindow::wait_events(double seconds) { glfwWaitEventsTimeout(seconds); }

}  // namespace glint
