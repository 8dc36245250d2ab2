// Spheres far away and spheres that are a floor: what is left of b^2 - 4ac in float.

#include "tests/gallery/exhibit.h"
#include "tests/gallery/stage.h"
#include "tests/gallery/textbook.h"

namespace glint::gallery {
namespace {

// The nearest distance > 0, or 0 for a miss.
long double exact_distance(const Ray& ray, const Sphere& sphere) {
    long double a = 0, b = 0, c = -static_cast<long double>(sphere.radius) * sphere.radius;
    for (int i = 0; i < 3; ++i) {
        const long double f = static_cast<long double>(ray.origin[i]) - sphere.center[i], d = ray.direction[i];
        a += d * d, b -= f * d, c += f * f;
    }
    const long double discriminant = b * b - a * c;
    if (discriminant < 0) return 0;
    const long double q = b + std::copysign(std::sqrt(discriminant), b), t0 = c / q, t1 = q / a;
    return std::min(t0, t1) > 0 ? std::min(t0, t1) : std::max<long double>(0, std::max(t0, t1));
}

const char* const kTextbookCode =
    "f = o - center;                        // all in float\nb = 2 * dot(f, d);  c = dot(f, f) - r*r;\n"
    "disc = b*b - 4*a*c;\nt = (-b - sqrt(disc)) / (2*a);";
const char* const kOurCode =
    "b = -dot(f, d);                        // in double, from float data\nnearest = f + (b/a) * d;\n"
    "disc = r*r - dot(nearest, nearest);\nq = b + copysign(sqrt(a * disc), b);\nt0 = c / q;  t1 = q / a;";

using Distance = float (*)(const Stage&, const Ray&, const Sphere&);
float naive(const Stage&, const Ray& ray, const Sphere& s) {
    return textbook::quadratic_sphere(ray.origin, ray.direction, s.center, s.radius);
}
float product(const Stage& stage, const Ray& ray, const Sphere&) {
    const Hit hit = stage.hit(ray);
    return hit.found() ? hit.t : 0.0f;
}

// Whether t is off by more than the rounding of the result itself, or a hit and a miss are confused.
bool wrong(float t, long double exact, long double tolerance) {
    if ((t > 0.0f) != (exact > 0)) return true;
    return std::abs(static_cast<long double>(t) - exact) > tolerance * exact;
}

}  // namespace

Exhibit far_spheres(int width) {
    Exhibit e{
        "S-SPH-01",
        "Spheres far away",
        "A ball of radius 1, each time magnified to the same size, from a distance of 100, 1000, 4096 and 10,000: "
        "<i>b</i>&sup2; and 4<i>ac</i> agree in almost all digits, and their difference, which holds the radius, is mostly "
        "rounding.",
        "glint measures how far the ray passes the centre, <i>r</i>&sup2; less the square of that (Haines, G&uuml;nther &amp; "
        "Akenine-M&ouml;ller 2019), and does so in double, so only the result is rounded.",
        "pixels with a distance off by more than 2&thinsp;&middot;&thinsp;2<sup>&minus;24</sup>, or a wrong hit or miss",
        kTextbookCode,
        kOurCode,
        {},
        {}};
    const int size = width / 4;
    const float distances[] = {100.0f, 1000.0f, 4096.0f, 10000.0f};
    const auto draw = [&](Distance distance) {
        Side side;
        Image image{width, size, std::vector<glm::vec3>(static_cast<std::size_t>(width * size))};
        for (int i = 0; i < 4; ++i) {
            const float far = distances[i];
            const CameraPose pose = camera_at({0, 0, 0}, {0, 0, -1},
                                              static_cast<float>(2.0 * std::atan(1.25 / static_cast<double>(far)) * 180.0 / kPi));
            SceneBuilder b;
            const Sphere ball{{0, 0, -far}, 1.0f};
            b.add(ball, b.add_material(matte(glm::vec3(0.8f))));
            const Stage stage(finish(b, pose));
            put(paint(pose, size, size,
                      [&](const Ray& ray, int, int) {
                          const float t = distance(stage, ray, ball);
                          side.defects += wrong(t, exact_distance(ray, ball), 0x1p-23L) ? 1.0 : 0.0;
                          if (!(t > 0.0f)) return glm::vec3(0.06f, 0.07f, 0.1f);
                          // The height of the point above the ball's middle, as a colour that shows every step.
                          const glm::vec3 p = ray.origin + t * ray.direction, n = glm::normalize(p - ball.center);
                          return lit({0.9f, 0.6f, 0.3f}, glm::dot(n, glm::normalize(glm::vec3(-1, 1, 1.4f))), true);
                      }),
                i * size, image);
        }
        side.picture = shown(image);
        side.caption = "From 100, 1000, 4096 and 10,000 radii";
        return side;
    };
    e.pairs.push_back({"far-spheres", draw(naive), draw(product)});
    return e;
}

Exhibit floor_sphere(int width) {
    Exhibit e{"S-SPH-02",
              "A floor that is a huge sphere",
              "The ground is the Earth, a ball of radius 6,371,000, the eye one unit above it: "
              "<i>c</i>&nbsp;=&nbsp;<i>f&middot;f</i>&nbsp;&minus;&nbsp;<i>r</i>&sup2; is a "
              "difference of numbers of 4&thinsp;&middot;&thinsp;10<sup>13</sup>, whose neighbours in float are 4,194,304 apart, "
              "so the chequers break into terraces.",
              "glint computes the root in double and rounds it to float once, at the end.",
              "pixels with a distance off by more than 0.00001 of it, or a wrong hit or miss",
              kTextbookCode,
              kOurCode,
              {},
              {}};
    const CameraPose pose = camera_at({0, 1, 0}, {0.35f, 0.72f, -1}, 50.0f);
    SceneBuilder b;
    const Sphere ground{{0, -6371000.0f, 0}, 6371000.0f};
    b.add(ground, b.add_material(matte(glm::vec3(0.8f))));
    const Stage stage(finish(b, pose));
    const auto draw = [&](Distance distance) {
        Side side;
        double largest = 0.0;
        side.picture = shown(paint(pose, width, width * 3 / 4, [&](const Ray& ray, int, int) {
            const float t = distance(stage, ray, ground);
            const long double exact = exact_distance(ray, ground);
            side.defects += wrong(t, exact, 1e-5L) ? 1.0 : 0.0;
            if (exact > 0)
                largest = std::max(largest, static_cast<double>(std::abs(static_cast<long double>(t) - exact) / exact));
            if (!(t > 0.0f)) return glm::vec3(0.75f, 0.83f, 0.92f);
            const glm::vec3 p = ray.origin + t * ray.direction;
            const bool odd = (static_cast<int>(std::floor(p.x)) + static_cast<int>(std::floor(p.z))) % 2 != 0;
            const float haze = t / (t + 30.0f);
            return glm::mix(odd ? glm::vec3(0.1f, 0.2f, 0.3f) : glm::vec3(0.85f, 0.8f, 0.7f), glm::vec3(0.75f, 0.83f, 0.92f),
                            haze);
        }));
        side.caption = fmt::format("Largest relative error of <i>t</i>: {:.2g}", largest);
        return side;
    };
    e.pairs.push_back({"floor-sphere", draw(naive), draw(product)});
    return e;
}

}  // namespace glint::gallery
