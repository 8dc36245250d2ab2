// What core asks of the machine's threads beyond std::jthread: builds spread over some, politeness, a processor to keep to.
// Knows no scene. Invariant: no more threads work at a time than were asked for, the calling one included.
#pragma once

#include <exception>
#include <stop_token>

#include "accel/parallel.h"

namespace glint {

// Thrown through a loop whose result nobody waits for any more.
class Abandoned : public std::exception {
public:
    [[nodiscard]] const char* what() const noexcept override { return "abandoned"; }
};

// A loop over up to `threads` threads, on oneTBB; the first exception of a task reaches the caller. Once `stop` is requested the
// next task throws Abandoned instead of working.
[[nodiscard]] ParallelFor parallel_for_on(int threads, std::stop_token stop = {});

// The calling thread, and threads it starts from now on, yield to those of normal priority: a window must stay responsive on a
// machine whose cores are all rendering.
void lower_priority();

// How many processors the calling thread may use; at least 1.
[[nodiscard]] int usable_processors();

// Keeps the calling thread on the index-th of the processors it may use, counted round. False where the system refuses.
bool pin_to_processor(int index);

}  // namespace glint
