#include "geometry/work_budgets.h"
#include "skinning/import/character_file.h"
#include "skinning/import/file_scene.h"
#include "skinning/import/uri.h"
#include "tests/skinning/import/glb_writer.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <chrono>
#include <string>

namespace lorica {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;
using test::GlbWriter;

std::string errorOf(const GlbWriter& writer) {
  const std::string glb = writer.glb();
  const Result<CharacterFile> file = parseCharacterFile(std::as_bytes(std::span(glb)), "hero.glb");
  return file ? "none" : file.error().message;
}

/// Nodes that all draw one mesh of primitives that share one triangle.
GlbWriter repeated(int nodes, int primitives, int mode) {
  GlbWriter writer;
  const int triangle = writer.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  Json mesh = {{"primitives", Json::array()}};
  for (int p = 0; p < primitives; ++p) {
    mesh["primitives"].push_back({{"attributes", {{"POSITION", triangle}}}, {"mode", mode}});
  }
  writer.add("meshes", mesh);
  for (int n = 0; n < nodes; ++n) writer.add("nodes", {{"mesh", 0}});
  return writer;
}

TEST(GltfWork, NodesTimesPrimitivesAreBounded) {
  for (const int mode : {0, 4}) {  // points are skipped, but that takes time, too
    const Clock::time_point start = Clock::now();
    EXPECT_EQ(errorOf(repeated(99'000, 10'000, mode)),
              "hero.glb: its nodes draw 990,000,000 primitives, expected at most 200,000");
    EXPECT_LT(Clock::now() - start, std::chrono::seconds(60)) << "990 million steps take minutes";
  }
  EXPECT_EQ(errorOf(repeated(200, 100, 4)), "none");
}

/// A skin of joints in a chain or in a fan.
GlbWriter skinned(int joints, bool chain) {
  GlbWriter writer;
  const int triangle = writer.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const int bones = writer.accessor(std::vector<std::uint16_t>(12, 0), "VEC4");
  const int weights = writer.accessor(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
  Json list = Json::array();
  for (int j = 0; j < joints; ++j) {
    Json node = Json::object();
    if (chain && j + 1 < joints) node["children"] = Json::array({j + 1});
    if (!chain && j == 0) {
      for (int child = 1; child < joints; ++child) node["children"].push_back(child);
    }
    writer.add("nodes", node);
    list.push_back(j);
  }
  writer.add("skins", {{"joints", list}});
  writer.add(
      "meshes",
      {{"primitives",
        Json::array({{{"attributes", {{"POSITION", triangle}, {"JOINTS_0", bones}, {"WEIGHTS_0", weights}}}}})}});
  writer.add("nodes", {{"mesh", 0}, {"skin", 0}});
  return writer;
}

TEST(GltfWork, TrianglesAreBounded) {
  FileScene scene;
  for (FileMesh& mesh : scene.meshes = std::vector<FileMesh>(2)) mesh.triangles.resize(kMaxTriangles / 2);
  EXPECT_TRUE(checkWork(scene, "hero.glb").ok());
  scene.meshes[0].triangles.emplace_back();
  EXPECT_EQ(checkWork(scene, "hero.glb").error().message,
            "hero.glb: 10,000,001 triangles, expected at most 10,000,000");
}

TEST(GltfWork, JointsAreBounded) {
  for (const bool chain : {false, true}) {
    EXPECT_EQ(errorOf(skinned(kMaxJoints + 1, chain)), "hero.glb: 2,049 joints, expected at most 2,048") << chain;
    EXPECT_EQ(errorOf(skinned(kMaxJoints, chain)), "none");
  }
}

/// A triangle on a node, and a strand of joints that swing below it.
GlbWriter stranded(std::size_t joints) {
  GlbWriter writer = repeated(1, 1, 4);
  Json strand = Json::array();
  for (std::size_t j = 1; j <= joints; ++j) {
    writer.document["nodes"][j - 1]["children"] = Json::array({j});
    writer.add("nodes", {{"translation", {0.0, -0.01, 0.0}}});
    strand.push_back({{"node", j}});
  }
  writer.document["extensions"]["VRMC_vrm"] = {{"specVersion", "1.0"}};
  writer.document["extensions"]["VRMC_springBone"] = {{"specVersion", "1.0"},
                                                      {"springs", Json::array({{{"joints", strand}}})}};
  return writer;
}

TEST(GltfWork, JointsThatSwingAreBoundedWithoutASkin) {
  // The end of a strand is no joint; the node above it is one.
  EXPECT_EQ(errorOf(stranded(kMaxJoints + 1)), "hero.glb: 2,049 joints, expected at most 2,048");
  EXPECT_EQ(errorOf(stranded(kMaxJoints)), "none");
}

TEST(GltfWork, ClipsAreBounded) {
  const auto withClips = [](std::size_t clips) {
    GlbWriter writer = repeated(1, 1, 4);
    const int times = writer.accessor(std::vector<float>{0, 1}, "SCALAR");
    const int moves = writer.accessor(std::vector<float>{0, 0, 0, 1, 0, 0}, "VEC3");
    const Json clip = {
        {"samplers", Json::array({{{"input", times}, {"output", moves}}})},
        {"channels", Json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}})}};
    for (std::size_t c = 0; c < clips; ++c) writer.add("animations", clip);
    return writer;
  };
  EXPECT_EQ(errorOf(withClips(kMaxClips + 1)), "hero.glb: 10,001 clips, expected at most 10,000");
  EXPECT_EQ(errorOf(withClips(kMaxClips)), "none");
}

TEST(GltfWork, BuffersInNamedPipesAreRefused) {
  const test::TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder.path() / "fifo.bin").c_str(), 0600), 0);
  const Result<CharacterFile> file = readCharacterFile(folder.write(
      "fifo.gltf", R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "fifo.bin", "byteLength": 10}]})"));
  ASSERT_FALSE(file.ok());
  EXPECT_NE(file.error().message.find("found a named pipe, expected a file"), std::string::npos);
}

TEST(DataUri, BytesAbove127AreNotNegative) {
  const Result<std::string> bytes = decodeDataUri("data:;base64,AA\xe4");
  ASSERT_FALSE(bytes.ok());
  EXPECT_EQ(bytes.error().message, "its data URI has byte 228 at 2, expected base64");
}

}  // namespace
}  // namespace lorica
