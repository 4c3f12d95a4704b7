#include "skinning/look/expressed_materials.h"

#include "geometry/result.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica {

namespace {

/// A colour without opacity. @tparam M  Material or const Material
template <typename M>
[[nodiscard]] auto& rgbOf(M& material, MaterialColor color) {
  if (color == MaterialColor::kShade) return material.toon.shadeColor;
  if (color == MaterialColor::kMatcap) return material.toon.matcapFactor;
  if (color == MaterialColor::kRim) return material.toon.rimColor;
  return color == MaterialColor::kOutline ? material.toon.outlineColor : material.emissive;
}

void add(const MaterialColorBind& bind, float weight, const Material& from, Material& shown) {
  if (bind.color == MaterialColor::kBase) {
    shown.baseColor += weight * (bind.value - from.baseColor);
  } else {
    rgbOf(shown, bind.color) += weight * (bind.value.head<3>() - rgbOf(from, bind.color));
  }
}

void add(const TextureTransformBind& bind, float weight, const TextureUse& from, TextureUse& shown) {
  const float c = std::cos(from.rotation);
  const float s = std::sin(from.rotation);
  Eigen::Matrix<float, 2, 3> whole;
  whole << c * bind.scale.x(), s * bind.scale.y(), bind.offset.x(),  //
      -s * bind.scale.x(), c * bind.scale.y(), bind.offset.y();
  shown.transform += weight * (whole - from.transform);
}

}  // namespace

bool changesMaterials(const Expressions& expressions) {
  return std::any_of(expressions.list.begin(), expressions.list.end(),
                     [](const Expression& e) { return !e.colors.empty() || !e.textures.empty(); });
}

void expressMaterials(const Expressions& expressions, std::span<const float> effective,
                      std::span<const Material> materials, std::span<Material> shown) {
  LORICA_CHECK(effective.size() == expressions.list.size(), "one weight per expression");
  LORICA_CHECK(shown.size() == materials.size(), "as many materials");
  for (const Expression& expression : expressions.list) {
    for (const MaterialColorBind& bind : expression.colors) shown[bind.material] = materials[bind.material];
    for (const TextureTransformBind& bind : expression.textures) shown[bind.material] = materials[bind.material];
  }
  for (std::size_t e = 0; e < effective.size(); ++e) {
    const float weight = effective[e];
    if (weight == 0.0f) continue;
    for (const MaterialColorBind& bind : expressions.list[e].colors) {
      add(bind, weight, materials[bind.material], shown[bind.material]);
    }
    for (const TextureTransformBind& bind : expressions.list[e].textures) {
      Material& to = shown[bind.material];
      const auto from = materials[bind.material].textures();
      const auto textures = Material::texturesOf(to);
      for (std::size_t t = 0; t < from.size(); ++t) {
        const bool byNormal = textures[t] == &to.toon.matcap;  // no coordinates
        if (!byNormal) add(bind, weight, *from[t], *textures[t]);
      }
    }
  }
}

}  // namespace lorica
