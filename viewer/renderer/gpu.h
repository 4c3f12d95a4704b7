#pragma once

#include "viewer/renderer/gl_functions.h"

#include <string>
#include <vector>

namespace lorica {

/// A buffer that is refilled in each frame and grows if necessary.
struct StreamBuffer {
  GLuint id = 0;
  std::size_t capacity = 0;  ///< [bytes]
};

/// The function table of one context and all OpenGL objects created through it. The destructor deletes the objects, so
/// the context must be current then.
class Gpu {
 public:
  explicit Gpu(const GlFunctions& functions) : gl(functions) {}
  ~Gpu();
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;

  GLuint makeBuffer() { return made(gl.GenBuffers, buffers_); }
  GLuint makeVertexArray() { return made(gl.GenVertexArrays, vertexArrays_); }
  GLuint makeFramebuffer() { return made(gl.GenFramebuffers, framebuffers_); }
  GLuint makeRenderbuffer() { return made(gl.GenRenderbuffers, renderbuffers_); }
  /// A 2D texture, bound to unit 0, clamped to its edges.
  GLuint makeTexture(GLint filter);

  /// The name of a buffer texture.
  GLuint makeBufferTexture() { return made(gl.GenTextures, textures_); }
  /// Deletes a texture before the context ends.
  void discardTexture(GLuint texture);

  /// Compiles and links a program; the uniform blocks "Frame" and "Surface", if it uses them, are bound to points 0
  /// and 1.
  /// @return the program, or an error with the name and the start of the compiler's log
  [[nodiscard]] Result<GLuint> makeProgram(const char* name, const std::string& vertex, const std::string& fragment);

  /// Binds the buffer to GL_ARRAY_BUFFER and writes the bytes at its start.
  void upload(StreamBuffer& buffer, const void* data, std::size_t bytes) const;

  template <typename T>
  void upload(StreamBuffer& buffer, const std::vector<T>& data) const {
    upload(buffer, data.data(), data.size() * sizeof(T));
  }

  const GlFunctions gl;

 private:
  static GLuint made(void (*generate)(GLsizei, GLuint*), std::vector<GLuint>& names) {
    generate(1, &names.emplace_back());
    return names.back();
  }

  std::vector<GLuint> buffers_, vertexArrays_, framebuffers_, renderbuffers_, textures_, programs_;
};

}  // namespace lorica
