#include "viewer/renderer/gl_functions.h"

#include <algorithm>

namespace lorica {

Result<GlFunctions> loadGlFunctions(void* (*getProc)(const char*)) {
  GlFunctions gl;
#define LORICA_GL_LOAD(name)                                                                           \
  gl.name = reinterpret_cast<decltype(gl.name)>(getProc("gl" #name));                                  \
  if (gl.name == nullptr) {                                                                            \
    return Error{ErrorCode::kNoDisplay, "the OpenGL library lacks gl" #name ": OpenGL 3.3 is needed"}; \
  }
  LORICA_GL_FUNCTIONS(LORICA_GL_LOAD)
#undef LORICA_GL_LOAD
  return gl;
}

Image readPixels(const GlFunctions& gl, GLuint framebuffer, int width, int height) {
  Image image = Image::filled(width, height);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  // OpenGL's rows start at the bottom.
  for (int top = 0, bottom = height - 1; top < bottom; ++top, --bottom) {
    std::swap_ranges(image.pixel(0, top), image.pixel(0, top + 1), image.pixel(0, bottom));
  }
  return image;
}

}  // namespace lorica
