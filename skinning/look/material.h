#pragma once

#include "geometry/math.h"

#include <array>
#include <cstdint>
#include <string>

namespace lorica {

/// What a texture returns outside 0 to 1.
enum class TextureWrap : std::uint8_t { kRepeat, kMirror, kClamp };

/// A picture as a material uses it.
struct TextureUse {
  int picture = -1;                          ///< index into Look::pictures; -1 = none: white
  int uvSet = 0;                             ///< 0 or 1
  TextureWrap wrapU = TextureWrap::kRepeat;  ///< outside 0 to 1
  TextureWrap wrapV = TextureWrap::kRepeat;  ///< the same
  bool smooth = true;                        ///< linear interpolation between texels; false: nearest
  /// KHR_texture_transform: texture coordinates = this * (u, v, 1).
  Eigen::Matrix<float, 2, 3> transform = Eigen::Matrix<float, 2, 3>::Identity();
  float rotation = 0.0f;  ///< the one in `transform` [rad]

  [[nodiscard]] bool given() const { return picture >= 0; }  ///< whether there is a texture
};

/// How a surface answers light.
enum class Shading : std::uint8_t {
  kPhysical,  ///< metallic-roughness of glTF 2.0
  kUnlit,     ///< KHR_materials_unlit
  kToon,      ///< MToon
};

/// What opacity does: nothing, a cut at alphaCutoff, or blending.
enum class AlphaMode : std::uint8_t { kOpaque, kMask, kBlend };

/// Units of the width of a toon outline.
enum class OutlineMode : std::uint8_t {
  kNone,
  kWorld,   ///< [m]
  kScreen,  ///< fraction of half the picture's height
};

/// Parameters of MToon 1.0. Those of MToon 0.x are converted to them.
/// https://github.com/vrm-c/vrm-specification: VRMC_materials_mtoon-1.0/README.md
struct ToonMaterial {
  Vec3f shadeColor{0.0f, 0.0f, 0.0f};        ///< where no light falls, linear RGB
  TextureUse shade;                          ///< factor of shadeColor
  float shift = 0.0f;                        ///< of the border between light and shade
  TextureUse shiftTexture;                   ///< red channel times shiftScale is added to shift
  float shiftScale = 1.0f;                   ///< factor of shiftTexture
  float toony = 0.9f;                        ///< sharpness of that border, 0 to 1
  Vec3f matcapFactor{1, 1, 1};               ///< linear RGB
  TextureUse matcap;                         ///< by the normal's direction on screen; added
  Vec3f rimColor{0, 0, 0};                   ///< linear RGB
  float rimPower = 5.0f;                     ///< Fresnel exponent
  float rimLift = 0.0f;                      ///< added to the Fresnel term
  TextureUse rim;                            ///< factor of matcap and rim
  float rimLightingMix = 1.0f;               ///< 0 = the rim glows, 1 = it is lit
  OutlineMode outline = OutlineMode::kNone;  ///< what outlineWidth is measured in
  float outlineWidth = 0.0f;                 ///< see OutlineMode
  TextureUse outlineWidthTexture;            ///< green channel is a factor of the width
  Vec3f outlineColor{0, 0, 0};               ///< linear RGB
  float outlineLightingMix = 1.0f;           ///< 0 = its own colour, 1 = times the lit surface
  float giEqualization = 0.9f;               ///< 1 = ambient light is the same from all directions
  TextureUse uvAnimationMask;                ///< blue channel is a factor of the animation below
  Eigen::Vector2f uvScroll{0, 0};            ///< of all textures [1/s]
  float uvRotation = 0.0f;                   ///< about their middle [rad/s]
};

/// How a surface looks: glTF 2.0 (https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html#materials) and MToon.
struct Material {
  std::string name;                       ///< in the file; may be empty
  Shading shading = Shading::kPhysical;   ///< which of the values below count
  Eigen::Vector4f baseColor{1, 1, 1, 1};  ///< linear RGB and opacity; the lit colour of toon materials
  TextureUse base;                        ///< RGB in sRGB, and opacity; a factor of baseColor
  float metallic = 1.0f;                  ///< 0 to 1
  float roughness = 1.0f;                 ///< 0 to 1
  TextureUse metallicRoughness;           ///< green: roughness, blue: metallic
  TextureUse normal;                      ///< tangent space
  float normalScale = 1.0f;               ///< factor of its x and y
  TextureUse occlusion;                   ///< red channel
  float occlusionStrength = 1.0f;         ///< 0 = no occlusion, 1 = all of the texture
  Vec3f emissive{0, 0, 0};                ///< linear RGB; may exceed 1
  float emissiveStrength = 1.0f;          ///< factor of `emissive`
  TextureUse emissiveTexture;             ///< RGB in sRGB; a factor of `emissive`
  AlphaMode alpha = AlphaMode::kOpaque;   ///< what baseColor's opacity does
  float alphaCutoff = 0.5f;               ///< of AlphaMode::kMask
  bool doubleSided = false;               ///< both sides are seen and lit
  bool blendWritesDepth = false;          ///< MToon's transparentWithZWrite
  int drawOrder = 0;                      ///< of blended materials: lower ones first (MToon's renderQueueOffsetNumber)
  ToonMaterial toon;                      ///< only for Shading::kToon

  /// All textures of a Material or a const Material, so that a check or a conversion does not miss one.
  template <typename M>
  [[nodiscard]] static auto texturesOf(M& material) {
    return std::array{&material.base,
                      &material.metallicRoughness,
                      &material.normal,
                      &material.occlusion,
                      &material.emissiveTexture,
                      &material.toon.shade,
                      &material.toon.shiftTexture,
                      &material.toon.matcap,
                      &material.toon.rim,
                      &material.toon.outlineWidthTexture,
                      &material.toon.uvAnimationMask};
  }
  [[nodiscard]] auto textures() const { return texturesOf(*this); }  ///< the same of this one
};

}  // namespace lorica
