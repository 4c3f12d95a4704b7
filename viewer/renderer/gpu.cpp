#include "viewer/renderer/gpu.h"

#include "geometry/errors.h"

#include <utility>

namespace lorica {

Gpu::~Gpu() {
  for (const GLuint program : programs_) gl.DeleteProgram(program);
  gl.DeleteVertexArrays(vertexArrays_.size(), vertexArrays_.data());
  gl.DeleteFramebuffers(framebuffers_.size(), framebuffers_.data());
  gl.DeleteRenderbuffers(renderbuffers_.size(), renderbuffers_.data());
  gl.DeleteTextures(textures_.size(), textures_.data());
  gl.DeleteBuffers(buffers_.size(), buffers_.data());
}

GLuint Gpu::makeTexture(GLint filter) {
  const GLuint texture = made(gl.GenTextures, textures_);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, texture);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

void Gpu::discardTexture(GLuint texture) {
  gl.DeleteTextures(1, &texture);
  std::erase(textures_, texture);
}

Result<GLuint> Gpu::makeProgram(const char* name, const std::string& vertex, const std::string& fragment) {
  const GLuint program = gl.CreateProgram();
  programs_.push_back(program);
  std::string log(1024, '\0');
  GLint ok = 0;
  for (const GLenum stage : {GL_VERTEX_SHADER, GL_FRAGMENT_SHADER}) {
    const GLuint shader = gl.CreateShader(stage);
    const char* text = stage == GL_VERTEX_SHADER ? vertex.c_str() : fragment.c_str();
    gl.ShaderSource(shader, 1, &text, nullptr);
    gl.CompileShader(shader);
    gl.GetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (!ok) gl.GetShaderInfoLog(shader, log.size(), nullptr, log.data());
    gl.AttachShader(program, shader);
    gl.DeleteShader(shader);
    if (!ok) {
      return noDisplay("the OpenGL driver cannot compile the {} shader '{}': {}",
                       stage == GL_VERTEX_SHADER ? "vertex" : "fragment", name, log.c_str());
    }
  }
  gl.LinkProgram(program);
  gl.GetProgramiv(program, GL_LINK_STATUS, &ok);
  if (!ok) {
    gl.GetProgramInfoLog(program, log.size(), nullptr, log.data());
    return noDisplay("the OpenGL driver cannot link the shader program '{}': {}", name, log.c_str());
  }
  for (const auto& [block, point] : {std::pair{"Frame", 0u}, {"Surface", 1u}}) {
    const GLuint index = gl.GetUniformBlockIndex(program, block);
    if (index != GL_INVALID_INDEX) gl.UniformBlockBinding(program, index, point);
  }
  return program;
}

void Gpu::upload(StreamBuffer& buffer, const void* data, std::size_t bytes) const {
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer.id);
  if (bytes > buffer.capacity) {
    buffer.capacity = bytes + bytes / 2;
    gl.BufferData(GL_ARRAY_BUFFER, buffer.capacity, nullptr, GL_STREAM_DRAW);
  }
  if (bytes > 0) gl.BufferSubData(GL_ARRAY_BUFFER, 0, bytes, data);
}

}  // namespace lorica
