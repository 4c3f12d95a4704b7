#include "skinning/import/gltf_parts.h"

#include "geometry/counts.h"
#include "geometry/work_budgets.h"
#include "tests/skinning/import/agreement.h"
#include "tests/skinning/import/gltf_truth.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

using test::GlbWriter;
using test::hasNote;
using test::parsed;
using test::smallCharacter;

/// Offsets of the eight vertices of the small character: vertex v moves by `step` times v.
[[nodiscard]] std::vector<float> steps(const Vec3f& step) {
  std::vector<float> numbers;
  for (int v = 0; v < 8; ++v) {
    for (int axis = 0; axis < 3; ++axis) numbers.push_back(static_cast<float>(v) * step[axis]);
  }
  return numbers;
}

/// The small character with two targets: 0 moves to +Y and turns normals to +Z, 1 moves to +X.
[[nodiscard]] GlbWriter morphingCharacter() {
  GlbWriter writer = smallCharacter();
  const int up = writer.accessor(steps({0.0F, 0.25F, 0.0F}), "VEC3");
  const int turn = writer.accessor(steps({0.0F, 0.0F, 0.5F}), "VEC3");
  const int aside = writer.accessor(steps({0.125F, 0.0F, 0.0F}), "VEC3");
  nlohmann::json& mesh = writer.document["meshes"][0];
  mesh["primitives"][0]["targets"] = {{{"POSITION", up}, {"NORMAL", turn}}, {{"POSITION", aside}}};
  mesh["extras"] = {{"targetNames", {"Smile", "Wink"}}};
  return writer;
}

/// An animation of the weights of node 2.
void addWeights(GlbWriter& writer, const std::string& interpolation, const std::vector<float>& times,
                const std::vector<float>& values, int node = 2) {
  const int input = writer.accessor(times, "SCALAR");
  const int output = writer.accessor(values, "SCALAR");
  writer.add("animations", {{"name", "face"},
                            {"samplers", {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}},
                            {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", "weights"}}}}}}});
}

TEST(GltfMorphs, NamesOffsetsAndWeightsAreTheFiles) {
  GlbWriter writer = morphingCharacter();
  writer.document["meshes"][0]["weights"] = {0.5};
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_TRUE(file.notes.empty());
  ASSERT_EQ(file.morphs.targets.size(), 2u);
  const MorphTarget& smile = file.morphs.targets[0];
  EXPECT_EQ(smile.name, "Smile");
  EXPECT_EQ(smile.defaultWeight, 0.5F);
  ASSERT_EQ(smile.offsets.size(), 7u);  // vertex 0 stays
  for (std::size_t i = 0; i < 7; ++i) {
    const auto v = static_cast<float>(i + 1);
    EXPECT_EQ(smile.offsets[i].vertex, static_cast<VertexIndex>(i + 1));
    EXPECT_TRUE(smile.offsets[i].position.isApprox(Vec3f(0.0F, 0.25F * v, 0.0F)));
    EXPECT_TRUE(smile.offsets[i].normal.isApprox(Vec3f(0.0F, 0.0F, 0.5F * v)));
  }
  EXPECT_EQ(file.morphs.targets[1].name, "Wink");
  EXPECT_EQ(file.morphs.targets[1].defaultWeight, 0.0F);
}

TEST(GltfMorphs, WeightsMoveTheBindPoseAsTheFileSays) {
  GlbWriter writer = morphingCharacter();
  writer.document["nodes"][2]["weights"] = {0.25, 1.0};
  const CharacterFile base = test::valueOf(parsed(smallCharacter())), file = test::valueOf(parsed(writer));
  const std::vector<Vec3>& bind = file.character.mesh.vertices;
  std::vector<Vec3> moved(bind.size());
  for (const auto& [up, aside] : {std::pair(0.0F, 0.0F), {0.25F, 1.0F}, {1.0F, -0.5F}}) {
    applyMorphs(file.morphs, std::vector<float>{up, aside}, bind, {}, moved, {});
    for (int v = 0; v < countOf(bind); ++v) {
      const Vec3 expected = base.character.mesh.vertices[v] + Vec3(0.125 * v * aside, 0.25 * v * up, 0.0);
      EXPECT_LT((moved[v] - expected).norm(), 1e-6);
    }
  }
}

TEST(GltfMorphs, OffsetsFollowTheFilesUnitsAndTheNodesTurn) {
  GlbWriter writer = morphingCharacter();
  writer.document["nodes"][2].erase("skin");
  writer.document["nodes"][2]["rotation"] = {std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)};  // Y to Z
  writer.document["nodes"][2]["scale"] = {2.0, 2.0, 2.0};
  const CharacterFile file = test::valueOf(parsed(writer));
  const MorphOffset& last = file.morphs.targets[0].offsets.back();
  EXPECT_TRUE(last.position.isApprox(Vec3f(0.0F, 0.0F, 2.0F * 7.0F * 0.25F), 1e-5F)) << last.position.transpose();
  EXPECT_TRUE(last.normal.isApprox(Vec3f(0.0F, -3.5F, 0.0F), 1e-5F)) << last.normal.transpose();
}

TEST(GltfMorphs, PrimitivesOfAMeshShareTheirTargets) {
  GlbWriter writer = morphingCharacter();
  nlohmann::json& primitives = writer.document["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  // The second has only one. Compilers differ over what braces around one element mean.
  primitives[1]["targets"] = nlohmann::json::array({primitives[0]["targets"][0]});
  const CharacterFile file = test::valueOf(parsed(writer));
  ASSERT_EQ(file.morphs.targets.size(), 2u);
  EXPECT_EQ(file.morphs.targets[0].offsets.size(), 14u);
  EXPECT_EQ(file.morphs.targets[0].offsets[7].vertex, 9);
  EXPECT_EQ(file.morphs.targets[1].offsets.size(), 7u);
}

TEST(GltfMorphs, UnusedVerticesDoNotShiftTheOffsets) {
  GlbWriter writer = morphingCharacter();
  const int indices = writer.accessor(std::vector<std::uint16_t>{7, 5, 3}, "SCALAR");
  writer.document["meshes"][0]["primitives"][0]["indices"] = indices;
  const CharacterFile file = test::valueOf(parsed(writer));
  const std::vector<MorphOffset>& offsets = file.morphs.targets[1].offsets;
  ASSERT_EQ(offsets.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(offsets[i].vertex, static_cast<VertexIndex>(i));
    EXPECT_FLOAT_EQ(offsets[i].position.x(), 0.125F * static_cast<float>(2 * i + 3));
  }
}

TEST(GltfMorphs, SparseOffsetsMoveOnlyTheirVertices) {
  GlbWriter writer = morphingCharacter();
  const int rows = writer.view(std::vector<std::uint16_t>{2, 6});
  const int values = writer.view(std::vector<float>{0, 1, 0, 0, 2, 0});
  const int accessor = writer.add("accessors", {{"componentType", 5126}, {"count", 8}, {"type", "VEC3"}});
  writer.document["accessors"][accessor]["sparse"] = test::sparse(2, rows, 5123, values);
  writer.document["meshes"][0]["primitives"][0]["targets"][0] = {{"POSITION", accessor}};
  const CharacterFile file = test::valueOf(parsed(writer));
  const std::vector<MorphOffset>& offsets = file.morphs.targets[0].offsets;
  ASSERT_EQ(offsets.size(), 2u);
  EXPECT_EQ(offsets[0].vertex, 2);
  EXPECT_EQ(offsets[1].vertex, 6);
  EXPECT_EQ(offsets[1].position, Vec3f(0.0F, 2.0F, 0.0F));
}

TEST(GltfMorphs, TargetsWithoutNamesAreNumbered) {
  GlbWriter writer = morphingCharacter();
  nlohmann::json& mesh = writer.document["meshes"][0];
  mesh["extras"] = {{"targetNames", {7, "Wink", "Too many"}}};
  CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_EQ(file.morphs.targets[0].name, "Body 0");
  EXPECT_EQ(file.morphs.targets[1].name, "Wink");
  mesh["extras"] = "none";
  mesh["primitives"][0]["extras"] = {{"targetNames", {"Joy"}}};
  EXPECT_EQ(test::valueOf(parsed(writer)).morphs.targets[0].name, "Joy");
}

TEST(GltfMorphs, ClipsMoveTheWeights) {
  GlbWriter writer = morphingCharacter();
  addWeights(writer, "LINEAR", {0.0F, 3.0F}, {0.0F, 1.0F, 1.0F, 0.25F});
  addWeights(writer, "STEP", {0.0F, 1.0F}, {0.0F, 1.0F, 1.0F, 0.25F});
  addWeights(writer, "CUBICSPLINE", {0.0F, 1.0F}, {0, 0, 0.25F, 0.5F, 0, 0, 0, 0, 0.75F, 0.5F, 0, 0});
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_TRUE(file.notes.empty());
  ASSERT_EQ(file.clips.size(), 4u);
  ASSERT_EQ(file.morphs.clips.size(), 4u);
  EXPECT_TRUE(file.morphs.clips[0].empty());
  EXPECT_EQ(file.clips[1].seconds, 3.0);
  const auto at = [&](std::size_t clip, double time) {
    std::vector<float> weights(2);
    sampleMorphWeights(file.morphs.clips[clip], time, weights);
    return weights;
  };
  EXPECT_EQ(at(1, 1.5), (std::vector<float>{0.5F, 0.625F}));
  EXPECT_EQ(at(2, 0.9), (std::vector<float>{0.0F, 1.0F}));
  EXPECT_EQ(at(3, 0.5), (std::vector<float>{0.5F, 0.5F}));
}

/// Weights far from 0 deform the character in its clips, and bones move what is deformed.
TEST(GltfMorphs, ClipsDeformTheSkinAsTheSpecificationSays) {
  for (const bool skinned : {true, false}) {
    for (const char* interpolation : {"LINEAR", "STEP", "CUBICSPLINE"}) {
      SCOPED_TRACE(testing::Message() << interpolation << ", skinned: " << skinned);
      GlbWriter writer = morphingCharacter();
      writer.document["meshes"][0]["weights"] = {0.5, 0.0};
      if (!skinned) writer.document["nodes"][2].erase("skin");
      std::vector<float> values;
      const int numbers = interpolation == std::string("CUBICSPLINE") ? 18 : 6;
      for (int i = 0; i < numbers; ++i) values.push_back(0.3F * static_cast<float>(i * 7 % 5) - 0.5F);
      addWeights(writer, interpolation, {0.25F, 1.0F, 1.5F}, values);
      // The clip that bends the upper bone moves weights as well.
      nlohmann::json& bend = writer.document["animations"][0];
      bend["samplers"].push_back(writer.document["animations"][1]["samplers"][0]);
      bend["channels"].push_back({{"sampler", 1}, {"target", {{"node", 2}, {"path", "weights"}}}});
      const CharacterFile file = test::valueOf(parsed(writer));
      EXPECT_FALSE(file.character.shapes.empty());
      EXPECT_EQ(file.nodeOfJoint.size(), file.character.jointFromModel.size());
      EXPECT_EQ(file.morphs.clips[1].size(), 1u);
      const test::GltfTruth truth(writer.glb());
      for (const int clip : {-1, 0, 1}) {
        for (const double time : {0.0, 0.25, 0.6, 1.0, 1.3, 2.0}) {
          EXPECT_LE(test::farthestFromTruth(file, truth, clip, time), 1e-5) << "clip " << clip << " at " << time;
        }
      }
    }
  }
}

TEST(GltfMorphs, BrokenTargetsAreSkippedAndTheBodyIsRead) {
  using Json = nlohmann::json;
  const auto list = [](const std::vector<float>& numbers, const char* type) {
    return [=](GlbWriter& w) { return w.accessor(numbers, type); };
  };
  std::vector<float> notFinite = steps({1.0F, 1.0F, 1.0F});
  notFinite[10] = std::numeric_limits<float>::quiet_NaN();
  struct Case {
    const char* attribute;
    std::function<int(GlbWriter&)> accessor;
    const char* note;
  };
  const std::vector<Case> cases = {
      {"POSITION", [](GlbWriter&) { return 4711; }, "refers to accessor 4711"},
      {"POSITION", list({1, 2, 3}, "VEC3"), "POSITION has 1 elements, expected 8"},
      {"POSITION", list(notFinite, "VEC3"), "element 3 has nan"},
      {"NORMAL", list(std::vector<float>(32, 1.0F), "VEC4"), "expected VEC3"},
      {"POSITION",
       [](GlbWriter& w) {
         return w.add("accessors", Json::parse(R"({"componentType": 5126, "count": 4000000000, "type": "VEC3"})"));
       },
       "too many for a file"},
      {"POSITION",
       [](GlbWriter& w) {
         const int beyond = w.accessor(std::vector<float>(3, 1.0F), "VEC3");
         w.document["accessors"][beyond]["count"] = 8;
         return beyond;
       },
       "but buffer view"}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.note);
    GlbWriter writer = morphingCharacter();
    const int accessor = c.accessor(writer);
    writer.document["meshes"][0]["primitives"][0]["targets"][1][c.attribute] = accessor;
    const CharacterFile file = test::valueOf(parsed(writer));
    EXPECT_EQ(file.character.mesh.vertices.size(), 8u);
    ASSERT_EQ(file.morphs.targets.size(), 2u);
    EXPECT_EQ(file.morphs.targets[0].offsets.size(), 7u);
    EXPECT_TRUE(hasNote(file, "1 part of a morph target could not be read: skipped (the first: "));
    EXPECT_TRUE(hasNote(file, c.note)) << file.notes.front();
  }
}

TEST(GltfMorphs, BrokenWeightChannelsAreSkippedAndTheOthersPlay) {
  struct Case {
    const char* interpolation;
    std::vector<float> times, values;
    int node;
    const char* note;
  };
  const std::vector<Case> cases = {
      {"LINEAR", {0, 1}, {1, 1, 1}, 2, "3 values for 2 keys of 2 morph targets, expected 4"},
      {"LINEAR", {0}, {1}, 0, "node 0 shows no morph targets"},
      {"LINEAR", {0}, {1}, 99, "node 99 shows no morph targets"},
      {"BEZIER", {0}, {1, 1}, 2, "expected STEP, LINEAR or CUBICSPLINE"},
      {"LINEAR", {0}, {std::numeric_limits<float>::infinity(), 0}, 2, "expected finite numbers"}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.note);
    GlbWriter writer = morphingCharacter();
    addWeights(writer, c.interpolation, c.times, c.values, c.node);
    addWeights(writer, "LINEAR", {0.0F, 1.0F}, {0.0F, 0.0F, 1.0F, 1.0F});
    const CharacterFile file = test::valueOf(parsed(writer));
    ASSERT_EQ(file.clips.size(), 2u);  // bend and the sound one
    EXPECT_EQ(file.morphs.clips[1].size(), 1u);
    EXPECT_TRUE(hasNote(file, c.note)) << file.notes.front();
  }
}

/// 4,096 targets that refer to the same offsets of 3,000 vertices would need 340 MB for a file of 0.1 MB.
TEST(GltfMorphs, OneListOfOffsetsCannotFillTheMemory) {
  constexpr std::size_t kVertices = 3000;
  GlbWriter writer = smallCharacter();
  nlohmann::json& mesh = writer.document["meshes"][0];
  const int positions = writer.accessor(std::vector<float>(3 * kVertices, 1.0F), "VEC3");
  mesh["primitives"] = {{{"attributes", {{"POSITION", positions}}}}};
  for (int t = 0; t < kMaxMorphTargets; ++t) {
    mesh["primitives"][0]["targets"].push_back({{"POSITION", positions}});
  }
  const CharacterFile file = test::valueOf(parsed(writer));
  std::size_t offsets = 0;
  for (const MorphTarget& target : file.morphs.targets) offsets += target.offsets.capacity();
  EXPECT_GT(offsets, 10 * kVertices);
  EXPECT_LT(3 * offsets, std::max<std::size_t>(8 * writer.glb().size(), 2'000'000));
  EXPECT_TRUE(hasNote(file, "moves 3,000 vertices, too many for a file of"));
}

TEST(GltfMorphs, AHundredThousandTargetsAreToldAndCut) {
  GlbWriter writer = morphingCharacter();
  nlohmann::json& targets = writer.document["meshes"][0]["primitives"][0]["targets"];
  const nlohmann::json target = targets[1];
  targets = nlohmann::json::array();
  for (int t = 0; t < 100'000; ++t) targets.push_back(target);
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_EQ(file.morphs.targets.size(), static_cast<std::size_t>(kMaxMorphTargets));
  EXPECT_EQ(file.morphTargets, 100'000);
  EXPECT_EQ(file.morphs.targets.back().offsets.size(), 7u);
  EXPECT_TRUE(hasNote(file, "100,000 morph targets, expected at most 4,096: the others are skipped"));
}

}  // namespace
}  // namespace lorica
