#include "verify.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace glint::bench {
namespace {

constexpr float kPeerTolerance = 1e-4f;  // of t
constexpr std::size_t kBruteForceTests = 200'000'000, kFewestSampled = 200, kMostSampled = 2000;

bool same_bits(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }

// u and v of a miss mean nothing.
bool same(const Hit& a, const Hit& b) {
    if (a.primitive != b.primitive) return false;
    return !a.found() || (same_bits(a.t, b.t) && same_bits(a.u, b.u) && same_bits(a.v, b.v));
}

void compare_with_peer(const Answers& ours, const Answers& theirs, bool any, Check& check) {
    for (std::size_t i = 0; i < check.rays; ++i) {
        if (any) {
            check.peer_hit_or_miss += ours.is_occluded(i) != theirs.is_occluded(i);
            continue;
        }
        const Hit a = ours.hit(i), b = theirs.hit(i);
        if (a.found() != b.found()) {
            ++check.peer_hit_or_miss;
        } else if (a.found() && a.primitive != b.primitive && std::abs(a.t - b.t) > kPeerTolerance * a.t) {
            ++check.peer_distance;
        }
    }
}

}  // namespace

Check check(const Competitors& competitors, const RaySet& set, const BruteForce& brute_force, std::size_t primitives) {
    using Role = Competitor::Role;
    Check result;
    result.set = set.name;
    result.rays = set.rays.size();
    Answers reference(result.rays);
    const auto single =
        std::find_if(competitors.begin(), competitors.end(), [](const auto& c) { return c->role() == Role::bvh_single; });
    trace(**single, set, reference);
    for (std::size_t i = 0; i < result.rays; ++i) result.hits += set.any ? reference.is_occluded(i) : reference.hit(i).found();
    for (const auto& competitor : competitors) {
        if (competitor == *single || !(competitor->is_glint() || competitor->role() == Role::embree_robust)) continue;
        Answers answers(result.rays);
        trace(*competitor, set, answers);
        if (!competitor->is_glint()) {
            compare_with_peer(reference, answers, set.any, result);
            continue;
        }
        for (std::size_t i = 0; i < result.rays; ++i) {
            const bool agree =
                set.any ? reference.is_occluded(i) == answers.is_occluded(i) : same(reference.hit(i), answers.hit(i));
            result.paths_differ += !agree;
        }
    }
    const std::size_t wanted = std::clamp(kBruteForceTests / std::max<std::size_t>(primitives, 1), kFewestSampled, kMostSampled);
    const std::size_t step = std::max<std::size_t>(result.rays / wanted, 1);
    for (std::size_t i = 0; i < result.rays; i += step) {
        const bool agree = set.any ? brute_force.occluded(set.rays[i]) == reference.is_occluded(i)
                                   : same(brute_force.closest_hit(set.rays[i]), reference.hit(i));
        result.brute_force_differs += !agree;
        ++result.sampled;
    }
    return result;
}

}  // namespace glint::bench
