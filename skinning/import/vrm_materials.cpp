#include "skinning/import/vrm_materials.h"

#include "skinning/import/json_values.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

namespace lorica {

namespace {

using Json = nlohmann::json;

// Of blended materials, those that write depth are drawn first, see VRMC_materials_mtoon, "Rendering".
constexpr int kWithoutDepth = 19;

[[nodiscard]] float linear(float encoded) {
  return std::pow(std::max(encoded, 0.0f), 2.2f);
}

/// A colour of VRM 0.x: gamma-encoded, but not its opacity.
void gammaColor(const Json& vectors, const char* key, Vec3f& color) {
  std::array<float, 3> encoded = {-1.0f, 0.0f, 0.0f};
  numbersOf(vectors, key, encoded);
  if (encoded[0] >= 0.0f) color = {linear(encoded[0]), linear(encoded[1]), linear(encoded[2])};
}

/// Orders of VRM 0.x are Unity's render queues: only their ranks among the file's blended materials count.
struct Queues {
  std::set<int> withDepth, withoutDepth;

  [[nodiscard]] int orderOf(int queue, bool writesDepth) const {
    const std::set<int>& all = writesDepth ? withDepth : withoutDepth;
    const int rank = static_cast<int>(std::distance(all.begin(), all.lower_bound(queue)));
    if (writesDepth) return std::min(rank, 9);
    return kWithoutDepth - std::min(static_cast<int>(all.size()) - 1 - rank, 9);
  }
};

struct Blend0 {
  bool blended = false;
  bool writesDepth = false;
  int queue = -1;
};

[[nodiscard]] Blend0 blendOf(const Json& properties) {
  const Json& shader = memberOf(properties, "shader");
  Blend0 blend;
  const bool unlitWithDepth = shader == "VRM/UnlitTransparentZWrite";
  blend.blended = shader == "VRM/UnlitTransparent" || unlitWithDepth ||
                  (shader == "VRM/MToon" && memberOf(memberOf(properties, "keywordMap"), "_ALPHABLEND_ON") == true);
  blend.writesDepth = unlitWithDepth || (shader == "VRM/MToon" &&
                                         numberOf(memberOf(properties, "floatProperties"), "_ZWrite", 0.0f) == 1.0f);
  blend.queue = static_cast<int>(numberOf(properties, "renderQueue", -1.0f));
  return blend;
}

void applyMtoon0(const Json& properties, const TextureOfIndex& textureOf, Material& material) {
  const Json& floats = memberOf(properties, "floatProperties");
  const Json& vectors = memberOf(properties, "vectorProperties");
  const Json& textures = memberOf(properties, "textureProperties");
  const Json& keywords = memberOf(properties, "keywordMap");

  // One transform for all textures, in Unity's coordinates: v points up.
  std::array<float, 4> moved = {0.0f, 0.0f, 1.0f, 1.0f};
  numbersOf(vectors, "_MainTex", moved);
  const auto textureNamed = [&](const char* key) {
    const Json& index = memberOf(textures, key);
    TextureUse use = index.is_number_integer() ? textureOf(index.get<int>()) : TextureUse();
    use.transform << moved[2], 0.0f, moved[0], 0.0f, moved[3], 1.0f - moved[3] - moved[1];
    return use;
  };
  material.shading = Shading::kToon;
  material.alpha = AlphaMode::kOpaque;
  if (memberOf(keywords, "_ALPHATEST_ON") == true) material.alpha = AlphaMode::kMask;
  if (memberOf(keywords, "_ALPHABLEND_ON") == true) material.alpha = AlphaMode::kBlend;
  material.alphaCutoff = numberOf(floats, "_Cutoff", 0.5f);
  material.doubleSided = numberOf(floats, "_CullMode", 2.0f) == 0.0f;
  std::array<float, 4> color = {1.0f, 1.0f, 1.0f, 1.0f};
  numbersOf(vectors, "_Color", color);
  material.baseColor = {linear(color[0]), linear(color[1]), linear(color[2]), color[3]};
  material.base = textureNamed("_MainTex");
  material.normal = textureNamed("_BumpMap");
  material.normalScale = numberOf(floats, "_BumpScale", 1.0f);
  material.emissive = Vec3f::Zero();
  gammaColor(vectors, "_EmissionColor", material.emissive);
  material.emissiveTexture = textureNamed("_EmissionMap");

  ToonMaterial& toon = material.toon;
  toon.shadeColor = {linear(0.97f), linear(0.81f), linear(0.86f)};
  gammaColor(vectors, "_ShadeColor", toon.shadeColor);
  toon.shade = textureNamed("_ShadeTexture");
  const float shift = numberOf(floats, "_ShadeShift", 0.0f);
  const float toony = numberOf(floats, "_ShadeToony", 0.9f);
  toon.toony = toony + (1.0f - toony) * (0.5f + 0.5f * shift);
  toon.shift = -shift - (1.0f - toon.toony);
  toon.matcap = textureNamed("_SphereAdd");
  toon.matcap.transform = TextureUse().transform;
  toon.matcapFactor = toon.matcap.given() ? Vec3f::Ones() : Vec3f::Zero();
  toon.rim = textureNamed("_RimTexture");
  gammaColor(vectors, "_RimColor", toon.rimColor);
  toon.rimPower = numberOf(floats, "_RimFresnelPower", 1.0f);
  toon.rimLift = numberOf(floats, "_RimLift", 0.0f);
  toon.rimLightingMix = numberOf(floats, "_RimLightingMix", 0.0f);
  const float mode = numberOf(floats, "_OutlineWidthMode", 0.0f);
  toon.outline = mode == 1.0f ? OutlineMode::kWorld : mode == 2.0f ? OutlineMode::kScreen : OutlineMode::kNone;
  toon.outlineWidth = 0.01f * numberOf(floats, "_OutlineWidth", 0.0f);  // centimetres, or percent
  toon.outlineWidthTexture = textureNamed("_OutlineWidthTexture");
  gammaColor(vectors, "_OutlineColor", toon.outlineColor);
  toon.outlineLightingMix =
      numberOf(floats, "_OutlineColorMode", 0.0f) == 1.0f ? numberOf(floats, "_OutlineLightingMix", 1.0f) : 0.0f;
  toon.uvAnimationMask = textureNamed("_UvAnimMaskTexture");
  toon.uvScroll = {numberOf(floats, "_UvAnimScrollX", 0.0f), -numberOf(floats, "_UvAnimScrollY", 0.0f)};
  toon.uvRotation = numberOf(floats, "_UvAnimRotation", 0.0f);
}

void applyUnlit0(const Json& properties, const TextureOfIndex& textureOf, Material& material) {
  const Json& vectors = memberOf(properties, "vectorProperties");
  material.shading = Shading::kUnlit;
  material.alpha = memberOf(properties, "shader") == "VRM/UnlitCutout" ? AlphaMode::kMask : AlphaMode::kOpaque;
  material.alphaCutoff = numberOf(memberOf(properties, "floatProperties"), "_Cutoff", 0.5f);
  std::array<float, 4> color = {1.0f, 1.0f, 1.0f, 1.0f};
  numbersOf(vectors, "_Color", color);
  material.baseColor = {linear(color[0]), linear(color[1]), linear(color[2]), color[3]};
  const Json& index = memberOf(memberOf(properties, "textureProperties"), "_MainTex");
  if (index.is_number_integer()) material.base = textureOf(index.get<int>());
}

}  // namespace

void applyMtoon1(const Json& mtoon, const std::function<TextureUse(const Json&)>& use, Material& material) {
  material.shading = Shading::kToon;
  material.blendWritesDepth = memberOf(mtoon, "transparentWithZWrite") == true;
  material.drawOrder = (material.blendWritesDepth ? 0 : kWithoutDepth) +
                       static_cast<int>(std::clamp(numberOf(mtoon, "renderQueueOffsetNumber", 0.0f), -9.0f, 9.0f));
  ToonMaterial& toon = material.toon;
  numbersOf(mtoon, "shadeColorFactor", {toon.shadeColor.data(), 3});
  toon.shade = use(memberOf(mtoon, "shadeMultiplyTexture"));
  toon.shift = numberOf(mtoon, "shadingShiftFactor", 0.0f);
  const Json& shiftTexture = memberOf(mtoon, "shadingShiftTexture");
  toon.shiftTexture = use(shiftTexture);
  toon.shiftScale = numberOf(shiftTexture, "scale", 1.0f);
  toon.toony = numberOf(mtoon, "shadingToonyFactor", 0.9f);
  toon.matcap = use(memberOf(mtoon, "matcapTexture"));
  numbersOf(mtoon, "matcapFactor", {toon.matcapFactor.data(), 3});
  if (!toon.matcap.given()) toon.matcapFactor = Vec3f::Zero();
  numbersOf(mtoon, "parametricRimColorFactor", {toon.rimColor.data(), 3});
  toon.rimPower = numberOf(mtoon, "parametricRimFresnelPowerFactor", 5.0f);
  toon.rimLift = numberOf(mtoon, "parametricRimLiftFactor", 0.0f);
  toon.rim = use(memberOf(mtoon, "rimMultiplyTexture"));
  toon.rimLightingMix = numberOf(mtoon, "rimLightingMixFactor", 1.0f);
  const Json& mode = memberOf(mtoon, "outlineWidthMode");
  toon.outline = mode == "worldCoordinates"    ? OutlineMode::kWorld
                 : mode == "screenCoordinates" ? OutlineMode::kScreen
                                               : OutlineMode::kNone;
  toon.outlineWidth = numberOf(mtoon, "outlineWidthFactor", 0.0f);
  toon.outlineWidthTexture = use(memberOf(mtoon, "outlineWidthMultiplyTexture"));
  numbersOf(mtoon, "outlineColorFactor", {toon.outlineColor.data(), 3});
  toon.outlineLightingMix = numberOf(mtoon, "outlineLightingMixFactor", 1.0f);
  toon.uvAnimationMask = use(memberOf(mtoon, "uvAnimationMaskTexture"));
  toon.uvScroll = {numberOf(mtoon, "uvAnimationScrollXSpeedFactor", 0.0f),
                   numberOf(mtoon, "uvAnimationScrollYSpeedFactor", 0.0f)};
  toon.uvRotation = numberOf(mtoon, "uvAnimationRotationSpeedFactor", 0.0f);
}

void applyVrm0Materials(const Json& properties, const TextureOfIndex& textureOf, std::vector<Material>& materials) {
  if (!properties.is_array()) return;
  Queues queues;
  for (const Json& entry : properties) {
    const Blend0 blend = blendOf(entry);
    if (blend.blended) (blend.writesDepth ? queues.withDepth : queues.withoutDepth).insert(blend.queue);
  }
  for (std::size_t m = 0; m < std::min(properties.size(), materials.size()); ++m) {
    const Json& shader = memberOf(properties[m], "shader");
    if (!shader.is_string()) continue;
    const auto& name = shader.get_ref<const std::string&>();
    if (name == "VRM/MToon") {
      applyMtoon0(properties[m], textureOf, materials[m]);
    } else if (name.starts_with("VRM/Unlit")) {
      applyUnlit0(properties[m], textureOf, materials[m]);
    } else {
      continue;
    }
    const Blend0 blend = blendOf(properties[m]);
    if (!blend.blended) continue;
    materials[m].alpha = AlphaMode::kBlend;
    materials[m].blendWritesDepth = blend.writesDepth;
    materials[m].drawOrder = queues.orderOf(blend.queue, blend.writesDepth);
  }
}

}  // namespace lorica
