#include "app/viewer_input.h"

#include <numbers>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace glint {
namespace {

std::string printed_label(int key) {
    const char* name = glfwGetKeyName(key, 0);
    return name != nullptr ? name : "";
}

}  // namespace

ViewerInput::ViewerInput(GLFWwindow* window, Session& session, std::function<void(Action)> command)
    : window_(window), session_(session), command_(std::move(command)), key_map_(printed_label) {
    glfwSetWindowUserPointer(window, this);
    glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int mods) { of(w).on_key(key, action, mods); });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int) { of(w).on_button(button, action); });
    glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) { of(w).on_cursor(x, y); });
    glfwSetScrollCallback(window, [](GLFWwindow* w, double, double dy) { of(w).session_.change_speed(dy); });
    glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int focused) { of(w).on_focus(focused == GLFW_TRUE); });
    glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int width, int height) {
        of(w).session_.resize(width, height);
        of(w).damaged_ = true;
    });
    glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { of(w).damaged_ = true; });
    int width = 0, height = 0;
    glfwGetFramebufferSize(window, &width, &height);
    session_.resize(width, height);
    glfwGetCursorPos(window, &cursor_x_, &cursor_y_);
}

ViewerInput::~ViewerInput() {
    glfwSetKeyCallback(window_, nullptr);
    glfwSetMouseButtonCallback(window_, nullptr);
    glfwSetCursorPosCallback(window_, nullptr);
    glfwSetScrollCallback(window_, nullptr);
    glfwSetWindowFocusCallback(window_, nullptr);
    glfwSetFramebufferSizeCallback(window_, nullptr);
    glfwSetWindowRefreshCallback(window_, nullptr);
}

ViewerInput& ViewerInput::of(GLFWwindow* window) { return *static_cast<ViewerInput*>(glfwGetWindowUserPointer(window)); }

void ViewerInput::on_key(int key, int action, int modifiers) {
    // Released whatever Ctrl says now: it may have changed since the press.
    if (action == GLFW_RELEASE) return session_.release(key);
    if (action != GLFW_PRESS) return;
    const KeyBinding* binding = key_map_.find(key, (modifiers & GLFW_MOD_CONTROL) != 0);
    if (binding == nullptr) return;
    if (binding->held) return session_.hold(key, binding->action);
    session_.apply(binding->action);
    command_(binding->action);
}

void ViewerInput::on_button(int button, int action) {
    // The drag starts where the last event left the pointer; where it is by now would lose what moved in between.
    if (button == GLFW_MOUSE_BUTTON_LEFT) dragging_ = action == GLFW_PRESS;
}

void ViewerInput::on_cursor(double x, double y) {
    const double right = x - std::exchange(cursor_x_, x), up = std::exchange(cursor_y_, y) - y;
    if (!dragging_) return;
    int width = 0, height = 0;
    glfwGetWindowSize(window_, &width, &height);
    // A drag over the whole height turns by the whole view angle, so the scene keeps up with the pointer.
    const double degrees = height > 0 ? static_cast<double>(session_.camera().view_angle) / height : 0.0;
    const double radians = degrees * std::numbers::pi / 180.0;
    session_.look(right * radians, up * radians);
}

void ViewerInput::on_focus(bool focused) {
    dragging_ = false;
    session_.release_all();
    // The keyboard's layout may have been switched meanwhile.
    if (focused) key_map_ = KeyMap(printed_label);
}

}  // namespace glint
