#include "app/keys.h"

#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <utility>

#include <gtest/gtest.h>

namespace glint {
namespace {

// The letters of a keyboard that prints `to[i]` where a US keyboard prints `from[i]`.
KeyMap keyboard(const std::string& from, const std::string& to) {
    return KeyMap([=](int key) {
        const auto at = from.find(static_cast<char>(key));
        return std::string(1, at == std::string::npos ? static_cast<char>(key) : to[at]);
    });
}

Action action_of(const KeyMap& map, int key) {
    const KeyBinding* binding = map.find(key, false);
    EXPECT_NE(binding, nullptr) << "key " << key;
    return binding != nullptr ? binding->action : Action::quit;
}

KeyMap dvorak() { return keyboard("QWERTYUIOPASDFGHJKL;ZXCVBNM,./'", "',.PYFGCRLAOEUIDHTNS;QJKXBMWVZ-"); }

TEST(Keys, NoKeyIsBoundTwice) {
    std::set<std::pair<int, bool>> keys;
    for (const KeyBinding& row : key_table())
        EXPECT_TRUE(keys.insert({row.key, row.rule == KeyRule::control}).second) << row.label;
}

// The README's table names every key of the program's (the four arrows as one word).
TEST(Keys, TheReadmeNamesEveryKey) {
    std::ifstream in(GLINT_TESTS "/../README.md");
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    const std::size_t begin = text.find("## Keys"), end = text.find("\n## ", begin + 1);
    ASSERT_NE(end, std::string::npos);
    const std::string keys = text.substr(begin, end - begin);
    const std::set<std::string_view> arrows{"Left", "Right", "Up", "Down"};
    for (const KeyBinding& row : key_table()) {
        const std::string word(arrows.count(row.label) > 0 ? "arrows" : row.label);
        EXPECT_TRUE(
            std::regex_search(keys, std::regex("[ |(,;]" + std::regex_replace(word, std::regex("\\+"), "\\+") + "[ |,;]")))
            << word;
    }
}

TEST(Keys, EveryActionHasOneHelpTextAndALabel) {
    std::map<Action, std::string_view> help;
    for (const KeyBinding& row : key_table()) {
        EXPECT_FALSE(row.help.empty()) << row.label;
        EXPECT_FALSE(row.label.empty()) << row.help;
        EXPECT_EQ(help.emplace(row.action, row.help).first->second, row.help);
    }
    for (int a = 0; a <= static_cast<int>(Action::quit); ++a) EXPECT_TRUE(help.contains(static_cast<Action>(a))) << a;
}

TEST(Keys, HelpHasOneLineForEachActionWithOptionAndState) {
    const std::string text = keys_help(KeyMap(), [](Action a) { return a == Action::toggle_dof ? "STATE" : ""; });
    for (const KeyBinding& row : key_table()) {
        const auto at = text.find(row.help);
        ASSERT_NE(at, std::string::npos) << row.help;
        const std::string line = text.substr(at, text.find('\n', at) - at);
        EXPECT_NE(line.find(row.option), std::string::npos) << line;
        EXPECT_EQ(line.find("STATE") != std::string::npos, row.action == Action::toggle_dof) << line;
    }
    EXPECT_EQ(keys_help(), keys_help(KeyMap(), {}));
    EXPECT_EQ(text.find(" \n"), std::string::npos) << "blanks before a line's end";
}

TEST(Keys, UsKeyboardFollowsTheTable) {
    const KeyMap map;
    for (const KeyBinding& row : key_table()) {
        EXPECT_EQ(map.find(row.key, row.rule == KeyRule::control), row.key > 0 ? &row : nullptr) << row.label;
    }
    EXPECT_EQ(map.find('Q', true)->action, Action::quit);
    EXPECT_EQ(map.find('Q', false)->action, Action::move_down);
    EXPECT_EQ(map.find('O', true), nullptr) << "Ctrl+O is not O";
    EXPECT_EQ(map.find(-1, false), nullptr) << "the code of an unknown key";
    EXPECT_EQ(map.labels(Action::screenshot), "P, F12");
    EXPECT_EQ(map.labels(Action::fast), "Shift");
}

TEST(Keys, MovementGoesByPositionOnAzerty) {
    const KeyMap map = keyboard("QAWZM;0123", "AQZW;M\xe0&\xe9\"");
    EXPECT_EQ(action_of(map, 'W'), Action::move_forward);
    EXPECT_EQ(map.labels(Action::move_forward), "Z");
    EXPECT_EQ(map.labels(Action::move_left), "Q");
    EXPECT_EQ(action_of(map, '1'), Action::accelerator_none) << "a digit that needs Shift keeps its place";
    EXPECT_EQ(map.labels(Action::accelerator_none), "1");
    EXPECT_EQ(map.find('A', true)->action, Action::quit) << "Ctrl+Q goes by the label, which is where a US keyboard has A";
}

TEST(Keys, LettersGoByLabel) {
    const KeyMap map = keyboard("OP", "PO");
    EXPECT_EQ(action_of(map, 'P'), Action::toggle_dof);
    EXPECT_EQ(action_of(map, 'O'), Action::screenshot);
    EXPECT_EQ(map.labels(Action::toggle_dof), "O");
}

TEST(Keys, LetterOnAMovementKeyKeepsItsUsPosition) {
    // Dvorak prints O on the US key S and R on the US key O, so dof needs US O and restart has to give way.
    const KeyMap map = dvorak();
    for (const char key : {'W', 'A', 'S', 'D', 'Q', 'E'}) EXPECT_TRUE(map.find(key, false)->held) << key;
    EXPECT_EQ(action_of(map, 'O'), Action::toggle_dof);
    EXPECT_EQ(action_of(map, 'R'), Action::restart);
    EXPECT_EQ(map.labels(Action::toggle_dof), "R (O of a US keyboard)");
}

TEST(Keys, EveryKeyboardReachesEveryActionByAKeyOfItsOwn) {
    const KeyMap maps[] = {KeyMap(), dvorak(), KeyMap([](int) { return "\xd1\x89"; }), KeyMap([](int) { return ""; })};
    for (const KeyMap& map : maps) {
        std::set<Action> reached;
        for (int key = 1; key < 400; ++key)
            for (const bool control : {false, true})
                if (const KeyBinding* binding = map.find(key, control)) reached.insert(binding->action);
        EXPECT_EQ(reached.size(), static_cast<std::size_t>(Action::quit) + 1 - 2) << "all but the two of the mouse";
    }
}

}  // namespace
}  // namespace glint
