// Entry: parses, dispatches, and turns what went wrong into one line and the promised exit code.
#include <cstdio>
#include <new>

#include <fmt/format.h>

#include "app/chart.h"
#include "app/compare.h"
#include "app/headless.h"
#include "app/options.h"
#include "app/viewer.h"
#include "core/image.h"

namespace {

// The exit codes that interface and scripts rely on.
constexpr int kBadUsage = 2, kSceneRefused = 3, kRenderFault = 4, kCannotWrite = 5;

int fail(int code, std::string_view reason) {
    fmt::print(stderr, "glint: {}\n", reason);
    return code;
}

int view(const glint::Options& o) {
    const glint::Job job = glint::prepare_job(o, o.arguments.empty() ? glint::default_scene() : o.arguments.front());
    glint::print_warnings(*job.scene, o);
    glint::ViewerOptions v;
    v.scene = job.scene;
    v.settings = job.settings;
    v.display = job.display;
    v.camera = job.camera;
    if (!job.accelerator_is_auto) v.accelerator = job.accelerator.kind;
    v.width = o.width;
    v.height = o.height;
    v.spp = job.spp;
    v.threads = job.threads;
    return glint::run_viewer(v);
}

int run(const glint::Options& o) {
    // Before anything is built: accelerators keep the instruction set they were built for.
    if (o.isa) glint::use_isa(*o.isa);
    switch (o.command) {
        case glint::Command::view: return view(o);
        case glint::Command::render: return glint::run_render(o);
        case glint::Command::compare: return glint::run_compare(o);
        case glint::Command::chart: return glint::run_chart(o);
        case glint::Command::info: return glint::run_info(o);
        case glint::Command::list: return glint::run_list();
    }
    return kBadUsage;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const auto options = glint::parse_options(std::vector<std::string>(argv + 1, argv + argc));
        return options ? run(*options) : 0;
    } catch (const glint::UsageError& e) {
        return fail(kBadUsage, e.what());
    } catch (const glint::SceneError& e) {
        return fail(kSceneRefused, e.what());
    } catch (const glint::ImageError& e) {
        return fail(kCannotWrite, e.what());
    } catch (const std::bad_alloc&) {
        return fail(kRenderFault, "out of memory");
    } catch (const std::exception& e) {
        return fail(kRenderFault, e.what());
    }
}
