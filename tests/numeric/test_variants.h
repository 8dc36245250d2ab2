// Tests of a ray against one primitive in several arithmetics: how far t is from the truth, and what a test costs.
// Knows no accelerator. Invariant: all variants get the same rays; the truth is computed in long double from the same floats.
#pragma once

#include <string>
#include <vector>

#include "accel/ray.h"

namespace glint::numeric {

struct Variant {
    PrimitiveKind primitive;
    const char* name;
    bool ours;
    int hits = 0;                                // that it and the truth report
    int wrong = 0;                               // hits where there is none, or the other way round
    double median = 0.0, p99 = 0.0, most = 0.0;  // error of t in units in its last place
    double nanoseconds = 0.0;                    // of one test, the least of `repeats` rounds
};

// Every primitive, size 1, from 1 to 10^4 sizes away, `cases` rays to near its middle, half of them hits.
[[nodiscard]] std::vector<Variant> measure_variants(int cases, int repeats);

}  // namespace glint::numeric
