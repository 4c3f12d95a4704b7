#pragma once

#include "geometry/result.h"
#include "viewer/renderer/image.h"

#include <GL/glcorearb.h>

/// The OpenGL 3.3 core functions that Lorica uses: PFNGL<first>PROC and the name without "gl".
#define LORICA_GL_FUNCTIONS(X)                                      \
  X(ACTIVETEXTURE, ActiveTexture)                                   \
  X(ATTACHSHADER, AttachShader)                                     \
  X(BINDBUFFER, BindBuffer)                                         \
  X(BINDBUFFERBASE, BindBufferBase)                                 \
  X(BINDFRAMEBUFFER, BindFramebuffer)                               \
  X(BINDRENDERBUFFER, BindRenderbuffer)                             \
  X(BINDTEXTURE, BindTexture)                                       \
  X(BINDVERTEXARRAY, BindVertexArray)                               \
  X(BLENDEQUATION, BlendEquation)                                   \
  X(BLENDFUNC, BlendFunc)                                           \
  X(BLENDFUNCSEPARATE, BlendFuncSeparate)                           \
  X(BLITFRAMEBUFFER, BlitFramebuffer)                               \
  X(BUFFERDATA, BufferData)                                         \
  X(BUFFERSUBDATA, BufferSubData)                                   \
  X(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus)                 \
  X(CLEAR, Clear)                                                   \
  X(CLEARCOLOR, ClearColor)                                         \
  X(COLORMASK, ColorMask)                                           \
  X(COMPILESHADER, CompileShader)                                   \
  X(CREATEPROGRAM, CreateProgram)                                   \
  X(CREATESHADER, CreateShader)                                     \
  X(CULLFACE, CullFace)                                             \
  X(DELETEBUFFERS, DeleteBuffers)                                   \
  X(DELETEFRAMEBUFFERS, DeleteFramebuffers)                         \
  X(DELETEPROGRAM, DeleteProgram)                                   \
  X(DELETERENDERBUFFERS, DeleteRenderbuffers)                       \
  X(DELETESHADER, DeleteShader)                                     \
  X(DELETETEXTURES, DeleteTextures)                                 \
  X(DELETEVERTEXARRAYS, DeleteVertexArrays)                         \
  X(DEPTHFUNC, DepthFunc)                                           \
  X(DEPTHMASK, DepthMask)                                           \
  X(DISABLE, Disable)                                               \
  X(DISABLEVERTEXATTRIBARRAY, DisableVertexAttribArray)             \
  X(DRAWARRAYS, DrawArrays)                                         \
  X(DRAWBUFFER, DrawBuffer)                                         \
  X(DRAWELEMENTS, DrawElements)                                     \
  X(DRAWELEMENTSINSTANCED, DrawElementsInstanced)                   \
  X(ENABLE, Enable)                                                 \
  X(ENABLEVERTEXATTRIBARRAY, EnableVertexAttribArray)               \
  X(FINISH, Finish)                                                 \
  X(FRAMEBUFFERRENDERBUFFER, FramebufferRenderbuffer)               \
  X(FRAMEBUFFERTEXTURE2D, FramebufferTexture2D)                     \
  X(GENBUFFERS, GenBuffers)                                         \
  X(GENERATEMIPMAP, GenerateMipmap)                                 \
  X(GENFRAMEBUFFERS, GenFramebuffers)                               \
  X(GENRENDERBUFFERS, GenRenderbuffers)                             \
  X(GENTEXTURES, GenTextures)                                       \
  X(GENVERTEXARRAYS, GenVertexArrays)                               \
  X(GETERROR, GetError)                                             \
  X(GETFLOATV, GetFloatv)                                           \
  X(GETINTEGERV, GetIntegerv)                                       \
  X(GETPROGRAMINFOLOG, GetProgramInfoLog)                           \
  X(GETPROGRAMIV, GetProgramiv)                                     \
  X(GETSHADERINFOLOG, GetShaderInfoLog)                             \
  X(GETSHADERIV, GetShaderiv)                                       \
  X(GETSTRING, GetString)                                           \
  X(GETUNIFORMBLOCKINDEX, GetUniformBlockIndex)                     \
  X(GETUNIFORMLOCATION, GetUniformLocation)                         \
  X(LINKPROGRAM, LinkProgram)                                       \
  X(PIXELSTOREI, PixelStorei)                                       \
  X(POLYGONOFFSET, PolygonOffset)                                   \
  X(READBUFFER, ReadBuffer)                                         \
  X(READPIXELS, ReadPixels)                                         \
  X(RENDERBUFFERSTORAGE, RenderbufferStorage)                       \
  X(RENDERBUFFERSTORAGEMULTISAMPLE, RenderbufferStorageMultisample) \
  X(SCISSOR, Scissor)                                               \
  X(SHADERSOURCE, ShaderSource)                                     \
  X(TEXBUFFER, TexBuffer)                                           \
  X(TEXIMAGE2D, TexImage2D)                                         \
  X(TEXPARAMETERFV, TexParameterfv)                                 \
  X(TEXPARAMETERI, TexParameteri)                                   \
  X(TEXSUBIMAGE2D, TexSubImage2D)                                   \
  X(UNIFORM1I, Uniform1i)                                           \
  X(UNIFORM4F, Uniform4f)                                           \
  X(UNIFORMBLOCKBINDING, UniformBlockBinding)                       \
  X(USEPROGRAM, UseProgram)                                         \
  X(VERTEXATTRIB3F, VertexAttrib3f)                                 \
  X(VERTEXATTRIBDIVISOR, VertexAttribDivisor)                       \
  X(VERTEXATTRIBIPOINTER, VertexAttribIPointer)                     \
  X(VERTEXATTRIBPOINTER, VertexAttribPointer)                       \
  X(VIEWPORT, Viewport)

namespace lorica {

/// Function table of one context. Several OpenGL libraries can be loaded in one process, so none is linked and the
/// table is not global. Filled by OSMesaGetProcAddress, eglGetProcAddress or glfwGetProcAddress.
struct GlFunctions {
#define LORICA_GL_MEMBER(TYPE, name) PFNGL##TYPE##PROC name = nullptr;
  LORICA_GL_FUNCTIONS(LORICA_GL_MEMBER)
#undef LORICA_GL_MEMBER
};

/// @param getProc  finds a function of the current context by its full name ("glClear")
/// @return the table, or kNoDisplay with the first function that the library lacks
[[nodiscard]] Result<GlFunctions> loadGlFunctions(void* (*getProc)(const char*));

/// What a framebuffer holds; it stays bound.
[[nodiscard]] Image readPixels(const GlFunctions& gl, GLuint framebuffer, int width, int height);

}  // namespace lorica
