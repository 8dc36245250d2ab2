#include "core/polygon.h"

#include <cassert>
#include <cmath>
#include <utility>

namespace glint {
namespace {

using Corner = std::uint32_t;

// Twice the signed area of a triangle, positive when it runs counter-clockwise.
double turn(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

// The polygon's normal, twice its area long (Newell's method: right for concave outlines and skewed first corners).
glm::dvec3 area_normal(std::span<const glm::dvec3> p) {
    glm::dvec3 n(0.0);
    // Relative to the first corner, so that a small polygon far from the origin keeps its digits.
    for (std::size_t i = 1; i + 1 < p.size(); ++i) n += glm::cross(p[i] - p[0], p[i + 1] - p[0]);
    return n;
}

// Dropping the normal's largest component keeps coordinates exact; the order of the others keeps the sense of rotation.
std::vector<glm::dvec2> project(std::span<const glm::dvec3> p, glm::dvec3 normal) {
    const glm::dvec3 size = glm::abs(normal);
    const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    int u = (axis + 1) % 3;
    int v = (axis + 2) % 3;
    if (normal[axis] < 0.0) std::swap(u, v);
    std::vector<glm::dvec2> flat;
    flat.reserve(p.size());
    for (const glm::dvec3& q : p) flat.emplace_back(q[u], q[v]);
    return flat;
}

// A counter-clockwise outline that loses one corner after the other.
class Clipper {
public:
    explicit Clipper(std::vector<glm::dvec2> flat) : at_(std::move(flat)), left_(at_.size()) {
        const auto n = static_cast<Corner>(left_);
        for (Corner i = 0; i < n; ++i) {
            next_.push_back(i + 1 < n ? i + 1 : 0);
            previous_.push_back(i > 0 ? i - 1 : n - 1);
        }
        blocks_.resize(left_);
        for (Corner i = 0; i < n; ++i) {
            blocks_[i] = corner(i) <= 0.0;
            if (blocks_[i]) blockers_.push_back(i);
        }
    }

    Triangulation run() {
        // Clipping an ear changes whether a corner is one only for its two neighbours (Eberly), so each corner is looked at
        // once at first and twice per ear: corners times reflex corners in all.
        std::vector<Corner> queue;
        for (Corner i = 0; i < at_.size(); ++i) queue.push_back(i);
        for (std::size_t k = 0; k < queue.size() && left_ > 3; ++k) {
            const Corner i = queue[k];
            if (next_[i] == kGone || !is_ear(i)) continue;
            const Corner a = previous_[i];
            const Corner c = next_[i];
            clip(i);
            queue.push_back(a);
            queue.push_back(c);
        }
        finish_crossed();
        return std::move(result_);
    }

private:
    static constexpr Corner kGone = 0xffffffffu;

    [[nodiscard]] double corner(Corner i) const { return turn(at_[previous_[i]], at_[i], at_[next_[i]]); }

    // A straight corner counts as an ear: it leaves without a triangle.
    [[nodiscard]] bool is_ear(Corner i) const {
        const glm::dvec2 a = at_[previous_[i]];
        const glm::dvec2 b = at_[i];
        const glm::dvec2 c = at_[next_[i]];
        const double area = turn(a, b, c);
        if (area <= 0.0) return area == 0.0;
        for (const Corner j : blockers_) {
            const glm::dvec2 q = at_[j];
            // Corners that share a place with one of the ear's do not hinder it: outlines with a bridge to a hole repeat points.
            if (!blocks_[j] || q == a || q == b || q == c) continue;
            if (turn(a, b, q) >= 0.0 && turn(b, c, q) >= 0.0 && turn(c, a, q) >= 0.0) return false;
        }
        return true;
    }

    void clip(Corner i) {
        const Corner a = previous_[i];
        const Corner c = next_[i];
        if (corner(i) > 0.0) result_.triangles.push_back({a, i, c});
        next_[a] = c;
        previous_[c] = a;
        next_[i] = kGone;
        blocks_[i] = false;
        --left_;
        head_ = a;
        // A corner that was convex stays convex when an ear beside it goes, so the list of blockers never grows.
        blocks_[a] = blocks_[a] && corner(a) <= 0.0;
        blocks_[c] = blocks_[c] && corner(c) <= 0.0;
    }

    // What is left is a triangle, or an outline that crosses itself: then corners go without asking what lies inside.
    void finish_crossed() {
        std::size_t refused = 0;
        for (Corner i = head_; left_ > 3 && refused < left_;) {
            const Corner after = next_[i];
            if (corner(i) >= 0.0) {
                result_.simple = false;
                clip(i);
                refused = 0;
            } else {
                ++refused;
            }
            i = after;
        }
        if (left_ > 3 || corner(head_) < 0.0) result_.simple = false;
        if (left_ == 3 && corner(head_) > 0.0) result_.triangles.push_back({previous_[head_], head_, next_[head_]});
    }

    std::vector<glm::dvec2> at_;
    std::vector<Corner> next_, previous_;
    std::vector<bool> blocks_;      // reflex or straight: can lie inside another corner's ear
    std::vector<Corner> blockers_;  // a superset of those corners
    std::size_t left_;
    Corner head_ = 0;
    Triangulation result_;
};

}  // namespace

Triangulation triangulate(std::span<const glm::dvec3> corners) {
    assert(corners.size() <= kMaxPolygonCorners);
    if (corners.size() < 3) return {};
    const glm::dvec3 normal = area_normal(corners);
    if (normal == glm::dvec3(0.0)) return {};
    if (corners.size() == 3) return {{{0, 1, 2}}, true};
    Triangulation result = Clipper(project(corners, normal)).run();
    const glm::dvec3 front = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (glm::dot(front, normal) < 0.0) {
        for (auto& triangle : result.triangles) std::swap(triangle[1], triangle[2]);
    }
    return result;
}

}  // namespace glint
