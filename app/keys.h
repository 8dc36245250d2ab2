// The one table of keys: what each does, how it is printed, and which option does the same on the command line.
// Help, README and tests come from it. Knows no window: key codes are GLFW's, written as plain numbers.
// Movement goes by key position (a US layout's codes), letters and digits by what is printed on the user's keys.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace glint {

enum class Action {
    move_forward,
    move_back,
    move_left,
    move_right,
    move_down,
    move_up,
    look_left,
    look_right,
    look_up,
    look_down,
    fast,
    slow,
    look_drag,
    fly_speed,
    accelerator_auto,
    accelerator_none,
    accelerator_grid,
    accelerator_bvh,
    toggle_dof,
    toggle_soft,
    toggle_fuzzy,
    toggle_aa,
    toggle_fresnel,
    exposure_up,
    exposure_down,
    pause,
    restart,
    screenshot,
    camera_home,
    help,
    quit
};

// position: the place on the keyboard decides. label: the printed letter decides. control: as label, together with Ctrl.
enum class KeyRule { position, label, control };

struct KeyBinding {
    int key;  // code of the key on a US layout; negative for the mouse
    KeyRule rule;
    std::string_view label;  // as printed on a US keyboard
    Action action;
    bool held;  // acts for as long as it is down, not once per press
    std::string_view help;
    std::string_view option;  // the same choice on the command line; empty where there is none
};

constexpr int kMouseLeftDrag = -100;  // not -1, which is GLFW's unknown key
constexpr int kMouseScroll = -101;

// Every binding, in the order of the help text; rows of one action stand together.
[[nodiscard]] std::span<const KeyBinding> key_table();

// What is printed on the key with this US code on the user's keyboard; empty when it is not known.
using PrintedLabel = std::function<std::string(int key)>;

// Which key does what on one keyboard. Where the label of a letter lies on a movement key (AZERTY, Dvorak), or nowhere
// (Cyrillic), the letter keeps its US position, and so does any letter whose key that takes away.
class KeyMap {
public:
    KeyMap();  // a US keyboard
    explicit KeyMap(const PrintedLabel& printed);

    // The binding that this key, with or without Ctrl, triggers; null when there is none.
    [[nodiscard]] const KeyBinding* find(int key, bool control) const;
    // The user's own labels of an action's keys, for example "P, F12".
    [[nodiscard]] std::string labels(Action action) const;

private:
    struct Place {
        int key;
        std::string label;
    };
    std::vector<Place> places_;  // one for each row of key_table()
};

// The state of an action's setting for the help text ("on", "off", a reason why it cannot act); may be empty.
using ActionState = std::function<std::string(Action)>;

// The help text: one line an action, each ended by a newline.
[[nodiscard]] std::string keys_help();
[[nodiscard]] std::string keys_help(const KeyMap& map, const ActionState& state);

}  // namespace glint
