#pragma once

#include <string>

namespace lorica {

/// GLSL 3.30 sources, put together from shared pieces.
namespace shaders {

/// What of the scene a surface is drawn for.
enum class Pass {
  kLit,      ///< the picture itself
  kShadow,   ///< depth seen from the key light
  kContact,  ///< nearness to the ground seen from below: the contact shadow
};
/// Skin: attributes position 0, normal 1, color 2.
/// @param shadowEachPixel  look the shadow up in the fragment shader; else for each vertex, which costs far less where
///                         triangles are about as small as pixels
std::string skinVertex(Pass pass, bool shadowEachPixel);
/// Props: attributes corner 0, normal 1; an instance's columns 2 to 5, extents and bevel 6, color 7.
std::string propVertex(Pass pass);
std::string surfaceFragment(Pass pass, bool shadowEachPixel);

/// Attribute 0 is a place in clip space.
std::string skyVertex();
std::string skyFragment();
/// The floor; attribute 0 is its place in xz.
std::string groundVertex();
/// @param shaded  with grid, shadow and contact shadow; else the plain far floor
std::string groundFragment(bool shaded);

/// Hulls and bones: OverlayVertex.
std::string overlayVertex();
std::string overlayFragment();
/// Contact markers: center 0, corner 1; discs that face the viewer. Uniform "tint" holds their alpha.
std::string markerVertex();
std::string markerFragment();

/// Grains: points that look like balls; center 0, color 1. Uniform "grain": radius [m]; the smallest and the largest
/// point size of the pass [pixels].
std::string grainVertex(Pass pass);
/// @param fine  with a round rim that is smoothed by alpha to coverage, and the depth of a ball: for grains of many
///              pixels. Else square or nearly so, which is drawn before it is shaded.
std::string grainFragment(Pass pass, bool fine);

/// A triangle over the whole target, and one over the rectangle in uniform "rectangle" (clip space).
std::string fullVertex();
std::string blurFragment();
std::string panelVertex();
std::string panelFragment();

}  // namespace shaders
}  // namespace lorica
