#pragma once

#include "skinning/character.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace lorica {

/// What a rendered person wears over the body.
enum class Clothes : std::uint8_t {
  kTrousers,  ///< loose, wider towards the hem
  kSkirt,     ///< from the waist to below the knee
  kCoat,      ///< from the neck to above the knee, with wide sleeves
  kHair,      ///< to the shoulder blades; the face stays free
};
/// In the order of Clothes.
inline constexpr std::array<std::string_view, 4> kClothesNames = {"trousers", "skirt", "coat", "hair"};

[[nodiscard]] std::optional<Clothes> clothesNamed(std::string_view name);

/// Dresses a character: each piece is one or more closed surfaces around the body of the bind pose, skinned by the
/// bones they hang from. Joints, height and the body's own vertices stay as they are. Cloth does not swing and has no
/// folds.
/// @param character  with humanoid bones; a piece whose bones are missing is left out. Change proportions before
/// @param pieces     each at most once
[[nodiscard]] Character withClothes(const Character& character, std::span<const Clothes> pieces);

}  // namespace lorica
