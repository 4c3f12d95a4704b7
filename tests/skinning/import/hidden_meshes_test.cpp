#include "skinning/import/hidden_meshes.h"

#include "tests/skinning/import/small_character.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

using test::GlbWriter;
using test::makeBox;
using test::smallCharacter;

/// Adds a rigid box on a node below "upper".
void addTool(GlbWriter& writer, const std::string& node, const std::string& mesh, const Vec3& size) {
  const TriMesh box = makeBox(Vec3::Zero(), size);
  const int positions = writer.positions(box.vertices);
  const int indices = writer.triangles(box.triangles);
  const int index = writer.add(
      "meshes", {{"name", mesh}, {"primitives", {{{"indices", indices}, {"attributes", {{"POSITION", positions}}}}}}});
  const int added = writer.add("nodes", {{"name", node}, {"mesh", index}, {"translation", {0.2, 0.5, 0.0}}});
  writer.document["nodes"][1]["children"].push_back(added);
}

GlbWriter armed() {
  GlbWriter writer = smallCharacter();
  addTool(writer, "Axe.R", "Cube.007", Vec3(0.1, 0.1, 0.5));
  addTool(writer, "Shield", "Cube.008", Vec3(0.5, 0.5, 0.1));
  return writer;
}

Result<CharacterFile> readWithout(const GlbWriter& writer, std::vector<std::string> hidden = {}) {
  const std::string glb = writer.glb();
  return parseCharacterFile(std::as_bytes(std::span(glb)), "hero.glb", {std::move(hidden)});
}

std::string problemOf(const GlbWriter& writer, std::vector<std::string> hidden) {
  const Result<CharacterFile> file = readWithout(writer, std::move(hidden));
  if (file) return "none";
  EXPECT_EQ(file.error().code, ErrorCode::kInvalidArgument);
  return file.error().message;
}

/// Mesh, skeleton, weights and clips are the same bit for bit.
void expectSame(const CharacterFile& a, const CharacterFile& b) {
  EXPECT_EQ(a.character.mesh.vertices, b.character.mesh.vertices);
  EXPECT_EQ(a.character.mesh.triangles, b.character.mesh.triangles);
  EXPECT_EQ(a.character.influenceBegin, b.character.influenceBegin);
  ASSERT_EQ(a.character.skeleton.jointCount(), b.character.skeleton.jointCount());
  for (JointIndex j = 0; j < a.character.skeleton.jointCount(); ++j) {
    EXPECT_EQ(a.character.skeleton.joint(j).name, b.character.skeleton.joint(j).name);
    EXPECT_EQ(a.character.jointFromModel[j].matrix(), b.character.jointFromModel[j].matrix());
  }
  EXPECT_EQ(a.clips.size(), b.clips.size());
  EXPECT_EQ(a.character.height, b.character.height);
}

TEST(HiddenMeshes, AFileIsReadAsIfTheyWereNotInIt) {
  const CharacterFile bare = readWithout(smallCharacter()).value();
  GlbWriter shielded = smallCharacter();
  addTool(shielded, "Shield", "Cube.008", Vec3(0.5, 0.5, 0.1));
  expectSame(readWithout(armed(), {"Axe.R", "Shield"}).value(), bare);
  expectSame(readWithout(armed(), {"Axe.R"}).value(), readWithout(shielded).value());
  EXPECT_GT(readWithout(armed()).value().character.mesh.vertices.size(), bare.character.mesh.vertices.size());
}

TEST(HiddenMeshes, ANameIsThatOfTheMeshOrItsNodeInAnyCase) {
  const CharacterFile byNode = readWithout(armed(), {"axe.r"}).value();
  expectSame(readWithout(armed(), {"CUBE.007"}).value(), byNode);
  expectSame(readWithout(armed(), {"Cube.007", "Axe.R", "Axe.R"}).value(), byNode);
  ASSERT_EQ(byNode.meshNames.size(), 2u);
  EXPECT_EQ(byNode.meshNames[0].text(), "box (Body)");
  EXPECT_EQ(byNode.meshNames[1].text(), "Shield (Cube.008)");
}

TEST(HiddenMeshes, NodesThatShareAMeshAreHiddenOneByOneOrTogether) {
  GlbWriter writer = armed();
  const auto axe = writer.document["nodes"][3]["mesh"];
  const int second = writer.add("nodes", {{"name", "Axe.L"}, {"mesh", axe}});
  writer.document["nodes"][0]["children"].push_back(second);
  const std::size_t all = readWithout(writer).value().character.mesh.triangles.size();
  EXPECT_EQ(all, 48u);
  EXPECT_EQ(readWithout(writer, {"Axe.L"}).value().character.mesh.triangles.size(), 36u);
  EXPECT_EQ(readWithout(writer, {"Cube.007"}).value().character.mesh.triangles.size(), 24u);
}

TEST(HiddenMeshes, ASkinnedMeshIsHiddenWithoutItsBones) {
  GlbWriter writer = armed();
  const CharacterFile file = readWithout(writer, {"Body"}).value();
  EXPECT_EQ(file.character.mesh.triangles.size(), 24u);
  EXPECT_EQ(file.clips.size(), 1u);
}

TEST(HiddenMeshes, TheUnitIsThatOfTheWholeFile) {
  // 15 units are taken for centimetres, 2 for metres.
  GlbWriter writer = smallCharacter();
  addTool(writer, "Flagpole", "Cube.009", Vec3(0.1, 15.0, 0.1));
  EXPECT_EQ(readWithout(smallCharacter()).value().metresPerUnit, 1.0);
  EXPECT_EQ(readWithout(writer).value().metresPerUnit, 0.01);
  EXPECT_EQ(readWithout(writer, {"Flagpole"}).value().metresPerUnit, 0.01);
}

TEST(HiddenMeshes, AnUnknownNameIsASentenceThatListsTheMeshes) {
  EXPECT_EQ(problemOf(armed(), {"Shield", "Sword"}),
            "hero.glb: no mesh named `Sword` to hide, expected one of box (Body), Axe.R (Cube.007), Shield (Cube.008)");
  GlbWriter crowd = smallCharacter();
  for (int i = 0; i < 50; ++i) addTool(crowd, "Leaf" + std::to_string(i), "", Vec3::Constant(0.1));
  const std::string sentence = problemOf(crowd, {""});
  EXPECT_NE(sentence.find("Leaf38 and 11 more"), std::string::npos) << sentence;

  GlbWriter bones = smallCharacter();
  bones.document["nodes"][2].erase("mesh");
  EXPECT_EQ(problemOf(bones, {"Body"}), "hero.glb: no mesh named `Body` to hide, the file has none");
}

TEST(HiddenMeshes, HidingAllIsASentence) {
  EXPECT_EQ(
      problemOf(armed(), {"Body", "Axe.R", "Shield"}),
      "hero.glb: every mesh is hidden (box (Body), Axe.R (Cube.007), Shield (Cube.008)), expected at least one to "
      "be left");
}

}  // namespace
}  // namespace lorica
