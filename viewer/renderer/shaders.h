#pragma once

#include <string>

namespace lorica {

/// GLSL 3.30 sources, assembled from shared pieces.
namespace shaders {

/// The render pass that a surface is drawn in.
enum class Pass {
  kLit,      ///< the final picture
  kShadow,   ///< depth as seen from the key light
  kContact,  ///< proximity to the ground as seen from below, for the contact shadow
};

/// Pieces that several shaders start from. The first line of frameBlock() is the version.
[[nodiscard]] std::string frameBlock();    ///< the uniform block "Frame"
[[nodiscard]] std::string colorCurves();   ///< vec3 toneMap(vec3) and toSrgb(vec3), of linear RGB
[[nodiscard]] std::string shadowLookup();  ///< float shadowAt(vec3 position, vec3 normal): share of the key light
[[nodiscard]] std::string fullVertex();    ///< a triangle over the whole target

/// The shaders of a program.
struct Sources {
  std::string vertex, fragment;
};

/// Skin: attributes position 0, normal 1, color 2.
/// @param shadowEachPixel  shadow lookup in the fragment shader; otherwise per vertex, which is much cheaper if
///                         triangles are about as small as pixels
std::string skinVertex(Pass pass, bool shadowEachPixel);
/// Props: attributes corner 0, normal 1; per instance columns 2 to 5, extents and bevel 6, color 7. Uniform "which" of
/// the lit pass: x is 1 for those that fade, 0 for the others.
std::string propVertex(Pass pass);
std::string surfaceFragment(Pass pass, bool shadowEachPixel);

/// A fragment shader that multiplies the alpha of its colour with "opacity". Of a pass for shadows, which have no
/// alpha, it leaves out that share of the pixels, in a pattern without rows. @param from  "uniform" (the x of a vec4),
/// or "flat in": from the vertex shader
std::string fading(const std::string& fragment, bool lit, const std::string& from = "uniform");

/// Attribute 0 is the position in clip space.
Sources sky();
/// Floor; attribute 0 is the position in xz. @param shaded  with grid, shadow and contact shadow; otherwise the plain
/// far floor
Sources ground(bool shaded);
/// Hulls and bones: OverlayVertex.
Sources overlay();
/// Contacts: center 0, corner 1; discs that face the viewer. Uniform "tint" has their alpha.
Sources markers();
/// Grains: points that look like balls; center 0, color and relative size 1. Uniform "grain": radius [m]; minimum and
/// maximum point size of the pass [pixels].
/// @param fine  for grains of many pixels: with a round rim, anti-aliased by alpha to coverage, and the depth of a
///              ball. Otherwise nearly square, which allows the depth test before shading.
Sources grains(Pass pass, bool fine);

/// Water, by passes: drops leave their depth and foam (uniform "grain": radius [m], pixels of the map to one of the
/// picture, maximum point size); that is smoothed, along one direction at a time (uniform "direction": x, y, radius and
/// pixels as before); normals are found; and the picture behind is seen through it (uniform "water": colour, bound of
/// the cells).
Sources drops();
Sources waterSmoothing();
Sources waterNormals();
Sources water();

Sources blur();
/// Over the uniform "rectangle" (clip space).
Sources panel();

}  // namespace shaders
}  // namespace lorica
