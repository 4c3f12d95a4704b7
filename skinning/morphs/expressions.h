#pragma once

#include "geometry/math.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// What an expression with a weight above 0 does to the procedural expressions of one kind.
enum class ExpressionOverride : std::uint8_t {
  kNone,
  kBlock,  ///< they have no effect
  kBlend,  ///< they are attenuated by 1 - weight
};

/// Expressions that a program sets by itself, beside those that somebody chooses.
enum class ProceduralKind : std::uint8_t {
  kNone,
  kBlink,   ///< blink, blinkLeft, blinkRight
  kLookAt,  ///< lookUp, lookDown, lookLeft, lookRight
  kMouth,   ///< aa, ih, ou, ee, oh
};

/// Adds weight x the expression's weight to a morph target's weight.
struct MorphBind {
  int target = 0;       ///< index into Morphs::targets
  float weight = 1.0F;  ///< at the expression's full weight
};

/// The colours of a material that an expression may change.
enum class MaterialColor : std::uint8_t { kBase, kEmission, kShade, kMatcap, kRim, kOutline };

/// The colour is base + weight x (value - base), summed over all expressions.
struct MaterialColorBind {
  int material = 0;                               ///< the file's index, not negative
  MaterialColor color = MaterialColor::kBase;     ///< which of its colours
  Eigen::Vector4f value{1.0F, 1.0F, 1.0F, 1.0F};  ///< linear RGBA; colours without opacity ignore the last number
};

/// Scale and offset of a material's texture coordinates, blended like a colour.
struct TextureTransformBind {
  int material = 0;                    ///< the file's index, not negative
  Eigen::Vector2f scale{1.0F, 1.0F};   ///< factor of texture coordinates
  Eigen::Vector2f offset{0.0F, 0.0F};  ///< (0, 0) is the upper left corner of a picture
};

/// A named face: what it moves and colours.
struct Expression {
  std::string name;                                               ///< VRM 1.0's name of a preset, else the file's
  bool binary = false;                                            ///< weights above 0.5 count as 1, others as 0
  ExpressionOverride overrideBlink = ExpressionOverride::kNone;   ///< what it does to blinking while it is shown
  ExpressionOverride overrideLookAt = ExpressionOverride::kNone;  ///< what it does to gaze while it is shown
  ExpressionOverride overrideMouth = ExpressionOverride::kNone;   ///< what it does to the mouth while it is shown
  ProceduralKind kind = ProceduralKind::kNone;                    ///< by the name
  std::vector<MorphBind> morphs;                                  ///< shapes
  std::vector<MaterialColorBind> colors;                          ///< colours of materials
  std::vector<TextureTransformBind> textures;                     ///< shifts of textures
};

/// The expressions of a character.
///
/// From VRM 0.x (blendShapeMaster) or VRM 1.0 (expressions); for a file without VRM data each morph target is an
/// expression by its own name. https://github.com/vrm-c/vrm-specification: VRMC_vrm-1.0/expressions.md, 0.0/README.md
struct Expressions {
  std::vector<Expression> list;    ///< names are unique, also if case is ignored
  std::vector<float> baseWeights;  ///< of each morph target while every expression is 0
};

/// VRM 1.0's name of a preset expression, from its name in 1.0 or 0.x in any case: "Joy" is "happy", "blink_l" is
/// "blinkLeft". Other names are returned as they are.
[[nodiscard]] std::string presetName(std::string_view name);
/// VRM 0.x's name of a preset expression of 1.0: "happy" is "Joy". Other names are returned as they are.
[[nodiscard]] std::string nameInVrm0(std::string_view name);

/// Index of the expression with a name in any case, or with a preset's other name; none if the character lacks it.
[[nodiscard]] std::optional<std::size_t> findExpression(const Expressions& expressions, std::string_view name);

/// Appends an expression and sets its kind. @return false if the name is taken; then nothing is appended
bool addExpression(Expressions& expressions, Expression expression);

/// The names, separated by ", ": for messages. Of more than `max` the rest is counted.
[[nodiscard]] std::string namesOf(const Expressions& expressions, std::size_t max = 100);

/// What remains of each expression's weight: clamped to 0..1, rounded if it is binary, and overridden.
///
/// Overrides add up: two that blend at 0.3 leave 0.4. A binary expression that is overridden at all is 0. An override
/// of the expression's own kind has no effect. Does not allocate memory.
/// @param weights    one for each expression; a number that is not finite counts as 0
/// @param effective  the same number, written
void effectiveWeights(const Expressions& expressions, std::span<const float> weights, std::span<float> effective);

/// Adds what each expression adds to the weights of the morph targets. They are not clamped, like those of three.js and
/// UniVRM. Does not allocate memory.
/// @param effective      see effectiveWeights()
/// @param targetWeights  one for each morph target, such as the base weights or those of a clip; added to
void addMorphWeights(const Expressions& expressions, std::span<const float> effective, std::span<float> targetWeights);

}  // namespace lorica
