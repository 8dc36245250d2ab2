#include "app/blit.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

// Prototypes instead of a loader: libOpenGL and libOSMesa both export the functions of OpenGL 3.3.
#ifndef GL_GLEXT_PROTOTYPES
#define GL_GLEXT_PROTOTYPES
#endif
#include <GL/glcorearb.h>

#include "shaders.h"

namespace glint {
namespace {

// The first line of what the compiler or linker of shaders said.
std::string first_line(const char* log) {
    const std::string text(log);
    return text.substr(0, text.find('\n'));
}

GLuint compile(GLenum stage, const char* source) {
    const GLuint shader = glCreateShader(stage);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    GLint ok = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (ok == GL_TRUE) return shader;
    std::array<char, 1024> log{};
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
    glDeleteShader(shader);
    throw BlitError("OpenGL refuses a shader: " + first_line(log.data()));
}

GLuint link(GLuint vertex, GLuint fragment) {
    const GLuint program = glCreateProgram();
    glAttachShader(program, vertex);
    glAttachShader(program, fragment);
    glLinkProgram(program);
    glDeleteShader(vertex);
    glDeleteShader(fragment);
    GLint ok = GL_FALSE;
    glGetProgramiv(program, GL_LINK_STATUS, &ok);
    if (ok == GL_TRUE) return program;
    std::array<char, 1024> log{};
    glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
    glDeleteProgram(program);
    throw BlitError("OpenGL refuses to link the shaders: " + first_line(log.data()));
}

struct Area {
    int x, y, width, height;
};

// The largest rectangle of the picture's shape inside the framebuffer, centred.
Area letterbox(int width, int height, int framebuffer_width, int framebuffer_height) {
    Area area{0, 0, framebuffer_width, framebuffer_height};
    const std::int64_t wide = std::int64_t{framebuffer_width} * height, tall = std::int64_t{framebuffer_height} * width;
    if (wide > tall) area.width = static_cast<int>(std::max<std::int64_t>(1, tall / height));
    if (tall > wide) area.height = static_cast<int>(std::max<std::int64_t>(1, wide / width));
    area.x = (framebuffer_width - area.width) / 2;
    area.y = (framebuffer_height - area.height) / 2;
    return area;
}

}  // namespace

Blit::Blit() {
    const GLuint vertex = compile(GL_VERTEX_SHADER, k_blit_vert);
    program_ = link(vertex, compile(GL_FRAGMENT_SHADER, k_blit_frag));
    area_location_ = glGetUniformLocation(program_, "area");
    glGenVertexArrays(1, &vertex_array_);
    glGenTextures(1, &texture_);
    glBindTexture(GL_TEXTURE_2D, texture_);
    // A texture without mipmaps is incomplete, and black, under the default filter.
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    // Both are colour work, and dithering is on unless switched off.
    glDisable(GL_DITHER);
    glDisable(GL_FRAMEBUFFER_SRGB);
}

Blit::~Blit() {
    glDeleteTextures(1, &texture_);
    glDeleteVertexArrays(1, &vertex_array_);
    glDeleteProgram(program_);
}

void Blit::upload(const Image8& image) {
    glBindTexture(GL_TEXTURE_2D, texture_);
    // Rows of three bytes a pixel are not padded to four.
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    if (image.width == width_ && image.height == height_) {
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, GL_RGB, GL_UNSIGNED_BYTE, image.rgb.data());
        return;
    }
    width_ = image.width;
    height_ = image.height;
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, width_, height_, 0, GL_RGB, GL_UNSIGNED_BYTE, image.rgb.data());
}

void Blit::draw(int framebuffer_width, int framebuffer_height) const {
    glViewport(0, 0, framebuffer_width, framebuffer_height);
    glClearColor(0.0f, 0.0f, 0.0f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    if (width_ == 0 || framebuffer_width <= 0 || framebuffer_height <= 0) return;
    const Area area = letterbox(width_, height_, framebuffer_width, framebuffer_height);
    glViewport(area.x, area.y, area.width, area.height);
    glUseProgram(program_);
    glUniform4i(area_location_, area.x, area.y, area.width, area.height);
    glBindTexture(GL_TEXTURE_2D, texture_);
    glBindVertexArray(vertex_array_);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace glint
