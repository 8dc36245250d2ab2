// The tile renderer: workers accumulate samples of an immutable Frame into a framebuffer, forever restartable.
// Knows no window. Invariants: restart() waits for nobody and clears nothing; a result of an old frame never
// reaches the framebuffer; the sums of a pixel depend on (frame, sample count) alone, never on threads or tiles.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "accel/accelerator.h"
#include "core/error_estimate.h"
#include "core/image.h"
#include "core/ray_counts.h"
#include "core/settings.h"

namespace glint {

// One immutable order to the workers. The rectangle [x0,x1) x [y0,y1) of the width x height picture is rendered.
struct Frame {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const AnyAccelerator> accelerator;
    CameraPose camera;
    RenderSettings settings;
    int width = 0, height = 0;
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // x1 = y1 = 0: the whole picture
    int spp = 64;                        // samples a pixel; the workers idle when they are reached. Where nothing is
                                         // random they are all alike, and one is taken. Where they are adaptive: the mean
};

struct Progress {
    std::uint64_t generation = 0;   // of the frame that is being rendered
    bool preview_complete = false;  // the coarse first look (or more) covers the whole picture
    bool finished = false;          // every pixel has its samples
    bool out_of_memory = false;     // the picture is too large: this frame never finishes, a later one may
    int spp_min = 0, spp_max = 0;   // samples a pixel so far
    int spp = 0;                    // the picture's: the least or, where they are adaptive, the mean
    double seconds = 0.0;           // since restart(), pauses excluded; stands still when finished
    RayCounts rays;                 // and the samples and branches that were dropped
};

class Renderer {
public:
    // threads >= 1; fewer where the system refuses some, std::runtime_error where it refuses all. preview: render a coarse
    // picture first after each restart (the viewer wants it, a file does not). pinned: each thread keeps to a processor of its
    // own, for measurements; it always does where there are as many threads as processors.
    Renderer(int threads, bool preview, bool pinned = false);
    ~Renderer();
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;

    // Replaces the frame: plans it on the caller's thread (a walk over the lights, and over balls and boxes where there is
    // glass), then swaps it in. Waits for no worker, touches no pixel. Returns the new generation.
    std::uint64_t restart(Frame frame);
    // Goes on with another accelerator of the same scene if `generation` is still the frame's: same bits, so nothing restarts.
    bool replace_accelerator(std::uint64_t generation, std::shared_ptr<const AnyAccelerator> accelerator);
    // Goes on to `spp` samples a pixel if `generation` is still the frame's, also when it is finished: the bits are those of a
    // frame that asked for as many from the start. Never takes samples away. False for another frame, or one that is too large.
    bool extend(std::uint64_t generation, int spp);
    void set_paused(bool paused);
    [[nodiscard]] Progress progress() const;
    // The mean of the samples so far as linear radiance, at the frame's crop size. Where a pixel has no sample yet, its
    // coarse preview. False, and `image` untouched, while not even the preview covers the picture.
    bool resolve(Image& image) const;
    // The last pass that covers the whole picture, every pixel with the same number of samples: what a screenshot takes.
    // Returns that number; 0, and `image` untouched, while there is none. Only with a preview.
    int resolve_pass(Image& image) const;
    // How far the picture is from its limit, for the number of samples that every pixel has at least; where
    // they are adaptive, for those that each tile has.
    [[nodiscard]] ErrorEstimate error() const;
    // Waits until finished, out of memory or until `deadline` seconds of rendering passed or *stop is true (stop may be null).
    void wait(double deadline_seconds, const std::atomic<bool>* stop) const;
    [[nodiscard]] int threads() const { return static_cast<int>(workers_.size()); }

private:
    struct State;
    std::unique_ptr<State> state_;
    std::vector<std::jthread> workers_;
};

}  // namespace glint
