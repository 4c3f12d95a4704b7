// Faces as three.js and three-vrm make them: every expression moves the vertices to the same places.
#include "skinning/morphs/face.h"
#include "tests/peers/avatar_poses.h"
#include "tests/peers/peer.h"
#include "tests/support/datasets.h"

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
  const Result<CharacterFile> file = readCharacterFile(path);
  ASSERT_TRUE(file.ok()) << file.error().message;
  ASSERT_EQ(file.value().expressions.list.size(), 17U);
  json shots = {{"picture", false}, {"vertices", true}};
  shots["shots"]["none"] = json::object();
  for (const Expression& expression : file.value().expressions.list) {
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
    const std::vector<Vec3> ours = faceOf(file.value(), shots["shots"][name].value("expressions", json::object()));
    // The face is the first mesh that both list; the others have no targets.
    const auto count = shot.facts.at("meshes").at(0).at("count").get<std::size_t>();
    ASSERT_LE(count, ours.size());
    double way = 0.0;
    double apart = 0.0;
    for (std::size_t v = 0; v < count; ++v) {
      apart = std::max(apart, (ours[v] - shot.vertices.at(v).cast<double>()).norm());
      way = std::max(way, (ours[v] - file.value().character.mesh.vertices[v]).norm());
    }
    EXPECT_LT(apart, 1e-4) << name;
    farthest = std::max(farthest, apart);
    moving += way > 1e-3 ? 1 : 0;
  }
  EXPECT_GE(moving, 28);
  std::printf("%zu faces, of which %d move a vertex by over 1 mm: within %.2g m\n", made.size(), moving, farthest);
}

}  // namespace
}  // namespace lorica
