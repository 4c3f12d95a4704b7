#pragma once

#include "geometry/result.h"
#include "viewer/renderer/image.h"

#define GL_GLEXT_PROTOTYPES  // for their types: none of them is linked
#include <GL/glcorearb.h>

/// The OpenGL 3.3 core functions that Lorica uses, without "gl".
// Several a line, which clang-format would each indent further.
// clang-format off
#define LORICA_GL_FUNCTIONS(X)                                                                                       \
  X(ActiveTexture) X(AttachShader) X(BindBuffer) X(BindBufferBase) X(BindFramebuffer) X(BindRenderbuffer)            \
  X(BindTexture) X(BindVertexArray) X(BlendEquation) X(BlendFunc) X(BlendFuncSeparate) X(BlitFramebuffer)            \
  X(BufferData) X(BufferSubData) X(CheckFramebufferStatus) X(Clear) X(ClearColor) X(ColorMask) X(CompileShader)      \
  X(CreateProgram) X(CreateShader) X(CullFace) X(DeleteBuffers) X(DeleteFramebuffers) X(DeleteProgram)               \
  X(DeleteRenderbuffers) X(DeleteShader) X(DeleteTextures) X(DeleteVertexArrays) X(DepthFunc) X(DepthMask)           \
  X(Disable) X(DisableVertexAttribArray) X(DrawArrays) X(DrawBuffer) X(DrawElements) X(DrawElementsInstanced)        \
  X(Enable) X(EnableVertexAttribArray) X(Finish) X(FramebufferRenderbuffer) X(FramebufferTexture2D) X(GenBuffers)    \
  X(GenerateMipmap) X(GenFramebuffers) X(GenRenderbuffers) X(GenTextures) X(GenVertexArrays) X(GetError)             \
  X(GetFloatv) X(GetIntegerv) X(GetProgramInfoLog) X(GetProgramiv) X(GetShaderInfoLog) X(GetShaderiv) X(GetString)   \
  X(GetUniformBlockIndex) X(GetUniformLocation) X(LinkProgram) X(PixelStorei) X(PolygonOffset) X(ReadBuffer)         \
  X(ReadPixels) X(RenderbufferStorage) X(RenderbufferStorageMultisample) X(Scissor) X(ShaderSource) X(TexBuffer)     \
  X(TexImage2D) X(TexParameterfv) X(TexParameteri) X(TexSubImage2D) X(Uniform1i) X(Uniform4f) X(UniformBlockBinding) \
  X(UseProgram) X(VertexAttrib3f) X(VertexAttribDivisor) X(VertexAttribIPointer) X(VertexAttribPointer) X(Viewport)
// clang-format on

namespace lorica {

/// Function table of one context. Several OpenGL libraries can be loaded in one process, so none is linked and the
/// table is not global. Filled by OSMesaGetProcAddress, eglGetProcAddress or glfwGetProcAddress.
struct GlFunctions {
#define LORICA_GL_MEMBER(name) decltype(&gl##name) name = nullptr;
  LORICA_GL_FUNCTIONS(LORICA_GL_MEMBER)
#undef LORICA_GL_MEMBER
};

/// @param getProc  finds a function of the current context by its full name ("glClear")
/// @return the table, or kNoDisplay with the first function that the library lacks
[[nodiscard]] Result<GlFunctions> loadGlFunctions(void* (*getProc)(const char*));

/// What a framebuffer holds; it stays bound.
[[nodiscard]] Image readPixels(const GlFunctions& gl, GLuint framebuffer, int width, int height);

}  // namespace lorica
