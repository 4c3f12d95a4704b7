#include "geometry/work_budgets.h"
#include "skinning/springs/spring_simulation.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/allocations.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <string>

namespace lorica {
namespace {

using Json = nlohmann::json;
using test::GlbWriter;
using test::hasNote;
using test::parsed;

/// The small character with a strand of three nodes on "upper": 3 "hair", 4 "hair 2" and 5 "hair end".
GlbWriter withHair() {
  GlbWriter writer = test::smallCharacter();
  writer.document["nodes"][1]["children"] = {3};
  writer.add("nodes", {{"name", "hair"}, {"translation", {0.0, 0.5, -0.2}}, {"children", {4}}});
  writer.add("nodes", {{"name", "hair 2"}, {"translation", {0.0, -0.1, 0.0}}, {"children", {5}}});
  writer.add("nodes", {{"name", "hair end"}, {"translation", {0.0, -0.2, 0.05}}});
  return writer;
}

GlbWriter with0(const char* secondaryAnimation) {
  GlbWriter writer = withHair();
  writer.document["extensions"]["VRM"]["secondaryAnimation"] = Json::parse(secondaryAnimation);
  return writer;
}

GlbWriter with1(Json springBone) {
  GlbWriter writer = withHair();
  springBone["specVersion"] = "1.0";
  writer.document["extensions"]["VRMC_vrm"] = {{"specVersion", "1.0"}};
  writer.document["extensions"]["VRMC_springBone"] = std::move(springBone);
  return writer;
}
GlbWriter with1(const char* springBone) {
  return with1(Json::parse(springBone));
}

std::string nameOf(const CharacterFile& file, JointIndex joint) {
  return file.character.skeleton.joint(joint).name;
}

/// The file is read, with a note; returns its springs.
SpringBones expectNote(const GlbWriter& writer, const std::string& note) {
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_TRUE(hasNote(file, note)) << "expected: " << note << "\nfound: " << testing::PrintToString(file.notes);
  EXPECT_TRUE(SpringSimulation::create(file.character.skeleton, file.springs).ok());
  return file.springs;
}

TEST(VrmSprings, AFileWithoutThemKeepsItsJoints) {
  const CharacterFile file = test::valueOf(parsed(withHair()));
  EXPECT_TRUE(file.springs.empty());
  EXPECT_EQ(file.character.skeleton.jointCount(), 3);
}

TEST(VrmSprings, Version0AppliesToAllDescendantsAndHasUnitysAxes) {
  const CharacterFile file = test::valueOf(parsed(with0(R"({
    "boneGroups": [{"bones": [3], "stiffiness": 2.5, "gravityPower": 0.4, "gravityDir": {"x": 0.6, "y": 0.0, "z": 0.8},
      "dragForce": 0.3, "hitRadius": 0.02, "center": -1, "colliderGroups": [0]}],
    "colliderGroups": [{"node": 1, "colliders": [{"offset": {"x": 0.1, "y": 0.2, "z": 0.3}, "radius": 0.15}]}]})")));
  ASSERT_EQ(file.springs.chains.size(), 1u);
  const SpringChain& chain = file.springs.chains[0];
  EXPECT_EQ(chain.center, kNoJoint);
  ASSERT_EQ(chain.joints.size(), 3u);
  EXPECT_EQ(nameOf(file, chain.joints[0].joint), "hair");
  EXPECT_EQ(nameOf(file, chain.joints[2].joint), "hair end");
  EXPECT_EQ(chain.joints[0].stiffness, 2.5);
  EXPECT_EQ(chain.joints[0].dragForce, 0.3);
  EXPECT_EQ(chain.joints[0].hitRadius, 0.02);
  EXPECT_NEAR((chain.joints[0].tail - Vec3(0.0, -0.1, 0.0)).norm(), 0.0, 1e-12);
  // The last one has a tail 7 cm farther along.
  EXPECT_NEAR((chain.joints[2].tail - 0.07 * Vec3(0.0, -0.2, 0.05).normalized()).norm(), 0.0, 1e-12);
  // Unity's (x, y, z) is glTF's (x, y, -z), and the character is turned to face +Z.
  EXPECT_NEAR((chain.joints[0].gravityDir - Vec3(-0.6, 0.0, 0.8)).norm(), 0.0, 1e-12);
  ASSERT_EQ(file.springs.colliders.size(), 1u);
  EXPECT_EQ(nameOf(file, file.springs.colliders[0].joint), "upper");
  EXPECT_NEAR((file.springs.colliders[0].offset - Vec3(0.1, 0.2, -0.3)).norm(), 0.0, 1e-12);
  EXPECT_EQ(file.springs.colliders[0].radius, 0.15);
}

TEST(VrmSprings, Version1HasATailForEachPairOfJoints) {
  const CharacterFile file = test::valueOf(parsed(with1(R"({
    "colliders": [{"node": 0, "shape": {"sphere": {"offset": [0, 1, 0], "radius": 0.1}}},
      {"node": 1, "shape": {"capsule": {"offset": [0, 1, 0], "tail": [0, 2, 0], "radius": 0.2}}},
      {"node": 1, "shape": {"sphere": {"radius": 1.0}}, "extensions": {"VRMC_springBone_extended_collider":
        {"shape": {"plane": {"offset": [0, 0, 1], "normal": [0, 1, 0]}}}}}],
    "colliderGroups": [{"colliders": [0, 2]}, {"colliders": [1]}],
    "springs": [{"name": "strand", "center": 0, "colliderGroups": [1, 0],
      "joints": [{"node": 3, "stiffness": 0.7, "gravityDir": [0, 0, 1]}, {"node": 5}]}]})")));
  ASSERT_EQ(file.springs.chains.size(), 1u);
  const SpringChain& chain = file.springs.chains[0];
  EXPECT_EQ(chain.name, "strand");
  EXPECT_EQ(nameOf(file, chain.center), "lower");
  ASSERT_EQ(chain.joints.size(), 1u);
  EXPECT_EQ(chain.joints[0].stiffness, 0.7);
  EXPECT_EQ(chain.joints[0].dragForce, 0.4);  // the specification's default
  EXPECT_NEAR((chain.joints[0].gravityDir - Vec3(0.0, 0.0, 1.0)).norm(), 0.0, 1e-12);
  // Across the node between them.
  EXPECT_NEAR((chain.joints[0].tail - Vec3(0.0, -0.3, 0.05)).norm(), 0.0, 1e-12);
  ASSERT_EQ(file.springs.colliders.size(), 3u);
  EXPECT_EQ(file.springs.colliders[1].shape, SpringColliderShape::kCapsule);
  EXPECT_EQ(file.springs.colliders[1].tail.y(), 2.0);
  EXPECT_EQ(file.springs.colliders[2].shape, SpringColliderShape::kPlane);
  EXPECT_EQ(file.springs.colliders[2].normal.y(), 1.0);
  EXPECT_EQ(file.springs.colliderGroups, (std::vector<std::vector<int>>{{0, 2}, {1}}));
  EXPECT_EQ(chain.colliderGroups, (std::vector<int>{1, 0}));
}

TEST(VrmSprings, ConstraintsAreReadFromTheirNodes) {
  GlbWriter writer = withHair();
  const auto constrain = [&](int node, Json constraint) {
    writer.document["nodes"][node]["extensions"]["VRMC_node_constraint"] = {{"specVersion", "1.0"},
                                                                            {"constraint", std::move(constraint)}};
  };
  constrain(3, {{"roll", {{"source", 1}, {"rollAxis", "Y"}, {"weight", 0.5}}}});
  constrain(4, {{"aim", {{"source", 0}, {"aimAxis", "NegativeZ"}}}});
  constrain(5, {{"rotation", {{"source", 1}}}});
  const CharacterFile file = test::valueOf(parsed(writer));
  ASSERT_EQ(file.springs.constraints.size(), 3u);
  for (const NodeConstraint& constraint : file.springs.constraints) {
    const std::string joint = nameOf(file, constraint.joint);
    if (joint == "hair") {
      EXPECT_EQ(constraint.kind, NodeConstraint::Kind::kRoll);
      EXPECT_EQ(nameOf(file, constraint.source), "upper");
      EXPECT_EQ(constraint.axis, Vec3(Vec3::UnitY()));
      EXPECT_EQ(constraint.weight, 0.5);
    } else if (joint == "hair 2") {
      EXPECT_EQ(constraint.kind, NodeConstraint::Kind::kAim);
      EXPECT_EQ(constraint.axis, Vec3(-Vec3::UnitZ()));
      EXPECT_EQ(constraint.weight, 1.0);
    } else {
      EXPECT_EQ(joint, "hair end");
      EXPECT_EQ(constraint.kind, NodeConstraint::Kind::kRotation);
    }
  }
}

TEST(VrmSprings, LengthsStayInTheFramesOfTheirJoints) {
  GlbWriter writer = with0(R"({"boneGroups": [{"bones": [5], "stiffiness": 1.0, "hitRadius": 0.02}]})");
  writer.document["nodes"].push_back({{"name", "armature"}, {"scale", {100.0, 100.0, 100.0}}, {"children", {0}}});
  writer.document["scenes"][0]["nodes"] = {6, 2};
  // A scaled armature with inverse bind matrices of its own size shows the character in centimetres.
  writer.document["skins"][0].erase("inverseBindMatrices");
  const CharacterFile file = test::valueOf(parsed(writer));
  ASSERT_EQ(file.metresPerUnit, 0.01);
  ASSERT_EQ(file.springs.springCount(), 1);
  EXPECT_EQ(file.springs.chains[0].joints[0].stiffness, 1.0);
  EXPECT_EQ(file.springs.chains[0].joints[0].hitRadius, 0.02);
}

TEST(VrmSprings, FaultsAreSkippedWithOneNoteEach) {
  const std::string strand = R"({"joints": [{"node": 3}, {"node": 5}]})";
  struct Row {
    GlbWriter file;
    std::string note;
    int springs;
  };
  const auto group0 = [](const std::string& members) {
    return with0(("{\"boneGroups\": [{" + members + "}]}").c_str());
  };
  for (const auto& [file, note, springs] : std::initializer_list<Row>{
           {group0(R"("bones": [99])"), "refers to node 99, which does not exist", 0},
           {group0(R"("bones": [3, 4])"), "node 4 'hair 2' swings already", 3},
           {group0(R"("bones": [3], "colliderGroups": [7])"), "refers to collider group 7, which does not exist", 3},
           // "lower" lies at the origin, so a virtual tail has no direction.
           {group0(R"("bones": [2])"), "'box' has no length", 0},
           {with1(R"({"springs": [{"joints": [{"node": 5}, {"node": 3}]}]})"), "node 3 is not below node 5", 0},
           {with1(R"({"springs": [{"joints": [{"node": 5}, {"node": 5}]}]})"), "node 5 is not below node 5", 0},
           {with1(("{\"springs\": [" + strand + ", " + strand + "]}").c_str()), "swings already", 1}}) {
    const SpringBones read = expectNote(file, note);
    EXPECT_EQ(read.springCount(), springs) << note;
    EXPECT_EQ(read.empty(), springs == 0) << note;
  }
  const auto chain = [&](const char* members, const char* note) {
    return expectNote(group0(members), note).chains.at(0);
  };
  EXPECT_EQ(chain(R"("bones": [3], "stiffiness": -4.0)", "stiffiness is -4.0").joints[0].stiffness, 0.0);
  EXPECT_EQ(chain(R"("bones": [3], "dragForce": "much")", "dragForce is \"much\"").joints[0].dragForce, 0.4);
  EXPECT_EQ(chain(R"("bones": [3], "center": 4)", "its centre, node 4, swings with it").center, kNoJoint);
  for (const auto& [file, note] :
       {std::pair(with0(R"({"colliderGroups": [{"node": -3, "colliders": [{"radius": 1.0}]}]})"),
                  "collider group 0 refers to node -3"),
        {with1(R"({"colliders": [{"node": 0, "shape": {"cone": {}}}]})"), "collider 0 has no shape"}}) {
    EXPECT_TRUE(expectNote(file, note).colliders.empty());
  }
  EXPECT_EQ(expectNote(with1(R"({"colliderGroups": [{"colliders": [1, 2, 3]}]})"), "collider 1, which does not exist")
                .colliderGroups,
            std::vector<std::vector<int>>(1));
  EXPECT_FALSE(hasNote(*parsed(with1(R"({"springs": 5, "colliders": "none", "colliderGroups": null})")), "springs"));
}

TEST(VrmSprings, CyclicConstraintsAreSkippedWithANote) {
  GlbWriter writer = withHair();
  const auto follow = [&](int node, int source) {
    writer.document["nodes"][node]["extensions"]["VRMC_node_constraint"]["constraint"]["rotation"]["source"] = source;
  };
  follow(3, 4);
  follow(4, 5);
  follow(5, 3);
  EXPECT_EQ(expectNote(writer, "the constraint of 'hair end' depends on itself").constraints.size(), 2u);
  writer = withHair();
  follow(3, 3);
  EXPECT_TRUE(expectNote(writer, "the constraint of 'hair' depends on itself").constraints.empty());
  follow(3, 12);
  EXPECT_TRUE(expectNote(writer, "constraint of node 3 refers to node 12").constraints.empty());
  writer.document["nodes"][3]["extensions"]["VRMC_node_constraint"]["constraint"] = {{"bend", 1}};
  EXPECT_TRUE(expectNote(writer, "neither roll, aim nor rotation").constraints.empty());
}

TEST(VrmSprings, AHundredThousandEntriesNeedLittleMemory) {
  constexpr int kMany = 100'000;
  Json springs = {{"colliders", Json::array()}, {"colliderGroups", Json::array()}, {"springs", Json::array()}};
  Json all = Json::array();
  for (int i = 0; i < kMany; ++i) {
    springs["colliders"].push_back({{"node", i % 5}, {"shape", {{"sphere", {{"radius", 0.1}}}}}});
    springs["springs"].push_back({{"joints", {{{"node", i}}, {{"node", i + 1}}}}, {"colliderGroups", {0}}});
    all.push_back(i);
  }
  springs["colliderGroups"].push_back({{"colliders", all}});
  const GlbWriter writer = with1(std::move(springs));
  const test::AllocationWatch watch;
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_LT(watch.largest(), std::size_t{40} << 20U);
  EXPECT_LE(file.springs.colliders.size(), kMaxSpringColliders);
  EXPECT_LT(file.notes.size(), 20u);
  EXPECT_TRUE(hasNote(file, "more than 10,000 colliders"));
}

TEST(VrmSprings, GodettesAreReadWhole) {
  LORICA_REQUIRE_DATASET(path, "characters/godette/Godette_vrm_v4.vrm");
  const CharacterFile file = test::valueOf(readCharacterFile(path));
  // 4 locks over the forehead, a ribbon and 3 tufts, each with a joint at its end.
  EXPECT_EQ(file.springs.chains.size(), 8u);
  EXPECT_EQ(file.springs.springCount(), 16);
  EXPECT_EQ(file.springs.colliders.size(), 4u);
  EXPECT_FALSE(hasNote(file, "springs"));
}

}  // namespace
}  // namespace lorica
