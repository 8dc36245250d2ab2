// The line on stderr that says what is being measured and how long it will still take.
// Knows no measurement: those who measure plan their seconds and report what they did.
#pragma once

#include <chrono>
#include <string>

namespace glint::chart {

class Meter {
public:
    explicit Meter(bool quiet);
    // More work, in seconds as estimated beforehand; less of it where negative.
    void plan(double seconds) { planned_ += seconds; }
    // What comes now.
    void say(const std::string& what);
    // Work of that estimate is done.
    void did(double seconds);
    [[nodiscard]] double elapsed() const;
    void end() const;

private:
    void show();

    bool quiet_, terminal_;
    std::string what_;
    double planned_ = 0.0, done_ = 0.0, next_ = 0.0;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace glint::chart
