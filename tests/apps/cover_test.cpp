#include "acd/decomposition_file.h"

#include "capture/files/joint_csv.h"
#include "collision/hulls/cover_choice.h"
#include "collision/live/choose_cover.h"
#include "geometry/convex_hull.h"
#include "geometry/mesh_files.h"
#include "session/pose_source.h"
#include "session/prepare/training_motions.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/apps/mesh_text.h"
#include "tests/apps/refusals.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lorica::test {
namespace {

/// A body with few parts from few keyframes.
CommandResult decomposeBody(const std::filesystem::path& file, const std::vector<std::string>& more) {
  std::vector<std::string> arguments = {"decompose",   "--force", "mannequin", "--parts", "8",
                                        "--keyframes", "2",       "-o",        file};
  arguments.insert(arguments.end(), more.begin(), more.end());
  arguments.insert(arguments.end(), {"--json", "-"});
  return runLorica(arguments);
}

/// A body with at most 100 points per part, made once, and its exported hulls.
struct BoundedBody {
  TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "body.lorica";
  std::filesystem::path hulls = folder.path() / "hulls.obj";
  CommandResult made = decomposeBody(file, {"--hull-vertices", "100", "--export-obj", hulls});
};
const BoundedBody& boundedBody() {
  static const BoundedBody body;
  return body;
}

/// The poses in which the command chooses covers: from the shipped recordings.
CoverPoses posesOfTheCommand(const Character& character) {
  std::vector<SkeletalMotion> motions;
  for (const char* name : {"walk", "wave", "jumping_jacks", "squat_and_reach", "punch_and_kick", "turn_around"}) {
    const std::vector<SkeletonFrame> frames = readJointCsv(recordingsFolder() / (std::string(name) + ".csv")).value();
    motions.push_back(perform(character.skeleton, frames).value());
  }
  return coverPoses(character, motions).value();
}

/// Largest distance of the parts' points outside the hulls of the stored cover, over the poses [m].
double farthestOut(const DecompositionFile& body, const std::vector<LiftedPoint>& lifted, BonePoseView poses,
                   int stride) {
  double farthest = 0.0;
  for (int pose = 0; pose < poses.poseCount(); pose += stride) {
    for (std::size_t i = 0; i < body.decomposition.parts.size(); ++i) {
      std::vector<Vec3> corners;
      for (const CoverPoint& p : body.cover->points[i]) {
        corners.push_back(positionOf(pushed(lifted[p.point], p.outward), poses.pose(pose)));
      }
      std::vector<Vec3> points;
      for (const PointIndex p : body.decomposition.parts[i].points) {
        points.push_back(positionOf(lifted[p], poses.pose(pose)));
      }
      farthest = std::max(farthest, largestViolation(convexHull(corners), points));
    }
  }
  return farthest;
}

TEST(Cover, IsKeptReportedAndStored) {
  const auto& [folder, file, hulls, made] = boundedBody();
  ASSERT_EQ(made.exitCode, 0) << made.err;
  const nlohmann::json figures = made.json()["cover"];
  EXPECT_EQ(figures["exact"], false);
  EXPECT_EQ(figures["hullVertices"], 100);
  EXPECT_EQ(figures["sampledPoses"], 128);
  EXPECT_EQ(figures["heldOutPoses"], 128);
  EXPECT_GT(figures["volumeGrowth"].get<double>(), 0.0);

  const DecompositionFile body = valueOf(readDecomposition(file));
  ASSERT_TRUE(body.cover.has_value());
  ASSERT_EQ(body.cover->points.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_LE(body.cover->points[i].size(), 100u);
    EXPECT_EQ(figures["pointsPerPart"][i], body.cover->points[i].size());
  }
  EXPECT_EQ(figures["growth"], body.cover->growth);
  EXPECT_EQ(figures["heldOutShortfall"], body.cover->heldOutShortfall);

  const Character character = makeMannequin();
  const CoverPoses poses = posesOfTheCommand(character);
  const std::vector<LiftedPoint> lifted = liftPoints(character, body.decomposition);
  EXPECT_LT(farthestOut(body, lifted, poses.sampledView(), 4), 1e-5 * character.height);
  EXPECT_NEAR(farthestOut(body, lifted, poses.heldOutView(), 1), body.cover->heldOutShortfall, 1e-6);

  // `lorica info` reports the same.
  nlohmann::json info = jsonOf({"info", file})["cover"];
  EXPECT_EQ(info["pointsPerPart"], figures["pointsPerPart"]);
  EXPECT_EQ(info["heldOutShortfall"], figures["heldOutShortfall"]);
  const std::string text = runLorica({"info", file}).out;
  expectAll(text, {"chosen in 128 poses, at most 100 per part", "in 128 other poses"});
}

TEST(Cover, PlayUsesTheCoverOfTheFileUnlessAnotherIsRequested) {
  const TemporaryFolder folder;
  const std::filesystem::path few = boundedBody().file;
  const std::filesystem::path all = folder.path() / "all.lorica";
  ASSERT_EQ(decomposeBody(all, {"--cover", "exact"}).exitCode, 0);
  EXPECT_FALSE(readDecomposition(all)->cover.has_value()) << "exact is the default";
  CommandSurroundings surroundings;
  surroundings.cache = folder.path() / "cache";
  const auto play = [&](const std::filesystem::path& body, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"play", "wave", "--decomposition", body, "--frames", "10", "--json", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = runLorica(arguments, surroundings);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    nlohmann::json json = result.json();
    json.erase("stages");
    return json;
  };
  const nlohmann::json exact = play(all, {});
  const nlohmann::json bounded = play(few, {});
  EXPECT_EQ(exact["cover"], nlohmann::json({{"exact", true}}));
  EXPECT_EQ(bounded["cover"]["hullVertices"], 100);
  EXPECT_NE(bounded["hash"], exact["hash"]);
  EXPECT_GT(bounded["error"].get<double>(), exact["error"].get<double>());
  // The error is known for the file's own hulls only.
  const auto unmeasured = [](nlohmann::json json) {
    json["error"] = nullptr;
    return json;
  };
  EXPECT_EQ(play(few, {"--cover", "exact"}), unmeasured(exact));
  EXPECT_FALSE(std::filesystem::exists(surroundings.cache / "lorica"));

  // Chosen by `play` it is the same cover; the next time it comes from the cache.
  EXPECT_EQ(play(all, {"--hull-vertices", "100"}), unmeasured(bounded));
  ASSERT_EQ(filesIn(surroundings.cache / "lorica").size(), 1u);
  const std::filesystem::path kept = surroundings.cache / "lorica" / filesIn(surroundings.cache / "lorica").front();
  const auto written = std::filesystem::last_write_time(kept);
  EXPECT_EQ(play(all, {"--hull-vertices", "100"}), unmeasured(bounded));
  EXPECT_EQ(std::filesystem::last_write_time(kept), written);
  play(all, {"--cover", "0.02"});
  EXPECT_EQ(filesIn(surroundings.cache / "lorica").size(), 2u) << "another cover has another cache file";
}

TEST(Cover, ATighterToleranceKeepsMorePointsAndLessProtrudes) {
  const TemporaryFolder folder;
  const CommandResult made =
      decomposeBody(folder.path() / "loose.lorica", {"--cover", "0.02", "--hull-vertices", "5000"});
  EXPECT_FALSE(made.json().contains("hullGrowth")) << "hullGrowth is for limited hulls in one pose";
  const nlohmann::json loose = made.json()["cover"];
  const nlohmann::json tight = decomposeBody(folder.path() / "tight.lorica", {"--cover", "0.005"}).json()["cover"];
  EXPECT_EQ(loose["tolerance"], 0.02);
  EXPECT_LE(loose["sampledShortfall"].get<double>(), 0.02);
  EXPECT_LE(tight["sampledShortfall"].get<double>(), 0.005);
  EXPECT_LT(tight["volumeGrowth"].get<double>(), loose["volumeGrowth"].get<double>());
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_GT(tight["pointsPerPart"][i].get<int>(), loose["pointsPerPart"][i].get<int>());
  }
}

TEST(Cover, WrongValuesAreRefusedBeforeAnyWork) {
  for (const std::string command : {"decompose", "play"}) {
    const std::string what = command == "play" ? "walk" : "mannequin";
    for (const char* bad : {"0", "-0.001", "2mm", "tight", "nan", "inf", ""}) {
      const CommandResult result = runLorica({command, what, std::string("--cover=") + bad});
      EXPECT_EQ(result.exitCode, 2) << bad;
      EXPECT_EQ(result.out, "");
      EXPECT_TRUE(has(result.err, "--cover")) << bad << ": " << result.err;
    }
    expectRefused(runLorica({command, what, "--cover", "2"}), {"found 2 m, expected at most 0.17"});
    expectRefused(runLorica({command, what, "--cover", "1e-9"}),
                  {"found 1e-09 m, expected exact, or at least 0.00018 m"});
    expectRefused(runLorica({command, what, "--cover", "exact", "--hull-vertices", "64"}), {"--hull-vertices 64"});
  }
}

TEST(Cover, AStaticMeshHasNone) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  expectRefused(runLorica({"decompose", mesh, "--cover", "0.01"}), {"--cover is for characters, but l.obj"});
  const std::filesystem::path file = folder.path() / "l.lorica";
  const nlohmann::json made = jsonOf({"decompose", mesh, "--hull-vertices", "8", "-o", file});
  EXPECT_FALSE(made.contains("cover"));
  EXPECT_TRUE(made.contains("hullGrowth"));
  EXPECT_FALSE(readDecomposition(file)->training.has_value());
  EXPECT_FALSE(has(runLorica({"info", file}).out, "cover"));
}

TEST(Cover, ExportedHullsOfACharacterHoldTheWholePartInTheBindPose) {
  const auto& [folder, file, hulls, made] = boundedBody();
  ASSERT_EQ(made.exitCode, 0) << made.err;
  EXPECT_EQ(made.json()["hullGrowthPerPart"].size(), 8u);
  const Character character = makeMannequin();
  const Decomposition decomposition = readDecomposition(file)->decomposition;
  const std::vector<LiftedPoint> lifted = liftPoints(character, decomposition);
  const std::vector<Affine3> bindPose(static_cast<std::size_t>(character.skeleton.jointCount()), Affine3::Identity());
  const std::vector<NamedMesh> objects = readObjObjects(hulls).value();
  ASSERT_EQ(objects.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_LE(objects[i].mesh.vertices.size(), 100u);
    std::vector<Vec3> points;
    for (const PointIndex p : decomposition.parts[i].points) {
      points.push_back(positionOf(lifted[p], bindPose));
    }
    EXPECT_LT(largestViolation(convexHull(objects[i].mesh.vertices), points), 1e-8);
  }
}

TEST(Cover, CtrlCCancelsTheChoice) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "body.lorica";
  ASSERT_EQ(decomposeBody(file, {}).exitCode, 0);
  CommandSurroundings surroundings;
  surroundings.cache = folder.path() / "cache";
  surroundings.interruptWhen = [](const RunningCommand& command) { return hasWorked(command, 1.5); };
  const CommandResult result = runLorica({"play", "walk", "--decomposition", file, "--cover", "0.0002"}, surroundings);
  EXPECT_EQ(result.exitCode, 130) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_FALSE(std::filesystem::exists(surroundings.cache / "lorica")) << "nothing is cached";
}

TEST(Training, EveryFrameOfTheTrainingIsKnownHoweverFewKeyframesThereAre) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "reacher.lorica";
  const nlohmann::json made =
      jsonOf({"decompose", "mannequin", "--parts", "5", "--motion", "squat_and_reach", "--keyframes", "1", "-o", file});
  const double known = jsonOf({"info", file})["training"]["knownDistance"];
  const nlohmann::json trained = jsonOf({"play", "squat_and_reach", "--decomposition", file})["training"];
  EXPECT_EQ(trained["framesOutside"], 0);
  EXPECT_NEAR(trained["largestDistance"].get<double>(), known, 1e-3 * known);
  EXPECT_GT(known, 0.2) << "greater than the default rule";
}

TEST(Training, PlayReportsPosesOutsideTheTrainingRange) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "waver.lorica";
  const CommandResult made = runLorica(
      {"decompose", "mannequin", "--parts", "5", "--motion", "wave", "--keyframes", "12", "-o", file, "--json", "-"});
  ASSERT_EQ(made.exitCode, 0) << made.err;
  const nlohmann::json known = jsonOf({"info", file})["training"];
  EXPECT_EQ(known["keyframes"], 12);
  EXPECT_EQ(known["probes"], 32);
  const double knownDistance = known["knownDistance"];
  const TrainingRange range = readDecomposition(file)->training.value();
  double sumSq = 0.0;
  for (const Vec3& p : range.positions) sumSq += p.squaredNorm();
  EXPECT_NEAR(knownDistance, 0.3 * std::sqrt(sumSq / static_cast<double>(range.positions.size())), 1e-12);

  const nlohmann::json inside = jsonOf({"play", "wave", "--decomposition", file})["training"];
  EXPECT_EQ(inside["framesOutside"], 0);
  EXPECT_TRUE(inside["firstOutside"].is_null());
  EXPECT_LE(inside["largestDistance"].get<double>(), knownDistance);
  EXPECT_GT(inside["largestDistance"].get<double>(), 0.0);

  const nlohmann::json outside = jsonOf({"play", "squat_and_reach", "--decomposition", file})["training"];
  EXPECT_EQ(outside["knownDistance"], knownDistance);
  EXPECT_GT(outside["largestDistance"].get<double>(), knownDistance);
  const int frames = outside["framesOutside"];
  EXPECT_GT(frames, 50);
  const int first = outside["firstOutside"]["frame"];
  EXPECT_NEAR(outside["firstOutside"]["time"].get<double>(), first / 30.0, 1e-3);
  // Stopped just before and just after it leaves the range.
  const auto until = [&file](int count) {
    return runLorica({"play", "squat_and_reach", "--decomposition", file, "--frames", std::to_string(count)}).out;
  };
  EXPECT_TRUE(has(until(first), "every pose is like one that the parts were made from (at most 0."));
  EXPECT_TRUE(has(until(first + 1),
                  "1 of " + std::to_string(first + 1) + " frames unlike those that the parts were made from"));
}

TEST(HullVertices, ExportedHullsKeepTheBudgetAndHoldTheMesh) {
  const TemporaryFolder folder;
  const TriMesh ball = makeSphere(1.0, 12, 18);
  const std::filesystem::path mesh = writeObj(folder, "ball.obj", ball);
  const std::filesystem::path hulls = folder.path() / "hulls.obj";
  const nlohmann::json json =
      jsonOf({"decompose", mesh, "--parts", "1", "--hull-vertices", "24", "--export-obj", hulls});
  const std::vector<NamedMesh> objects = valueOf(readObjObjects(hulls));
  ASSERT_EQ(objects.size(), 1u);
  const ConvexHull exported = convexHull(objects.front().mesh.vertices);
  EXPECT_LE(exported.vertices.size(), 24u);
  EXPECT_LE(largestViolation(exported, ball.vertices), 1e-8);  // numbers in the file have nine digits
  EXPECT_EQ(json["hullVertices"], 24);
  const double growth = exported.volume / convexHull(ball.vertices).volume;
  EXPECT_NEAR(json["hullGrowth"].get<double>(), growth, 1e-8);
  ASSERT_EQ(json["hullGrowthPerPart"].size(), 1u);
  EXPECT_NEAR(json["hullGrowthPerPart"][0].get<double>(), growth, 1e-8);
  EXPECT_GT(growth, 1.0);
  EXPECT_LT(growth, 1.2);
}

TEST(HullVertices, GrowthIsReportedWithoutAnExportToo) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "ball.obj", makeSphere(1.0, 12, 18));
  const CommandResult result = runLorica({"decompose", mesh, "--parts", "1", "--hull-vertices", "24"});
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_TRUE(has(result.out, "at most 24, before 200"));
  const CommandResult without = runLorica({"decompose", mesh, "--parts", "1", "--json", "-"});
  EXPECT_FALSE(without.json().contains("hullGrowth"));
}

TEST(HullPlanes, ExportedHullsHaveSoFewFaces) {
  const TemporaryFolder folder;
  const TriMesh ball = makeSphere(1.0, 12, 18);
  const std::filesystem::path mesh = writeObj(folder, "ball.obj", ball);
  const std::filesystem::path hulls = folder.path() / "hulls.obj";
  for (const char* command : {"decompose", "export"}) {
    std::vector<std::string> line = {command, mesh, "--parts", "1", "--hull-planes", "12", "--force", "--json", "-"};
    if (line.front() == "export") line.insert(line.begin() + 2, hulls);
    if (line.front() == "decompose") line.insert(line.end(), {"--export-obj", hulls});
    const CommandResult result = runLorica(line);
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const std::vector<NamedMesh> objects = valueOf(readObjObjects(hulls));
    ASSERT_EQ(objects.size(), 1u);
    const ConvexHull exported = convexHull(objects.front().mesh.vertices);
    EXPECT_LE(exported.vertices.size(), 20u);  // 12 planes, three in each corner
    EXPECT_LE(largestViolation(exported, ball.vertices), 1e-8);
    EXPECT_LT(exported.volume, 1.03 * 5.5503);  // of a dodecahedron around it
    EXPECT_NEAR(result.json()[line.front() == "export" ? "growth" : "hullGrowth"].get<double>(),
                exported.volume / convexHull(ball.vertices).volume, 1e-8);
  }
}

TEST(HullVertices, BoxesNeedNoMore) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  const nlohmann::json result = jsonOf({"decompose", mesh, "--hull-vertices", "32"});
  EXPECT_EQ(result["hullGrowth"], 1.0);
}

TEST(HullVertices, TooFewForACharacterSayWhatHelps) {
  expectRefused(runLorica({"decompose", "mannequin", "--parts", "2", "--hull-vertices", "4"}),
                {"allow more vertices\n"});
}

TEST(KeyframesAuto, SaysWhichFramesOfWhichRecording) {
  const std::vector<std::string> command = {"decompose", "mannequin", "--parts", "1",        "--keyframes",
                                            "auto",      "--motion",  "wave",    "--motion", "walk"};
  std::vector<std::string> asJson = command;
  asJson.insert(asJson.end(), {"--json", "-"});
  const CommandResult result = runLorica(asJson);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json json = result.json();
  const nlohmann::json& chosen = json["chosenKeyframes"];
  ASSERT_GT(chosen.size(), 1u);
  ASSERT_LE(chosen.size(), 12u);
  EXPECT_EQ(json["keyframes"], chosen.size());
  EXPECT_EQ(chosen[0]["motion"], "wave");
  EXPECT_EQ(chosen[0]["frame"], 0);
  bool fromWalk = false;
  for (const nlohmann::json& frame : chosen) {
    fromWalk |= frame["motion"] == "walk";
    EXPECT_TRUE(frame["motion"] == "walk" || frame["motion"] == "wave") << frame;
    // Both were recorded at 30 frames a second.
    EXPECT_NEAR(frame["time"].get<double>(), frame["frame"].get<int>() / 30.0, 1e-3);
  }
  EXPECT_TRUE(fromWalk);
  const CommandResult text = runLorica(command);
  EXPECT_TRUE(has(text.out, "These keyframes were chosen"));
}

}  // namespace
}  // namespace lorica::test
