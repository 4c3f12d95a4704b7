#include "skinning/import/vrm_materials.h"

#include "geometry/counts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace lorica {

namespace {

using Json = nlohmann::json;

// Of blended materials, those that write depth are drawn first, see VRMC_materials_mtoon, "Rendering".
constexpr int kWithoutDepth = 19;

[[nodiscard]] float linear(float encoded) {
  return std::pow(std::max(encoded, 0.0f), 2.2f);
}

/// A colour of VRM 0.x: gamma-encoded, but not its opacity.
void gammaColor(const Json& vectors, const char* key, MemberReader& members, Vec3f& color) {
  std::array<float, 3> encoded = {-1.0f, 0.0f, 0.0f};
  members.numbers(vectors, key, encoded);
  if (encoded[0] >= 0.0f) color = {linear(encoded[0]), linear(encoded[1]), linear(encoded[2])};
}

[[nodiscard]] int orderOf(const Vrm0Queues& queues, int queue, bool writesDepth) {
  const std::set<int>& all = writesDepth ? queues.withDepth : queues.withoutDepth;
  const int rank = std::distance(all.begin(), all.lower_bound(queue));
  if (writesDepth) return std::min(rank, 9);
  return kWithoutDepth - std::min(countOf(all) - 1 - rank, 9);
}

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
  blend.queue = std::clamp(numberOf(properties, "renderQueue", -1.0f), -1.0f, 1e6f);
  return blend;
}

/// The one transform of all textures, in Unity's coordinates: v points up.
[[nodiscard]] Eigen::Matrix<float, 2, 3> transformOf(const Json& vectors, MemberReader& members) {
  std::array<float, 4> moved = {0.0f, 0.0f, 1.0f, 1.0f};  // offset, scale
  members.numbers(vectors, "_MainTex", moved);
  Eigen::Matrix<float, 2, 3> transform;
  transform << moved[2], 0.0f, moved[0], 0.0f, moved[3], 1.0f - moved[3] - moved[1];
  return transform;
}

[[nodiscard]] TextureUse textureNamed(const Json& properties, const char* key, const TextureOfIndex& textureOf) {
  const Json& index = memberOf(memberOf(properties, "textureProperties"), key);
  return index.is_null() ? TextureUse() : textureOf(index.is_number_integer() ? index.get<std::int64_t>() : -1);
}

void applyMtoon0(const Json& properties, const TextureOfIndex& textureOf, MemberReader& members, Material& material) {
  const Json& floats = memberOf(properties, "floatProperties");
  const Json& vectors = memberOf(properties, "vectorProperties");
  const Json& keywords = memberOf(properties, "keywordMap");
  const Eigen::Matrix<float, 2, 3> transform = transformOf(vectors, members);
  const auto texture = [&](const char* key) {
    TextureUse use = textureNamed(properties, key, textureOf);
    use.transform = transform;
    return use;
  };
  material.shading = Shading::kToon;
  material.alpha = AlphaMode::kOpaque;
  if (members.flag(keywords, "_ALPHATEST_ON")) material.alpha = AlphaMode::kMask;
  if (members.flag(keywords, "_ALPHABLEND_ON")) material.alpha = AlphaMode::kBlend;
  material.alphaCutoff = members.number(floats, "_Cutoff", 0.5f);
  material.doubleSided = members.number(floats, "_CullMode", 2.0f) == 0.0f;
  std::array<float, 4> color = {1.0f, 1.0f, 1.0f, 1.0f};
  members.numbers(vectors, "_Color", color);
  material.baseColor = {linear(color[0]), linear(color[1]), linear(color[2]), color[3]};
  material.base = texture("_MainTex");
  material.normal = texture("_BumpMap");
  material.normalScale = members.number(floats, "_BumpScale", 1.0f);
  material.emissive = Vec3f::Zero();
  gammaColor(vectors, "_EmissionColor", members, material.emissive);
  material.emissiveTexture = texture("_EmissionMap");

  ToonMaterial& toon = material.toon;
  toon.shadeColor = {linear(0.97f), linear(0.81f), linear(0.86f)};
  gammaColor(vectors, "_ShadeColor", members, toon.shadeColor);
  toon.shade = texture("_ShadeTexture");
  const float shift = members.number(floats, "_ShadeShift", 0.0f);
  const float toony = members.number(floats, "_ShadeToony", 0.9f);
  toon.toony = toony + (1.0f - toony) * (0.5f + 0.5f * shift);
  toon.shift = -shift - (1.0f - toon.toony);
  toon.matcap = texture("_SphereAdd");
  toon.matcap.transform = TextureUse().transform;
  toon.matcapFactor = toon.matcap.given() ? Vec3f::Ones() : Vec3f::Zero();
  toon.rim = texture("_RimTexture");
  gammaColor(vectors, "_RimColor", members, toon.rimColor);
  toon.rimPower = members.number(floats, "_RimFresnelPower", 1.0f);
  toon.rimLift = members.number(floats, "_RimLift", 0.0f);
  toon.rimLightingMix = members.number(floats, "_RimLightingMix", 0.0f);
  const float mode = members.number(floats, "_OutlineWidthMode", 0.0f);
  toon.outline = mode == 1.0f ? OutlineMode::kWorld : mode == 2.0f ? OutlineMode::kScreen : OutlineMode::kNone;
  toon.outlineWidth = 0.01f * members.number(floats, "_OutlineWidth", 0.0f);  // centimetres, or percent
  toon.outlineWidthTexture = texture("_OutlineWidthTexture");
  gammaColor(vectors, "_OutlineColor", members, toon.outlineColor);
  toon.outlineLightingMix = members.number(floats, "_OutlineColorMode", 0.0f) == 1.0f
                                ? members.number(floats, "_OutlineLightingMix", 1.0f)
                                : 0.0f;
  toon.giEqualization = 1.0f - std::clamp(members.number(floats, "_IndirectLightIntensity", 0.1f), 0.0f, 1.0f);
  toon.uvAnimationMask = texture("_UvAnimMaskTexture");
  toon.uvScroll = {members.number(floats, "_UvAnimScrollX", 0.0f), -members.number(floats, "_UvAnimScrollY", 0.0f)};
  toon.uvRotation = members.number(floats, "_UvAnimRotation", 0.0f);
}

void applyUnlit0(const Json& properties, const TextureOfIndex& textureOf, MemberReader& members, Material& material) {
  const Json& vectors = memberOf(properties, "vectorProperties");
  material.shading = Shading::kUnlit;
  material.alpha = memberOf(properties, "shader") == "VRM/UnlitCutout" ? AlphaMode::kMask : AlphaMode::kOpaque;
  material.alphaCutoff = members.number(memberOf(properties, "floatProperties"), "_Cutoff", 0.5f);
  std::array<float, 4> color = {1.0f, 1.0f, 1.0f, 1.0f};
  members.numbers(vectors, "_Color", color);
  material.baseColor = {linear(color[0]), linear(color[1]), linear(color[2]), color[3]};
  material.base = textureNamed(properties, "_MainTex", textureOf);
  material.base.transform = transformOf(vectors, members);
}

}  // namespace

void applyMtoon1(const Json& mtoon, const std::function<TextureUse(const Json&)>& use, MemberReader& members,
                 Material& material) {
  material.shading = Shading::kToon;
  material.blendWritesDepth = members.flag(mtoon, "transparentWithZWrite");
  // Offsets count up from the first of those with depth, and down from the last of the others.
  const float offset = members.number(mtoon, "renderQueueOffsetNumber", 0.0f);
  material.drawOrder = material.blendWritesDepth ? static_cast<int>(std::clamp(offset, 0.0f, 9.0f))
                                                 : kWithoutDepth + static_cast<int>(std::clamp(offset, -9.0f, 0.0f));
  ToonMaterial& toon = material.toon;
  members.numbers(mtoon, "shadeColorFactor", {toon.shadeColor.data(), 3});
  toon.shade = use(memberOf(mtoon, "shadeMultiplyTexture"));
  toon.shift = members.number(mtoon, "shadingShiftFactor", 0.0f);
  const Json& shiftTexture = memberOf(mtoon, "shadingShiftTexture");
  toon.shiftTexture = use(shiftTexture);
  toon.shiftScale = members.number(shiftTexture, "scale", 1.0f);
  toon.toony = members.number(mtoon, "shadingToonyFactor", 0.9f);
  toon.matcap = use(memberOf(mtoon, "matcapTexture"));
  members.numbers(mtoon, "matcapFactor", {toon.matcapFactor.data(), 3});
  if (!toon.matcap.given()) toon.matcapFactor = Vec3f::Zero();
  members.numbers(mtoon, "parametricRimColorFactor", {toon.rimColor.data(), 3});
  toon.rimPower = members.number(mtoon, "parametricRimFresnelPowerFactor", 5.0f);
  toon.rimLift = members.number(mtoon, "parametricRimLiftFactor", 0.0f);
  toon.rim = use(memberOf(mtoon, "rimMultiplyTexture"));
  toon.rimLightingMix = members.number(mtoon, "rimLightingMixFactor", 1.0f);
  constexpr std::array<const char*, 3> kModes = {"none", "worldCoordinates", "screenCoordinates"};
  toon.outline = std::array{OutlineMode::kNone, OutlineMode::kWorld,
                            OutlineMode::kScreen}[members.word(mtoon, "outlineWidthMode", kModes)];
  toon.outlineWidth = members.number(mtoon, "outlineWidthFactor", 0.0f);
  toon.outlineWidthTexture = use(memberOf(mtoon, "outlineWidthMultiplyTexture"));
  members.numbers(mtoon, "outlineColorFactor", {toon.outlineColor.data(), 3});
  toon.outlineLightingMix = members.number(mtoon, "outlineLightingMixFactor", 1.0f);
  toon.giEqualization = std::clamp(members.number(mtoon, "giEqualizationFactor", 0.9f), 0.0f, 1.0f);
  toon.uvAnimationMask = use(memberOf(mtoon, "uvAnimationMaskTexture"));
  toon.uvScroll = {members.number(mtoon, "uvAnimationScrollXSpeedFactor", 0.0f),
                   members.number(mtoon, "uvAnimationScrollYSpeedFactor", 0.0f)};
  toon.uvRotation = members.number(mtoon, "uvAnimationRotationSpeedFactor", 0.0f);
}

Vrm0Queues queuesOf(const Json& allProperties) {
  Vrm0Queues queues;
  for (const Json& properties : allProperties) {
    const Blend0 blend = blendOf(properties);
    if (blend.blended) (blend.writesDepth ? queues.withDepth : queues.withoutDepth).insert(blend.queue);
  }
  return queues;
}

void applyVrm0Material(const Json& properties, const Vrm0Queues& queues, const TextureOfIndex& textureOf,
                       MemberReader& members, Material& material) {
  const Json& shader = memberOf(properties, "shader");
  if (!shader.is_string()) return;
  const auto& name = shader.get_ref<const std::string&>();
  if (name == "VRM/MToon") {
    applyMtoon0(properties, textureOf, members, material);
  } else if (name.starts_with("VRM/Unlit")) {
    applyUnlit0(properties, textureOf, members, material);
  } else {
    return;
  }
  const Blend0 blend = blendOf(properties);
  if (!blend.blended) return;
  material.alpha = AlphaMode::kBlend;
  material.blendWritesDepth = blend.writesDepth;
  material.drawOrder = orderOf(queues, blend.queue, blend.writesDepth);
}

}  // namespace lorica
