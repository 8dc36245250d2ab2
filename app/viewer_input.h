// Turns the window's events into actions of the session, by the table of keys.
// Knows no renderer and no picture. Invariant: a toggle acts on press, never on repeat; a window without focus holds no key.
#pragma once

#include <functional>

#include "app/session.h"

struct GLFWwindow;

namespace glint {

class ViewerInput {
public:
    // command: called for presses that the session does not act on itself (help, screenshot, quit).
    ViewerInput(GLFWwindow* window, Session& session, std::function<void(Action)> command);
    ~ViewerInput();
    ViewerInput(const ViewerInput&) = delete;
    ViewerInput& operator=(const ViewerInput&) = delete;

    [[nodiscard]] const KeyMap& key_map() const { return key_map_; }
    // Whether the window lost its contents since the last clear_damage().
    [[nodiscard]] bool damaged() const { return damaged_; }
    void clear_damage() { damaged_ = false; }

private:
    static ViewerInput& of(GLFWwindow* window);
    void on_key(int key, int action, int modifiers);
    void on_button(int button, int action);
    void on_cursor(double x, double y);
    void on_focus(bool focused);

    GLFWwindow* window_;
    Session& session_;
    std::function<void(Action)> command_;
    KeyMap key_map_;
    bool dragging_ = false;
    double cursor_x_ = 0.0, cursor_y_ = 0.0;
    bool damaged_ = true;
};

}  // namespace glint
