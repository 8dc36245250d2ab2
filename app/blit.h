// All of glint's OpenGL: a picture of bytes onto the current framebuffer. The GPU does no colour work.
// Knows no window system; every call, the destructor too, needs the same current OpenGL 3.3 core context.
// Invariant: where picture and framebuffer have one size, the framebuffer holds the picture's bytes.
#pragma once

#include <stdexcept>

#include "core/image.h"

namespace glint {

// The driver cannot do what OpenGL 3.3 promises; the message is one line.
class BlitError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

class Blit {
public:
    Blit();  // throws BlitError
    ~Blit();
    Blit(const Blit&) = delete;
    Blit& operator=(const Blit&) = delete;

    // The picture for draw() from now on. It must have at least one pixel.
    void upload(const Image8& image);
    // Draws the picture as large as it fits, without changing its shape, centred on black. Black without a picture.
    void draw(int framebuffer_width, int framebuffer_height) const;

private:
    unsigned program_ = 0, texture_ = 0, vertex_array_ = 0;
    int area_location_ = -1;
    int width_ = 0, height_ = 0;
};

}  // namespace glint
