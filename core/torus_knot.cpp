#include "core/torus_knot.h"

#include <cmath>
#include <cstddef>

namespace glint {
namespace {

constexpr double kTau = 6.28318530717958647692;
// The torus has radii 2 and 1; the strands of the knot lie 2 apart.
constexpr double kMajor = 2.0, kTube = 0.55;
constexpr double kAspect = 8.0;  // of rings to columns: the tube is that many times longer than around

// Waves along and around the tube, as fractions of its radius. Their slopes are alike, as rough surfaces have it, so that
// triangles vary in size and shape at every scale.
struct Wave {
    double height, along, around, phase;
};
constexpr std::array<Wave, 6> kWaves{{{0.120, 9.0, 2.0, 0.10},
                                      {0.070, -23.0, 3.0, 0.37},
                                      {0.040, 53.0, -5.0, 0.71},
                                      {0.020, -121.0, 9.0, 0.23},
                                      {0.009, 271.0, 17.0, 0.89},
                                      {0.004, -601.0, 31.0, 0.53}}};

struct Turn {
    double sin, cos;
};

// Sine and cosine of t turns by their Taylor series within an eighth of a turn. A math library's last bits differ between
// machines; these do not. Error below 1e-15.
Turn turn(double t) {
    const double quarter = std::floor(4.0 * t + 0.5);
    const double x = kTau * (t - 0.25 * quarter), x2 = x * x;
    double s = 0.0, c = 0.0;
    for (int k = 16; k >= 2; k -= 2) {
        s = (1.0 - s) * x2 / static_cast<double>(k * (k + 1));
        c = (1.0 - c) * x2 / static_cast<double>(k * (k - 1));
    }
    s = (1.0 - s) * x;
    c = 1.0 - c;
    switch (static_cast<long long>(quarter) & 3) {
        case 0: return {s, c};
        case 1: return {c, -s};
        case 2: return {-s, -c};
        default: return {-c, s};
    }
}

using Waves = std::array<Turn, kWaves.size()>;

// Everything about a ring of the tube, at `at` turns of the knot's parameter.
struct Ring {
    glm::dvec3 center, out, side;  // of the torus' surface there; across the tube
    Waves waves;

    explicit Ring(double at) {
        // Rings are three times as dense in some places as in others.
        const double u = at + 0.03 * turn(3.0 * at + 0.2).sin;
        const Turn p = turn(2.0 * u), q = turn(3.0 * u);
        const double r = kMajor + q.cos;
        center = {r * p.cos, r * p.sin, q.sin};
        // The torus' normal is a frame that closes and is at right angles to every curve on the torus.
        out = {q.cos * p.cos, q.cos * p.sin, q.sin};
        const glm::dvec3 along(-2.0 * r * p.sin - 3.0 * q.sin * p.cos, 2.0 * r * p.cos - 3.0 * q.sin * p.sin, 3.0 * q.cos);
        side = glm::cross(along / std::sqrt(glm::dot(along, along)), out);
        for (std::size_t k = 0; k < kWaves.size(); ++k) waves[k] = turn(kWaves[k].along * u + kWaves[k].phase);
    }
};

// Everything about a line along the tube, at `at` turns around it.
struct Column {
    Turn direction;
    Waves waves;

    explicit Column(double at) {
        const double v = at + 0.05 * turn(2.0 * at).sin;
        direction = turn(v);
        for (std::size_t k = 0; k < kWaves.size(); ++k) waves[k] = turn(kWaves[k].around * v);
    }
};

glm::vec3 surface_point(const Ring& ring, const Column& column) {
    double radius = 1.0;
    for (std::size_t k = 0; k < kWaves.size(); ++k) {
        radius += kWaves[k].height * (ring.waves[k].sin * column.waves[k].cos + ring.waves[k].cos * column.waves[k].sin);
    }
    const glm::dvec3 across = column.direction.cos * ring.out + column.direction.sin * ring.side;
    return glm::vec3(kKnotScale * (ring.center - kKnotCenter + kTube * radius * across));
}

// What a division into rings and columns lacks to the wished count: a vertex more in the middle of a triangle makes three
// triangles of one. Spread over the mesh; the two triangles of quad q are 2q and 2q + 1.
void split_triangles(KnotMesh& mesh, std::size_t splits, std::size_t rings, std::size_t columns) {
    const std::size_t quads = rings * columns;
    for (std::size_t k = 0; k < splits; ++k) {
        const std::size_t quad = k * quads / splits;
        const double i = static_cast<double>(quad / columns) + 1.0 / 3.0, j = static_cast<double>(quad % columns) + 1.0 / 3.0;
        const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(surface_point(Ring(i / static_cast<double>(rings)), Column(j / static_cast<double>(columns))));
        const auto [a, b, c] = mesh.triangles[2 * quad];
        mesh.triangles[2 * quad] = {a, b, middle};
        mesh.triangles.push_back({b, c, middle});
        mesh.triangles.push_back({c, a, middle});
    }
}

}  // namespace

KnotMesh torus_knot(int n) {
    const auto quads_wanted = static_cast<std::size_t>(n / 2);
    const auto columns = static_cast<std::size_t>(std::sqrt(static_cast<double>(quads_wanted) / kAspect));
    const std::size_t rings = quads_wanted / columns, splits = quads_wanted - rings * columns;
    KnotMesh mesh;
    mesh.vertices.reserve(rings * columns + splits);
    mesh.triangles.reserve(2 * (rings * columns + splits));
    std::vector<Column> lines;
    lines.reserve(columns);
    for (std::size_t j = 0; j < columns; ++j) lines.emplace_back(static_cast<double>(j) / static_cast<double>(columns));
    const auto vertex = [&](std::size_t i, std::size_t j) {
        return static_cast<std::uint32_t>((i % rings) * columns + j % columns);
    };
    for (std::size_t i = 0; i < rings; ++i) {
        const Ring ring(static_cast<double>(i) / static_cast<double>(rings));
        for (const Column& column : lines) mesh.vertices.push_back(surface_point(ring, column));
        for (std::size_t j = 0; j < columns; ++j) {
            const std::uint32_t a = vertex(i, j), b = vertex(i, j + 1), c = vertex(i + 1, j + 1), d = vertex(i + 1, j);
            mesh.triangles.push_back({a, b, d});
            mesh.triangles.push_back({b, c, d});
        }
    }
    split_triangles(mesh, splits, rings, columns);
    return mesh;
}

}  // namespace glint
