#include "geometry/work_budgets.h"
#include "skinning/import/scene_readers.h"

#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lorica {
namespace {

using nlohmann::json;
using test::GlbWriter;
using test::hasNote;
using test::parsed;

constexpr double kDegree = std::numbers::pi / 180.0;

[[nodiscard]] const Expression* expressionOf(const CharacterFile& file, const std::string& name) {
  const std::optional<std::size_t> index = findExpression(file.expressions, name);
  return index ? &file.expressions.list[*index] : nullptr;
}

/// The small character with three targets, two materials, and a second node that shows the same mesh.
[[nodiscard]] GlbWriter morphingCharacter() {
  GlbWriter writer = test::smallCharacter();
  const int up = writer.accessor(std::vector<float>(24, 0.125F), "VEC3");
  json& mesh = writer.document["meshes"][0];
  for (int t = 0; t < 3; ++t) mesh["primitives"][0]["targets"].push_back({{"POSITION", up}});
  mesh["extras"] = {{"targetNames", {"Smile", "Wink", "smile"}}};
  mesh["weights"] = {0.0, 0.25, 0.5};
  writer.add("nodes", {{"name", "copy"}, {"mesh", 0}, {"skin", 0}});
  writer.document["scenes"][0]["nodes"] = {0, 2, 3};
  writer.document["materials"] = {{{"name", "skin"}}, {{"name", "eyes"}}};
  return writer;
}

TEST(VrmExpressions, WithoutVrmTargetsAreExpressionsByTheirNames) {
  const CharacterFile file = test::valueOf(parsed(morphingCharacter()));
  ASSERT_EQ(file.morphs.targets.size(), 6u);
  EXPECT_EQ(namesOf(file.expressions), "Smile, Wink");  // "smile" differs only in case
  EXPECT_TRUE(hasNote(file, "2 expressions have a name that another one has: skipped"));
  const Expression& wink = *expressionOf(file, "wink");
  ASSERT_EQ(wink.morphs.size(), 2u);  // of both nodes
  EXPECT_EQ(wink.morphs[0].target, 1);
  EXPECT_EQ(wink.morphs[1].target, 4);
  std::vector<float> targets = file.expressions.baseWeights;
  EXPECT_EQ(targets, (std::vector<float>{0, 0.25F, 0.5F, 0, 0.25F, 0.5F}));  // the bind pose
  addMorphWeights(file.expressions, std::vector<float>{0.5F, 1.0F}, targets);
  EXPECT_EQ(targets, (std::vector<float>{0.5F, 1.0F, 0.5F, 0.5F, 1.0F, 0.5F}));
}

TEST(VrmExpressions, GroupsOfVrm0AreRead) {
  GlbWriter writer = morphingCharacter();
  json& vrm = writer.document["extensions"]["VRM"];
  vrm["blendShapeMaster"]["blendShapeGroups"] = json::parse(R"([
    {"name": "JOY", "presetName": "joy", "binds": [{"mesh": 0, "index": 1, "weight": 40}]},
    {"name": "Cheeks", "presetName": "unknown", "isBinary": true, "binds": []},
    {"name": "Blush", "presetName": "blink_l", "materialValues": [
      {"materialName": "eyes", "propertyName": "_Color", "targetValue": [1.0, 0.5, 0.0, 0.25]},
      {"materialName": "skin", "propertyName": "_EmissionColor", "targetValue": [3.0, 0.5, 0.0, 1.0]},
      {"materialName": "skin", "propertyName": "_MainTex_ST", "targetValue": [0.5, 0.25, 0.125, 0.0]},
      {"materialName": "skin", "propertyName": "_Cutoff", "targetValue": [0.5]},
      {"materialName": "nobody", "propertyName": "_Color", "targetValue": [1.0]}]}])");
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_EQ(namesOf(file.expressions), "happy, Cheeks, blinkLeft");
  const Expression& happy = *expressionOf(file, "Joy");
  ASSERT_EQ(happy.morphs.size(), 2u);  // 0.x binds meshes: both nodes
  EXPECT_EQ(happy.morphs[1].target, 4);
  EXPECT_FLOAT_EQ(happy.morphs[0].weight, 0.4F);
  EXPECT_FALSE(happy.binary);
  EXPECT_TRUE(expressionOf(file, "cheeks")->binary);
  // Targets that an expression moves begin at 0, the others at their defaults.
  EXPECT_EQ(file.expressions.baseWeights, (std::vector<float>{0, 0, 0.5F, 0, 0, 0.5F}));

  const Expression& blush = *expressionOf(file, "Blink_L");
  EXPECT_EQ(blush.kind, ProceduralKind::kBlink);
  ASSERT_EQ(blush.colors.size(), 2u);
  EXPECT_EQ(blush.colors[0].material, 1);
  EXPECT_EQ(blush.colors[0].color, MaterialColor::kBase);
  EXPECT_TRUE(blush.colors[0].value.isApprox(Eigen::Vector4f(1.0F, std::pow(0.5F, 2.2F), 0.0F, 0.25F)));
  EXPECT_EQ(blush.colors[1].color, MaterialColor::kEmission);
  EXPECT_TRUE(blush.colors[1].value.isApprox(Eigen::Vector4f(3.0F, 0.5F, 0.0F, 1.0F)));
  ASSERT_EQ(blush.textures.size(), 1u);
  EXPECT_EQ(blush.textures[0].material, 0);
  EXPECT_TRUE(blush.textures[0].scale.isApprox(Eigen::Vector2f(0.5F, 0.25F)));
  EXPECT_TRUE(blush.textures[0].offset.isApprox(Eigen::Vector2f(0.125F, 0.75F)));
  EXPECT_TRUE(hasNote(file, "2 binds of expressions refer to what does not exist: skipped (the first: "));
}

TEST(VrmExpressions, ExpressionsOfVrm1AreRead) {
  GlbWriter writer = morphingCharacter();
  writer.document["extensions"]["VRMC_vrm"]["expressions"] = json::parse(R"({
    "preset": {"happy": {"isBinary": true, "overrideBlink": "block", "overrideLookAt": "blend",
      "overrideMouth": "often", "morphTargetBinds": [{"node": 3, "index": 0, "weight": 0.75}]}, "aa": {}},
    "custom": {"Rose": {"textureTransformBinds": [{"material": 0, "offset": [0.5, 0.25]}],
      "materialColorBinds": [{"material": 1, "type": "rimColor", "targetValue": [0.1, 0.2, 0.3, 0.4]}]},
      "HAPPY": {}}})");
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_EQ(namesOf(file.expressions), "aa, happy, Rose");
  EXPECT_TRUE(hasNote(file, "1 expression has a name that another one has"));
  const Expression& happy = *expressionOf(file, "happy");
  EXPECT_TRUE(happy.binary);
  EXPECT_EQ(happy.overrideBlink, ExpressionOverride::kBlock);
  EXPECT_EQ(happy.overrideLookAt, ExpressionOverride::kBlend);
  EXPECT_EQ(happy.overrideMouth, ExpressionOverride::kNone);
  ASSERT_EQ(happy.morphs.size(), 1u);  // 1.0 binds nodes: one of them
  EXPECT_EQ(happy.morphs[0].target, 3);
  EXPECT_EQ(expressionOf(file, "aa")->kind, ProceduralKind::kMouth);
  const Expression& rose = *expressionOf(file, "rose");
  ASSERT_EQ(rose.colors.size(), 1u);
  EXPECT_EQ(rose.colors[0].color, MaterialColor::kRim);
  EXPECT_TRUE(rose.colors[0].value.isApprox(Eigen::Vector4f(0.1F, 0.2F, 0.3F, 0.4F)));
  ASSERT_EQ(rose.textures.size(), 1u);
  EXPECT_EQ(rose.textures[0].scale, Eigen::Vector2f(1.0F, 1.0F));
  EXPECT_EQ(rose.textures[0].offset, Eigen::Vector2f(0.5F, 0.25F));
}

TEST(VrmExpressions, BindsToWhatDoesNotExistAreCounted) {
  GlbWriter writer = morphingCharacter();
  writer.document["extensions"]["VRMC_vrm"]["expressions"]["preset"] = json::parse(R"({
    "angry": {"morphTargetBinds": [{"node": 2, "index": 3, "weight": 1}, {"node": 0, "index": 0, "weight": 1},
        {"node": -1, "index": 0, "weight": 1}, {"node": 1e30, "index": "one"}, "bind",
        {"node": 2, "index": 0, "weight": "much"}],
      "materialColorBinds": [{"material": 2, "type": "color"}, {"material": 0, "type": "colour"}],
      "textureTransformBinds": [{"material": 99}, null]},
    "sad": "sad", "neutral": {"morphTargetBinds": 7}})");
  const CharacterFile file = test::valueOf(parsed(writer));
  const Expression& angry = *expressionOf(file, "angry");
  ASSERT_EQ(angry.morphs.size(), 1u);
  EXPECT_EQ(angry.morphs[0].weight, 0.0F);
  EXPECT_TRUE(angry.colors.empty());
  EXPECT_TRUE(angry.textures.empty());
  EXPECT_TRUE(hasNote(file, "9 binds of expressions refer to what does not exist"));
  EXPECT_NE(expressionOf(file, "sad"), nullptr);
}

TEST(VrmExpressions, OddDocumentsAreHarmless) {
  for (const char* text :
       {"{}", "[]", "7", R"({"expressions": []})", R"({"expressions": {"preset": [1]}})",
        R"({"lookAt": 3, "expressions": {"custom": {"": {}}}})", R"({"humanoid": {"humanBones": 1}})",
        R"({"blendShapeMaster": {"blendShapeGroups": [1, {}, {"name": 3}]}, "firstPerson": []})"}) {
    for (const char* key : {"VRM", "VRMC_vrm"}) {
      GlbWriter writer = morphingCharacter();
      writer.document["extensions"][key] = json::parse(text);
      EXPECT_TRUE(parsed(writer).ok()) << text;
    }
  }
}

TEST(VrmExpressions, TooManyExpressionsAndBindsAreCut) {
  GlbWriter writer = morphingCharacter();
  json& custom = writer.document["extensions"]["VRMC_vrm"]["expressions"]["custom"];
  for (int e = 0; e < 5000; ++e) custom["e" + std::to_string(e)] = json::object();
  CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_EQ(file.expressions.list.size(), static_cast<std::size_t>(kMaxExpressions));
  EXPECT_TRUE(hasNote(file, "3,976 expressions or their binds are beyond the first 1,024 expressions"));

  custom = json::object();
  for (int b = 0; b < kMaxExpressionBinds + 5; ++b) {
    custom["much"]["morphTargetBinds"].push_back({{"node", 2}, {"index", 0}, {"weight", 1e-3}});
  }
  file = test::valueOf(parsed(writer));
  EXPECT_EQ(expressionOf(file, "much")->morphs.size(), static_cast<std::size_t>(kMaxExpressionBinds));
  EXPECT_TRUE(hasNote(file, "5 expressions or their binds are beyond"));
}

TEST(VrmExpressions, GazeOfVrm1IsRead) {
  GlbWriter writer = morphingCharacter();
  json& vrm = writer.document["extensions"]["VRMC_vrm"];
  vrm["humanoid"]["humanBones"] = {{"head", {{"node", 0}}}, {"leftEye", {{"node", 1}}}, {"rightEye", {{"node", 3}}}};
  vrm["lookAt"] = {{"type", "bone"},
                   {"offsetFromHeadBone", {0.0, 0.1, 0.2}},
                   {"rangeMapHorizontalInner", {{"inputMaxValue", 60.0}, {"outputScale", 8.0}}},
                   {"rangeMapVerticalUp", {{"inputMaxValue", 0.0}, {"outputScale", "high"}}}};
  const CharacterFile file = test::valueOf(parsed(writer));
  const LookAt& lookAt = file.lookAt;
  EXPECT_EQ(lookAt.kind, LookAtKind::kBone);
  EXPECT_EQ(lookAt.head, file.character.skeleton.jointOf(HumanBone::kHead));
  EXPECT_EQ(file.character.skeleton.joint(lookAt.leftEye).name, "upper");
  EXPECT_EQ(lookAt.rightEye, kNoJoint);  // the node moves nothing, so it has no joint
  EXPECT_TRUE(lookAt.offsetFromHead.isApprox(Vec3(0.0, 0.1, 0.2), 1e-6));
  EXPECT_NEAR(lookAt.inner.inputMax, 60.0 * kDegree, 1e-6);
  EXPECT_NEAR(lookAt.inner.output, 8.0 * kDegree, 1e-6);
  EXPECT_NEAR(lookAt.outer.inputMax, 90.0 * kDegree, 1e-6);
  EXPECT_NEAR(lookAt.outer.output, 10.0 * kDegree, 1e-6);
  EXPECT_GT(lookAt.up.inputMax, 0.0);
}

TEST(VrmExpressions, GazeWithoutEyesIsNone) {
  GlbWriter writer = morphingCharacter();
  json& vrm = writer.document["extensions"]["VRMC_vrm"];
  vrm["humanoid"]["humanBones"] = {{"head", {{"node", 0}}}, {"leftEye", {{"node", 4711}}}};
  vrm["lookAt"] = {{"type", "bone"}};
  EXPECT_EQ(test::valueOf(parsed(writer)).lookAt.kind, LookAtKind::kNone);
  vrm["lookAt"]["type"] = "expression";
  EXPECT_EQ(test::valueOf(parsed(writer)).lookAt.kind, LookAtKind::kNone);
  vrm["expressions"]["preset"]["lookUp"] = json::object();
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_EQ(file.lookAt.kind, LookAtKind::kExpression);
  EXPECT_EQ(file.lookAt.outer.output, 1.0);
}

TEST(VrmExpressions, GodetteHasSeventeenAndLooksByExpressions) {
  LORICA_REQUIRE_DATASET(path, "characters/godette/Godette_vrm_v4.vrm");
  const CharacterFile file = test::valueOf(readCharacterFile(path));
  EXPECT_EQ(file.morphs.targets.size(), 15u);
  EXPECT_EQ(file.morphs.targets[14].name, "angled_eyebrows");
  EXPECT_EQ(namesOf(file.expressions),
            "neutral, aa, ih, ou, ee, oh, blink, happy, angry, sad, relaxed, lookUp, lookDown, lookLeft, lookRight, "
            "blinkLeft, blinkRight");
  EXPECT_EQ(file.lookAt.kind, LookAtKind::kExpression);
  EXPECT_NEAR(file.lookAt.up.output, 2.9, 1e-6);
  EXPECT_TRUE(file.lookAt.offsetFromHead.isApprox(Vec3(0.0, 0.146, -0.122), 1e-6));
  // It faces +Z here, so a point before the face is straight ahead.
  std::vector<Affine3> world(file.character.skeleton.jointCount());
  computeWorldFromJoint(file.character.skeleton, restPose(file.character.skeleton), world);
  const Affine3& head = world[file.lookAt.head];
  const Vec3 eyes = head * file.lookAt.offsetFromHead;
  EXPECT_GT(eyes.z(), head.translation().z());
  const Gaze gaze = gazeTowards(file.lookAt, head, eyes + Vec3(1.0, 0.0, 1.0));
  EXPECT_NEAR(gaze.yaw, 45.0 * kDegree, 1e-6);
  EXPECT_NEAR(gaze.pitch, 0.0, 1e-6);
}

}  // namespace
}  // namespace lorica
