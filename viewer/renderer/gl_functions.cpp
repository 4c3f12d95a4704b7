#include "viewer/renderer/gl_functions.h"

namespace lorica {

Result<GlFunctions> loadGlFunctions(void* (*getProc)(const char*)) {
  GlFunctions gl;
#define LORICA_GL_LOAD(TYPE, name)                                                                     \
  gl.name = reinterpret_cast<PFNGL##TYPE##PROC>(getProc("gl" #name));                                  \
  if (gl.name == nullptr) {                                                                            \
    return Error{ErrorCode::kNoDisplay, "the OpenGL library lacks gl" #name ": OpenGL 3.3 is needed"}; \
  }
  LORICA_GL_FUNCTIONS(LORICA_GL_LOAD)
#undef LORICA_GL_LOAD
  return gl;
}

}  // namespace lorica
