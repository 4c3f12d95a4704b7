#include "skinning/import/scene_readers.h"

#include "geometry/work_budgets.h"
#include "skinning/import/json_values.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace lorica {

namespace {

using Json = nlohmann::json;

constexpr float kDegree = std::numbers::pi_v<float> / 180.0F;

[[nodiscard]] ExpressionOverride overrideOf(const Json& expression, const char* key) {
  const std::string text = textOf(expression, key);
  if (text == "block") return ExpressionOverride::kBlock;
  return text == "blend" ? ExpressionOverride::kBlend : ExpressionOverride::kNone;
}

/// A colour property of 1.0 or of a shader of 0.x.
[[nodiscard]] std::optional<MaterialColor> colorOf(const std::string& name) {
  static const std::map<std::string, MaterialColor> kColors = {
      {"color", MaterialColor::kBase},           {"emissionColor", MaterialColor::kEmission},
      {"shadeColor", MaterialColor::kShade},     {"matcapColor", MaterialColor::kMatcap},
      {"rimColor", MaterialColor::kRim},         {"outlineColor", MaterialColor::kOutline},
      {"_Color", MaterialColor::kBase},          {"_EmissionColor", MaterialColor::kEmission},
      {"_ShadeColor", MaterialColor::kShade},    {"_RimColor", MaterialColor::kRim},
      {"_OutlineColor", MaterialColor::kOutline}};
  const auto found = kColors.find(name);
  if (found == kColors.end()) return std::nullopt;
  return found->second;
}

class ExpressionReader {
 public:
  explicit ExpressionReader(FileScene& scene) : scene_(scene) {
    for (std::size_t t = 0; t < scene.morphTargets.size(); ++t) {
      const FileMorphTarget& target = scene.morphTargets[t];
      targetsOfMesh_[{target.mesh, target.index}].push_back(t);
      targetsOfNode_[{target.node, target.index}].push_back(t);
      scene.expressions.baseWeights.push_back(target.defaultWeight);
    }
  }

  void readVrm1(const Json& vrm) {
    for (const char* list : {"preset", "custom"}) {
      const Json& expressions = memberOf(memberOf(vrm, "expressions"), list);
      if (!expressions.is_object()) continue;
      for (const auto& [name, from] : expressions.items()) {
        if (!hasRoom()) continue;
        Expression expression;
        expression.name = name;
        expression.binary = memberOf(from, "isBinary") == true;
        expression.overrideBlink = overrideOf(from, "overrideBlink");
        expression.overrideLookAt = overrideOf(from, "overrideLookAt");
        expression.overrideMouth = overrideOf(from, "overrideMouth");
        for (const Json& bind : listOf(from, "morphTargetBinds")) {
          addMorph(targetsOfNode_, bind, "node", numberOf(bind, "weight", 0.0F), expression);
        }
        for (const Json& bind : listOf(from, "materialColorBinds")) addColor(bind, expression);
        for (const Json& bind : listOf(from, "textureTransformBinds")) addTexture(bind, expression);
        add(std::move(expression));
      }
    }
    const Json& lookAt = memberOf(vrm, "lookAt");
    if (!lookAt.is_object()) return;
    readRanges(lookAt, textOf(lookAt, "type") != "expression", "rangeMap", "inputMaxValue", "outputScale");
    std::array<float, 3> offset = {0.0F, 0.06F, 0.0F};
    numbersOf(lookAt, "offsetFromHeadBone", offset);
    scene_.lookAt.offsetFromHead = Vec3(offset[0], offset[1], offset[2]);
    const Json& humanBones = memberOf(memberOf(vrm, "humanoid"), "humanBones");
    scene_.leftEye = nodeOf(memberOf(humanBones, "leftEye"));
    scene_.rightEye = nodeOf(memberOf(humanBones, "rightEye"));
  }

  void readVrm0(const Json& vrm) {
    for (const Json& group : listOf(memberOf(vrm, "blendShapeMaster"), "blendShapeGroups")) {
      const std::string preset = textOf(group, "presetName");
      Expression expression;
      expression.name = preset.empty() || preset == "unknown" ? textOf(group, "name") : presetName(preset);
      if (expression.name.empty() || !hasRoom()) continue;
      expression.binary = memberOf(group, "isBinary") == true;
      for (const Json& bind : listOf(group, "binds")) {
        addMorph(targetsOfMesh_, bind, "mesh", 0.01F * numberOf(bind, "weight", 100.0F), expression);
      }
      for (const Json& value : listOf(group, "materialValues")) addMaterialValue(value, expression);
      add(std::move(expression));
    }
    const Json& firstPerson = memberOf(vrm, "firstPerson");
    if (!firstPerson.is_object()) return;
    readRanges(firstPerson, textOf(firstPerson, "lookAtTypeName") != "BlendShape", "lookAt", "xRange", "yRange");
    // Unity's Z points forward, the file's backward.
    const Json& offset = memberOf(firstPerson, "firstPersonBoneOffset");
    scene_.lookAt.offsetFromHead =
        Vec3(numberOf(offset, "x", 0.0F), numberOf(offset, "y", 0.06F), -numberOf(offset, "z", 0.0F));
    for (const Json& bone : listOf(memberOf(vrm, "humanoid"), "humanBones")) {
      const std::string name = textOf(bone, "bone");
      if (name == "leftEye") scene_.leftEye = nodeOf(bone);
      if (name == "rightEye") scene_.rightEye = nodeOf(bone);
    }
  }

  /// As VRM defines, targets that an expression moves are at 0 without it.
  void clearBoundTargets() {
    for (const Expression& expression : scene_.expressions.list) {
      for (const MorphBind& bind : expression.morphs) scene_.expressions.baseWeights[bind.target] = 0.0F;
    }
  }

  void readTargetNames() {
    std::map<std::string, std::size_t> known;
    for (std::size_t t = 0; t < scene_.morphTargets.size(); ++t) {
      const FileMorphTarget& target = scene_.morphTargets[t];
      // At weight 0 the target keeps its default, at 1 it is whole.
      const MorphBind bind{static_cast<int>(t), 1.0F - target.defaultWeight};
      if (const auto same = known.find(target.name); same != known.end()) {
        scene_.expressions.list[same->second].morphs.push_back(bind);
        continue;
      }
      Expression expression;
      expression.name = target.name;
      expression.morphs.push_back(bind);
      if (!hasRoom()) break;
      known[target.name] = scene_.expressions.list.size();
      if (!addExpression(scene_.expressions, std::move(expression))) {
        known.erase(target.name);
        ++doubled_;
      }
    }
  }

  void tell() {
    const std::string beyond = fmt::format("beyond the first {} expressions and {} binds: skipped",
                                           grouped(kMaxExpressions), grouped(kMaxExpressionBinds));
    scene_.note(full_, "expression or bind is " + beyond, "expressions or their binds are " + beyond);
    scene_.note(doubled_, "expression has a name that another one has: skipped",
                "expressions have a name that another one has: skipped");
    const std::string lost = fmt::format("to what does not exist: skipped (the first: {})", firstLost_);
    scene_.note(lost_, "bind of an expression refers " + lost, "binds of expressions refer " + lost);
  }

 private:
  using Targets = std::map<std::pair<int, int>, std::vector<int>>;

  [[nodiscard]] bool hasRoom() {
    if (scene_.expressions.list.size() < kMaxExpressions && binds_ < kMaxExpressionBinds) {
      return true;
    }
    ++full_;
    return false;
  }

  void add(Expression expression) {
    if (!addExpression(scene_.expressions, std::move(expression))) ++doubled_;
  }

  void lose(const Expression& expression, const Json& bind) {
    if (lost_++ == 0) firstLost_ = fmt::format("{} of '{}'", bind.dump(-1, ' ', true).substr(0, 100), expression.name);
  }

  void addMorph(const Targets& targets, const Json& bind, const char* owner, float weight, Expression& expression) {
    const std::optional<int> from = indexOf(bind, owner, std::size_t{1} << 30);
    const std::optional<int> index = indexOf(bind, "index", std::size_t{1} << 30);
    const auto found = from && index ? targets.find({*from, *index}) : targets.end();
    if (found == targets.end()) return lose(expression, bind);
    for (const int target : found->second) {
      if (!hasRoom()) return;
      ++binds_;
      expression.morphs.push_back({target, weight});
    }
  }

  void addColor(const Json& bind, Expression& expression) {
    const std::optional<int> material = indexOf(bind, "material", scene_.materials.size());
    const std::optional<MaterialColor> color = colorOf(textOf(bind, "type"));
    if (!material || !color) return lose(expression, bind);
    if (!hasRoom()) return;
    ++binds_;
    std::array<float, 4> value = {1.0F, 1.0F, 1.0F, 1.0F};
    numbersOf(bind, "targetValue", value);
    expression.colors.push_back({*material, *color, {value[0], value[1], value[2], value[3]}});
  }

  void addTexture(const Json& bind, Expression& expression) {
    const std::optional<int> material = indexOf(bind, "material", scene_.materials.size());
    if (!material) return lose(expression, bind);
    if (!hasRoom()) return;
    ++binds_;
    std::array<float, 2> scale = {1.0F, 1.0F};
    std::array<float, 2> offset = {0.0F, 0.0F};
    numbersOf(bind, "scale", scale);
    numbersOf(bind, "offset", offset);
    expression.textures.push_back({*material, {scale[0], scale[1]}, {offset[0], offset[1]}});
  }

  /// 0.x names materials, and properties of their shaders.
  void addMaterialValue(const Json& value, Expression& expression) {
    const std::string name = textOf(value, "materialName");
    const std::string property = textOf(value, "propertyName");
    std::array<float, 4> target = {1.0F, 1.0F, 1.0F, 1.0F};
    numbersOf(value, "targetValue", target);
    const std::optional<MaterialColor> color = colorOf(property);
    bool found = false;
    for (std::size_t m = 0; m < scene_.materials.size(); ++m) {
      if (scene_.materials[m].name != name) continue;
      if ((!color && property != "_MainTex_ST") || !hasRoom()) break;
      found = true;
      ++binds_;
      const int material = m;
      if (color) {
        // Unity's colours are gamma-encoded, but not the emission, which may exceed 1.
        const auto linear = [&](float c) {
          return *color == MaterialColor::kEmission ? c : std::pow(std::max(c, 0.0F), 2.2F);
        };
        expression.colors.push_back(
            {material, *color, {linear(target[0]), linear(target[1]), linear(target[2]), target[3]}});
      } else {
        // Unity's textures begin at the lower left corner.
        expression.textures.push_back({material, {target[0], target[1]}, {target[2], 1.0F - target[3] - target[1]}});
      }
    }
    if (!found) lose(expression, value);
  }

  [[nodiscard]] int nodeOf(const Json& bone) const { return indexOf(bone, "node", scene_.nodes.size()).value_or(-1); }

  /// Angles are in degrees. Without a range the eyes move as three-vrm lets them.
  /// @param prefix,input,output  of the names of members
  void readRanges(const Json& from, bool bones, const std::string& prefix, const char* input, const char* output) {
    LookAt& lookAt = scene_.lookAt;
    lookAt.kind = bones ? LookAtKind::kBone : LookAtKind::kExpression;
    for (const auto& [key, range] :
         {std::pair("HorizontalInner", &lookAt.inner), std::pair("HorizontalOuter", &lookAt.outer),
          std::pair("VerticalDown", &lookAt.down), std::pair("VerticalUp", &lookAt.up)}) {
      const Json& map = memberOf(from, (prefix + key).c_str());
      const float scale = numberOf(map, output, bones ? 10.0F : 1.0F);
      range->inputMax = kDegree * std::max(numberOf(map, input, 90.0F), 0.01F);
      range->output = bones ? kDegree * scale : scale;
    }
  }

  FileScene& scene_;
  Targets targetsOfMesh_;
  Targets targetsOfNode_;
  int binds_ = 0;
  std::uint64_t full_ = 0;
  std::uint64_t doubled_ = 0;
  std::uint64_t lost_ = 0;
  std::string firstLost_;
};

}  // namespace

void readExpressions(const Json& extensions, FileScene& scene) {
  ExpressionReader reader(scene);
  if (const Json& vrm1 = memberOf(extensions, "VRMC_vrm"); vrm1.is_object()) {
    reader.readVrm1(vrm1);
    reader.clearBoundTargets();
  } else if (const Json& vrm0 = memberOf(extensions, "VRM"); vrm0.is_object()) {
    reader.readVrm0(vrm0);
    reader.clearBoundTargets();
  } else {
    reader.readTargetNames();
  }
  reader.tell();
}

}  // namespace lorica
