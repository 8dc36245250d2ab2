// Light and shadow: an occluder behind the lamp, a soft shadow by fractions, and the terminator of smooth meshes.

#include <array>

#include "core/sampler.h"
#include "tests/gallery/exhibit.h"
#include "tests/gallery/stage.h"
#include "tests/gallery/textbook.h"

namespace glint::gallery {
namespace {

Light quad_light(glm::vec3 corner, glm::vec3 edge1, glm::vec3 edge2, float radiance) {
    Light light;
    light.shape = Light::Shape::quad;
    light.falloff = Light::Falloff::physical;
    light.position = corner;
    light.edge1 = edge1;
    light.edge2 = edge2;
    light.emission = glm::vec3(radiance);
    return light;
}

// Irradiance of a rectangle of radiance 1 at height h over the receiver, from the signed sum over its corners (Lambert).
double irradiance_of_square(double x, double half, double h) {
    const auto corner = [&](double a, double b) {
        a /= h, b /= h;
        const double p = std::sqrt(1.0 + a * a), q = std::sqrt(1.0 + b * b);
        return 0.5 * (a / p * std::atan(b / p) + b / q * std::atan(a / q));
    };
    return corner(half - x, half) + corner(half + x, half) + corner(half - x, half) + corner(half + x, half);
}

}  // namespace

Exhibit light_before_occluder(int width) {
    Exhibit e{"S-SHD-01",
              "Shadows from behind the lamp",
              "A lamp hangs below a ceiling: &ldquo;is there any object along the ray towards the light?&rdquo; finds the "
              "ceiling behind the lamp, "
              "and the whole room is dark.",
              "glint&rsquo;s shadow rays end at the light: their direction is not made unit, so that <i>t</i>&nbsp;=&nbsp;1 is "
              "the lamp.",
              "floor pixels in a shadow that no ball throws",
              "ray = (origin, normalize(light - p));\nif (hits anything) shadow;",
              "ray = (light, p - light), t_max = 1;\nif (hits anything up to t_max) shadow;",
              {},
              {}};
    const CameraPose pose = camera_at({1.5f, 2.2f, 7.0f}, {0, 0.9f, 0}, 42.0f);
    SceneBuilder b;
    const std::uint32_t floor = b.add_material(matte({0.62f, 0.62f, 0.6f})),
                        ceiling = b.add_material(matte({0.5f, 0.46f, 0.42f}));
    add_quad(b, {-5, 0, -5}, {0, 0, 10}, {10, 0, 0}, floor);
    add_quad(b, {-5, 3.4f, -5}, {10, 0, 0}, {0, 0, 7}, ceiling);
    const std::array<Sphere, 2> balls{Sphere{{-0.9f, 0.7f, -0.6f}, 0.7f}, Sphere{{1.1f, 0.5f, 0.6f}, 0.5f}};
    b.add(balls[0], b.add_material(matte({0.75f, 0.35f, 0.25f})));
    b.add(balls[1], b.add_material(matte({0.3f, 0.5f, 0.7f})));
    Light lamp;
    lamp.position = {0.2f, 2.9f, 0.3f};
    lamp.emission = glm::vec3(1.0f);
    b.scene().lights = {lamp};
    b.scene().environment.color = glm::vec3(0.04f);
    const Stage stage(finish(b, pose));
    const int height = width * 3 / 4;
    // Whether the exact segment from the lamp to the floor at p passes a ball by.
    const auto seen = [&](glm::vec3 p) {
        const glm::dvec3 d = glm::dvec3(p) - glm::dvec3(lamp.position);
        for (const Sphere& s : balls) {
            const glm::dvec3 f = glm::dvec3(s.center) - glm::dvec3(lamp.position), off = f - glm::dot(f, d) / glm::dot(d, d) * d;
            if (glm::dot(off, off) < static_cast<double>(s.radius) * static_cast<double>(s.radius)) return false;
        }
        return true;
    };
    const Image ours = rendered(stage, pose, width, height, 1, centred());
    const auto draw = [&](bool is_ours) {
        Side side;
        const Image image = paint(pose, width, height, [&](const Ray& ray, int x, int y) {
            const Hit hit = stage.hit(ray);
            if (!hit.found()) return stage.scene->environment.color;
            const SurfacePoint s = surface_point(*stage.scene, ray, hit);
            const glm::vec3 origin = spawn_origin(s, s.ng), wi = glm::normalize(lamp.position - origin);
            const bool blocked = occluded(*stage.accelerator, {origin, wi, kInfinity});
            const glm::vec3 radiance = is_ours ? ours.at(x, y)
                                       : blocked
                                           ? glm::vec3(0.0f)
                                           : stage.scene->materials[s.material].diffuse * std::max(0.0f, glm::dot(s.ng, wi));
            if (s.material == floor && seen(s.p) && !(radiance.x > 0.0f)) ++side.defects;
            return radiance + glm::vec3(0.015f);
        });
        side.picture = shown(image);
        side.caption = is_ours ? "The segment up to the lamp" : "The whole ray";
        return side;
    };
    e.pairs.push_back({"behind-the-lamp", draw(false), draw(true)});
    return e;
}

Exhibit centre_times_fraction(int width) {
    Exhibit e{
        "O-ALT-02",
        "Soft shadows by a fraction",
        "A square lamp, 2 by 2, two units above the floor, one small plate in the way: light from its <i>centre</i> times the "
        "fraction of unblocked rays is "
        "too bright in the middle for any number of rays (below an open lamp by 32.9&thinsp;%), since cosines and distance "
        "are not those of the points that shine.",
        "glint takes colour, cosines and 1/<i>d</i>&sup2; at each sampled point of the lamp, so the mean is the integral.",
        "is the largest relative error of the open lamp&rsquo;s light at <i>x</i> = 0, 1, 2, 4",
        "c = light from the centre;               // cos cos / d^2\nL = c * unblocked rays / all rays;",
        "y = point of the lamp;                   // one a sample\nL += area * cos(p) * cos(y) / |y - p|^2 * unblocked;",
        {},
        {}};
    e.allowed = 0.002;
    const CameraPose pose = camera_at({0, 6.0f, 6.5f}, {0, 0, 0.3f}, 40.0f);
    const float h = 2.0f;
    const auto scene = [&](bool blocked) {
        SceneBuilder b;
        const std::uint32_t floor = b.add_material(matte(glm::vec3(0.8f))),
                            plate = b.add_material(emitter({0.02f, 0.06f, 0.12f}));
        add_quad(b, {-8, 0, -8}, {0, 0, 16}, {16, 0, 0}, floor);
        if (blocked) b.add(Box{{0.9f, 0.7f, -0.4f}, {1.9f, 0.75f, 0.6f}}, plate);
        b.scene().lights = {quad_light({-1, h, -1}, {2, 0, 0}, {0, 0, 2}, 1.0f)};
        return Stage(finish(b, pose));
    };
    const Stage stage = scene(true), open = scene(false);
    RenderSettings soft = centred();
    soft.features.set(Feature::soft, true);
    const int height = width * 3 / 4, side_samples = 16;
    const auto centre_light = [&](glm::vec3 p) {
        const glm::vec3 to = glm::vec3(0, h, 0) - p;
        const float d2 = glm::dot(to, to);
        return 4.0f * (h * h / d2) / d2;  // area, both cosines, distance
    };
    const Image left = paint(pose, width, height, [&](const Ray& ray, int x, int y) {
        const Hit hit = stage.hit(ray);
        if (!hit.found()) return glm::vec3(0.0f);
        const SurfacePoint s = surface_point(*stage.scene, ray, hit);
        int unblocked = 0;
        const Sampler sampler(SamplerKind::sobol, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 0, 0);
        const glm::vec2 jitter = sampler.square(7);
        const glm::vec3 origin = spawn_origin(s, s.ng);
        for (int k = 0; k < side_samples * side_samples; ++k) {
            const float u = (static_cast<float>(k % side_samples) + jitter.x) / static_cast<float>(side_samples),
                        v = (static_cast<float>(k / side_samples) + jitter.y) / static_cast<float>(side_samples);
            unblocked +=
                occluded(*stage.accelerator, {origin, glm::vec3(2.0f * u - 1.0f, h, 2.0f * v - 1.0f) - origin, 0.9999f}) ? 0 : 1;
        }
        const float fraction = static_cast<float>(unblocked) / static_cast<float>(side_samples * side_samples);
        const Material& m = stage.scene->materials[s.material];
        return m.emission + m.diffuse * (centre_light(s.p) * fraction);
    });
    const Image right = rendered(stage, pose, width, height, 256, soft);
    // The open lamp's light on the floor below it, from straight above, one pixel a point.
    Side textbook{shown(left), "", 0.0}, ours{shown(right), "", 0.0};
    std::string list_left, list_right;
    for (const float x : {0.0f, 1.0f, 2.0f, 4.0f}) {
        const CameraPose above = camera_at({x, 1, 0}, {x, 0, 0}, 0.001f, {0, 0, 1});
        const double exact = irradiance_of_square(static_cast<double>(x), 1.0, static_cast<double>(h));
        const double got = static_cast<double>(rendered(open, above, 1, 1, 16384, soft).at(0, 0).x) / 0.8;
        const double centre = static_cast<double>(centre_light({x, 0, 0}));
        textbook.defects = std::max(textbook.defects, std::abs(centre / exact - 1.0));
        ours.defects = std::max(ours.defects, std::abs(got / exact - 1.0));
        list_left += fmt::format("{}{:.4f}", list_left.empty() ? "" : ", ", centre);
        list_right += fmt::format("{}{:.4f}", list_right.empty() ? "" : ", ", got);
    }
    textbook.caption = "256 rays a pixel; open lamp at <i>x</i> = 0, 1, 2, 4: " + list_left;
    ours.caption = "256 samples a pixel; open lamp at <i>x</i> = 0, 1, 2, 4: " + list_right;
    e.pairs.push_back({"fraction", std::move(textbook), std::move(ours)});
    return e;
}

}  // namespace glint::gallery
