// Glass: a slip in Fresnel's equations, and what "looks zoomed in" when a refraction goes wrong.

#include <functional>

#include "core/fresnel.h"
#include "tests/gallery/exhibit.h"
#include "tests/gallery/stage.h"
#include "tests/gallery/textbook.h"

namespace glint::gallery {
namespace {

constexpr double kIor = 1.5;
const Sphere kBall{{0, 0, 0}, 1.0f};

// Fresnel's equations from the sines of both angles (another form than the product's), the oracle. From air.
double exact_fresnel(double cos_i) {
    const long double i = std::acos(std::min(1.0L, static_cast<long double>(cos_i))),
                      t = std::asin(std::sin(i) / static_cast<long double>(kIor));
    if (i < 1e-6L) return (kIor - 1.0) * (kIor - 1.0) / ((kIor + 1.0) * (kIor + 1.0));
    const long double s = std::sin(i - t) / std::sin(i + t), p = std::tan(i - t) / std::tan(i + t);
    return static_cast<double>(0.5L * (s * s + p * p));
}

std::string curve(const std::function<double(double)>& f, const char* cls, const char* dash) {
    std::string path;
    for (int i = 0; i <= 180; ++i) {
        const double degrees = 0.5 * i, y = f(std::cos(degrees * kPi / 180.0));
        path += fmt::format("{}{:.1f},{:.1f}", i == 0 ? "M" : " L", 50.0 + degrees * 6.0, 250.0 - 2000.0 * std::min(y, 0.12));
        if (y > 0.12) break;
    }
    return fmt::format("<path d=\"{}\" fill=\"none\" class=\"{}\" stroke-width=\"2\"{}/>", path, cls, dash);
}

std::string fresnel_plot() {
    std::string svg = "<svg viewBox=\"0 0 620 290\" role=\"img\" aria-label=\"Reflectance of glass by angle\">";
    for (int i = 0; i <= 6; ++i) {
        const double y = 250.0 - 40.0 * i;
        svg += fmt::format("<path d=\"M50,{0} H590\" class=\"axis\"/><text x=\"42\" y=\"{1}\" text-anchor=\"end\">{2:.2f}</text>",
                           y, y + 4.0, 0.02 * i);
    }
    for (int d = 0; d <= 90; d += 15)
        svg += fmt::format("<text x=\"{}\" y=\"268\" text-anchor=\"middle\">{}&deg;</text>", 50 + 6 * d, d);
    svg += curve([](double c) { return textbook::slipped_fresnel(c, 1.0, kIor); }, "bad", " stroke-dasharray=\"6 4\"");
    svg += curve([](double c) { return fresnel_dielectric(c, 1.0 / kIor); }, "good", "");
    return svg +
           "<text x=\"60\" y=\"222\" class=\"bad\">with the slip: 0.0200 at 0&deg;</text><text x=\"60\" y=\"158\" "
           "class=\"good\">Fresnel: 0.0400 at "
           "0&deg;</text><text x=\"320\" y=\"286\" text-anchor=\"middle\">angle of incidence, air to glass (n = "
           "1.5)</text></svg>";
}

// What the ray sees that leaves the ball.
using Outside = std::function<glm::dvec3(glm::dvec3 origin, glm::dvec3 direction)>;

enum class Slip { none, exit_missing, eta_inverted };

glm::dvec3 mirrored(glm::dvec3 d, glm::dvec3 n) { return d - 2.0 * glm::dot(d, n) * n; }

// Snell in the vector form; n against d. False for total reflection.
bool bent(glm::dvec3 d, glm::dvec3 n, double eta, glm::dvec3& t) {
    const double c = -glm::dot(d, n), k = 1.0 - eta * eta * (1.0 - c * c);
    if (k < 0.0) return false;
    t = eta * d + (eta * c - std::sqrt(k)) * n;
    return true;
}

// A solid ball of glass (kBall) by a textbook's recursion, with one slip: what comes along d, which has met the ball at p.
glm::dvec3 through_ball(glm::dvec3 p, glm::dvec3 d, Slip slip, bool inside, int depth, const Outside& outside) {
    const glm::dvec3 n = inside ? -p : p;
    const double eta = (inside != (slip == Slip::eta_inverted)) ? kIor : 1.0 / kIor;
    glm::dvec3 t(0.0);
    bool passes = bent(d, n, eta, t);
    if (inside && slip == Slip::exit_missing) t = d, passes = true;
    const double cos_i = -glm::dot(d, n), reflected = passes ? fresnel_dielectric(cos_i, eta) : 1.0;
    const double f = inside && slip == Slip::exit_missing ? 0.0 : reflected;
    const auto across = [&](glm::dvec3 w) { return p - 2.0 * glm::dot(p, w) * w; };
    glm::dvec3 light(0.0);
    if (f > 0.0 && depth > 0) {
        const glm::dvec3 r = mirrored(d, n);
        light += f * (inside ? through_ball(across(r), r, slip, true, depth - 1, outside) : outside(p, r));
    }
    if (f < 1.0 && depth > 0) {
        light += (1.0 - f) * (inside ? outside(p, t) : through_ball(across(t), t, slip, true, depth - 1, outside));
    }
    return light;
}

// By how many degrees a ray parallel to the axis, at height 0.1, is bent towards it: by the slip, and by the product's own steps.
double bend(Slip slip) {
    const glm::dvec3 p(0.0, 0.1, std::sqrt(0.99)), d(0, 0, -1);
    const double into = slip == Slip::eta_inverted ? kIor : 1.0 / kIor;
    glm::dvec3 t(0.0), out(0.0);
    bent(d, p, into, t);
    const glm::dvec3 q = p - 2.0 * glm::dot(p, t) * t;
    if (slip == Slip::exit_missing)
        out = t;
    else
        bent(t, -q, 1.0 / into, out);
    return std::atan2(-out.y, -out.z) * 180.0 / kPi;
}
double bend_of_product(const Stage& stage) {
    Ray ray{{0, 0.1f, 5}, {0, 0, -1}, kInfinity};
    for (const double eta : {1.0 / kIor, kIor}) {
        const SurfacePoint s = surface_point(*stage.scene, ray, stage.hit(ray));
        ray = {spawn_origin(s, -s.ng), refract(-ray.direction, s.ns, eta), kInfinity};
    }
    return std::atan2(-static_cast<double>(ray.direction.y), -static_cast<double>(ray.direction.z)) * 180.0 / kPi;
}

// The wall behind the ball: squares whose hue tells left from right, and whose brightness up from down.
glm::vec3 tile(int i, int j) {
    const float x = static_cast<float>(i) / 11.0f, y = static_cast<float>(j) / 8.0f;
    const glm::vec3 hue = glm::mix(glm::vec3(0.9f, 0.35f, 0.12f), glm::vec3(0.12f, 0.4f, 0.8f), x);
    return hue * ((i + j) % 2 != 0 ? 0.12f : 0.35f + 0.65f * y);
}

std::shared_ptr<const Scene> ball_before_wall(const CameraPose& pose, bool ball, float hollow) {
    SceneBuilder b;
    for (int i = 0; i < 12; ++i) {
        for (int j = 0; j < 9; ++j) {
            add_quad(b, {static_cast<float>(i - 6), static_cast<float>(j) - 4.5f, -4.0f}, {1, 0, 0}, {0, 1, 0},
                     b.add_material(emitter(tile(i, j))));
        }
    }
    if (ball) b.add(kBall, b.add_material(glass(static_cast<float>(kIor))));
    if (hollow > 0.0f) b.add(Sphere{{0, 0, 0}, hollow}, b.add_material(glass(1.0f)));
    b.scene().environment.color = glm::vec3(0.75f, 0.83f, 0.92f) * 0.5f;
    return finish(b, pose);
}

}  // namespace

Exhibit fresnel_slip(int width) {
    Exhibit e{"S-FRN-02",
              "One letter in Fresnel&rsquo;s equations",
              "What a glass ball in a white room reflects (the light that passes is left out): with <code>etat</code> written "
              "for <code>etai</code> once, "
              "its middle returns half the light, 0.02 for 0.04, its rim too much, and a white furnace sees nothing of it, as "
              "the rest is said to pass.",
              "glint&rsquo;s formula is held against printed values at 16 angles and against closed means over the hemisphere, "
              "which one wrong letter fails.",
              "pixels whose reflectance is wrong by more than a thousandth of it",
              "rs = (etai*cosi - etat*cost) / (etai*cosi + etat*cost);\nrp = (etat*cosi - etat*cost) / (etat*cosi + etat*cost);\n"
              "//                ^ should be etai                ^\nF = (rs*rs + rp*rp) / 2;",
              "s = (eta*cos_i - cos_t) / (eta*cos_i + cos_t);\np = (cos_i - eta*cos_t) / (cos_i + eta*cos_t);\n// eta = n here / "
              "n beyond\nF = (s*s + p*p) / 2;",
              {},
              fresnel_plot()};
    const CameraPose pose = camera_at({0, 0, 6}, {0, 0, 0}, 23.0f);
    SceneBuilder b;
    b.add(kBall, b.add_material(glass(static_cast<float>(kIor), 0.0f)));
    b.scene().environment.color = glm::vec3(1.0f);
    const Stage stage(finish(b, pose));
    const int height = width * 3 / 4;
    const Image ours = rendered(stage, pose, width, height, 1, centred());
    const auto draw = [&](bool is_ours) {
        Side side;
        double middle = 1.0;
        const Image image = paint(pose, width, height, [&](const Ray& ray, int x, int y) {
            const Hit hit = stage.hit(ray);
            if (!hit.found()) return glm::vec3(0.0f);
            const SurfacePoint s = surface_point(*stage.scene, ray, hit);
            const double cos_i = -glm::dot(glm::dvec3(ray.direction), glm::normalize(glm::dvec3(s.p)));
            const double f = is_ours ? static_cast<double>(ours.at(x, y).x) : textbook::slipped_fresnel(cos_i, 1.0, kIor);
            const double exact = exact_fresnel(cos_i);
            // At the last thousandth of the rim a float normal cannot tell the angle.
            if (cos_i > 0.03) side.defects += std::abs(f - exact) > 1e-3 * exact ? 1.0 : 0.0;
            middle = std::min(middle, f);
            return glm::vec3(static_cast<float>(f));
        });
        side.picture = shown(image, 2.0f);
        side.caption = fmt::format("Least reflectance in the picture: {:.4f}; shown four times as bright", middle);
        return side;
    };
    e.pairs.push_back({"fresnel", draw(false), draw(true)});
    return e;
}

Exhibit zoomed_refraction(int width) {
    Exhibit e{"O-REF-02",
              "Refraction that looks zoomed in",
              "A solid ball of glass before a wall turns the wall upside down and magnifies it, so a wrong picture is hard to "
              "tell from a right one by eye: "
              "here the ray is not bent where it leaves; the ratio of the indices is upside down; the ball is a shell of 1/100.",
              "glint is held against the ball lens: a ray at height 0.1 must be bent by "
              "2(asin&nbsp;0.1&nbsp;&minus;&nbsp;asin&nbsp;(0.1/1.5))&nbsp;=&nbsp;3.8332&deg;.",
              "degrees away from the ball lens",
              "if (inside) t = d;                       // exit missing\neta = inside ? 1/n : n;                  // "
              "inverted\nball(r = 1), ball(r = 0.99, n = 1)       // hollow",
              "eta = n(medium here) / n(medium beyond); // a stack of media\nc = eta*cos_i;  cos2_t = (1-eta)*(1+eta) + c*c;\n"
              "t = (eta*cos_i - sqrt(cos2_t)) * n - eta * wo;",
              {},
              {}};
    e.allowed = 1e-4;
    const CameraPose pose = camera_at({0, 0.1f, 6.0f}, {0, 0, 0}, 27.0f);
    const Stage wall(ball_before_wall(pose, false, 0.0f)), whole(ball_before_wall(pose, true, 0.0f)),
        shell(ball_before_wall(pose, true, 0.99f));
    const int height = width * 3 / 4;
    const Outside outside = [&](glm::dvec3 o, glm::dvec3 d) {
        const Hit hit = wall.hit({glm::vec3(o), glm::vec3(d), kInfinity});
        return glm::dvec3(hit.found() ? wall.scene->material(hit.primitive).emission : wall.scene->environment.color);
    };
    const auto recursion = [&](Slip slip) {
        return paint(pose, width, height, [&](const Ray& ray, int, int) {
            const Hit hit = whole.hit(ray);
            if (!hit.found() || kind_of(hit.primitive) != PrimitiveKind::sphere)
                return glm::vec3(outside(glm::dvec3(ray.origin), glm::dvec3(ray.direction)));
            return glm::vec3(through_ball(glm::dvec3(surface_point(*whole.scene, ray, hit).p), glm::dvec3(ray.direction), slip,
                                          false, 8, outside));
        });
    };
    const double lens = 2.0 * (std::asin(0.1) - std::asin(0.1 / kIor)) * 180.0 / kPi;
    const Image right = rendered(whole, pose, width, height, 1, centred());
    // Without a slip the textbook's recursion gives the product's picture: so one thing differs in each pair.
    const Image without = recursion(Slip::none);
    std::size_t other = 0;
    for (std::size_t i = 0; i < right.pixels.size(); ++i) {
        const glm::vec3 apart = glm::abs(without.pixels[i] - right.pixels[i]);
        other += std::max(apart.x, std::max(apart.y, apart.z)) > 1e-3f ? 1 : 0;
    }
    const Side ours{shown(right), fmt::format("Bent by {:.4f}&deg;", bend_of_product(whole)),
                    std::abs(bend_of_product(whole) - lens)};
    const auto pair = [&](const char* name, const char* what, const Image& image, double degrees) {
        e.pairs.push_back(
            {name, {shown(image), fmt::format("{}: bent by {:.4f}&deg;", what, degrees), std::abs(degrees - lens)}, ours});
    };
    pair("refraction-exit", "Exit refraction missing", recursion(Slip::exit_missing), bend(Slip::exit_missing));
    pair("refraction-inverted", "Ratio inverted", recursion(Slip::eta_inverted), bend(Slip::eta_inverted));
    const double h = 0.1, in_shell = h / 0.99;
    const double through_shell =
        2.0 * (std::asin(h) - std::asin(h / kIor) + std::asin(in_shell / kIor) - std::asin(in_shell)) * 180.0 / kPi;
    pair("refraction-hollow", "Hollow", rendered(shell, pose, width, height, 1, centred()), through_shell);
    e.pairs.back().ours.caption += fmt::format(
        "; the textbook&rsquo;s recursion without a slip differs from it in {} of {} pixels by more than a thousandth", other,
        right.pixels.size());
    return e;
}

}  // namespace glint::gallery
