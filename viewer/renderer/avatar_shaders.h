#pragma once

#include "skinning/look/look.h"
#include "viewer/renderer/shaders.h"

#include <array>
#include <cstdint>
#include <string>

namespace lorica::shaders {

/// Textures of an avatar's material, in the order of Material::textures() and of their rows in the uniform block
/// "Surface". Their units follow kFirstAvatarUnit in the same order.
enum class AvatarSlot : std::uint8_t {
  kBase,
  kMetallicRoughness,
  kNormal,
  kOcclusion,
  kEmissive,
  kShade,
  kShift,
  kMatcap,
  kRim,
  kOutlineWidth,
  kAnimationMask,
};
inline constexpr int kAvatarSlots = 11;
inline constexpr int kJointUnit = 3;
inline constexpr int kFirstAvatarUnit = 4;  ///< 4 to 14

/// The uniform block "Surface" (std140): a material's numbers.
struct SurfaceUniforms {
  Eigen::Vector4f baseColor;
  Eigen::Vector4f emissive;  ///< w: normal scale
  Eigen::Vector4f physical;  ///< metallic, roughness, occlusion strength, alpha cutoff
  Eigen::Vector4f shade;     ///< w: shading shift
  Eigen::Vector4f toon;      ///< toony, shift scale, ambient light evened out, rim lighting mix
  Eigen::Vector4f matcap;
  Eigen::Vector4f rim;      ///< w: power
  Eigen::Vector4f outline;  ///< rim lift, width, 1 = screen, lighting mix
  Eigen::Vector4f outlineColor;
  Eigen::Vector4f animation;                 ///< scroll [1/s], rotation [rad/s]
  Eigen::Vector4f uvRows[2 * kAvatarSlots];  ///< per slot: two rows of its transform; w of the first: set

  [[nodiscard]] bool operator==(const SurfaceUniforms&) const = default;
};

[[nodiscard]] SurfaceUniforms surfaceUniforms(const Material& material);

/// What a program for avatars is made for. Programs are compiled when first needed: what a material lacks costs
/// nothing.
struct AvatarVariant {
  /// The pass that the program draws.
  enum class Draw : std::uint8_t {
    kSurface,
    kOutline,
    kDepth,  ///< before blended surfaces: only where they are more opaque than not
    kShadow,
    kContact,
  };
  Draw draw = Draw::kSurface;
  Shading shading = Shading::kPhysical;
  AlphaMode alpha = AlphaMode::kOpaque;
  bool flat = false;
  bool fading = false;  ///< see shaders::fading()
  bool posed = false;   ///< the vertices are in their pose
  bool fewInfluences = true;
  bool shadowEachPixel = true;
  std::uint32_t textures = 0;  ///< bits by AvatarSlot

  [[nodiscard]] bool operator==(const AvatarVariant&) const = default;
};

[[nodiscard]] AvatarVariant variantFor(const Material& material, AvatarVariant::Draw draw);

[[nodiscard]] std::string avatarVertex(const AvatarVariant& variant);
[[nodiscard]] std::string avatarFragment(const AvatarVariant& variant);

/// The sampler of a slot in the shaders.
[[nodiscard]] const char* samplerName(AvatarSlot slot);

}  // namespace lorica::shaders
