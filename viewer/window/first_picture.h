#pragma once

#include "viewer/renderer/gl_functions.h"

namespace lorica {

/// Draws what a window shows before anything else can be drawn: the background with an empty progress bar, without
/// shaders and fonts. Into the bound framebuffer.
void drawFirstPicture(const GlFunctions& gl, int width, int height);

}  // namespace lorica
