#include "core/render_plan.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

bool any_material(const Scene& scene, bool (*has)(const Material&)) {
    return std::any_of(scene.materials.begin(), scene.materials.end(), has);
}

bool has_mirror(const Scene& scene) {
    return any_material(scene, [](const Material& m) { return m.has_mirror(); });
}

bool has_glass(const Scene& scene) {
    return any_material(scene, [](const Material& m) { return m.glass; });
}

// Two perpendicular edges of length 2 * half across `up`; which way they turn is fixed by up alone.
void spread_over_square(Light& light, glm::vec3 up, float half) {
    const glm::dvec3 n = glm::normalize(glm::dvec3(up));
    const glm::dvec3 a = glm::abs(n);
    const glm::dvec3 axis = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                            : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                     : glm::dvec3(0, 0, 1);
    const glm::dvec3 e1 = glm::normalize(glm::cross(axis, n)), e2 = glm::cross(n, e1);
    light.edge1 = glm::vec3(e1 * (2.0 * half));
    light.edge2 = glm::vec3(e2 * (2.0 * half));
}

struct Enclosing {
    double size;
    std::uint32_t material;
};

// Adds the glass balls and boxes of one geometry around the eye, which is given in its space; `scale` is what a length of it
// may grow to in the world.
void add_enclosing(const Geometry& g, const Surfaces& surfaces, const std::vector<Material>& materials, glm::dvec3 eye,
                   double scale, std::vector<Enclosing>& around) {
    const auto& sphere_material = surfaces.material_of[static_cast<std::size_t>(PrimitiveKind::sphere)];
    for (std::size_t i = 0; i < g.spheres.size(); ++i) {
        const glm::dvec3 d = eye - glm::dvec3(g.spheres[i].center);
        const double r = g.spheres[i].radius;
        if (materials[sphere_material[i]].glass && glm::dot(d, d) < r * r)
            around.push_back({scale * 2.0 * r, sphere_material[i]});
    }
    const auto& box_material = surfaces.material_of[static_cast<std::size_t>(PrimitiveKind::box)];
    for (std::size_t i = 0; i < g.boxes.size(); ++i) {
        const glm::dvec3 lo(g.boxes[i].lo), hi(g.boxes[i].hi);
        const bool inside = glm::all(glm::lessThan(lo, eye)) && glm::all(glm::lessThan(eye, hi));
        if (materials[box_material[i]].glass && inside) {
            const glm::dvec3 size = hi - lo;
            around.push_back({scale * std::max(size.x, std::max(size.y, size.z)), box_material[i]});
        }
    }
}

// The glass balls and boxes around the eye, outermost first. Meshes are taken as seen from outside.
MediumStack medium_at(const Scene& scene, glm::vec3 eye) {
    std::vector<Enclosing> around;
    const Geometry& g = *scene.geometry;
    add_enclosing(g, scene, scene.materials, glm::dvec3(eye), 1.0, around);
    for (const Instance& instance : g.instances) {
        const Geometry& prototype = *g.prototypes[instance.prototype].geometry;
        if (prototype.spheres.empty() && prototype.boxes.empty()) continue;
        const AffineMap& map = instance.object_from_world;
        add_enclosing(prototype, scene.prototypes[instance.prototype], scene.materials, map.point(glm::dvec3(eye)),
                      inverse(map).growth(), around);
    }
    std::stable_sort(around.begin(), around.end(), [](const Enclosing& a, const Enclosing& b) { return a.size > b.size; });
    MediumStack stack;
    for (const Enclosing& e : around) stack.enter(e.material);
    return stack;
}

}  // namespace

bool can_act(const Scene& scene, Feature feature) {
    switch (feature) {
        case Feature::aa:
        case Feature::dof: return true;
        case Feature::soft:
            return std::any_of(scene.lights.begin(), scene.lights.end(),
                               [](const Light& l) { return l.shape != Light::Shape::directional; });
        case Feature::specular:
        case Feature::shadows: return !scene.lights.empty();
        case Feature::fuzzy: return has_mirror(scene);
        case Feature::reflections: return has_mirror(scene) || has_glass(scene);
        case Feature::refractions: return has_glass(scene);
    }
    return false;
}

FeatureSet features_of(const Scene& scene) {
    FeatureSet set = FeatureSet::whitted();
    set.set(Feature::aa, true);
    set.set(Feature::dof, scene.cameras.front().lens_radius > 0.0f);
    set.set(Feature::soft, std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& l) { return l.has_area(); }));
    set.set(Feature::fuzzy, any_material(scene, [](const Material& m) { return m.has_mirror() && m.roughness > 0.0f; }));
    return set;
}

RenderPlan plan_render(const Scene& scene, const RenderSettings& settings, const CameraPose& camera) {
    const auto wants = [&](Feature f) { return settings.features.has(f); };
    const CameraPose& home = scene.cameras.front();
    const FeatureSet own = features_of(scene);
    RenderPlan plan;
    plan.depth = settings.depth;
    plan.cutoff = settings.cutoff;
    plan.jitter = wants(Feature::aa);
    plan.highlights = wants(Feature::specular);
    plan.shadows = wants(Feature::shadows);
    plan.reflections = wants(Feature::reflections);
    plan.refractions = wants(Feature::refractions);
    plan.background_is_color = settings.background == Background::color;
    plan.fresnel = settings.fresnel;
    plan.sampler = settings.sampler;
    plan.seed = settings.seed;

    plan.camera = camera;
    if (!wants(Feature::dof)) {
        plan.camera.lens_radius = 0.0f;
    } else if (!(camera.lens_radius > 0.0f)) {
        plan.camera.lens_radius = home.target_distance() / 100.0f;
    }
    if (!(plan.camera.focus_distance > 0.0f)) plan.camera.focus_distance = camera.target_distance();

    plan.lights = scene.lights;
    const bool soft = wants(Feature::soft);
    const bool add_spread = soft && (!own.has(Feature::soft) || settings.light_size);
    for (Light& light : plan.lights) {
        if (!soft) {
            light = without_area(light);
        } else if (add_spread && light.shape == Light::Shape::point) {
            const float half = settings.light_size.value_or(home.target_distance() / 60.0f);
            if (half > 0.0f)
                spread_over_square(light, scene.world_up(), half);
            else
                light = without_area(light);
        }
    }
    std::erase_if(plan.lights, [](const Light& l) { return l.emission == glm::vec3(0.0f); });
    if (std::any_of(plan.lights.begin(), plan.lights.end(), [](const Light& l) { return l.has_area(); }) && soft) {
        plan.kernel |= kernel_part::soft;
        plan.light_samples = settings.light_samples;
        for (Light& light : plan.lights) {
            if (light.has_area()) light.emission /= static_cast<float>(plan.light_samples);
        }
    }

    // At depth 0 too: the integrator counts what the limit cuts off.
    if (plan.reflections && has_mirror(scene)) {
        plan.kernel |= kernel_part::mirror;
        if (wants(Feature::fuzzy)) {
            if (settings.roughness)
                plan.forced_fuzz = *settings.roughness;
            else if (!own.has(Feature::fuzzy))
                plan.default_fuzz = 0.3f;
            if (plan.forced_fuzz != 0.0f) plan.kernel |= kernel_part::fuzzy;
        }
    }
    if ((plan.reflections || plan.refractions) && has_glass(scene)) {
        plan.kernel |= kernel_part::glass;
        plan.medium = medium_at(scene, camera.eye);
        plan.one_branch = settings.glass == GlassBranches::one && plan.reflections && plan.refractions;
    }
    return plan;
}

}  // namespace glint
