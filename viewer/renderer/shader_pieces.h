#pragma once

#include <string>

namespace lorica::shaders {

/// Pieces that several shaders start from. The first line of frameBlock() is the version.
[[nodiscard]] std::string frameBlock();    ///< the uniform block "Frame"
[[nodiscard]] std::string colorCurves();   ///< vec3 toneMap(vec3) and toSrgb(vec3), of linear RGB
[[nodiscard]] std::string backdrop();      ///< the colours of sky and floor, sRGB
[[nodiscard]] std::string shadowLookup();  ///< float shadowAt(vec3 position, vec3 normal): share of the key light

}  // namespace lorica::shaders
