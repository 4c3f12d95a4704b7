
#include "acd/decompose.h"
#include "acd/level_of_detail.h"
#include "capture/files/joint_csv.h"
#include "collision/hulls/cover_choice.h"
#include "collision/hulls/file_content.h"
#include "collision/hulls/part_hulls.h"
#include "collision/hulls/quality.h"
#include "collision/live/live_body.h"
#include "geometry/files.h"
#include "geometry/random_numbers.h"
#include "session/prepare/body.h"
#include "session/prepare/training_motions.h"
#include "session/recording/session_file.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/skinning/body/hard_characters.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

/// A folder, what was said about it, and how often bodies were begun to be made.
struct Desk {
  test::TemporaryFolder folder;
  std::vector<std::string> said;
  int steps = 0;
  DecompositionCache cache{folder.path() / "cache", [this](const std::string& sentence) { said.push_back(sentence); }};

  Result<ClosedBody> body(const Character& character, double resolution = 0.0) {
    BodySettings settings;
    settings.resolution = resolution;
    settings.progress = [this](int, int) {
      ++steps;
      return true;
    };
    return cachedBody(character, settings, cache);
  }
  [[nodiscard]] std::vector<fs::path> entries() const {
    std::vector<fs::path> found;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(cache.folder, none)) found.push_back(entry.path());
    return found;
  }
};

Character openBox(double height) {
  Character character = test::bonesAt({{"root", kNoJoint, Vec3::Zero()}});
  TriMesh box = test::makeBox(Vec3(-0.5, 0.0, -0.5), Vec3(0.5, height, 0.5));
  box.triangles.pop_back();
  test::add(character, box, 0);
  return test::finished(std::move(character));
}

TEST(BodyCache, TheSecondTimeNothingIsMadeAndTheBodyIsTheSame) {
  Desk desk;
  const ClosedBody made = desk.body(openBox(1.0)).value();
  EXPECT_GT(desk.steps, 0);
  ASSERT_EQ(desk.entries().size(), 1u);
  EXPECT_EQ(desk.entries().front().extension(), ".body");
  desk.steps = 0;
  const ClosedBody again = desk.body(openBox(1.0)).value();
  EXPECT_EQ(desk.steps, 0);
  EXPECT_EQ(hashOf(again.character), hashOf(made.character));
  EXPECT_EQ(again.notes, made.notes);
  EXPECT_EQ(hashOf(makeBody(openBox(1.0)).value().character), hashOf(made.character));
  EXPECT_TRUE(desk.said.empty());
}

TEST(BodyCache, AnotherMeshOrResolutionIsAnotherBody) {
  Desk desk;
  (void)desk.body(openBox(1.0)).value();
  (void)desk.body(openBox(1.25)).value();
  (void)desk.body(openBox(1.0), 0.05).value();
  EXPECT_EQ(desk.entries().size(), 3u);
}

TEST(BodyCache, AClosedSurfaceIsNotKept) {
  Desk desk;
  Character closed = test::bonesAt({{"root", kNoJoint, Vec3::Zero()}});
  test::add(closed, test::makeBox(Vec3::Zero(), Vec3::Ones()), 0);
  closed = test::finished(std::move(closed));
  EXPECT_FALSE(desk.body(closed).value().made);
  EXPECT_TRUE(desk.entries().empty());
}

TEST(BodyCache, ADamagedEntryIsReplacedWithAWarning) {
  Desk desk;
  const std::uint64_t made = hashOf(desk.body(openBox(1.0)).value().character);
  const fs::path entry = desk.entries().front();
  const auto size = fs::file_size(entry);
  std::fstream(entry, std::ios::in | std::ios::out | std::ios::binary).seekp(static_cast<std::streamoff>(size / 2))
      << "??";
  EXPECT_EQ(hashOf(desk.body(openBox(1.0)).value().character), made);
  ASSERT_EQ(desk.said.size(), 1u);
  expectAll(desk.said.front(), {"damaged", "computed again"});

  // The entry of another character under this one's name.
  Desk other;
  (void)other.body(openBox(2.0)).value();
  fs::copy_file(other.entries().front(), entry, fs::copy_options::overwrite_existing);
  EXPECT_EQ(hashOf(desk.body(openBox(1.0)).value().character), made);
  EXPECT_EQ(desk.said.size(), 2u);
  desk.steps = 0;
  (void)desk.body(openBox(1.0)).value();
  EXPECT_EQ(desk.steps, 0) << "it was replaced";
}

TEST(BodyCache, AFolderThatCannotBeWrittenIsAWarning) {
  Desk desk;
  desk.cache.folder = desk.folder.write("occupied", "a file") / "cache";
  EXPECT_TRUE(desk.body(openBox(1.0)).ok());
  ASSERT_EQ(desk.said.size(), 1u);
  EXPECT_TRUE(has(desk.said.front(), "is not cached"));
}

TEST(BodyCache, ARefusedCharacterLeavesNothing) {
  Desk desk;
  EXPECT_FALSE(desk.body(openBox(1.0), 10.0).ok()) << "voxels larger than the character";
  EXPECT_TRUE(desk.entries().empty());
}

/// A box, whose topology does not depend on its size.
TriMesh box(double width) {
  return test::makeBox(Vec3::Zero(), Vec3(width, 1.0, 1.0));
}

class Cache : public testing::Test {
 protected:
  CachedDecomposition get(const TriMesh& mesh) {
    Result<CachedDecomposition> made =
        meshDecomposition("box", mesh, DecomposeSettings(),
                          {folder.path() / "c", [this](const std::string& sentence) { warnings.push_back(sentence); }});
    EXPECT_TRUE(made) << made.error().message;
    return std::move(made).value();
  }
  [[nodiscard]] std::vector<fs::path> entries() const {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder.path() / "c")) files.push_back(entry.path());
    return files;
  }
  test::TemporaryFolder folder;
  std::vector<std::string> warnings;
};

TEST_F(Cache, AnEntryIsUsedAgain) {
  EXPECT_FALSE(get(box(1.0)).fromCache);
  EXPECT_TRUE(get(box(1.0)).fromCache);
  EXPECT_FALSE(get(box(2.0)).fromCache);
  EXPECT_EQ(entries().size(), 2u);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
}

TEST_F(Cache, AValidEntryOfAnotherKeyIsNotUsed) {
  (void)get(box(1.0));
  const fs::path one = entries().front();
  const std::string first = readFile(one).value();
  (void)get(box(2.0));
  for (const fs::path& file : entries()) {
    if (file == one) continue;
    ASSERT_TRUE(writeFileAtomically(file, first));
  }
  EXPECT_FALSE(get(box(2.0)).fromCache) << "it has the same triangles, but other hulls";
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_TRUE(has(warnings[0], "does not begin with 'lorica cache entry"));
  EXPECT_TRUE(get(box(2.0)).fromCache) << "it was replaced";
}

TEST_F(Cache, EveryCutOffEntryIsReplaced) {
  (void)get(box(1.0));
  const fs::path file = entries().front();
  const std::string whole = readFile(file).value();
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{5}, std::size_t{36}, std::size_t{60}, whole.size() - 1}) {
    ASSERT_TRUE(writeFileAtomically(file, whole.substr(0, length)));
    EXPECT_FALSE(get(box(1.0)).fromCache) << length;
    EXPECT_EQ(readFile(file).value(), whole) << length;
  }
  EXPECT_EQ(warnings.size(), 5u);
}

TEST_F(Cache, ALinkIsReplacedAndAForeignFolderNotUsed) {
  (void)get(box(1.0));
  const fs::path file = entries().front();
  const fs::path target = folder.write("target", "precious");
  fs::remove(file);
  fs::create_symlink(target, file);
  EXPECT_FALSE(get(box(1.0)).fromCache);
  EXPECT_EQ(readFile(target).value(), "precious");
  EXPECT_FALSE(fs::is_symlink(file));
  EXPECT_TRUE(get(box(1.0)).fromCache);

  warnings.clear();
  fs::permissions(folder.path() / "c", fs::perms::all);
  EXPECT_FALSE(get(box(2.0)).fromCache);
  EXPECT_FALSE(get(box(2.0)).fromCache);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_TRUE(has(warnings[0], "everybody may write into it; what was computed is not cached"));
}

/// The mannequin with a rod of 40 cm in its left hand that no triangle of the body uses.
Character withRod() {
  Character character = makeMannequin();
  const JointIndex hand = character.skeleton.jointOf(HumanBone::kLeftHand);
  const Vec3 grip = character.jointFromModel[hand].inverse().translation();
  for (int k = 0; k <= 20; ++k) {
    character.mesh.vertices.emplace_back(grip + Vec3(0.08, 0.0, 0.02 * k));
    character.influences.push_back({hand, 1.0});
    character.influenceBegin.push_back(static_cast<std::uint32_t>(character.influences.size()));
  }
  return character;
}

TEST(UsedHulls, AreTheHullsThatPlay) {
  const Character character = withRod();
  Host host;
  Motion wave;
  wave.name = "wave";
  wave.joints = shippedFrames("wave");
  const std::vector<Motion> motions = {wave};
  const Training training = test::valueOf(trainingMotions(character, motions, {}));
  for (const int count : {3, kChooseKeyframes}) {
    const Keyframes keyframes = test::valueOf(trainingKeyframes(character, training, count));
    const PoseView poses{keyframes.positions, static_cast<int>(character.mesh.vertices.size())};
    const Decomposition parts = test::valueOf(decompose(character.mesh, poses, {.maxParts = 6}));
    const CoverPoses coverIn = test::valueOf(coverPoses(character, training.motions, 8));
    const HullCover few = test::valueOf(chooseCover(character, parts, coverIn, {std::nullopt, 100}, host));
    const BonePoseView bones{keyframes.worldFromModel, character.skeleton.jointCount()};
    ASSERT_EQ(bones.poseCount(), keyframes.count);
    std::vector<double> errors;
    for (const HullCover& cover : {coverExactly(parts, liftPoints(character, parts)), few}) {
      const UsedHulls hulls = liveHulls(character, parts, cover, bones);
      LiveBody body = test::valueOf(LiveBody::create(parts, character, cover));
      for (int k = 0; k < keyframes.count; ++k) {
        body.update(bones.pose(k));
        for (std::size_t i = 0; i < parts.parts.size(); ++i) {
          const ConvexHull played = worldHull(body.parts()[i]);
          const double volume = signedVolume(played.vertices, played.triangles);
          EXPECT_NEAR(hulls[k][i].volume, volume, 1e-5 * volume) << "keyframe " << k << ", part " << i;
        }
      }
      errors.push_back(measureQuality(character.mesh, poses, hulls).error);
    }
    // Both are larger than the hulls of the parts: one holds the rod, the other has few points too.
    EXPECT_GT(errors[0], measureQuality(character.mesh, poses, hullsOfParts(parts, poses)).error + 0.01);
    EXPECT_GT(errors[1], errors[0]);
  }
}

/// Two balls far from 0, as fine as the planes of a hull are put into groups for.
PartHulls balls(const Vec3& place) {
  PartHulls hulls;
  for (const double x : {0.0, 3.0}) {
    NamedMesh& ball = hulls.objects.emplace_back(NamedMesh{"ball", makeSphere(1.0, 24, 48)});
    for (Vec3& p : ball.mesh.vertices) p += place + Vec3(x, 0, 0);
  }
  return hulls;
}

TEST(PartHulls, WhatIsFarthestOutsideAllHullsIsNamed) {
  for (const Vec3& place : {Vec3(0, 0, 0), Vec3(-1000, 500, 2000)}) {
    const PartHulls hulls = balls(place);
    std::vector<Vec3> vertices = hulls.objects[0].mesh.vertices;
    RandomNumbers random(3);
    while (vertices.size() < 3000) {
      const Vec3 p(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
      if (p.norm() < 0.98) vertices.push_back(place + p + Vec3(vertices.size() % 2 == 0 ? 0.0 : 3.0, 0, 0));
    }
    std::vector<VertexIndex> which(vertices.size());
    std::iota(which.begin(), which.end(), 0);
    EXPECT_TRUE(checkHullsHold(hulls, vertices, which).ok());
    for (const double distance : {2e-5, 0.01, 0.4}) {
      const Vec3 corner = hulls.objects[0].mesh.vertices[300] - place;
      vertices[1500] = place + (1.0 + distance) * corner;
      vertices[1600] = place + Vec3(3, 0, 0) + (1.0 + 0.9 * distance) * corner;
      const Result<void> held = checkHullsHold(hulls, vertices, which);
      ASSERT_FALSE(held.ok()) << distance;
      EXPECT_TRUE(held.error().message.starts_with("vertex 1500 ")) << held.error().message;
      double brute = 0.0;
      for (const Triangle& t : hulls.objects[0].mesh.triangles) {
        const auto at = [&](std::size_t i) -> const Vec3& { return hulls.objects[0].mesh.vertices[t[i]]; };
        const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
        brute = std::max(brute, normal.dot(vertices[1500] - at(0)));
      }
      EXPECT_TRUE(has(held.error().message, fmt::format("is {:g} outside all hulls", brute))) << ", expected " << brute;
    }
    vertices[1500] = vertices[1600] = place;
    EXPECT_TRUE(checkHullsHold(hulls, vertices, which).ok());
    EXPECT_TRUE(checkHullsHold(hulls, vertices, {}).ok());
  }
}

}  // namespace
}  // namespace lorica::test
