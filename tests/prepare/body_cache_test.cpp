#include "prepare/cache_entries.h"

#include "session/recording/session_file.h"
#include "tests/skinning/body/hard_characters.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <fstream>

namespace lorica {
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
  EXPECT_NE(desk.said.front().find("damaged"), std::string::npos) << desk.said.front();
  EXPECT_NE(desk.said.front().find("computed again"), std::string::npos) << desk.said.front();

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
  EXPECT_NE(desk.said.front().find("is not cached"), std::string::npos) << desk.said.front();
}

TEST(BodyCache, ARefusedCharacterLeavesNothing) {
  Desk desk;
  EXPECT_FALSE(desk.body(openBox(1.0), 10.0).ok()) << "voxels larger than the character";
  EXPECT_TRUE(desk.entries().empty());
}

}  // namespace
}  // namespace lorica
