#include "capture/sensor/oni_file.h"
#include "geometry/arrays/array_file.h"
#include "geometry/little_endian.h"
#include "geometry/new_file.h"
#include "tests/apps/mesh_text.h"
#include "tests/apps/run_command.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <vector>

namespace lorica::test {
namespace {

TEST(Info, DescribesAClosedMesh) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  const nlohmann::json json = jsonOf({"info", mesh});
  EXPECT_EQ(json["kind"], "mesh");
  EXPECT_EQ(json["vertices"], 12);
  EXPECT_EQ(json["triangles"], 20);
  EXPECT_EQ(json["components"], 1);
  EXPECT_EQ(json["closed"], true);
  EXPECT_TRUE(json["problem"].is_null());
  EXPECT_NEAR(json["volume"].get<double>(), 3.0, 1e-12);
  EXPECT_NEAR(json["convexity"].get<double>(), 3.0 / 3.5, 1e-12);
  EXPECT_EQ(json["boundingBox"], nlohmann::json::parse("[[0.0,0.0,0.0],[2.0,2.0,1.0]]"));
}

TEST(Info, SaysWhatIsWrongWithAnOpenMesh) {
  const TemporaryFolder folder;
  TriMesh mesh = makeBox({0, 0, 0}, {1, 1, 1});
  mesh.triangles.resize(10);
  const CommandResult result = runLorica({"info", writeObj(folder, "open.obj", mesh), "--json", "-"});
  EXPECT_EQ(result.exitCode, 0) << "describing a broken mesh is not an error: " << result.err;
  const nlohmann::json json = result.json();
  EXPECT_EQ(json["closed"], false);
  EXPECT_TRUE(has(json["problem"].get<std::string>(), "edge")) << json["problem"];
}

TEST(Info, SaysWhatIsMended) {
  const TemporaryFolder folder;
  TriMesh mesh = makeBox({0, 0, 0}, {1, 1, 1});
  mesh.triangles.pop_back();
  const nlohmann::json json = jsonOf({"info", writeObj(folder, "open.obj", mesh)});
  EXPECT_EQ(json["closed"], true);
  EXPECT_EQ(json["repaired"], "1 pinhole closed with 1 triangle");
}

TEST(Info, CountsComponents) {
  const TemporaryFolder folder;
  const TriMesh mesh = joined(makeBox({0, 0, 0}, {1, 1, 1}), makeBox({2, 0, 0}, {3, 1, 1}));
  EXPECT_EQ(jsonOf({"info", writeObj(folder, "two.obj", mesh)})["components"], 2);
}

TEST(Info, DescribesTheMannequin) {
  const nlohmann::json json = jsonOf({"info", "mannequin"});
  EXPECT_EQ(json["kind"], "character");
  EXPECT_EQ(json["closed"], true) << json["problem"];
  EXPECT_GE(json["joints"].get<int>(), 22);
  EXPECT_LE(json["maxInfluences"].get<int>(), 4);
  EXPECT_NEAR(json["height"].get<double>(), 1.75, 0.1);
}

TEST(Info, PrintsTheDetailLevelsAndWherePartsCameFrom) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  const std::filesystem::path file = folder.path() / "l.lorica";
  ASSERT_EQ(runLorica({"decompose", mesh, "--parts", "2", "-o", file}).exitCode, 0);
  const nlohmann::json json = jsonOf({"info", file});
  // One part: the hull is a pentagonal prism of volume 3.5, the mesh has 3. Two parts: boxes.
  ASSERT_EQ(json["detailLevels"].size(), 2u);
  EXPECT_EQ(json["detailLevels"][0]["parts"], 1);
  EXPECT_NEAR(json["detailLevels"][0]["error"].get<double>(), 0.5 / 3.0, 1e-9);
  EXPECT_NEAR(json["detailLevels"][0]["worstError"].get<double>(), 0.5 / 3.0, 1e-9);
  EXPECT_EQ(json["detailLevels"][0]["hullVertices"], 10);
  EXPECT_EQ(json["detailLevels"][1]["parts"], 2);
  EXPECT_NEAR(json["detailLevels"][1]["error"].get<double>(), 0.0, 1e-9);
  EXPECT_EQ(json["detailLevels"][1]["hullVertices"], 16);
  ASSERT_EQ(json["partOrigins"].size(), 2u);
  std::set<int> sources;
  for (const nlohmann::json& part : json["partOrigins"]) {
    for (const nlohmann::json& source : part["sourceTriangles"]) sources.insert(source.get<int>());
    EXPECT_FALSE(part.contains("bones"));
  }
  EXPECT_EQ(sources.size(), 20u);
  EXPECT_EQ(*sources.begin(), 0);
  EXPECT_EQ(*sources.rbegin(), 19);
  EXPECT_TRUE(json["partOrigins"][0]["splitFrom"].is_null());
  EXPECT_EQ(json["partOrigins"][1]["splitFrom"], 0);

  const std::string text = runLorica({"info", file}).out;
  EXPECT_TRUE(
      has(text, "\n  parts   error  hull vertices\n      1  16.7 %             10\n      2   0.0 %             16\n"));
  EXPECT_TRUE(has(text, "\n  part  source triangles  "));
}

TEST(Info, NamesTheBonesOfACharactersParts) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "body.lorica";
  const nlohmann::json made = jsonOf({"decompose", "mannequin", "--parts", "4", "--keyframes", "2", "-o", file});
  const nlohmann::json json = jsonOf({"info", file});
  ASSERT_EQ(json["detailLevels"].size(), 4u);
  EXPECT_NEAR(json["detailLevels"][3]["error"].get<double>(), made["error"].get<double>(), 1e-7);
  EXPECT_GE(json["detailLevels"][3]["worstError"].get<double>(), json["detailLevels"][3]["error"].get<double>());
  ASSERT_EQ(json["partOrigins"].size(), 4u);
  for (const nlohmann::json& part : json["partOrigins"]) {
    double sum = 0.0;
    double last = 1.0;
    for (const nlohmann::json& bone : part["bones"]) {
      const double share = bone["share"];
      EXPECT_LE(share, last);
      EXPECT_FALSE(bone["name"].get<std::string>().empty());
      sum += share;
      last = share;
    }
    EXPECT_NEAR(sum, 1.0, 1e-9);
  }
  const std::string text = runLorica({"info", file}).out;
  EXPECT_TRUE(has(text, "  worst keyframe  hull vertices\n"));
  EXPECT_TRUE(has(text, "  bones, by share of the surface\n"));
}

TEST(Info, DescribesARecording) {
  const nlohmann::json byName = jsonOf({"info", "walk"});
  EXPECT_EQ(byName["kind"], "recording");
  EXPECT_NEAR(byName["framesPerSecond"].get<double>(), 30.0, 0.1);
  EXPECT_GE(byName["seconds"].get<double>(), 5.0);
  EXPECT_NEAR(byName["jointsSeen"].get<double>() + byName["jointsGuessed"].get<double>() +
                  byName["jointsUnknown"].get<double>(),
              1.0, 1e-12);
  EXPECT_EQ(jsonOf({"info", recordingsFolder() / "walk.csv"}), byName);
}

TEST(Info, ADepthRecordingOfAnotherKindIsTheSameAsOni) {
  const TemporaryFolder folder;
  const std::unique_ptr<OniFile> source = valueOf(openOni(recordingsFolder() / "wave_depth.oni"));
  const DepthCamera& camera = source->camera();
  NamedArray depth{"depth", "<u2", {0, std::size_t(camera.height), std::size_t(camera.width)}, {}};
  NamedArray times{"times", "<f8", {0}, {}}, lens{"K", "<f8", {3, 3}, {}};
  for (DepthFrame frame; depth.shape[0] < 30 && valueOf(source->next(frame)) == DepthRead::kFrame; ++depth.shape[0]) {
    for (const std::uint16_t each : frame.depthMm) appendLittleEndian(each, depth.bytes);
    appendLittleEndian(frame.time, times.bytes);
    ++times.shape[0];
  }
  for (const double k : {camera.focalX(), 0.0, 0.5 * (camera.width - 1), 0.0, camera.focalY(),
                         0.5 * (camera.height - 1), 0.0, 0.0, 1.0}) {
    appendLittleEndian(k, lens.bytes);
  }
  const std::filesystem::path take = folder.path() / "take.npz", oni = folder.path() / "take.oni";
  const auto file = valueOf(NewFile::create(take));
  ASSERT_TRUE(writeArrays(std::vector{depth, times, lens}, *file));
  ASSERT_TRUE(file->finish());
  const nlohmann::json info = jsonOf({"info", take}), shipped = jsonOf({"info", "wave_depth"});
  EXPECT_EQ(info["kind"], shipped["kind"]);
  EXPECT_EQ(info["firstGuess"], shipped["firstGuess"]);
  EXPECT_EQ(jsonOf({"convert", take, oni})["frames"], 30);
  const nlohmann::json converted = jsonOf({"info", oni});
  for (const char* key : {"frames", "width", "height", "firstGuess"}) EXPECT_EQ(info[key], converted[key]) << key;
  const std::string joints = folder.path() / "joints.csv", same = folder.path() / "same.csv";
  EXPECT_EQ(jsonOf({"convert", take, joints})["frames"], jsonOf({"convert", oni, same})["frames"]);
}

}  // namespace
}  // namespace lorica::test
