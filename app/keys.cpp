#include "app/keys.h"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>

namespace glint {
namespace {

// GLFW's codes of the keys that are not printable; printable keys have their upper case ASCII code.
enum : int {
    kEscape = 256,
    kRight = 262,
    kLeft = 263,
    kDown = 264,
    kUp = 265,
    kPageUp = 266,
    kPageDown = 267,
    kHome = 268,
    kF1 = 290,
    kF12 = 301,
    kLeftShift = 340,
    kLeftAlt = 342,
    kRightShift = 344,
    kRightAlt = 346
};

using enum Action;
using enum KeyRule;

constexpr bool kHeld = true, kPress = false;

constexpr std::array kTable{
    KeyBinding{'W', position, "W", move_forward, kHeld, "fly forward", ""},
    KeyBinding{'S', position, "S", move_back, kHeld, "fly back", ""},
    KeyBinding{'A', position, "A", move_left, kHeld, "fly left", ""},
    KeyBinding{'D', position, "D", move_right, kHeld, "fly right", ""},
    KeyBinding{'Q', position, "Q", move_down, kHeld, "fly down", ""},
    KeyBinding{'E', position, "E", move_up, kHeld, "fly up", ""},
    KeyBinding{kLeft, position, "Left", look_left, kHeld, "look left", ""},
    KeyBinding{kRight, position, "Right", look_right, kHeld, "look right", ""},
    KeyBinding{kUp, position, "Up", look_up, kHeld, "look up", ""},
    KeyBinding{kDown, position, "Down", look_down, kHeld, "look down", ""},
    KeyBinding{kLeftShift, position, "Shift", fast, kHeld, "fly 4 times faster", ""},
    KeyBinding{kRightShift, position, "Shift", fast, kHeld, "fly 4 times faster", ""},
    KeyBinding{kLeftAlt, position, "Alt", slow, kHeld, "fly 4 times slower", ""},
    KeyBinding{kRightAlt, position, "Alt", slow, kHeld, "fly 4 times slower", ""},
    KeyBinding{kMouseLeftDrag, position, "left drag", look_drag, kHeld, "look around", ""},
    KeyBinding{kMouseScroll, position, "scroll", fly_speed, kHeld, "flying speed", ""},
    KeyBinding{kHome, position, "Home", camera_home, kPress, "camera as loaded", ""},
    KeyBinding{'0', label, "0", accelerator_auto, kPress, "accelerator chosen for the scene", "--accel auto"},
    KeyBinding{'1', label, "1", accelerator_none, kPress, "no accelerator", "--accel none"},
    KeyBinding{'2', label, "2", accelerator_grid, kPress, "uniform grid", "--accel grid"},
    KeyBinding{'3', label, "3", accelerator_bvh, kPress, "bounding volume hierarchy", "--accel bvh"},
    KeyBinding{'O', label, "O", toggle_dof, kPress, "depth of field", "--features dof"},
    KeyBinding{'L', label, "L", toggle_soft, kPress, "soft shadows", "--features soft"},
    KeyBinding{'F', label, "F", toggle_fuzzy, kPress, "fuzzy reflection", "--features fuzzy"},
    KeyBinding{'J', label, "J", toggle_aa, kPress, "jittered anti-aliasing", "--features aa"},
    KeyBinding{'X', label, "X", toggle_fresnel, kPress, "exact Fresnel or Schlick", "--fresnel"},
    KeyBinding{kPageUp, position, "PgUp", exposure_up, kPress, "exposure + 1/3 stop", "--exposure"},
    KeyBinding{kPageDown, position, "PgDn", exposure_down, kPress, "exposure - 1/3 stop", "--exposure"},
    KeyBinding{' ', position, "Space", pause, kPress, "pause", ""},
    KeyBinding{'R', label, "R", restart, kPress, "restart the picture", ""},
    KeyBinding{'P', label, "P", screenshot, kPress, "screenshot", "render -o"},
    KeyBinding{kF12, position, "F12", screenshot, kPress, "screenshot", "render -o"},
    KeyBinding{'H', label, "H", help, kPress, "this help", "--help"},
    KeyBinding{kF1, position, "F1", help, kPress, "this help", "--help"},
    KeyBinding{kEscape, position, "Esc", quit, kPress, "quit", ""},
    KeyBinding{'Q', control, "Ctrl+Q", quit, kPress, "quit", ""},
};

std::string upper(std::string text) {
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

// The letter or digit of a row that goes by label.
std::string letter_of(const KeyBinding& row) { return std::string(row.label.substr(row.label.size() - 1)); }

// The keys that print something and so may carry another label than on a US keyboard.
constexpr std::string_view kPrintable = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789'-=[]\\;`,./";

bool is_movement(int key) {
    return std::ranges::any_of(kTable, [&](const KeyBinding& row) { return row.rule == position && row.key == key; });
}

int key_labelled(const PrintedLabel& printed, const std::string& letter) {
    for (const char key : kPrintable)
        if (upper(printed(key)) == letter) return key;
    return 0;
}

}  // namespace

std::span<const KeyBinding> key_table() { return kTable; }

KeyMap::KeyMap() : KeyMap([](int key) { return std::string(1, static_cast<char>(key)); }) {}

KeyMap::KeyMap(const PrintedLabel& printed) {
    for (const KeyBinding& row : kTable) {
        int key = row.key;
        std::string name(row.label);
        if (row.rule != position) {
            const int labelled = key_labelled(printed, letter_of(row));
            if (labelled != 0) key = labelled;
        } else if (key > ' ' && key < kEscape) {
            // Movement stays where it is; only its name is the user's own.
            if (const std::string own = upper(printed(key)); !own.empty()) name = own;
        }
        places_.push_back({key, name});
    }
    // A letter whose key is taken goes to its US position, which may take the key of another letter in turn. Every round
    // moves at least one letter there for good, and US positions are all different, so this ends.
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t i = 0; i < kTable.size(); ++i) {
            if (kTable[i].rule != label || places_[i].key == kTable[i].key) continue;
            const bool taken =
                is_movement(places_[i].key) || std::ranges::any_of(kTable, [&](const KeyBinding& other) {
                    const auto at = static_cast<std::size_t>(&other - kTable.data());
                    return at != i && other.rule == label && places_[at].key == other.key && other.key == places_[i].key;
                });
            if (!taken) continue;
            places_[i].key = kTable[i].key;
            changed = true;
        }
    }
    // A letter away from its label is named by what the key prints, so that the help tells where to press. Digits are on
    // every keyboard's top row, even where they need Shift (AZERTY), and keep their name.
    for (std::size_t i = 0; i < kTable.size(); ++i) {
        if (kTable[i].rule != label || kTable[i].key <= '9') continue;
        const std::string own = upper(printed(places_[i].key));
        if (!own.empty() && own != kTable[i].label)
            places_[i].label = fmt::format("{} ({} of a US keyboard)", own, kTable[i].label);
    }
}

const KeyBinding* KeyMap::find(int key, bool control_down) const {
    if (key <= 0) return nullptr;  // the mouse, and keys that have no code
    for (std::size_t i = 0; i < kTable.size(); ++i)
        if (places_[i].key == key && (kTable[i].rule == control) == control_down) return &kTable[i];
    return nullptr;
}

std::string KeyMap::labels(Action action) const {
    std::string text;
    for (std::size_t i = 0; i < kTable.size(); ++i) {
        if (kTable[i].action != action || (i > 0 && kTable[i - 1].action == action && places_[i - 1].label == places_[i].label))
            continue;
        text += (text.empty() ? "" : ", ") + places_[i].label;
    }
    return text;
}

std::string keys_help() { return keys_help(KeyMap(), {}); }

std::string keys_help(const KeyMap& map, const ActionState& state) {
    std::size_t width = 0;
    for (const KeyBinding& row : kTable) width = std::max(width, map.labels(row.action).size());
    std::string text;
    for (std::size_t i = 0; i < kTable.size(); ++i) {
        const KeyBinding& row = kTable[i];
        if (i > 0 && kTable[i - 1].action == row.action) continue;
        std::string line = fmt::format("  {:<{}}  {:<34}", map.labels(row.action), width, row.help);
        const std::string now = state ? state(row.action) : std::string();
        if (!row.option.empty() || !now.empty()) line += fmt::format("{:<18}", row.option);
        if (!now.empty()) line += now;
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + '\n';
    }
    return text;
}

}  // namespace glint
