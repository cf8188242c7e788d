// OpenGL objects that delete themselves. Internal. All need the context they were made in to be current,
// when they are destroyed too.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>
#include <utility>

#include "precompute/math/vec.h"
#include "runtime/gl_functions.h"

namespace prt {

/// Objects of this process that were made and not yet deleted, in all contexts.
size_t liveGlObjects();

/// A name and the function that deletes it.
class GlObject {
  public:
    using Delete = void (*)(const GlFunctions& gl, GLuint name);
    GlObject() = default;
    /// Counts as live until destroyed.
    GlObject(const GlFunctions& gl, GLuint name, Delete destroy);
    GlObject(GlObject&& other) noexcept { swap(other); }
    GlObject& operator=(GlObject&& other) noexcept {
        GlObject moved(std::move(other));
        swap(moved);
        return *this;
    }
    ~GlObject();
    GLuint name() const { return name_; }
    explicit operator bool() const { return name_ != 0; }

  private:
    void swap(GlObject& other) noexcept {
        std::swap(gl_, other.gl_);
        std::swap(name_, other.name_);
        std::swap(delete_, other.delete_);
    }
    const GlFunctions* gl_ = nullptr;
    GLuint name_ = 0;
    Delete delete_ = nullptr;
};

GlObject makeTexture(const GlFunctions& gl, GLenum target);
GlObject makeFramebuffer(const GlFunctions& gl);
GlObject makeVertexArray(const GlFunctions& gl);
GlObject makeSampler(const GlFunctions& gl);

/// One 2D image with one level.
GlObject makeImage(const GlFunctions& gl, GLenum internalFormat, int width, int height);

/// The same with so many samples to a pixel; of more than one the texture is multisampled, with samples at
/// the same places in every pixel.
GlObject makeSampledImage(const GlFunctions& gl, GLenum internalFormat, int width, int height, int samples);

/// A buffer that shaders read with texelFetch.
class GlBufferTexture {
  public:
    GlBufferTexture() = default;
    /// @param internalFormat  of one element, e.g. GL_RGB32F
    /// @param elements        their number
    /// @throws InputError     more than GL_MAX_TEXTURE_BUFFER_SIZE (named `what`)
    GlBufferTexture(const GlFunctions& gl, GLenum internalFormat, std::span<const std::byte> bytes,
                    size_t elements, const char* what);
    GLuint texture() const { return texture_.name(); }

  private:
    GlObject buffer_, texture_;
};

/// Shaders linked together, and their uniforms by name.
class GlProgram {
  public:
    GlProgram() = default;
    /// @param vertex, fragment, geometry  names in runtime/shaders; geometry may be empty: none
    /// @param defines                     lines put in front, e.g. "#define PER_VERTEX\n"
    /// @throws Error  the compiler's log
    GlProgram(const GlFunctions& gl, const std::string& vertex, const std::string& fragment,
              const std::string& defines, const std::string& geometry = {});
    void use() const { gl_->UseProgram(program_.name()); }
    void set(const char* uniform, int value) const {
        gl_->ProgramUniform1i(program_.name(), at(uniform), value);
    }
    void set(const char* uniform, int x, int y) const {
        gl_->ProgramUniform2i(program_.name(), at(uniform), x, y);
    }
    void set(const char* uniform, float value) const {
        gl_->ProgramUniform1f(program_.name(), at(uniform), value);
    }
    /// An array of numbers, from its first on.
    void set(const char* uniform, std::span<const float> values) const {
        gl_->ProgramUniform1fv(program_.name(), at(uniform), GLsizei(values.size()), values.data());
    }
    void set(const char* uniform, const Vec3f& value) const {
        gl_->ProgramUniform3fv(program_.name(), at(uniform), 1, value.data());
    }
    /// An array of them, from its first on.
    void set(const char* uniform, std::span<const Vec3f> values) const {
        gl_->ProgramUniform3fv(program_.name(), at(uniform), GLsizei(values.size()), values.data()->data());
    }
    void set(const char* uniform, const Mat4f& value) const {
        gl_->ProgramUniformMatrix4fv(program_.name(), at(uniform), 1, GL_FALSE, value.data());
    }

  private:
    GLint at(const char* uniform) const { return gl_->GetUniformLocation(program_.name(), uniform); }
    const GlFunctions* gl_ = nullptr;
    GlObject program_;
};

/// A framebuffer that draws into these images, in order, with a depth image (0: none).
GlObject makeFramebufferOver(const GlFunctions& gl, std::initializer_list<GLuint> colours, GLuint depth);

GLint glInteger(const GlFunctions& gl, GLenum what);

}  // namespace prt
