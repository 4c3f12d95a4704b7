// Faces as three.js and three-vrm make them: every expression moves the vertices to the same places and gives materials
// the same colours.
#include "skinning/morphs/face.h"
#include "tests/peers/avatar_poses.h"
#include "tests/peers/bare_picture.h"
#include "tests/peers/peer.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

using nlohmann::json;

/// The vertices of the bind pose with some expressions, by name.
std::vector<Vec3> faceOf(const CharacterFile& file, const json& expressions) {
  Face face(file.morphs, file.expressions, file.lookAt);
  face.setBlinking(false);
  for (const auto& [name, weight] : expressions.items()) {
    face.set(findExpression(file.expressions, name).value(), weight.get<float>());
  }
  face.update({});
  Character moved = file.character;
  applyMorphs(file.morphs, face.targetWeights(), file.character.mesh.vertices, {}, moved.mesh.vertices, {});
  return test::posedVertices(moved, restPose(moved.skeleton));
}

TEST(PeerExpressions, VerticesAgreeForEachOfGodettesSeventeen) {
  LORICA_REQUIRE_DATASET(path, "characters/godette/Godette_vrm_v4.vrm");
  LORICA_REQUIRE_PEERS();
  const CharacterFile file = test::valueOf(readCharacterFile(path));
  ASSERT_EQ(file.expressions.list.size(), 17U);
  json shots = {{"picture", false}, {"vertices", true}};
  shots["shots"]["none"] = json::object();
  for (const Expression& expression : file.expressions.list) {
    for (const double weight : {0.4, 1.0}) {
      shots["shots"][expression.name + (weight == 1.0 ? "" : " partly")]["expressions"][expression.name] = weight;
    }
  }
  shots["shots"]["several"]["expressions"] = {{"angry", 0.7}, {"aa", 0.6}, {"blinkRight", 0.9}, {"lookLeft", 0.3}};

  const auto made = test::shootWithPeer(path, shots);
  ASSERT_EQ(made.size(), shots["shots"].size());
  double farthest = 0.0;
  int moving = 0;
  for (const auto& [name, shot] : made) {
    const std::vector<Vec3> ours = faceOf(file, shots["shots"][name].value("expressions", json::object()));
    // The face is the first mesh that both list; the others have no targets.
    const auto count = shot.facts.at("meshes").at(0).at("count").get<std::size_t>();
    ASSERT_LE(count, ours.size());
    double way = 0.0;
    double apart = 0.0;
    for (std::size_t v = 0; v < count; ++v) {
      apart = std::max(apart, (ours[v] - shot.vertices.at(v).cast<double>()).norm());
      way = std::max(way, (ours[v] - file.character.mesh.vertices[v]).norm());
    }
    EXPECT_LT(apart, 1e-4) << name;
    farthest = std::max(farthest, apart);
    moving += way > 1e-3 ? 1 : 0;
  }
  EXPECT_GE(moving, 28);
  std::printf("%zu faces, of which %d move a vertex by over 1 mm: within %.2g m\n", made.size(), moving, farthest);
}

/// Adds what an expression of VRM 0.x changes of a material. Colours are 0 or 1, because three-vrm takes them as linear
/// and Lorica as gamma-encoded, as Unity does. Shades are nowhere brighter than the lit colour, which Lorica forbids.
void addMaterialValue(json& document, const std::string& preset, const char* material, const char* property,
                      const json& target) {
  for (json& group : document["extensions"]["VRM"]["blendShapeMaster"]["blendShapeGroups"]) {
    if (group["presetName"] != preset) continue;
    group["materialValues"].push_back(
        {{"materialName", material}, {"propertyName", property}, {"targetValue", target}});
  }
}

TEST(PeerExpressions, ColoursAndTexturesAgreeOnAnEditedGodette) {
  LORICA_REQUIRE_DATASET(path, "characters/godette/Godette_vrm_v4.vrm");
  LORICA_REQUIRE_PEERS();
  LORICA_REQUIRE_STUDIO(studio, "");
  const test::TemporaryFolder folder;
  const std::filesystem::path edited = folder.path() / "edited.vrm";
  test::writeEdited(path, edited, [](json& document) {
    addMaterialValue(document, "joy", "Face", "_Color", {1, 0, 0, 1});
    addMaterialValue(document, "joy", "Face", "_ShadeColor", {1, 0, 0, 1});
    addMaterialValue(document, "angry", "Body", "_Color", {0, 1, 1, 1});
    addMaterialValue(document, "angry", "Body", "_ShadeColor", {0, 0, 1, 1});
    addMaterialValue(document, "sorrow", "Body", "_MainTex_ST", {1, 1, 0.25, 0.25});
    addMaterialValue(document, "sorrow", "Face", "_MainTex_ST", {2, 1, 0, 0});
  });
  CharacterFile file = test::valueOf(readCharacterFile(edited));
  MadeAvatar avatar = test::valueOf(makeAvatar(file.character, file.look));
  const test::Sitter sitter = {std::move(file), avatar.avatar};
  json shots = {{"eye", {0.6, 1.2, 2.4}}, {"target", {0, 0.75, 0}}, {"width", 400}, {"height", 400}};
  shots["shots"]["none"] = json::object();
  for (const char* name : {"happy", "angry", "sad"}) shots["shots"][name]["expressions"][name] = 1.0;
  shots["shots"]["half"]["expressions"] = {{"happy", 0.5}, {"sad", 0.5}};
  const auto made = test::shootWithPeer(edited, shots);
  ASSERT_EQ(made.size(), 5u);
  for (const auto& [name, shot] : made) {
    const test::MaskedPicture ours = test::drawBare(*studio, sitter, shot.facts["options"]);
    const test::Likeness like = test::likenessOf(ours, {shot.picture, shot.mask});
    const test::Likeness unlike = test::likenessOf(ours, {made.at("none").picture, made.at("none").mask});
    EXPECT_GE(like.silhouettes, 0.99) << name;
    EXPECT_LE(like.wrong, 0.03) << name;
    if (name != "none") {
      EXPECT_GT(unlike.wrong, 0.1) << name << " changes nothing";
    }
    std::printf("%s: %.2f %% wholly wrong; against no expression %.1f %%\n", name.c_str(), 100.0 * like.wrong,
                100.0 * unlike.wrong);
  }
}

}  // namespace
}  // namespace lorica
